/// \file
/// The search for the cheapest model and integration that hold an accuracy: probes, cheapest first, against a converged
/// reference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/apps/withy/probe.hpp"

namespace withy::app {

/// What may be chosen from. Values of each axis.
struct Candidates {
  std::vector<std::string> formulations;
  std::vector<std::string> families;  ///< of bending; empty text: the scene's
  std::vector<int> modes;             ///< of each family of a beam; 0 where no beam has modes
  std::vector<std::string> integrators;
  std::vector<double> tolerances;  ///< loosest first
};
/// The candidates of a command line, without those that mean nothing for the scene.
/// \throws InputError where a value cannot be, or is `inconsistent`.
Candidates candidates_for(const Engine& engine, const AdviseArguments& arguments);

class Advisor {
 public:
  Advisor(const Engine& engine, const AdviseArguments& arguments);

  /// Finds the reference, then the cheapest candidate that passes. False where there is none or the user interrupted.
  bool search();
  /// Measures what stands one step above the choice: a formulation that neglects less; one mode more. Whole runs.
  void look_up();

  [[nodiscard]] const Accuracy& accuracy() const { return accuracy_; }
  [[nodiscard]] const MeasuredOutputs& outputs() const { return outputs_; }
  [[nodiscard]] const Candidates& candidates() const { return candidates_; }
  [[nodiscard]] const std::optional<Reference>& reference() const { return reference_; }
  /// Why there is no reference to measure against; empty: there is.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }
  [[nodiscard]] const std::vector<Probe>& probes() const { return probes_; }
  [[nodiscard]] const std::optional<Probe>& choice() const { return choice_; }
  [[nodiscard]] const std::vector<Probe>& above() const { return above_; }
  /// Evaluations times their least CPU time in this model and integrator [s]: what a run costs without the noise of
  /// other work on the machine.
  [[nodiscard]] double cost(const Probe& probe) const;
  [[nodiscard]] const ProbedModel& model_of(const TradePoint& point);
  /// CPU time of all runs [s].
  [[nodiscard]] double spent() const { return spent_; }
  [[nodiscard]] bool interrupted() const { return interrupted_; }
  /// Nothing is chosen that was chosen before and proved wrong: searches among the probes that are left.
  bool reject_choice();

 private:
  void find_reference();
  std::optional<Reference> reference_at(const TradePoint& point, std::string& trouble);
  [[nodiscard]] std::vector<ProbedModel*> models_by_cost();
  void try_model(ProbedModel& model);
  [[nodiscard]] double exact_enough_tolerance() const;
  const Probe& run(ProbedModel& model, const TradePoint& point, double most_use, double most_seconds);
  void note_unit_cost(const Probe& probe);
  double time_again(const Probe& p);
  void choose();
  void simplify_bodies();
  [[nodiscard]] bool allowed(const std::string& formulation) const;
  [[nodiscard]] double unit_cost(const TradePoint& point) const;
  ProbedModel& made(const TradePoint& point);

  const Engine& engine_;
  const AdviseArguments& arguments_;
  Accuracy accuracy_;
  MeasuredOutputs outputs_;
  Candidates candidates_;
  std::optional<Reference> reference_;
  std::string trouble_;
  std::vector<std::unique_ptr<ProbedModel>> models_;
  std::vector<std::pair<std::string, double>> unit_costs_;  ///< by model and integrator [s an evaluation]
  std::vector<Probe> probes_, above_;
  std::optional<Probe> choice_;
  double best_ = 0;  ///< cost of the cheapest that passed so far [s]; infinite: none
  double spent_ = 0;
  bool interrupted_ = false;
};

}  // namespace withy::app
