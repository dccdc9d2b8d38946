/// \file
/// An effort on one rate of a hinge as a function of time: constant, sine, table or steps.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "withy/core/plugin/entry.hpp"
#include "withy/loads/hinge_rate.hpp"

namespace withy {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Constant {
  double value = 0;
  double operator()(double /*t*/) const noexcept { return value; }
};

struct Sine {
  double amplitude = 0;
  double frequency = 0;  ///< [Hz]
  double phase = 0;      ///< [rad]
  double operator()(double t) const noexcept {
    return amplitude * std::sin(2 * std::numbers::pi * frequency * t + phase);
  }
};

struct Rows {
  std::vector<double> times;
  std::vector<double> values;
};

/// Linear between rows, zero outside them.
struct Table : Rows {
  double operator()(double t) const noexcept {
    if (!(t >= times.front() && t < times.back())) return std::isnan(t) ? t : 0;
    const auto i = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
    const double r = (t - times[i - 1]) / (times[i] - times[i - 1]);
    return (1 - r) * values[i - 1] + r * values[i];
  }
};

/// The value of each row until the next, of the last for ever; zero before the first.
struct Steps : Rows {
  double operator()(double t) const noexcept {
    const auto next = std::upper_bound(times.begin(), times.end(), t);
    if (next == times.begin() || std::isnan(t)) return std::isnan(t) ? t : 0;
    return values[static_cast<std::size_t>(next - times.begin()) - 1];
  }
};

/// A law that acts for start ≤ t < stop [s].
struct Effort {
  std::variant<Constant, Sine, Table, Steps> law;
  double start = -infinity;
  double stop = infinity;

  double operator()(double t) const noexcept {
    if (t < start || t >= stop) return 0;
    return std::visit([t](const auto& f) { return f(t); }, law);
  }
  std::vector<double> discontinuities() const {
    std::vector<double> jumps;
    if (const auto* table = std::get_if<Table>(&law)) jumps = table->times;
    if (const auto* steps = std::get_if<Steps>(&law)) jumps = steps->times;
    std::erase_if(jumps, [this](double t) { return t <= start || t >= stop; });
    if (start > -infinity) jumps.insert(jumps.begin(), start);
    if (stop < infinity && !(end() > 0 && end() < stop)) jumps.push_back(stop);
    return jumps;
  }
  double end() const {
    double last = stop;
    if (const auto* table = std::get_if<Table>(&law)) last = std::min(stop, table->times.back());
    if (const auto* steps = std::get_if<Steps>(&law); steps != nullptr && steps->values.back() == 0)
      last = std::min(stop, steps->times.back());
    return last < infinity ? last : 0;
  }
};

class BoundHingeEffort final : public BoundLoad {
 public:
  BoundHingeEffort(Effort effort, std::size_t speed) : effort_(std::move(effort)), speed_(speed) {}
  std::size_t scratch() const override { return 0; }
  void add(double t, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> efforts, std::span<double> /*scratch*/) const noexcept override {
    efforts[speed_] += effort_(t);
  }
  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const override {
    return true;  // a function of time alone
  }
  std::vector<double> discontinuities() const override { return effort_.discontinuities(); }
  double end() const override { return effort_.end(); }
  void begin(State& /*state*/) const override {}

 private:
  Effort effort_;
  std::size_t speed_;
};

class HingeEffort final : public Load {
 public:
  HingeEffort(RateName rate, Effort effort) : rate_(std::move(rate)), effort_(std::move(effort)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundHingeEffort>(effort_, speed_index(model, rate_));
  }

 private:
  RateName rate_;
  Effort effort_;
};

/// Reports the keys that another law takes, and returns whether there were none.
bool only(const Value& p, const MakeContext& context, std::initializer_list<std::string_view> taken) {
  bool ok = true;
  for (const std::string_view key : {"value", "amplitude", "period", "frequency", "phase", "table"}) {
    const Value* v = p.find(key);
    if (v == nullptr || std::find(taken.begin(), taken.end(), key) != taken.end()) continue;
    context.diagnostics.error(v->place(), "the law '" + p.text_at("law") + "' takes no '" + std::string(key) + "'");
    ok = false;
  }
  return ok;
}

/// Reports that a law lacks something.
std::optional<Effort> lacking(const Value& p, const MakeContext& context, const std::string& what) {
  context.diagnostics.error(p.place(), "the law '" + p.text_at("law") + "' needs " + what);
  return {};
}

std::optional<Effort> read_law(const Value& p, const MakeContext& context) {
  const std::string& law = p.text_at("law");
  if (law == "constant") {
    if (!only(p, context, {"value"})) return {};
    if (!p.has("value")) return lacking(p, context, "'value'");
    return Effort{Constant{p.number_at("value")}};
  }
  if (law == "sine") {
    if (!only(p, context, {"amplitude", "period", "frequency", "phase"})) return {};
    if (!p.has("amplitude")) return lacking(p, context, "'amplitude'");
    if (p.has("period") == p.has("frequency")) return lacking(p, context, "one of 'period' and 'frequency'");
    const double frequency = p.has("period") ? 1 / p.number_at("period") : p.number_at("frequency");
    return Effort{Sine{p.number_at("amplitude"), frequency, p.has("phase") ? p.number_at("phase") : 0}};
  }
  if (!only(p, context, {"table"})) return {};
  const std::size_t least = law == "table" ? 2 : 1;
  if (!p.has("table") || p.at("table").items().size() < least)
    return lacking(p, context, least == 2 ? "a 'table' of two rows or more" : "a 'table'");
  Rows rows;
  for (const Value& row : p.at("table").items()) {
    rows.times.push_back(row.items()[0].number());
    rows.values.push_back(row.items()[1].number());
  }
  if (law == "table") return Effort{Table{std::move(rows)}};
  return Effort{Steps{std::move(rows)}};
}

std::unique_ptr<Load> make(const Value& p, const MakeContext& context) {
  std::optional<Effort> effort = read_law(p, context);
  if (!effort) return nullptr;
  if (const Value* v = p.find("start")) effort->start = v->number();
  if (const Value* v = p.find("stop")) effort->stop = v->number();
  if (!(effort->start < effort->stop)) {
    context.diagnostics.error(p.at("stop").place(), "'stop' is not after 'start'");
    return nullptr;
  }
  return std::make_unique<HingeEffort>(rate_name(p), std::move(*effort));
}

void enroll(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "hinge-effort",
       .summary = "Effort on one rate of a hinge as a function of time; a force in N where the rate is a velocity",
       .parameters = rate_parameters(
           {text("law", "effort as a function of time").one_of({"constant", "sine", "table", "steps"}),
            number("value", "N m", "effort (constant)").optional(),
            number("amplitude", "N m", "greatest effort (sine)").optional(),
            number("period", "s", "period (sine)").above(0).optional(),
            number("frequency", "Hz", "frequency, in place of the period (sine)").above(0).optional(),
            number("phase", "rad", "phase at time 0 (sine)").optional(),
            table("table", {"s", "N m"},
                  "time and effort: linear in between and zero outside (table), or each from its time on (steps)")
                .optional(),
            number("start", "s", "the effort is zero before").optional(),
            number("stop", "s", "the effort is zero from here on").optional()}),
       .make = &make});
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(hinge_effort, withy::enroll);
