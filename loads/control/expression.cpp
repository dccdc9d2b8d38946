/// \file
/// A controller written as a formula of the time and of signals.
#include <fmt/format.h>

#include <array>

#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/formula.hpp"
#include "withy/core/plugin/formula_course.hpp"
#include "withy/loads/control/control_load.hpp"

namespace withy {
namespace {

class FormulaBlock final : public ControlBlock, public CourseOfTime {
 public:
  explicit FormulaBlock(Formula formula) : formula_(std::move(formula)), course_(formula_) {
    for (const std::string& name : formula_.names())
      if (name != "t") signals_.push_back(name);
  }
  [[nodiscard]] const std::vector<std::string>& signals() const { return signals_; }
  std::size_t inputs() const override { return signals_.size(); }
  void output(double t, std::span<const double> w, std::span<const double> /*z*/,
              std::span<double> v) const noexcept override {
    std::array<double, Formula::most_names> named{};
    std::size_t next = 0;
    for (std::size_t i = 0; i < formula_.names().size(); ++i) named[i] = formula_.names()[i] == "t" ? t : w[next++];
    v[0] = formula_(named);
  }
  std::size_t courses() const override { return course_.count(); }
  void course(double t, std::span<double> values) const noexcept override { course_.set(t, values); }

 private:
  Formula formula_;
  FormulaCourse course_;
  std::vector<std::string> signals_;
};

std::unique_ptr<Load> make_control_expression(const Value& p, const MakeContext& context) {
  const Value& given = p.at("value");
  std::optional<ControlEnds> ends = read_ends(p, context);
  try {
    auto block = std::make_shared<FormulaBlock>(Formula(given.text()));
    if (!ends) return nullptr;
    if (p.has("of")) {
      context.diagnostics.error(p.at("of").place(), "an expression measures what its formula names; leave it out");
      return nullptr;
    }
    ends->of = block->signals();
    ends->measures_nothing = ends->of.empty();
    return make_control(std::move(*ends), std::move(block));
  } catch (const std::invalid_argument& e) {
    context.diagnostics.error(given.place(), fmt::format("got \"{}\": {}", given.text(), e.what()));
  }
  return nullptr;
}

}  // namespace

void enroll_control_expression(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "expression",
       .summary = "Controller: a formula of the time t and of signals",
       .parameters = control_parameters(
           {text("value", "formula of columns of hinges, outputs and other loads, as -20*arm - 3*arm.rate")}),
       .make = &make_control_expression});
}

}  // namespace withy
