/// \file
/// Scenes that are run for their certificates.
#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/scene/scene_error.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study::certified_scenes {

using test::plugins;

inline constexpr int outputs = 25;

/// A scene in a formulation; with `mixed` that body in `ruthless`.
struct Certified {
  std::string formulation, mixed;
  Prepared prepared;
  CertifiedRun run;
  std::vector<State> seen;  ///< outputs up to the last state that can be trusted

  [[nodiscard]] const Model& model() const { return prepared.model(); }
  [[nodiscard]] const Certificate& certificate() const { return run.certificate; }
  [[nodiscard]] const EquationsOfMotion& equations() const { return *prepared.equations; }
};

/// Before the name of a scene that is run to its own end.
inline const std::string whole = "whole:";

/// Where the environment has it, all scenes are run to their ends, in all formulations: the target `certificates`.
inline const char* const everything = "WITHY_CERTIFY_WHOLE";

inline SceneValues shortened(const std::string& file) {
  if (file.starts_with(whole)) return SceneValues::read(file.substr(whole.size()));
  const auto is = [&](const char* name) { return file.find(name) != std::string::npos; };
  const double longest = is("orbiting-boom") ? 0.002 : is("long-chain") || is("spacecraft") ? 0.03 : 0.1;  // [s]
  SceneValues values = SceneValues::read(file);
  const Value* given = values.root().at("time").find("end");  // else the scene ends with its motions
  const double end =
      given != nullptr && given->kind() == Value::Kind::number ? std::min(given->number(), longest) : longest;
  values.set("time.end", Value(end), "the test").set("time.output", Value(end / outputs), "the test");
  return values;
}

/// Nothing where the formulation cannot treat the scene.
inline std::optional<Certified> certified(const std::string& file, const std::string& formulation,
                                          const std::string& mixed, bool tight) {
  SceneValues values = shortened(file);
  values.choose_formulation(formulation, "the test");
  if (!mixed.empty()) values.body_formulation(mixed, "ruthless", "the test");
  if (tight) {
    const Value dop853 =
        Value::map({{"name", Value(std::string("dop853"))}, {"rtol", Value(1e-10)}, {"atol", Value(1e-12)}});
    values.choose_integrator(dop853, "the test");
  }
  try {
    Certified c{formulation, mixed, prepare(values, plugins()), {}, {}};
    RunSettings settings;
    if (tight) settings.estimate = Estimate::never;
    settings.look_beyond = !tight;
    settings.output = [&](const State& state, std::size_t) { c.seen.push_back(state); };
    c.run = run(c.prepared, plugins(), settings);
    std::erase_if(c.seen, [&](const State& s) { return s.time > c.run.summary.final.time; });
    return c;
  } catch (const SceneError&) {
    return {};
  } catch (const InputError&) {
    return {};
  } catch (const std::invalid_argument&) {  // an integrator that the formulation has no way to
    return {};
  }
}

}  // namespace withy::study::certified_scenes
