/// \file
/// Proportional, integral and derivative feedback with a limit (Åström & Hägglund, "Advanced PID Control", ch. 3):
///   e = r − y,   u = k_p e + I + k_d d,   τ = max(−τ_max, min(τ_max, u)),
///   d = (e − f)/T_f with ḟ = (e − f)/T_f,  or ṙ − ẏ without filter,
/// with gains that are constant or tables over a signal;
///   İ = k_i e + (τ − u)/T_t  (back-calculation),  or k_i e, zero while u is beyond the limit and e drives it further
///   (clamping).
#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/loads/control/control_load.hpp"
#include "withy/loads/control/reference.hpp"

namespace withy {
namespace {

enum class AntiWindup { none, back_calculation, clamping };

/// A gain, or a table of it over the signal that schedules it: straight lines between the rows, constant beyond.
struct Gain {
  std::vector<double> at, values;  ///< `at` empty: one value for all

  double operator()(double s) const noexcept {
    if (at.empty() || s <= at.front()) return values.front();
    if (s >= at.back()) return values.back();
    const std::size_t i = row(s);
    return values[i] + slope(s) * (s - at[i]);
  }
  [[nodiscard]] double slope(double s) const noexcept {
    if (at.empty() || s <= at.front() || s >= at.back()) return 0;
    const std::size_t i = row(s);
    return (values[i + 1] - values[i]) / (at[i + 1] - at[i]);
  }
  [[nodiscard]] double greatest() const { return *std::max_element(values.begin(), values.end()); }

 private:
  [[nodiscard]] std::size_t row(double s) const noexcept {
    return static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), s) - at.begin()) - 1;
  }
};

struct PidGains {
  Gain proportional, integral, derivative;
  bool scheduled = false;  ///< by the last signal
  double filter = 0;       ///< T_f [s]; 0: the rate is measured
  double limit = std::numeric_limits<double>::infinity();
  AntiWindup anti_windup = AntiWindup::none;
  double tracking = 0;  ///< T_t [s]
};

class Pid final : public ControlBlock, public CourseOfTime {
 public:
  Pid(const PidGains& gains, Trajectory reference) : k_(gains), reference_(std::move(reference)) {}

  std::size_t inputs() const override { return 1 + (measures_rate() ? 1 : 0) + (k_.scheduled ? 1 : 0); }
  std::vector<std::string> states() const override {
    std::vector<std::string> names;
    if (integrates()) names.emplace_back("integral");
    if (filters()) names.emplace_back("filter");
    return names;
  }
  void begin(double t, std::span<const double> w, std::span<double> z) const noexcept override {
    if (integrates()) z[0] = 0;
    if (filters()) z[filter_place()] = at(reference_, t).position - w[0];
  }
  std::vector<Shown> shown() const override {
    std::vector<Shown> all{{"error", "signal"}};
    if (limited()) all.push_back({"margin", "command"});
    return all;
  }
  void tell(double t, std::span<const double> w, std::span<const double> z,
            std::span<double> values) const noexcept override {
    const Demand a = demand(t, w, z);
    values[0] = a.error;
    if (limited()) values[1] = a.wanted;
  }
  void finish(std::span<double> values) const noexcept override {
    if (limited()) values[1] = k_.limit - std::abs(values[1]);
  }
  std::string unit_of_state(std::size_t state) const override {
    return filters() && state == filter_place() ? "signal" : "command";
  }
  void rates(double t, std::span<const double> w, std::span<const double> z,
             std::span<double> rates) const noexcept override {
    const Demand a = demand(t, w, z);
    if (filters()) rates[filter_place()] = (a.error - z[filter_place()]) / k_.filter;
    if (integrates()) rates[0] = integral_rate(a, w);
  }
  void output(double t, std::span<const double> w, std::span<const double> z,
              std::span<double> v) const noexcept override {
    v[0] = demand(t, w, z).effort;
  }
  bool feeds_through(std::size_t input) const override {
    return (k_.scheduled && input + 1 == inputs()) || k_.proportional.greatest() > 0 || k_.derivative.greatest() > 0;
  }
  void set_sample(double period) override { period_ = period; }
  void advance(double t, std::span<const double> w, std::span<double> z) const noexcept override {
    const Demand a = demand(t, w, z);
    if (integrates()) z[0] += period_ * integral_rate(a, w);
    if (filters()) z[filter_place()] = a.error + (z[filter_place()] - a.error) * std::exp(-period_ / k_.filter);
  }
  bool slopes(double t, std::span<const double> w, std::span<const double> z, Slopes& s) const override {
    const Demand a = demand(t, w, z);
    const double kp = k_.proportional(w.back()), ki = k_.integral(w.back()), kd = k_.derivative(w.back());
    const bool free = a.effort == a.wanted;
    // Of u, by w and z; e = r − w₀.
    Eigen::RowVectorXd by_input = Eigen::RowVectorXd::Zero(s.output_by_input.cols()),
                       by_state = Eigen::RowVectorXd::Zero(s.output_by_state.cols());
    by_input[0] = -kp;
    const auto f = static_cast<Eigen::Index>(filter_place());
    if (filters()) {
      by_input[0] -= kd / k_.filter;
      by_state[f] = -kd / k_.filter;
      s.rate_by_input(f, 0) = -1 / k_.filter;
      s.rate_by_state(f, f) = -1 / k_.filter;
    } else if (measures_rate()) {
      by_input[1] = -kd;
    }
    if (integrates()) by_state[0] = 1;
    const Eigen::Index scheduling = by_input.cols() - 1;
    if (k_.scheduled)
      by_input[scheduling] = k_.proportional.slope(w.back()) * a.error + k_.derivative.slope(w.back()) * a.change;
    if (free) {
      s.output_by_input.row(0) = by_input;
      s.output_by_state.row(0) = by_state;
    }
    if (!integrates() || (!free && k_.anti_windup == AntiWindup::clamping && a.error * a.wanted > 0)) return true;
    s.rate_by_input(0, 0) = -ki;
    if (k_.scheduled) s.rate_by_input(0, scheduling) = k_.integral.slope(w.back()) * a.error;
    if (!free && k_.anti_windup == AntiWindup::back_calculation) {
      s.rate_by_input.row(0) -= by_input / k_.tracking;
      s.rate_by_state.row(0) = -by_state / k_.tracking;
    }
    return true;
  }
  std::vector<double> discontinuities() const override { return jumps_of(reference_); }
  std::size_t courses() const override { return courses_of(reference_); }
  void course(double t, std::span<double> values) const noexcept override { course_of(reference_, t, values); }
  double end() const override { return end_of(reference_); }
  [[nodiscard]] bool measures_rate() const { return k_.derivative.greatest() > 0 && k_.filter == 0; }

 private:
  struct Demand {
    double error, change, wanted, effort;  ///< e, d, u, τ
  };
  [[nodiscard]] bool limited() const { return k_.limit < std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool integrates() const { return k_.integral.greatest() > 0; }
  [[nodiscard]] bool filters() const { return k_.derivative.greatest() > 0 && k_.filter > 0; }
  [[nodiscard]] std::size_t filter_place() const { return integrates() ? 1 : 0; }
  [[nodiscard]] Demand demand(double t, std::span<const double> w, std::span<const double> z) const noexcept {
    const MotionPoint r = at(reference_, t);
    const double error = r.position - w[0];
    const double change = filters() ? (error - z[filter_place()]) / k_.filter : measures_rate() ? r.rate - w[1] : 0;
    double wanted = k_.proportional(w.back()) * error;
    if (integrates()) wanted += z[0];
    wanted += k_.derivative(w.back()) * change;
    return {error, change, wanted, std::clamp(wanted, -k_.limit, k_.limit)};
  }
  [[nodiscard]] double integral_rate(const Demand& a, std::span<const double> w) const noexcept {
    const bool beyond = a.effort != a.wanted;
    if (beyond && k_.anti_windup == AntiWindup::clamping && a.error * a.wanted > 0) return 0;
    double rate = k_.integral(w.back()) * a.error;
    if (beyond && k_.anti_windup == AntiWindup::back_calculation) rate += (a.effort - a.wanted) / k_.tracking;
    return rate;
  }

  PidGains k_;
  Trajectory reference_;
  double period_ = 0;  ///< [s]
};

Gain gain_of(const Value& given) {
  if (given.kind() == Value::Kind::number) return {{}, {given.number()}};
  Gain gain;
  for (const Value& row : given.items()) {
    gain.at.push_back(row.items()[0].number());
    gain.values.push_back(row.items()[1].number());
  }
  return gain;
}

/// Nothing after a reported error.
std::optional<PidGains> read_gains(const Value& p, const MakeContext& context) {
  PidGains k{.proportional = gain_of(p.at("proportional")),
             .integral = gain_of(p.at("integral")),
             .derivative = gain_of(p.at("derivative")),
             .scheduled = p.has("schedule"),
             .filter = p.number_at("filter")};
  const auto error = [&](const Value& at, const char* message) {
    context.diagnostics.error(at.place(), message);
    return std::nullopt;
  };
  for (const char* key : {"proportional", "integral", "derivative"})
    if (!k.scheduled && p.at(key).kind() == Value::Kind::list)
      return error(p.at(key), "a table of a gain needs a 'schedule', the signal of its first column");
  const double kp = k.proportional.greatest(), ki = k.integral.greatest(), kd = k.derivative.greatest();
  if (k.scheduled && k.proportional.at.empty() && k.integral.at.empty() && k.derivative.at.empty())
    return error(p.at("schedule"), "no gain is a table over it");
  if (kp == 0 && ki == 0 && kd == 0) return error(p, "does nothing; need 'proportional', 'integral' or 'derivative'");
  if (const Value* limit = p.find("limit")) k.limit = limit->number();
  const Value* way = p.find("anti_windup");
  if (way != nullptr && !p.has("limit")) return error(*way, "there is no 'limit', at which the integral would wind up");
  if (p.has("limit") && ki > 0) {
    const std::string name = way == nullptr ? "back-calculation" : way->text();
    k.anti_windup = name == "none"       ? AntiWindup::none
                    : name == "clamping" ? AntiWindup::clamping
                                         : AntiWindup::back_calculation;
  }
  if (const Value* tracking = p.find("tracking_time")) {
    if (k.anti_windup != AntiWindup::back_calculation)
      return error(*tracking, "is of the back-calculation at a 'limit', of an 'integral'");
    k.tracking = tracking->number();
  } else if (k.anti_windup == AntiWindup::back_calculation) {
    // Between the derivative's time and the integral's (Åström & Hägglund, section 3.5).
    k.tracking = kd > 0 ? std::sqrt(kd / ki) : kp / ki;
    if (!(k.tracking > 0)) return error(p, "an integral alone needs a 'tracking_time' for its back-calculation");
  }
  return k;
}

std::unique_ptr<Load> make_pid(const Value& p, const MakeContext& context) {
  const std::size_t before = context.diagnostics.errors().size();
  std::optional<ControlEnds> ends = read_ends(p, context);
  const std::optional<PidGains> gains = read_gains(p, context);
  const std::optional<Trajectory> reference = read_reference(p, context);
  if (ends && ends->of.size() > 1) context.diagnostics.error(p.at("of").place(), "got more than one signal; need one");
  if (ends && ends->of.empty() && !ends->hinge)
    context.diagnostics.error(p.place(), "measures nothing; need 'of' or 'hinge'");
  if (!ends || !gains || !reference || context.diagnostics.errors().size() != before) return nullptr;
  auto block = std::make_shared<Pid>(*gains, *reference);
  block->set_sample(ends->sample);
  ends->rate_too = block->measures_rate();
  if (p.has("schedule")) ends->also = {p.text_at("schedule")};
  return make_control(std::move(*ends), std::move(block));
}

}  // namespace

void enroll_pid(Enrollment& enrollment) {
  std::vector<ParameterSpec> own{
      number("proportional", "N m/rad|N/m", "effort for one of error").least(0).or_table("1").otherwise(0.0),
      number("integral", "N m/(rad s)|N/(m s)", "rate of effort for one of error")
          .least(0)
          .or_table("1")
          .otherwise(0.0),
      number("derivative", "N m s/rad|N s/m", "effort for one of error a second").least(0).or_table("1").otherwise(0.0),
      text("schedule", "signal over which gains are tables").naming(ParameterSpec::Refers::signal).optional(),
      number("filter", "s", "time constant of the derivative's first-order filter; 0: the rate of the hinge")
          .least(0)
          .otherwise(0.0),
      number("limit", "N m|N", "the effort never exceeds this").above(0).optional(),
      text("anti_windup", "what the integral does at the limit, back-calculation where left out")
          .one_of({"back-calculation", "clamping", "none"})
          .optional(),
      number("tracking_time", "s", "of the back-calculation, in which the integral follows the limit")
          .above(0)
          .optional()};
  for (ParameterSpec& spec : reference_parameters("rad|m")) own.push_back(std::move(spec));
  enrollment.add<Load>(
      {.id = "pid",
       .summary = "Controller: proportional, integral and derivative feedback, limited, with anti-windup",
       .parameters = control_parameters(std::move(own)),
       .make = &make_pid});
}

}  // namespace withy
