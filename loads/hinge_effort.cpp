/// \file
/// An effort on one rate of a hinge as a function of time: constant, sine or table.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <variant>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/entry.hpp"

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

/// Linear between rows, zero outside them.
struct Table {
  std::vector<double> times;
  std::vector<double> values;
  double operator()(double t) const noexcept {
    if (!(t >= times.front() && t < times.back())) return std::isnan(t) ? t : 0;
    const auto i = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
    const double r = (t - times[i - 1]) / (times[i] - times[i - 1]);
    return (1 - r) * values[i - 1] + r * values[i];
  }
};

/// A law that acts for start ≤ t < stop [s].
struct Effort {
  std::variant<Constant, Sine, Table> law;
  double start = -infinity;
  double stop = infinity;

  double operator()(double t) const noexcept {
    if (t < start || t >= stop) return 0;
    return std::visit([t](const auto& f) { return f(t); }, law);
  }
  std::vector<double> discontinuities() const {
    std::vector<double> jumps;
    if (const auto* table = std::get_if<Table>(&law)) jumps = table->times;
    std::erase_if(jumps, [this](double t) { return t <= start || t >= stop; });
    if (start > -infinity) jumps.insert(jumps.begin(), start);
    if (stop < infinity) jumps.push_back(stop);
    return jumps;
  }
  double end() const {
    const auto* table = std::get_if<Table>(&law);
    const double last = std::min(stop, table == nullptr ? infinity : table->times.back());
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
  std::vector<double> discontinuities() const override { return effort_.discontinuities(); }
  double end() const override { return effort_.end(); }
  void begin(State& /*state*/) const override {}

 private:
  Effort effort_;
  std::size_t speed_;
};

class HingeEffort final : public Load {
 public:
  HingeEffort(std::string hinge, std::size_t component, Effort effort)
      : hinge_(std::move(hinge)), component_(component), effort_(std::move(effort)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    const Slot* slot = model.layout().hinge(hinge_);
    if (slot == nullptr) throw std::invalid_argument("there is no hinge '" + hinge_ + "'");
    if (component_ >= slot->speeds)
      throw std::invalid_argument("hinge '" + hinge_ + "' has " + std::to_string(slot->speeds) +
                                  " rates; there is no component " + std::to_string(component_) +
                                  " (they count from 0)");
    return std::make_unique<BoundHingeEffort>(effort_, slot->speed + component_);
  }

 private:
  std::string hinge_;
  std::size_t component_;
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
  if (!p.has("table") || p.at("table").items().size() < 2) return lacking(p, context, "a 'table' of two rows or more");
  Table table;
  for (const Value& row : p.at("table").items()) {
    table.times.push_back(row.items()[0].number());
    table.values.push_back(row.items()[1].number());
  }
  return Effort{std::move(table)};
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
  return std::make_unique<HingeEffort>(p.text_at("hinge"), p.count_at("component"), std::move(*effort));
}

void enroll(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "hinge-effort",
       .summary = "Effort on one rate of a hinge as a function of time; a force in N where the rate is a velocity",
       .parameters = {text("hinge", "hinge that is driven").naming(ParameterSpec::Refers::hinge),
                      integer("component", "which of the hinge's rates, counted from 0").least(0).otherwise(0.0),
                      text("law", "effort as a function of time").one_of({"constant", "sine", "table"}),
                      number("value", "N m", "effort (constant)").optional(),
                      number("amplitude", "N m", "greatest effort (sine)").optional(),
                      number("period", "s", "period (sine)").above(0).optional(),
                      number("frequency", "Hz", "frequency, in place of the period (sine)").above(0).optional(),
                      number("phase", "rad", "phase at time 0 (sine)").optional(),
                      table("table", {"s", "N m"}, "time and effort, linear in between, zero outside").optional(),
                      number("start", "s", "the effort is zero before").optional(),
                      number("stop", "s", "the effort is zero from here on").optional()},
       .make = &make});
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(hinge_effort, withy::enroll);
