/// \file
/// Tries the values of a plan in its scene, so that what is wrong is known before the first case runs.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/study/prepared.hpp"

namespace withy::campaign {

/// Sets a value of a case; `null` takes away what the scene has there, if it has anything.
void set_or_take(SceneValues& scene, const std::string& path, const Value& value, const std::string& origin);

/// A value that stands in the plan, to be tried at a path of the scene.
struct Trial {
  std::size_t axis = 0;
  std::string path;
  Value value;  ///< with its place in the plan
};

/// Values that cases set together: a row of a list, by their paths.
using TrialRow = std::vector<std::pair<std::string, Value>>;

/// Problems of a plan and of scenes made from it, told together.
class Problems {
 public:
  explicit Problems(std::string plan) : plan_(std::move(plan)) {}
  Diagnostics& of_plan() { return of_plan_; }
  /// Adds those of a scene, at the places of the plan that values come from or at those of the scene's file.
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

/// Makes the scene, then again with the first value of every axis, then with each other one in its place, then with
/// each of the rows. What is wrong with a row is no problem of the plan: its cases are refused.
/// \returns what all of these scenes were made from
SceneSources try_values(const SceneValues& base, const std::vector<Trial>& trials, const std::vector<TrialRow>& rows,
                        const std::string& plan, Registry& registry, Problems& problems);

/// The scene without what varies: names are looked up in it, whatever else is wrong with the plan. Null where it cannot
/// be and something is said already, which may be that. \throws SceneError, InputError where nothing is said yet
std::shared_ptr<study::Prepared> prepared_base(SceneValues base, Registry& registry, const Problems& problems);

}  // namespace withy::campaign
