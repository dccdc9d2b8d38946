/// \file
/// The sizes of all terms of motion along a run.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "withy/core/analysis/term_ledger.hpp"
#include "withy/study/prepared.hpp"
#include "withy/study/scene_terms.hpp"

namespace withy::study {

/// What a formulation leaves out along a run.
struct LeftOutBy {
  std::string formulation;
  std::vector<std::vector<double>> sizes;  ///< [group][output] [N/√kg]
  [[nodiscard]] double rms(std::size_t group) const;
  [[nodiscard]] double peak(std::size_t group) const;
};

/// Sizes of all terms over the outputs of a run [N/√kg].
struct TermSizes {
  std::vector<CoordinateGroup> groups;
  std::vector<double> times;  ///< [s]
  /// [group][term][output]
  std::vector<std::array<std::vector<double>, terms_of_motion>> sizes;
  std::string richest;  ///< formulation that the others are compared with
  /// How far the force balance of each other formulation there is lies from the richest's, lowest rank first; without
  /// those that mean the same or cannot treat the model.
  std::vector<LeftOutBy> left_out;

  [[nodiscard]] double rms(std::size_t group, std::size_t term) const;
  [[nodiscard]] double peak(std::size_t group, std::size_t term) const;
  /// Whether a term is nowhere but rounding.
  [[nodiscard]] bool absent(std::size_t term) const;
  [[nodiscard]] double greatest_rms(std::size_t group) const;
  [[nodiscard]] double greatest_peak(std::size_t group) const;
};

/// Follows a run of the scene's own formulation.
class TermStudy {
 public:
  /// `prepared` must outlive it. \throws InputError where loops are closed; as SceneTerms; SceneError as check_loads.
  TermStudy(const Prepared& prepared, Registry& registry);
  /// Adds the terms at an output; none where the equations have no accelerations there.
  void enter(const State& state);
  [[nodiscard]] const TermSizes& sizes() const { return sizes_; }

 private:
  void compile_all(Registry& registry);
  void enter_left_out(const State& state, std::span<const double> accelerations);

  const Prepared& prepared_;
  SceneTerms terms_;
  std::vector<Beyond> others_;  ///< of `left_out`, and last the richest
  TermSizes sizes_;
};

}  // namespace withy::study
