/// \file
/// Actuators between a command and the effort on a hinge: a second-order lag with limits, and a direct-current motor.
#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/loads/control/control_load.hpp"
#include "withy/loads/control/reference.hpp"

namespace withy {
namespace {

bool is_limit(double limit) { return limit < std::numeric_limits<double>::infinity(); }

struct Lag {
  double frequency = 0;                                         ///< ω [rad/s]
  double damping = 0;                                           ///< ζ
  double rate_limit = std::numeric_limits<double>::infinity();  ///< [N m/s, N/s]
  double limit = std::numeric_limits<double>::infinity();       ///< [N m, N]
};

/// τ̇ = max(−ρ, min(ρ, v)),  v̇ = ω² (c − τ) − 2 ζ ω v,  with the command c and the effort given within the limit.
class Actuator final : public ControlBlock {
 public:
  explicit Actuator(const Lag& lag) : lag_(lag) {}
  std::size_t inputs() const override { return 1; }
  std::vector<std::string> states() const override { return {"effort", "rate"}; }
  std::string unit_of_state(std::size_t state) const override { return state == 0 ? "command" : "command/s"; }
  std::vector<Shown> shown() const override {
    std::vector<Shown> all;
    if (is_limit(lag_.limit)) all.push_back({"margin", "command"});
    if (is_limit(lag_.rate_limit)) all.push_back({"rate_margin", "command/s"});
    return all;
  }
  void tell(double /*t*/, std::span<const double> w, std::span<const double> z,
            std::span<double> values) const noexcept override {
    std::size_t next = 0;
    if (is_limit(lag_.limit)) values[next++] = lag_.limit - std::abs(w[0]);
    if (is_limit(lag_.rate_limit)) values[next] = lag_.rate_limit - std::abs(z[1]);
  }
  void begin(double /*t*/, std::span<const double> w, std::span<double> z) const noexcept override {
    z[0] = limited(w[0], lag_.limit);
    z[1] = 0;
  }
  void rates(double /*t*/, std::span<const double> w, std::span<const double> z,
             std::span<double> rates) const noexcept override {
    rates[0] = limited(z[1], lag_.rate_limit);
    rates[1] = lag_.frequency * (lag_.frequency * (limited(w[0], lag_.limit) - z[0]) - 2 * lag_.damping * z[1]);
  }
  void output(double /*t*/, std::span<const double> /*w*/, std::span<const double> z,
              std::span<double> v) const noexcept override {
    v[0] = limited(z[0], lag_.limit);
  }
  bool feeds_through(std::size_t /*input*/) const override { return false; }
  bool slopes(double /*t*/, std::span<const double> w, std::span<const double> z, Slopes& s) const override {
    const double w2 = lag_.frequency * lag_.frequency;
    s.rate_by_state << 0, within(z[1], lag_.rate_limit), -w2, -2 * lag_.damping * lag_.frequency;
    s.rate_by_input << 0, w2 * within(w[0], lag_.limit);
    s.output_by_state << within(z[0], lag_.limit), 0;
    return true;
  }

 private:
  static double limited(double x, double limit) noexcept { return std::clamp(x, -limit, limit); }
  static double within(double x, double limit) noexcept { return x >= -limit && x <= limit ? 1 : 0; }
  Lag lag_;
};

/// L i̇ = V − R i − n k_e ẋ, τ = n k i; without inductance i follows at once. V within its limit.
struct Motor {
  double resistance = 0, inductance = 0, constant = 0, back = 0, gear = 1;
  double limit = std::numeric_limits<double>::infinity();
};

class DcMotor final : public ControlBlock, public CourseOfTime {
 public:
  /// \param voltage where none is measured
  DcMotor(const Motor& motor, std::optional<Trajectory> voltage) : motor_(motor), voltage_(std::move(voltage)) {}
  std::size_t inputs() const override { return voltage_ ? 1 : 2; }
  std::vector<std::string> states() const override {
    return motor_.inductance > 0 ? std::vector<std::string>{"current"} : std::vector<std::string>{};
  }
  std::vector<Shown> shown() const override {
    std::vector<Shown> all{{"voltage", "V"}};
    if (is_limit(motor_.limit)) all.push_back({"margin", "V"});
    return all;
  }
  void tell(double t, std::span<const double> w, std::span<const double> /*z*/,
            std::span<double> values) const noexcept override {
    const double voltage = asked(t, w);
    values[0] = std::clamp(voltage, -motor_.limit, motor_.limit);
    if (is_limit(motor_.limit)) values[1] = motor_.limit - std::abs(voltage);
  }
  std::string unit_of_state(std::size_t /*state*/) const override { return "A"; }
  void begin(double t, std::span<const double> w, std::span<double> z) const noexcept override {
    if (!z.empty()) z[0] = drop(t, w) / motor_.resistance;
  }
  void rates(double t, std::span<const double> w, std::span<const double> z,
             std::span<double> rates) const noexcept override {
    if (!z.empty()) rates[0] = (drop(t, w) - motor_.resistance * z[0]) / motor_.inductance;
  }
  void output(double t, std::span<const double> w, std::span<const double> z,
              std::span<double> v) const noexcept override {
    v[0] = motor_.gear * motor_.constant * (z.empty() ? drop(t, w) / motor_.resistance : z[0]);
  }
  bool feeds_through(std::size_t /*input*/) const override { return !(motor_.inductance > 0); }
  bool slopes(double t, std::span<const double> w, std::span<const double> z, Slopes& s) const override {
    Eigen::RowVectorXd by_input(static_cast<Eigen::Index>(inputs()));
    by_input[by_input.size() - 1] = -motor_.gear * motor_.back;
    if (!voltage_) by_input[0] = std::abs(asked(t, w)) <= motor_.limit ? 1 : 0;
    const double effort = motor_.gear * motor_.constant;
    if (z.empty()) {
      s.output_by_input = effort / motor_.resistance * by_input;
      return true;
    }
    s.output_by_state(0, 0) = effort;
    s.rate_by_input = by_input / motor_.inductance;
    s.rate_by_state(0, 0) = -motor_.resistance / motor_.inductance;
    return true;
  }
  std::size_t courses() const override { return voltage_ ? courses_of(*voltage_) : 0; }
  void course(double t, std::span<double> values) const noexcept override { course_of(*voltage_, t, values); }
  std::vector<double> discontinuities() const override {
    return voltage_ ? jumps_of(*voltage_) : std::vector<double>{};
  }
  double end() const override { return voltage_ ? end_of(*voltage_) : 0; }

 private:
  [[nodiscard]] double asked(double t, std::span<const double> w) const noexcept {
    return voltage_ ? at(*voltage_, t).position : w[0];
  }
  /// V less what the motor generates [V].
  [[nodiscard]] double drop(double t, std::span<const double> w) const noexcept {
    return std::clamp(asked(t, w), -motor_.limit, motor_.limit) - motor_.gear * motor_.back * w.back();
  }
  Motor motor_;
  std::optional<Trajectory> voltage_;
};

/// Whether it is continuous; reports a sample.
bool continuous(const Value& p, const MakeContext& context) {
  if (!p.has("sample")) return true;
  context.diagnostics.error(p.at("sample").place(), "an actuator is continuous in time; its controller may be sampled");
  return false;
}

std::unique_ptr<Load> make_actuator(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_ends(p, context);
  if (!continuous(p, context) || !ends) return nullptr;
  if (ends->of.size() != 1) {
    context.diagnostics.error(p.place(),
                              "needs 'of' with one signal, its command: the name of a controller or of another number");
    return nullptr;
  }
  Lag lag{p.number_at("frequency"), p.number_at("damping_ratio")};
  if (const Value* limit = p.find("rate_limit")) lag.rate_limit = limit->number();
  if (const Value* limit = p.find("limit")) lag.limit = limit->number();
  return make_control(std::move(*ends), std::make_shared<Actuator>(lag));
}

std::unique_ptr<Load> make_dc_motor(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_ends(p, context);
  const std::optional<Trajectory> voltage = read_reference(p, context);
  if (!continuous(p, context) || !ends || !voltage) return nullptr;
  const bool given = p.has("reference") || p.has("motion");
  const auto error = [&](const char* message) {
    context.diagnostics.error(p.place(), message);
    return nullptr;
  };
  if (!ends->hinge || !ends->to.empty() || !ends->acts)
    return error("a motor needs the 'hinge' that it turns, and no 'to'");
  if (given != ends->of.empty() || ends->of.size() > 1)
    return error("needs its voltage: one signal as 'of', or a 'reference'");
  ends->rate_of_hinge = true;
  Motor motor{p.number_at("resistance"), p.number_at("inductance"), p.number_at("torque_constant"),
              p.has("back_emf") ? p.number_at("back_emf") : p.number_at("torque_constant"), p.number_at("gear")};
  if (const Value* limit = p.find("voltage_limit")) motor.limit = limit->number();
  return make_control(std::move(*ends), std::make_shared<DcMotor>(motor, given ? voltage : std::nullopt));
}

}  // namespace

void enroll_actuator(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "actuator",
       .summary = "Actuator: the effort follows a command by a second-order lag, with limits of effort and rate",
       .parameters =
           control_parameters({number("frequency", "rad/s", "undamped natural frequency").above(0),
                               number("damping_ratio", "1", "damping over critical damping").above(0).otherwise(0.7),
                               number("rate_limit", "N m/s|N/s", "the effort never changes faster").above(0).optional(),
                               number("limit", "N m|N", "the effort never exceeds this").above(0).optional()}),
       .make = &make_actuator});
  std::vector<ParameterSpec> motor{
      number("resistance", "1", "of the armature [ohm]").above(0),
      number("inductance", "1", "of the armature [H]; 0: the current follows at once").least(0).otherwise(0.0),
      number("torque_constant", "1", "torque of the motor for one ampere [N m/A]").above(0),
      number("back_emf", "1", "voltage for one radian per second [V s]; the torque constant where left out")
          .least(0)
          .optional(),
      number("gear", "1", "turns of the motor for one of the hinge").otherwise(1.0),
      number("voltage_limit", "1", "the voltage never exceeds this [V]").above(0).optional()};
  for (ParameterSpec& spec : reference_parameters("1")) motor.push_back(std::move(spec));
  enrollment.add<Load>({.id = "dc-motor",
                        .summary = "Direct-current motor that turns a hinge: resistance, inductance, back EMF, gear",
                        .parameters = control_parameters(std::move(motor)),
                        .make = &make_dc_motor});
}

}  // namespace withy
