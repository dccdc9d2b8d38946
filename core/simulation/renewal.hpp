/// \file
/// Renews discrete states of loads, with what they measure.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/model/signal_source.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/plugin/sampled_part.hpp"
#include "withy/core/simulation/sensor_reader.hpp"

namespace withy {

/// Renews the discrete states of one model in one formulation. What a SampledPart measures of outputs is that of the
/// state before the instant, whatever the order of the loads; what other loads give is what they give when its turn
/// comes. Where that state has no finite accelerations, a load that needs outputs keeps what it has. Of one thread.
class Renewal {
 public:
  /// The model and its equations must outlive it.
  /// \throws std::invalid_argument where a load measures what there is not.
  Renewal(const Model& model, const EquationsOfMotion& equations);
  /// Goes to an instant, before any load is renewed there. Where loads or motions jump at it, which their times may
  /// tell by rounding later, outputs are what they are from then on.
  void at(const State& before);
  /// Renews the states of one load at the state's time: that of the last call of `at`. \param slot of the load, or a
  /// part of it
  void operator()(State& state, const LoadSlot& slot, const Crossing& crossing);
  /// Why a load whose law is not the engine's own has failed at this state, "load 'name': …"; empty: none has.
  [[nodiscard]] std::string failure(const State& state) const;
  /// Why no simulation can go on from this state, which was saved; empty: it can.
  [[nodiscard]] std::string refusal(const State& state) const;
  /// A simulation goes on from a saved state: the failures of before are no longer its own.
  void forget() const;

 private:
  /// What a load measures.
  struct Measured {
    const SampledPart* part = nullptr;  ///< null: positions and speeds alone
    std::vector<SignalSource> sources;
    bool outputs = false;  ///< numbers of outputs among them
  };
  /// A load whose law is not the engine's own.
  struct Foreign {
    LoadSlot slot;
    const ForeignLaw* law;
  };
  void measure(const Measured& measured, const State& state);
  std::string said(const State& state, std::string (ForeignLaw::*what)(std::span<const double>) const) const;

  const Model& model_;
  std::vector<double> jumps_;       ///< [s], of loads and motions
  std::vector<Measured> measured_;  ///< one a slot of discrete states
  std::vector<Foreign> foreign_;
  std::unique_ptr<SensorReader> reader_;  ///< null: no load measures outputs
  std::unique_ptr<SensedState> sensed_;   ///< for what loads give; null: none measures it
  State before_;
  bool looked_ = false, readable_ = false;  ///< at `before_`
  std::vector<double> readings_, values_, scratch_;
};

}  // namespace withy
