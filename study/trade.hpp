/// \file
/// Runs the points of a trade study against a converged reference, on all cores.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/reference.hpp"

namespace withy::study {

/// What one point gave. Errors are greatest distances from the reference over the outputs.
struct TradeResult {
  Point point;
  std::string status;         ///< of the run; "refused" where the scene has no such model
  std::string message;        ///< why it is not "completed"
  double hinge_error = 0;     ///< greatest of all hinges [rad, m]
  double tip_error = 0;       ///< greatest of all tips [m]
  double relative_error = 0;  ///< greatest of all outputs, over what each is measured by
  double cpu_seconds = 0;
  std::size_t steps = 0, evaluations = 0;
  double reference_error = 0;                  ///< of its reference, relative: errors below it cannot be told apart
  std::map<std::string, double> sensors = {};  ///< greatest distances of the numbers of sensors, each in its unit
  [[nodiscard]] bool completed() const { return status == "completed"; }
};

/// What errors were measured against: more modes than any point has and a tighter tolerance.
struct TradeReference {
  Point point;
  double hinge_way = 0, tip_way = 0;      ///< greatest distances from the start [rad or m; m]
  double hinge_error = 0, tip_error = 0;  ///< its own, from what the last modes and tolerances changed
  double relative_error = 0;
  std::map<std::string, double> sensor_ways = {}, sensor_errors = {};  ///< of the numbers of sensors, in their units
};

/// Keeps what is finished. Called by one thread at a time.
class PointStore {
 public:
  virtual ~PointStore() = default;
  struct Kept {
    TradeResult result;
    TradeReference reference;
  };
  /// What was kept of a point by the same study; nothing where that is not there.
  virtual std::optional<Kept> find(const Point& point) = 0;
  virtual void keep(const Kept& kept) = 0;
};

struct TradeOptions {
  std::size_t jobs = 0;         ///< threads; 0: one a core
  PointStore* store = nullptr;  ///< null: nothing is kept
  Control control = {};
  std::vector<std::string> outputs = {};  ///< that errors are measured on; empty: all of the usual ones
};

class TradeStudy {
 public:
  /// `base` and `registry` must outlive it. \throws InputError where the scene has nothing to measure; SceneError as
  /// check_loads.
  TradeStudy(const Prepared& base, Registry& registry, std::vector<Point> points, TradeOptions options);
  ~TradeStudy();
  TradeStudy(const TradeStudy&) = delete;
  TradeStudy& operator=(const TradeStudy&) = delete;

  /// One more point; it must not have more modes or a smaller tolerance than the others, on which the reference rests.
  void add(const Point& point);
  /// Runs what is not finished yet; false where the user interrupted. Results do not depend on the number of threads.
  /// \throws InputError where a reference does not come to its end; PluginError.
  bool run();
  /// Of the finished points, in their order.
  [[nodiscard]] std::vector<TradeResult> results() const;
  /// Of that point; null where it is not among them or not finished.
  [[nodiscard]] const TradeResult* result(const Point& point) const;
  [[nodiscard]] const Outputs& outputs() const { return outputs_; }
  /// By the values gone over, joined with spaces.
  [[nodiscard]] const std::map<std::string, TradeReference>& references() const { return told_; }

 private:
  struct Known;
  struct Pool;
  void look_up(std::size_t index);
  void find_reference_for(const Point& point);
  [[nodiscard]] TradeResult run_point(const Point& point) const;
  void work(Pool& pool);

  const Prepared& base_;
  Registry& registry_;
  std::vector<Point> points_;
  TradeOptions options_;
  Outputs outputs_;
  std::vector<std::optional<TradeResult>> finished_;
  std::map<std::string, Known> known_;  ///< references that were run, by the values gone over
  std::map<std::string, TradeReference> told_;
};

/// Whether no other completed point is both more accurate, as far as its reference can tell, and cheaper.
std::vector<bool> pareto_front(const std::vector<TradeResult>& results);

}  // namespace withy::study
