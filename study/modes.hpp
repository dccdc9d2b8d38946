/// \file
/// Natural modes about steady states, along a sweep of a value of the scene or of a hinge's rate.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/analysis/mode_branches.hpp"
#include "withy/study/configuration.hpp"
#include "withy/study/continuation.hpp"
#include "withy/study/control.hpp"
#include "withy/study/turning.hpp"

namespace withy::study {

/// Numbers that a value takes, one after the other.
struct Sweep {
  std::string path;  ///< in the scene, or `spin.hinge`: the hinge is held at that rate; empty: nothing is swept
  std::vector<double> values{0.0};
  std::string unit = {};  ///< of the values, as the scene writes it; empty: SI
  [[nodiscard]] bool none() const { return path.empty(); }
  /// A value as a scene writes it, "3.75 rpm".
  [[nodiscard]] std::string text(double value) const;
  /// The hinge of `spin.hinge`; empty for a path of the scene.
  [[nodiscard]] std::string spun() const { return path.starts_with("spin.") ? path.substr(5) : ""; }
  /// Of the values, to be shown: that of `unit`, of a rate without one rad/s; empty: the SI unit of what is swept.
  [[nodiscard]] std::string shown_unit() const { return unit.empty() && !spun().empty() ? "rad/s" : unit; }
};

using StartState = std::function<StateAsGiven(const Prepared&)>;

/// A steady state that was looked for.
struct SteadyFound {
  SteadyState steady;
  Held held;
  /// Whether it stays as the hinges turn; not known where no modes were found about it.
  std::optional<bool> stays;
  std::string derivatives;  ///< how they were found; the same
};

/// The modes at one configuration.
struct ModesAt {
  double value = 0;  ///< of what is swept
  std::vector<Mode> modes;
  std::vector<std::size_t> branches;  ///< of a sweep, of each mode: they ascend, with gaps where branches have ended
  double period = 0;                  ///< [s] of sampled loads, whose modes these are: else 0
  std::size_t forgotten = 0;          ///< of sampled loads, states that are zero after some samples: no modes
  /// Of the speeds, then of the continuous states of loads and of what sampled ones hold.
  std::vector<std::string> names;
  Eigen::VectorXd masses;             ///< M_ii, one a speed, zero for states; empty where there are no modes
  std::string problem;                ///< why there are none; empty where there are
  Jump jump = Jump::none;             ///< of a sweep, from the steady state at the value before
  std::string closing;                ///< Configuration::closing, of the state that this one was looked for from
  std::string bent;                   ///< how far the steady state is bent and by what, where that is far; else empty
  std::vector<std::string> limited;   ///< loads that are at their limits there
  std::optional<SteadyFound> steady;  ///< none where the state was taken as it is
  std::shared_ptr<const Model> model;
  std::optional<TurningModes> turn;  ///< none where there are no modes

  /// The mode on a branch; null where there is none.
  [[nodiscard]] const Mode* on(std::size_t branch) const;
  /// Whether these are modes of equations that change as the hinges turn, frozen at one angle, or as loads change
  /// them with time, or about a balance of such loads: they tell no stability.
  [[nodiscard]] bool frozen() const {
    return turn && (turn->check.periodic() || !turn->timed.empty() || !turn->shaking.empty());
  }
};

/// One formulation, all values.
struct ModesOf {
  std::string formulation;
  std::vector<ModesAt> points;

  /// How many branches there are at all values together.
  [[nodiscard]] std::size_t branches() const;
  /// What dominates a branch where it begins; empty where there is none.
  [[nodiscard]] std::string name(std::size_t branch) const;
};

/// Modes about the configuration's steady state, or where `as_is` about its state. Where loads are sampled they are
/// those of the map from just before one common sample to just before the next: λ of the multiplier e^{λT}, its
/// frequency that of what vibrates between the samples.
/// \throws InputError where a turn of sampled loads is asked for
ModesAt modes_at(const Configuration& configuration, bool as_is, const TurningWish& wish = {});

/// Goes through the sweep: each value begins at the steady state of the one before, and modes keep their branches.
/// \param start gives the state that a scene begins at; empty: its initial one
/// \throws SceneError, InputError, PluginError
ModesOf sweep_modes(const SceneValues& values, Registry& registry, const StartState& start, const Holding& holding,
                    const Sweep& sweep, bool as_is, const TurningWish& wish, const Control& control);

/// Name of the coordinate that dominates a mode, as "link1.bending_y[1]".
std::string dominating(const ModesAt& at, const Mode& mode);
/// A growth without what rounding leaves of it, as Mode::resolution tells [1/s].
double resolved_growth(const ModesAt& at, const Mode& mode);
/// Whether it grows, beyond that.
bool unstable(const ModesAt& at, const Mode& mode);
/// "rigid", "diverges", "flutters", "overdamped", "decays" (a real eigenvalue by itself), "alternates" (of sampled
/// loads, on the other side at each sample) or "stable"; of a frozen angle "grows here" and "decays here".
std::string behaviour(const ModesAt& at, const Mode& mode);
/// What modes of sampled loads are, in a sentence; empty where none are sampled.
std::string sampling_text(const ModesOf& run);

}  // namespace withy::study
