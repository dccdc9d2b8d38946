/// \file
/// The drive of a reaction wheel on its axle:
///   T τ̇ = max(−τ_max, min(τ_max, c)) − τ  (at once where T is zero),
///   effort = s τ − b Ω − τ_c tanh(Ω/Ω_c),
/// where s falls from 1 to 0 over the last hundredth before the speed limit for what drives, and is 1 for what brakes.
/// It acts behind the lag: what the motor cannot give at its speed it does not give because it was asked for before.
#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/loads/control/control_load.hpp"

namespace withy {
namespace {

struct WheelDrive {
  double torque_limit = std::numeric_limits<double>::infinity();  ///< τ_max [N m]
  double speed_limit = std::numeric_limits<double>::infinity();   ///< [rad/s]
  double lag = 0;                                                 ///< T [s]
  double viscous = 0;                                             ///< b [N m s/rad]
  double coulomb = 0, coulomb_speed = 1;                          ///< τ_c [N m], Ω_c [rad/s]
  double inertia = 0;  ///< of the wheel about its axle [kg m²]; 0: its momentum is not shown
};

class ReactionWheel final : public ControlBlock {
 public:
  explicit ReactionWheel(const WheelDrive& drive) : drive_(drive) {}
  std::size_t inputs() const override { return 2; }
  std::vector<std::string> states() const override {
    return drive_.lag > 0 ? std::vector<std::string>{"torque"} : std::vector<std::string>{};
  }
  std::string unit_of_state(std::size_t /*state*/) const override { return "command"; }
  std::vector<Shown> shown() const override {
    std::vector<Shown> all{{"motor", "command"}, {"friction", "command"}};
    if (drive_.inertia > 0) all.push_back({"momentum", "kg m^2/s"});
    if (std::isfinite(drive_.torque_limit)) all.push_back({"margin", "command"});
    if (std::isfinite(drive_.speed_limit)) all.push_back({"speed_margin", "rad/s"});
    return all;
  }
  void tell(double /*t*/, std::span<const double> w, std::span<const double> z,
            std::span<double> values) const noexcept override {
    values[0] = motor(w, z);
    values[1] = friction(w[1]);
    std::size_t next = 2;
    if (drive_.inertia > 0) values[next++] = drive_.inertia * w[1];
    if (std::isfinite(drive_.torque_limit)) values[next++] = drive_.torque_limit - std::abs(w[0]);
    if (std::isfinite(drive_.speed_limit)) values[next] = drive_.speed_limit - std::abs(w[1]);
  }
  void begin(double /*t*/, std::span<const double> w, std::span<double> z) const noexcept override {
    if (!z.empty()) z[0] = limited(w[0]);
  }
  void rates(double /*t*/, std::span<const double> w, std::span<const double> z,
             std::span<double> rates) const noexcept override {
    if (!z.empty()) rates[0] = (limited(w[0]) - z[0]) / drive_.lag;
  }
  void output(double /*t*/, std::span<const double> w, std::span<const double> z,
              std::span<double> v) const noexcept override {
    v[0] = motor(w, z) - friction(w[1]);
  }
  bool feeds_through(std::size_t input) const override { return input == 1 || !(drive_.lag > 0); }
  bool slopes(double /*t*/, std::span<const double> w, std::span<const double> z, Slopes& s) const override {
    const double torque = z.empty() ? limited(w[0]) : z[0];
    const double share = share_at(torque, w[1]), within = std::abs(w[0]) <= drive_.torque_limit ? 1 : 0,
                 sech = 1 / std::cosh(w[1] / drive_.coulomb_speed);
    s.output_by_input(0, 1) = -drive_.viscous - drive_.coulomb / drive_.coulomb_speed * sech * sech;
    if (share > 0 && share < 1)
      s.output_by_input(0, 1) -= torque * std::copysign(1 / (soft * drive_.speed_limit), w[1]);
    if (z.empty()) {
      s.output_by_input(0, 0) = share * within;
      return true;
    }
    s.output_by_state(0, 0) = share;
    s.rate_by_input(0, 0) = within / drive_.lag;
    s.rate_by_state(0, 0) = -1 / drive_.lag;
    return true;
  }

 private:
  static constexpr double soft = 0.01;  ///< of the speed limit

  /// Share of a torque that the motor gives at a rate: all that brakes, and less of what drives near the limit.
  [[nodiscard]] double share_at(double torque, double rate) const noexcept {
    if (!std::isfinite(drive_.speed_limit) || torque * rate <= 0) return 1;
    return std::clamp((drive_.speed_limit - std::abs(rate)) / (soft * drive_.speed_limit), 0.0, 1.0);
  }
  [[nodiscard]] double limited(double command) const noexcept {
    return std::clamp(command, -drive_.torque_limit, drive_.torque_limit);
  }
  /// What the motor gives [N m].
  [[nodiscard]] double motor(std::span<const double> w, std::span<const double> z) const noexcept {
    const double torque = z.empty() ? limited(w[0]) : z[0];
    return torque * share_at(torque, w[1]);
  }
  [[nodiscard]] double friction(double rate) const noexcept {
    return drive_.viscous * rate + drive_.coulomb * std::tanh(rate / drive_.coulomb_speed);
  }
  WheelDrive drive_;
};

std::unique_ptr<Load> make_reaction_wheel(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_ends(p, context);
  const auto error = [&](const Value& at, const char* message) {
    context.diagnostics.error(at.place(), message);
    return nullptr;
  };
  if (p.has("sample")) return error(p.at("sample"), "a wheel is continuous in time; its controller may be sampled");
  if (!ends) return nullptr;
  if (!ends->hinge || !ends->to.empty() || !ends->acts)
    return error(p, "needs the 'hinge' that is the wheel's axle, and no 'to'");
  if (ends->of.size() != 1) return error(p, "needs 'of' with one signal, the torque that is commanded");
  WheelDrive drive{.lag = p.number_at("time_constant"),
                   .viscous = p.number_at("viscous"),
                   .coulomb = p.number_at("coulomb"),
                   .coulomb_speed = p.number_at("coulomb_speed")};
  if (const Value* limit = p.find("torque_limit")) drive.torque_limit = limit->number();
  if (const Value* limit = p.find("speed_limit")) drive.speed_limit = limit->number();
  if (const Value* inertia = p.find("inertia")) drive.inertia = inertia->number();
  ends->rate_of_hinge = true;
  return make_control(std::move(*ends), std::make_shared<ReactionWheel>(drive));
}

}  // namespace

void enroll_reaction_wheel(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "reaction-wheel",
       .summary = "Drive of a reaction wheel on its axle: limits of torque and speed, friction, momentum stored",
       .parameters = control_parameters(
           {number("torque_limit", "N m", "the motor never gives more").above(0).optional(),
            number("speed_limit", "rad/s", "the motor drives the wheel no faster").above(0).optional(),
            number("time_constant", "s", "of the motor; 0: its torque follows at once").least(0).otherwise(0.0),
            number("viscous", "N m s/rad", "friction for one of rate").least(0).otherwise(0.0),
            number("coulomb", "N m", "friction at all rates far above coulomb_speed").least(0).otherwise(0.0),
            number("coulomb_speed", "rad/s", "rate over which the Coulomb friction turns round")
                .above(0)
                .otherwise(1.0),
            number("inertia", "kg m^2", "of the wheel about its axle, for the momentum that is shown")
                .above(0)
                .optional()}),
       .make = &make_reaction_wheel});
}

}  // namespace withy
