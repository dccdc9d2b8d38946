/// \file
/// The steps of a search for advice, among models that a yardstick measures. Its numbers are where they are used, with
/// what they mean. Costs are CPU times, which other work on the machine makes longer by some tens of per cent: what is
/// within such a margin is not told apart by one run.
#pragma once

#include <algorithm>
#include <set>

#include "withy/study/advice.hpp"

namespace withy::study {

/// A search under way: what it is about does not change, what it has found is in the advice.
class Search {
 public:
  /// \param advice with its yardstick, but for stopped() and over()
  Search(Evaluator& evaluator, const Candidates& candidates, Advice& advice, const Finding& finding)
      : evaluator_(evaluator), candidates_(candidates), advice_(advice), finding_(finding) {}

  /// Runs of the search for a reference: they are paid for, as candidates and as looks at models.
  /// \param runs must outlive this
  void take(const std::vector<Reference>& runs);
  void try_models();
  /// What the reference's own error is to be, as a share of the accuracy, that candidates which would cost clearly less
  /// than the best are held to hold; nothing where there are none.
  [[nodiscard]] std::optional<double> own_wanted() const;
  /// Measures what holds, or would with a better known reference, against that of the advice.
  void judge_again();
  void choose();
  void simplify_bodies();
  void look_up();
  [[nodiscard]] bool stopped() const { return advice_.interrupted || evaluator_.control().stop(); }
  /// So too where there is no time left, but for the run of what is chosen as a scene that says so is.
  [[nodiscard]] bool over() const;

 private:
  /// Times the best cost so far: what finding out about a model may cost, since a looser integration of it may cost
  /// less.
  static constexpr double model_allowance = 4;

  template <class T>
  [[nodiscard]] static bool contains(const std::vector<T>& all, const T& value) {
    return std::find(all.begin(), all.end(), value) != all.end();
  }
  void tell_probe(const Probe& probe, double best_before);
  [[nodiscard]] bool worth_trying(const std::string& integrator, const Point& model) const;
  bool try_integrations(const Point& model, const std::string& integrator);
  [[nodiscard]] bool hold(const Point& above);
  [[nodiscard]] std::vector<Point> models_by_cost(const std::vector<int>& modes) const;
  void try_models(const std::vector<int>& modes);
  void try_known(const std::vector<int>& modes);
  void loosen_taken();
  [[nodiscard]] bool is_candidate(const Point& point) const;
  [[nodiscard]] std::vector<std::size_t> near_misses() const;
  void try_tightest();
  void try_model(const Point& model);
  bool model_holds(const Point& model);
  [[nodiscard]] double exact_enough_tolerance(double part) const;
  [[nodiscard]] bool limited_by_stability(const Point& model) const;
  [[nodiscard]] bool passed(const std::vector<int>& modes) const;
  [[nodiscard]] double best_cost() const;
  [[nodiscard]] Allowance within_time(Allowance allowance, double best) const;
  const Probe& run(const Point& point, const Allowance& allowance);
  void time_again(const Probe& probe);
  [[nodiscard]] const Yardstick& yardstick() const { return *advice_.yardstick; }

  Evaluator& evaluator_;
  const Candidates& candidates_;
  Advice& advice_;
  const Finding& finding_;
  std::vector<const Reference*> made_;  ///< runs that need not be made again
  std::set<std::string> tried_;         ///< models with an integrator, all of whose tolerances have been tried
  std::set<std::string> told_;          ///< formulations of which it has been told that a model is not exact enough
  std::string told_best_;               ///< the point that was last told to hold
  bool tightest_ = false;               ///< models are looked at with the tightest tolerance of all candidates
};

}  // namespace withy::study
