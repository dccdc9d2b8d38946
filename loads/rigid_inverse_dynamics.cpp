/// \file
/// Open-loop efforts from the inverse dynamics of the rigid tree along a rest-to-rest quintic.
#include "withy/core/sweep/rigid_inverse_dynamics.hpp"

#include <algorithm>
#include <stdexcept>

#include "withy/core/plugin/entry.hpp"

namespace withy {
namespace {

/// A hinge with one coordinate and where it goes [rad or m].
struct Target {
  std::string hinge;
  double from = 0;
  double to = 0;
};

class BoundSlew final : public BoundLoad {
 public:
  BoundSlew(const Model& model, const std::vector<Target>& targets, double end)
      : dynamics_(model), speeds_(model.layout().speeds), end_(end) {
    const State reference = model.reference_state();
    reference_.assign(reference.y.begin(), reference.y.begin() + static_cast<std::ptrdiff_t>(model.layout().positions));
    for (const Target& target : targets) {
      const Slot* slot = model.layout().hinge(target.hinge);
      if (slot == nullptr) throw std::invalid_argument("there is no hinge '" + target.hinge + "'");
      if (slot->positions != 1 || slot->speeds != 1)
        throw std::invalid_argument("hinge '" + target.hinge + "' has " + std::to_string(slot->speeds) +
                                    " rates; a quintic moves hinges with one coordinate");
      axes_.push_back({slot->position, slot->speed, target.from, target.to - target.from});
      reference_[slot->position] = target.from;
    }
  }

  std::size_t scratch() const override { return reference_.size() + 3 * speeds_ + dynamics_.scratch(); }

  /// θ = from + Δ s(t/T), s = 10τ³ − 15τ⁴ + 6τ⁵, T = duration / time_scale: the motion runs time_scale times as fast.
  void add(double t, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> efforts, std::span<double> scratch) const noexcept override {
    const auto x = scratch.first(reference_.size());
    const auto u = scratch.subspan(x.size(), speeds_);
    const auto u_dot = scratch.subspan(x.size() + speeds_, speeds_);
    const auto tau = scratch.subspan(x.size() + 2 * speeds_, speeds_);
    std::copy(reference_.begin(), reference_.end(), x.begin());
    std::fill(u.begin(), u.end(), 0.0);
    std::fill(u_dot.begin(), u_dot.end(), 0.0);
    double s = t < end_ ? 0 : 1, s1 = 0, s2 = 0;
    if (t > 0 && t < end_) {
      const double r = t / end_;
      s = r * r * r * (10 + r * (-15 + 6 * r));
      s1 = 30 * r * r * (1 - r) * (1 - r) / end_;
      s2 = 60 * r * (1 - r) * (1 - 2 * r) / (end_ * end_);
    }
    for (const Axis& axis : axes_) {
      x[axis.position] = axis.from + axis.change * s;
      u[axis.speed] = axis.change * s1;
      u_dot[axis.speed] = axis.change * s2;
    }
    dynamics_.efforts(x, u, u_dot, tau, scratch.subspan(x.size() + 3 * speeds_));
    for (const Axis& axis : axes_) efforts[axis.speed] += tau[axis.speed];
  }

  std::vector<double> discontinuities() const override { return {0.0, end_}; }
  double end() const override { return end_; }
  void begin(State& state) const override {
    for (const Axis& axis : axes_) state.y[axis.position] = axis.from;
  }

 private:
  struct Axis {
    std::size_t position;
    std::size_t speed;
    double from;
    double change;
  };

  RigidInverseDynamics dynamics_;
  std::size_t speeds_;
  double end_;                     ///< [s]
  std::vector<double> reference_;  ///< positions; hinges that are not moved stay there
  std::vector<Axis> axes_;
};

class Slew final : public Load {
 public:
  Slew(std::vector<Target> targets, double end) : targets_(std::move(targets)), end_(end) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundSlew>(model, targets_, end_);
  }

 private:
  std::vector<Target> targets_;
  double end_;
};

std::unique_ptr<Load> make(const Value& p, const MakeContext& context) {
  std::vector<Target> targets;
  for (const auto& [hinge, target] : p.at("hinges").members())
    targets.push_back({hinge, target.number_at("from"), target.number_at("to")});
  if (targets.empty()) {
    context.diagnostics.error(p.at("hinges").place(), "names no hinge; need at least one to move");
    return nullptr;
  }
  return std::make_unique<Slew>(std::move(targets), p.number_at("duration") / p.number_at("time_scale"));
}

void enroll(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "rigid-inverse-dynamics",
       .summary = "Open-loop efforts that would carry the tree of rigid bodies along a trajectory",
       .parameters = {text("law", "trajectory: a rest-to-rest quintic").one_of({"quintic"}).otherwise("quintic"),
                      number("duration", "s", "duration of the motion before scaling").above(0),
                      number("time_scale", "1", "time runs this many times as fast").above(0).otherwise(1.0),
                      named("hinges",
                            {number("from", "rad", "coordinate at the start, rad or m").otherwise(0.0),
                             number("to", "rad", "coordinate at the end, rad or m").otherwise(0.0)},
                            "hinges to move, of one coordinate each; the others count as held at their reference")
                          .naming(ParameterSpec::Refers::hinge)},
       .make = &make});
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(rigid_inverse_dynamics, withy::enroll);
