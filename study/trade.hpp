/// \file
/// Runs the points of a trade study against a converged reference, on all cores, and keeps what is finished.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "withy/apps/withy/comparison.hpp"
#include "withy/apps/withy/trade_plan.hpp"

namespace withy::study {

/// What one point gave. Errors are greatest distances from the reference over the outputs.
struct TradeResult {
  TradePoint point;
  std::string status;         ///< of the run; "refused" where the scene has no such model
  std::string message;        ///< why it is not "completed"
  double hinge_error = 0;     ///< greatest of all hinges [rad, m]
  double tip_error = 0;       ///< greatest of all tips [m]
  double relative_error = 0;  ///< the greater of both, over the greatest way that a hinge or tip goes in the reference
  double cpu_seconds = 0;
  std::size_t steps = 0, evaluations = 0;
  double reference_error = 0;  ///< of its reference, relative: errors below it cannot be told apart
  [[nodiscard]] bool completed() const { return status == "completed"; }
};
nlohmann::ordered_json result_json(const TradeResult& result);

/// The run that errors are measured against: `exact` where every flexible body offers it, else `quadratic`, with more
/// modes than any point and a tighter tolerance.
struct TradeReference {
  TradePoint point;
  ComparedRun run;
  double hinge_way = 0, tip_way = 0;      ///< greatest distances from the start [rad or m; m]
  double hinge_error = 0, tip_error = 0;  ///< its own, by one mode less and ten times the tolerance
  double relative_error = 0;
};

struct TradeOptions {
  std::filesystem::path folder;  ///< where finished points are kept and found; empty: nowhere
  std::size_t jobs = 0;          ///< threads; 0: one a core
};

class TradeStudy {
 public:
  TradeStudy(const SceneArguments& arguments, std::vector<TradePoint> points, TradeOptions options);
  ~TradeStudy();
  /// One more point; it must not have more modes or a smaller tolerance than the others, on which the reference rests.
  void add(const TradePoint& point);
  /// Runs what is not finished yet; false where the user interrupted. Results do not depend on the number of threads.
  bool run();
  /// Of the finished points, in their order.
  [[nodiscard]] std::vector<TradeResult> results() const;
  /// Of that point; null where it is not among them or not finished.
  [[nodiscard]] const TradeResult* result(const TradePoint& point) const;
  /// By the values gone over, joined with spaces.
  [[nodiscard]] const nlohmann::ordered_json& references() const;
  [[nodiscard]] const Engine& engine() const { return engine_; }

 private:
  [[nodiscard]] TradeResult run_point(const TradePoint& point);
  [[nodiscard]] const TradeReference& reference_for(const TradePoint& point);
  [[nodiscard]] ComparedRun simulate(const TradePoint& point, double& cpu_seconds);
  void find_finished(std::size_t first);
  void keep(const TradeResult& result) const;

  struct Shared;
  SceneArguments arguments_;
  Engine engine_;
  std::vector<TradePoint> points_;
  TradeOptions options_;
  std::string fingerprint_;  ///< of the scene, the overrides and the points that set the reference
  std::vector<std::optional<TradeResult>> finished_;
  std::unique_ptr<Shared> shared_;
};

/// Whether no other completed point is both more accurate, as far as its reference can tell, and cheaper.
std::vector<bool> pareto_front(const std::vector<TradeResult>& results);

}  // namespace withy::study
