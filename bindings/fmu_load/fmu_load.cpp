/// \file
/// A controller from elsewhere: an FMU for co-simulation, stepped at its own rate.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "withy/bindings/fmu_load/fmu_block.hpp"
#include "withy/core/plugin/entry.hpp"
#include "withy/core/plugin/file_notes.hpp"
#include "withy/loads/control/bound_control.hpp"
#include "withy/scene/names.hpp"

namespace withy::fmu_load {
namespace {

/// The controller of any model; an FMU is always by the clock.
class FmuLoad final : public Load {
 public:
  FmuLoad(ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : ends_(std::move(ends)), block_(std::move(block)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return make_sampled_control(model, ends_, block_);
  }

 private:
  ControlEnds ends_;
  std::shared_ptr<const ControlBlock> block_;
};

/// Reads a load of this type; what is wrong is reported with its place.
class Reader {
 public:
  Reader(const Value& p, const MakeContext& context) : p_(p), context_(context) {}

  std::unique_ptr<Load> read() {
    const std::size_t before = context_.diagnostics.errors().size();
    const std::shared_ptr<const Program> program = load();
    if (program == nullptr) return nullptr;
    std::optional<ControlEnds> ends = read_ends_of(program->description());
    if (!ends) return nullptr;
    Wiring wiring;
    find(wiring.inputs, "inputs", measured(*ends), "input");
    find(wiring.outputs, "outputs", commanded(*ends), "output");
    read_settings(wiring);
    if (context_.diagnostics.errors().size() != before) return nullptr;
    try {
      auto block = std::make_shared<FmuBlock>(p_.text_at("file"), p_.place().line, program, std::move(wiring), 0);
      block->set_sample(ends->sample);
      return std::make_unique<FmuLoad>(std::move(*ends), std::move(block));
    } catch (const FmuError& e) {
      error(p_.at("file"), fmt::format("FMU '{}': {}", p_.text_at("file"), e.what()));
    }
    return nullptr;
  }

 private:
  void error(const Value& at, const std::string& message) { context_.diagnostics.error(at.place(), message); }

  std::shared_ptr<const Program> load() {
    const Value& named = p_.at("file");
    const auto fault = [&](const std::string& why) {
      error(named, fmt::format("got '{}'; {}", named.text(), why));
      return nullptr;
    };
    const std::filesystem::path file = std::filesystem::path(context_.directory) / named.text();
    std::error_code none;
    if (!std::filesystem::is_regular_file(file, none))
      return fault(fmt::format("there is no file '{}'; need an FMU", file.string()));
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    if (!stream) return fault(fmt::format("'{}' cannot be read", file.string()));
    FileNotes::add(named.text(), bytes);
    try {
      auto archive = std::make_unique<const Archive>(file);
      description_ = read_description(archive->description());
      return std::make_shared<const Program>(std::move(archive), description_);
    } catch (const std::exception& e) {
      return fault(fmt::format("the FMU {}", e.what()));
    }
  }

  std::optional<ControlEnds> read_ends_of(const FmuDescription& d) {
    Value with_sample = p_;
    if (!p_.has("sample")) {
      if (!d.step) {
        error(p_, "needs a 'sample': the FMU proposes no step of its own");
        return {};
      }
      with_sample.set("sample", Value(*d.step));
    }
    std::optional<ControlEnds> ends = read_ends(with_sample, context_);
    if (ends) ends->measures_nothing = !p_.has("of") && !p_.has("inputs");
    return ends;
  }

  std::vector<std::string> texts_of(const char* key) const {
    std::vector<std::string> all;
    if (const Value* given = p_.find(key))
      for (const Value& item : given->items()) all.push_back(item.text());
    return all;
  }
  /// Names of variables: as given, or those of the signals.
  std::vector<std::string> measured(const ControlEnds& ends) {
    if (!p_.has("inputs")) return ends.of;
    const std::size_t signals = ends.of.empty() ? 1 : ends.of.size();
    std::vector<std::string> names = texts_of("inputs");
    if (names.size() != signals)
      error(p_.at("inputs"), fmt::format("got {} names; need {}, one a signal of 'of'", names.size(), signals));
    return names;
  }
  /// As given, or all outputs of the FMU where there are as many as it acts on.
  std::vector<std::string> commanded(const ControlEnds& ends) {
    const std::size_t places = ends.to.empty() ? 1 : ends.to.size();
    std::vector<std::string> names = texts_of("outputs");
    if (!p_.has("outputs"))
      for (const FmuVariable& v : description_.variables)
        if (v.causality == "output" && v.is_number()) names.push_back(v.name);
    if (ends.acts && names.size() != places)
      error(p_.has("outputs") ? p_.at("outputs") : p_,
            fmt::format("{} {} outputs; need {}, one a place where it acts: 'outputs' names them",
                        p_.has("outputs") ? "got" : "the FMU has", names.size(), places));
    return names;
  }

  void find(std::vector<std::uint32_t>& references, const char* key, const std::vector<std::string>& names,
            const char* causality) {
    const Value& at = p_.has(key) ? p_.at(key) : p_.has("of") && key == std::string("inputs") ? p_.at("of") : p_;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool listed = at.kind() == Value::Kind::list && i < at.items().size();
      if (const FmuVariable* v = variable(names[i], causality, listed ? at.items()[i] : at))
        references.push_back(v->reference);
    }
  }
  const FmuVariable* variable(const std::string& name, const std::string& causality, const Value& at) {
    const auto& all = description_.variables;
    const auto known = [&](const FmuVariable& v) { return v.name == name; };
    const auto found = std::find_if(all.begin(), all.end(), known);
    if (found != all.end() && found->causality == causality && found->is_number()) return &*found;
    std::vector<std::string> candidates;
    for (const FmuVariable& v : all)
      if (v.causality == causality && v.is_number()) candidates.push_back(v.name);
    const std::string near = nearest(name, candidates);
    const std::string why = found == all.end() ? std::string("the FMU has no such variable")
                            : found->causality != causality
                                ? "it is no " + causality + " of the FMU but " + found->causality
                                : "it is " + (found->array ? std::string("an array") : "of type " + found->type) +
                                      "; need a single real number";
    error(at, fmt::format("got '{}'; {}{}; {}s: {}", name, why,
                          near.empty() || near == name ? "" : fmt::format(", did you mean '{}'?", near), causality,
                          candidates.empty() ? "none" : fmt::format("{}", fmt::join(candidates, ", "))));
    return nullptr;
  }

  /// "name=number".
  void read_settings(Wiring& wiring) {
    const Value* given = p_.find("set");
    if (given == nullptr) return;
    for (const Value& item : given->items()) {
      const std::string& text = item.text();
      const std::size_t equals = text.rfind('=');
      double value = 0;
      const char* const end = text.data() + text.size();
      const auto read =
          std::from_chars(text.data() + (equals == std::string::npos ? text.size() : equals + 1), end, value);
      const bool whole =
          equals != std::string::npos && read.ec == std::errc() && read.ptr == end && std::isfinite(value);
      if (!whole) {
        error(item, fmt::format("got '{}'; need name=number, of a parameter of the FMU", text));
      } else if (const FmuVariable* v = variable(text.substr(0, equals), "parameter", item)) {
        wiring.parameters.push_back(v->reference);
        wiring.parameter_values.push_back(value);
      }
    }
  }

  const Value& p_;
  const MakeContext& context_;
  FmuDescription description_;
};

std::unique_ptr<Load> make_fmu_load(const Value& p, const MakeContext& context) { return Reader(p, context).read(); }

void enroll_fmu_load(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "fmu",
       .summary = "Controller: an FMU (2.0 or 3.0, co-simulation), stepped by the clock",
       .parameters = control_parameters(
           {text("file", "the FMU, relative to the scene"),
            texts("inputs", "its inputs, one a signal of 'of'; where left out they have the signals' names").optional(),
            texts("outputs", "its outputs, one a place where it acts; where left out all that it has").optional(),
            texts("set", "its parameters, each as name=number, before it is initialized").optional()}),
       .make = &make_fmu_load});
}

}  // namespace
}  // namespace withy::fmu_load

WITHY_PLUGIN(fmu, withy::fmu_load::enroll_fmu_load);
