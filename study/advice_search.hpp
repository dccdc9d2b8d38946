/// \file
/// The steps of a search for advice. Its numbers are in advice_search.cpp, with what they mean.
#pragma once

#include "withy/study/advice.hpp"
#include "withy/study/pace.hpp"

namespace withy::study {

/// A search under way: what it is about does not change, what it has found is in the advice.
class Search {
 public:
  Search(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy, Advice& advice)
      : evaluator_(evaluator), candidates_(candidates), accuracy_(accuracy), advice_(advice) {}

  void find_yardstick();
  void try_models();
  void choose();
  void simplify_bodies();
  void look_up();
  [[nodiscard]] bool stopped() const { return advice_.interrupted || evaluator_.control().stop(); }
  /// So too where there is no time left.
  [[nodiscard]] bool over() const { return stopped() || evaluator_.out_of_time(); }

 private:
  void explain(const ReferenceFound& found);
  [[nodiscard]] bool affordable(const Walk& so_far);
  [[nodiscard]] double own_use(const Reference& r) const;
  [[nodiscard]] bool worth_trying(const std::string& integrator, const Point& model) const;
  void try_integrations(const Point& model, const std::string& integrator);
  [[nodiscard]] bool hold(const Point& above);
  [[nodiscard]] std::vector<Point> models_by_cost(const std::vector<int>& modes) const;
  void try_models(const std::vector<int>& modes);
  void try_model(const Point& model);
  bool model_holds(const Point& model);
  [[nodiscard]] double exact_enough_tolerance() const;
  [[nodiscard]] double best_cost() const;
  const Probe& run(const Point& point, const Allowance& allowance);
  void time_again(const Probe& probe);
  [[nodiscard]] const Yardstick& yardstick() const { return *advice_.yardstick; }

  Evaluator& evaluator_;
  const Candidates& candidates_;
  const Accuracy& accuracy_;
  Advice& advice_;
  Pace pace_;  ///< of the reference's run under way
};

}  // namespace withy::study
