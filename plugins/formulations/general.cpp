/// \file
/// A formulation by its two choices: any strain kinematics, any truncation. The other names are presets of it.
#include "formulation_plugin.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"

namespace withy {
namespace {

Truncation truncation_named(const std::string& name) {
  if (name == "ruthless") return Truncation::ruthless;
  if (name == "strict") return Truncation::strict;
  return name == "symmetric" ? Truncation::symmetric : Truncation::none;
}

std::unique_ptr<Formulation> make(const Value& p, const MakeContext& context) {
  const Value& wanted = p.at("kinematics");
  const Plugin<StrainKinematics>* plugin = context.registry.find<StrainKinematics>(wanted.text());
  if (plugin == nullptr) {
    std::string known;
    for (const std::string& id : context.registry.ids<StrainKinematics>()) known += (known.empty() ? "" : ", ") + id;
    context.diagnostics.error(wanted.place(),
                              "no strain-kinematics plugin \"" + wanted.text() + "\"; available: " + known);
    return nullptr;
  }
  std::shared_ptr<const StrainKinematics> kinematics = plugin->make(Value::map({}, wanted.place()), context);
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
