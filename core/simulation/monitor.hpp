/// \file
/// What a run watches while it goes: peaks, deflections, energy, the sign of det M.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {

/// Watches one run from its initial state on; the peaks go to the run's summary.
class Monitor {
 public:
  Monitor(const Model& model, const EquationsOfMotion& equations, const State& initial, double deflection_limit,
          RunSummary& summary);

  /// Peaks of deflections and efforts: for every accepted step and output.
  void observe(const State& state, bool output);
  /// The deflection past its limit in the states observed, in words; empty where there is none.
  [[nodiscard]] const std::string& excess() const { return excess_; }
  /// Energy against the work done.
  void audit_energy(const State& state);
  /// Sign of det M at an accepted state against that of the start.
  void audit_mass_matrix(const State& state, int sign);
  /// Rejections up to now, after an accepted step: notes the time where they pile up.
  void audit_steps(const State& state, const StepStatistics& steps);

  [[nodiscard]] const std::optional<SignChange>& sign_change() const { return sign_change_; }

 private:
  struct Tip {
    const Slot* slot;  ///< of the body's modes
    int body;
    int frame;  ///< −1: `section` stands for it
    PointExpansion section;
    double length;  ///< [m]
    std::array<double, 3>* peak;
    double* ratio;
    std::array<double, 3> rough{};  ///< greatest |deflection| by the expansion
  };
  [[nodiscard]] std::array<double, 3> deflection(const Tip& tip, const State& state) const;
  /// The same by the second-order expansion of the section.
  [[nodiscard]] static std::array<double, 3> expanded(const Tip& tip, const State& state);
  /// Sign of det M by one evaluation; 0 where it cannot be solved.
  [[nodiscard]] int mass_matrix_sign(const State& state);

  const Model& model_;
  const EquationsOfMotion& equations_;
  RunSummary& summary_;
  std::vector<Tip> tips_;
  double deflection_limit_;
  std::string excess_;
  std::vector<double> efforts_, scratch_, rates_;
  Work work_;
  double initial_energy_ = 0, initial_work_ = 0;
  double energy_error_ = 0, energy_scale_ = 0;
  int initial_sign_ = 0;  ///< of det M
  double checked_;        ///< time of the last look at the sign of det M
  std::optional<SignChange> sign_change_;
  std::size_t rejected_ = 0;  ///< steps rejected so far
  std::size_t burst_ = 0;     ///< of these, in the present burst
};

}  // namespace withy
