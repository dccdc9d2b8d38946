/// \file
/// Prescribed motions of hinges.
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/entry.hpp"
#include "withy/core/plugin/formula.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/loads/motion_input.hpp"
#include "withy/loads/shaped_motion.hpp"
#include "withy/loads/trajectory.hpp"

namespace withy {
namespace {

struct FormulaMotion;

/// A coordinate on a trajectory.
template <class Law>
class Following final : public Motion, public CourseOfTime {
 public:
  explicit Following(Law law) : law_(std::move(law)) {}
  bool locks() const override { return false; }
  MotionPoint at(double t) const noexcept override { return law_(t); }
  std::vector<double> discontinuities() const override { return law_.jumps(); }
  double end() const override { return law_.end(); }
  std::size_t courses() const override { return std::is_same_v<Law, FormulaMotion> ? 1 : 0; }
  void course(double t, std::span<double> values) const noexcept override { values[0] = law_(t).acceleration; }

 private:
  Law law_;
};

class Locked final : public Motion {
 public:
  bool locks() const override { return true; }
  MotionPoint at(double /*t*/) const noexcept override { return {}; }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
};

/// A constant rate from time 0 on and before.
struct ConstantRate {
  double from = 0;
  double rate = 0;
  MotionPoint operator()(double t) const noexcept { return {from + rate * t, rate, 0}; }
  std::vector<double> jumps() const { return {}; }
  double end() const { return 0; }
};

/// From rest to the rate ω in the time T, with an acceleration that begins and ends at zero with its derivative:
///   x = from + (ω/T) (t²/2 + (T/2π)² (cos(2π t/T) − 1)),  then  from + ω (t − T/2).
struct SpinUp {
  double from = 0;
  double rate = 0;
  double duration = 1;  ///< T [s]
  MotionPoint operator()(double t) const noexcept {
    if (!(t > 0)) return {from, 0, 0};
    if (t >= duration) return {from + rate * (t - 0.5 * duration), rate, 0};
    const double frequency = 2 * std::numbers::pi / duration;
    const double half = std::sin(0.5 * frequency * t);  // cos a − 1 = −2 sin²(a/2), which loses nothing at small t
    const double ramp = rate / duration;
    return {from + ramp * (0.5 * t * t - 2 * half * half / (frequency * frequency)),
            ramp * (t - std::sin(frequency * t) / frequency), ramp * 2 * half * half};
  }
  std::vector<double> jumps() const { return {0, duration}; }
  double end() const { return duration; }
};

/// A formula of the time, with its exact derivatives.
struct FormulaMotion {
  Formula formula;
  MotionPoint operator()(double t) const noexcept {
    const std::array<double, 3> x = formula.with_derivatives(t);
    return {x[0], x[1], x[2]};
  }
  std::vector<double> jumps() const { return {}; }
  double end() const { return 0; }
};

double value(const Value& p, const char* key) { return p.number_at(key); }

std::unique_ptr<Motion> make_locked(const Value& /*p*/, const MakeContext& /*context*/) {
  return std::make_unique<Locked>();
}
std::unique_ptr<Motion> make_constant_rate(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<Following<ConstantRate>>(ConstantRate{value(p, "from"), value(p, "rate")});
}
std::unique_ptr<Motion> make_spin_up(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<Following<SpinUp>>(SpinUp{value(p, "from"), value(p, "rate"), value(p, "duration")});
}
std::unique_ptr<Motion> make_quintic(const Value& p, const MakeContext& /*context*/) {
  const double from = value(p, "from");
  return std::make_unique<Following<Quintic>>(Quintic{from, value(p, "to") - from, value(p, "duration")});
}
std::unique_ptr<Motion> make_sine(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<Following<SineMotion>>(
      SineMotion{value(p, "center"), value(p, "amplitude"), 1 / value(p, "period"), value(p, "phase")});
}
std::unique_ptr<Motion> make_expression(const Value& p, const MakeContext& context) {
  const Value& given = p.at("value");
  try {
    Formula formula(given.text());
    for (const std::string& name : formula.names())
      if (name != "t") throw std::invalid_argument("there is nothing called '" + name + "'; need the time t alone");
    return std::make_unique<Following<FormulaMotion>>(FormulaMotion{std::move(formula)});
  } catch (const std::invalid_argument& e) {
    context.diagnostics.error(given.place(), "got \"" + given.text() + "\": " + e.what());
    return nullptr;
  }
}
std::unique_ptr<Motion> make_table(const Value& p, const MakeContext& context) {
  const Value& rows = p.at("table");
  if (rows.items().empty()) {
    context.diagnostics.error(rows.place(), "has no row; need [s, rad] at least once");
    return nullptr;
  }
  std::vector<double> times, positions;
  for (const Value& row : rows.items()) {
    times.push_back(row.items()[0].number());
    positions.push_back(row.items()[1].number());
  }
  if (times.size() == 1 && value(p, "start_rate") != value(p, "end_rate")) {
    context.diagnostics.error(rows.place(),
                              "has one row, where the rate would jump from 'start_rate' to 'end_rate'; need two rows");
    return nullptr;
  }
  return std::make_unique<Following<Spline>>(
      Spline(std::move(times), std::move(positions), value(p, "start_rate"), value(p, "end_rate")));
}

ParameterSpec from_parameter() { return number("from", "rad|m", "coordinate at time 0").otherwise(0.0); }

void enroll(Enrollment& enrollment) {
  enroll_motion_input(enrollment);
  enroll_shaped_motion(enrollment);
  enrollment.add<Motion>({.id = "locked",
                          .summary = "The hinge stays where the simulation begins; hinges of any kind",
                          .parameters = {},
                          .make = &make_locked});
  enrollment.add<Motion>({.id = "constant-rate",
                          .summary = "Constant rate",
                          .parameters = {number("rate", "rad/s|m/s", "rate"), from_parameter()},
                          .make = &make_constant_rate});
  enrollment.add<Motion>(
      {.id = "spin-up",
       .summary = "Smoothly from rest to a rate, which then stays",
       .parameters = {number("rate", "rad/s|m/s", "rate at the end"),
                      number("duration", "s", "time until it is reached").above(0), from_parameter()},
       .make = &make_spin_up});
  enrollment.add<Motion>({.id = "quintic",
                          .summary = "From rest to rest, along a polynomial of degree five",
                          .parameters = {from_parameter(), number("to", "rad|m", "coordinate at the end"),
                                         number("duration", "s", "time until the end").above(0)},
                          .make = &make_quintic});
  enrollment.add<Motion>({.id = "sine",
                          .summary = "Oscillation about a centre",
                          .parameters = {number("amplitude", "rad|m", "greatest distance from the centre"),
                                         number("period", "s", "period").above(0),
                                         number("center", "rad|m", "coordinate about which it swings").otherwise(0.0),
                                         number("phase", "rad", "phase at time 0").otherwise(0.0)},
                          .make = &make_sine});
  enrollment.add<Motion>(
      {.id = "expression",
       .summary = "A formula of the time t",
       .parameters = {text("value", "coordinate [rad, m] as a formula of the time t [s], twice differentiable")},
       .make = &make_expression});
  enrollment.add<Motion>(
      {.id = "table",
       .summary = "Cubic spline through given points, at rest in the first and the last or at rates",
       .parameters = {table("table", {"s", "rad|m"}, "time and coordinate"),
                      number("start_rate", "rad/s|m/s", "rate in the first row and before").otherwise(0.0),
                      number("end_rate", "rad/s|m/s", "rate in the last row and after").otherwise(0.0)},
       .make = &make_table});
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(motions, withy::enroll);
