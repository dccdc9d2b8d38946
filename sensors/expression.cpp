/// \file
/// A formula of what other sensors give.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/formula.hpp"
#include "withy/core/plugin/formula_course.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {
namespace {

class BoundExpression final : public BoundSensor, public CourseOfTime {
 public:
  /// `places`: of the formula's names among the numbers before it; `time_place` for the time.
  BoundExpression(Formula formula, std::string unit, std::vector<std::size_t> places)
      : formula_(std::move(formula)), course_(formula_), unit_(std::move(unit)), places_(std::move(places)) {}
  static constexpr std::size_t time_place = static_cast<std::size_t>(-1);

  std::vector<SensorColumn> columns() const override { return {{"", unit_}}; }
  void read(SensedState& state, const SensorInputs& inputs, std::span<double> values) const noexcept override {
    std::array<double, Formula::most_names> named{};
    for (std::size_t i = 0; i < places_.size(); ++i)
      named[i] = places_[i] == time_place ? state.time() : inputs.before[places_[i]];
    values[0] = formula_(named);
  }
  std::size_t courses() const override { return course_.count(); }
  void course(double t, std::span<double> values) const noexcept override { course_.set(t, values); }

 private:
  Formula formula_;
  FormulaCourse course_;
  std::string unit_;
  std::vector<std::size_t> places_;
};

class ExpressionSensor final : public Sensor {
 public:
  ExpressionSensor(Formula formula, std::string unit) : formula_(std::move(formula)), unit_(std::move(unit)) {}
  std::unique_ptr<BoundSensor> bind(const Model& /*model*/, std::span<const SensorNode> before) const override {
    std::vector<std::string> known;
    for (const SensorNode& node : before) {
      for (const SensorColumn& c : node.sensor->columns())
        known.push_back(c.component.empty() ? node.name : node.name + '.' + c.component);
    }
    std::vector<std::size_t> places;
    for (const std::string& name : formula_.names()) {
      std::size_t place = 0;
      while (place < known.size() && known[place] != name) ++place;
      if (name == "t") {
        place = BoundExpression::time_place;
      } else if (place == known.size()) {
        throw std::invalid_argument(fmt::format(
            "no number '{}' of an output that stands before; known: t{}{}", name, known.empty() ? "" : ", ",
            fmt::join(known.begin(),
                      known.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(known.size(), 30)), ", ")));
      }
      places.push_back(place);
    }
    return std::make_unique<BoundExpression>(formula_, unit_, std::move(places));
  }

 private:
  Formula formula_;
  std::string unit_;
};

/// Whether a column can have a text for its unit: heads of tables are ASCII, with commas and brackets of their own.
bool is_unit(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    return c >= ' ' && c <= '~' && std::string_view(",\"[]").find(c) == std::string_view::npos;
  });
}

std::unique_ptr<Sensor> make_expression(const Value& p, const MakeContext& context) {
  const Value& given = p.at("value");
  if (const Value& unit = p.at("unit"); !is_unit(unit.text())) {
    context.diagnostics.error(unit.place(),
                              "got what no column can have for its unit; need ASCII text without commas, quotes and "
                              "brackets");
    return nullptr;
  }
  try {
    return std::make_unique<ExpressionSensor>(Formula(given.text()), p.text_at("unit"));
  } catch (const std::invalid_argument& e) {
    context.diagnostics.error(given.place(), fmt::format("got \"{}\": {}", given.text(), e.what()));
  }
  return nullptr;
}

}  // namespace

void enroll_expression(Enrollment& enrollment) {
  enrollment.add<Sensor>({.id = "expression",
                          .summary = "Formula of the time t and of numbers that outputs before it give",
                          .parameters = {text("value", "formula, as norm(tip.vx, tip.vy)"),
                                         text("unit", "SI unit of its value").otherwise("1")},
                          .make = &make_expression});
}

}  // namespace withy
