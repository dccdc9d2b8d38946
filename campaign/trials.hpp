/// \file
/// Tries the values of a plan in its scene, so that what is wrong is known before the first case runs.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/study/prepared.hpp"

namespace withy::campaign {

/// Sets a value of a case; `null` takes away what the scene has there, if it has anything.
void set_or_take(SceneValues& scene, const std::string& path, const Value& value, const std::string& origin);

/// A value of an axis, to be tried in the scene.
struct Trial {
  std::size_t axis = 0;
  Value value;  ///< with its place in the plan
  /// It bounds or places a distribution: no case need have it, nor what follows from it.
  bool end = false;
};

/// Values that cases set together: a row of a list, by their axes.
using TrialRow = std::vector<std::pair<std::size_t, Value>>;

/// Problems of a plan and of scenes made from it, told together.
class Problems {
 public:
  explicit Problems(std::string plan) : plan_(std::move(plan)) {}
  Diagnostics& of_plan() { return of_plan_; }
  /// Adds those of a scene, at the places of the plan that values come from or at those of the scene's file; but not
  /// those of a value of which another scene has told some.
  void add(const SceneError& error, const SceneValues& values);
  [[nodiscard]] bool none() const { return of_plan_.ok() && of_scene_.empty(); }
  /// \throws SceneError where there are any.
  void raise() const;

 private:
  std::string plan_;
  Diagnostics of_plan_;
  std::vector<Diagnostic> of_scene_;
  std::vector<std::string> origins_;
};

/// "plan.yaml:7:3".
std::string origin_of(const std::string& file, const Place& place);

/// Puts values of the axes into a scene, and what follows from them if `derive`: but for formulas that name no number.
/// \param source as value_of has it
/// \param last the axis whose place messages name of what several have set, as the elements of an inertia; where there
/// is none, or another axis leads into it, the last one
void set_values(const Plan& plan, const Value& source, CaseValues values, bool derive, SceneValues& scene,
                std::optional<std::size_t> last = {});

/// What came of trials.
struct Tried {
  SceneSources sources;  ///< of all scenes that could be made
  Value source;          ///< checked values of the scene without what varies
  /// Of each axis: values of all with which the scene took its first quantity, or its first value where it has none;
  /// empty where they are not known.
  std::vector<CaseValues> beside;
};

/// Makes the scene, then again with each value beside the first of every other axis. One that is refused there may only
/// not go together with these: it is tried alone, then beside the other values of each axis, and is a problem where
/// the scene takes it nowhere. Then come the rows: what is wrong with them is no problem of the plan, but of their
/// cases, which are refused. \param plan with its axes and what is derived
Tried try_values(const Plan& plan, const SceneValues& base, const std::vector<Trial>& trials,
                 const std::vector<TrialRow>& rows, Registry& registry, Problems& problems);

/// The scene without what varies: names are looked up in it, whatever else is wrong with the plan. Null where it cannot
/// be and something is said already, which may be that. \throws SceneError, InputError where nothing is said yet
std::shared_ptr<study::Prepared> prepared_base(SceneValues base, Registry& registry, const Problems& problems);

}  // namespace withy::campaign
