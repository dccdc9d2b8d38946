/// \file
/// An on-off controller with hysteresis on a rate of a hinge, as of attitude thrusters (Schmitt trigger): on
///   s = x − x_r + T ẋ
/// it switches −τ on where s rises to `on` and +τ where it falls to −`on`, and off where |s| has come back to `off`.
#include "withy/core/plugin/effortless_load.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/loads/hinge_rate.hpp"

namespace withy {
namespace {

struct Relay {
  double effort = 0;     ///< τ [N m, N]
  double target = 0;     ///< x_r [rad, m]
  double rate_time = 0;  ///< T [s]
  double on = 0;         ///< [rad, m]
  double off = 0;        ///< [rad, m]
};

class BoundHingeRelay final : public EffortlessLoad, public DiscretePart {
 public:
  BoundHingeRelay(std::size_t position, std::size_t speed, const Relay& relay)
      : position_(position), speed_(speed), relay_(relay) {}

  using EffortlessLoad::add;
  const DiscretePart* discrete() const override { return this; }

  // The one discrete state is the sign of the effort: −1, 0, +1.
  std::size_t states() const override { return 1; }
  std::size_t switches() const override { return 4; }
  void switching(double /*t*/, std::span<const double> positions, std::span<const double> speeds,
                 std::span<const double> /*discrete*/, std::span<double> values) const noexcept override {
    const double s = signal(positions, speeds);
    values[rises_to_on] = s - relay_.on;
    values[falls_to_off] = s - relay_.off;
    values[rises_to_off] = s + relay_.off;
    values[falls_to_on] = s + relay_.on;
  }
  void renew(double /*t*/, std::span<const double> positions, std::span<const double> speeds, const Crossing& crossing,
             std::span<double> discrete, std::span<double> /*scratch*/) const noexcept override {
    double& level = discrete[0];
    const bool rises = crossing.direction > 0;
    if (crossing.function < 0) {
      const double s = signal(positions, speeds);
      if (s >= relay_.on) level = -1;
      if (s <= -relay_.on) level = 1;
    }
    if (crossing.function == rises_to_on && rises) level = -1;
    if (crossing.function == falls_to_on && !rises) level = 1;
    if (crossing.function == falls_to_off && !rises && level < 0) level = 0;
    if (crossing.function == rises_to_off && rises && level > 0) level = 0;
  }
  void add(double /*t*/, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    efforts[speed_] += relay_.effort * discrete[0];
  }

 private:
  enum Function : int { rises_to_on, falls_to_off, rises_to_off, falls_to_on };
  double signal(std::span<const double> positions, std::span<const double> speeds) const noexcept {
    return positions[position_] - relay_.target + relay_.rate_time * speeds[speed_];
  }

  std::size_t position_;
  std::size_t speed_;
  Relay relay_;
};

class HingeRelay final : public Load {
 public:
  HingeRelay(RateName rate, const Relay& relay) : rate_(std::move(rate)), relay_(relay) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundHingeRelay>(position_index(model, rate_), speed_index(model, rate_), relay_);
  }

 private:
  RateName rate_;
  Relay relay_;
};

std::unique_ptr<Load> make_hinge_relay(const Value& p, const MakeContext& context) {
  const Relay relay{p.number_at("effort"), p.number_at("target"), p.number_at("rate_time"), p.number_at("on"),
                    p.number_at("off")};
  if (relay.off >= relay.on) {
    context.diagnostics.error(p.at("off").place(),
                              "got an 'off' not below 'on'; without hysteresis it would switch without end");
    return nullptr;
  }
  return std::make_unique<HingeRelay>(rate_name(p), relay);
}

}  // namespace

void enroll_hinge_relay(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "hinge-relay",
                        .summary = "On-off controller with hysteresis on a rate of a hinge, as of attitude thrusters",
                        .parameters = rate_parameters(
                            {number("effort", "N m|N", "effort while it is on").above(0),
                             number("target", "rad|m", "coordinate to hold").otherwise(0.0),
                             number("rate_time", "s", "weight of the rate in the signal").least(0).otherwise(0.0),
                             number("on", "rad|m", "signal at which it switches on").above(0),
                             number("off", "rad|m", "signal at which it switches off; below 'on'").least(0)}),
                        .make = &make_hinge_relay});
}

}  // namespace withy
