/// \file
/// A formulation by its two choices: any strain kinematics, any truncation. The other names are presets of it.

#include "formulation_plugin.hpp"
#include "withy/core/plugin/default_values.hpp"
#include "withy/core/plugin/plugin_call.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"

namespace withy {
namespace {

Truncation truncation_named(const std::string& name) {
  if (name == "ruthless") return Truncation::ruthless;
  if (name == "strict") return Truncation::strict;
  return name == "symmetric" ? Truncation::symmetric : Truncation::none;
}

/// Null after reporting at `wanted`, which names it.
std::shared_ptr<const StrainKinematics> kinematics_named(const Value& wanted, const MakeContext& context) {
  const auto refuse = [&](const std::string& why) -> std::shared_ptr<const StrainKinematics> {
    context.diagnostics.error(wanted.place(), why);
    return nullptr;
  };
  const Plugin<StrainKinematics>* plugin = context.registry.find<StrainKinematics>(wanted.text());
  if (plugin == nullptr) {
    std::string known;
    for (const std::string& id : context.registry.ids<StrainKinematics>()) known += (known.empty() ? "" : ", ") + id;
    return refuse("no strain-kinematics plugin \"" + wanted.text() + "\"; available: " + known);
  }
  const std::string who = "strain kinematics '" + plugin->id + "'";
  for (const ParameterSpec& spec : plugin->parameters)
    if (spec.required && !spec.fallback)
      return refuse(who + " needs '" + spec.key + "', and a scene names strain kinematics without parameters");
  const std::size_t before = context.diagnostics.errors().size();
  try {
    return plugin_call(who + " cannot be made", [&] {
      std::shared_ptr<const StrainKinematics> made =
          plugin->make(default_values(plugin->parameters, wanted.place()), context);
      if (made == nullptr && context.diagnostics.errors().size() == before)
        return refuse(who + " cannot be made and does not say why");
      const std::string fault = made == nullptr ? "" : find_fault(*made);
      return fault.empty() ? made : refuse(who + " made one that cannot be: " + fault);
    });
  } catch (const std::invalid_argument& e) {
    const std::string why = e.what();
    return refuse(why.starts_with(who) ? why : who + " cannot be made: " + why);
  }
}

std::unique_ptr<Formulation> make(const Value& p, const MakeContext& context) {
  const std::shared_ptr<const StrainKinematics> kinematics = kinematics_named(p.at("kinematics"), context);
  if (kinematics == nullptr) return nullptr;
  Terms terms{kinematics->order(), truncation_named(p.text_at("truncation"))};
  const bool anew = terms.strain != StrainOrder::linear && !kinematics->complete();
  if (anew) terms.kinematics = kinematics;
  return std::make_unique<SweptFormulation>(terms, InStudies::aside);
}

}  // namespace

void enroll_general(Enrollment& enrollment) {
  enrollment.add<Formulation>(
      {.id = "general",
       .summary = "Any strain kinematics with any truncation",
       .parameters = {text("kinematics", "strain kinematics").naming(ParameterSpec::Refers::strain_kinematics),
                      text("truncation", "how elastic coordinates enter the equations")
                          .one_of({"ruthless", "strict", "symmetric", "none"})
                          .otherwise("none")},
       .make = &make});
}

}  // namespace withy
