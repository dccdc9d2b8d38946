/// \file
/// A shaken base: motion is relative to it, and all mass feels its acceleration the other way.
#include <algorithm>
#include <array>
#include <variant>

#include "withy/core/plugin/formula.hpp"
#include "withy/loads/fields/bound_field.hpp"
#include "withy/loads/time_law.hpp"

namespace withy {
namespace {

using fields::FieldAt;

/// One formula of the time a component, world axes.
struct FormulaLaw {
  std::vector<Formula> components;

  Vector3 operator()(double t) const noexcept {
    const std::array<double, 1> time{t};
    return {components[0](time), components[1](time), components[2](time)};
  }
};

/// a = −A(t), A the acceleration of the base.
struct BaseExcitation {
  std::variant<TimeLaw<Vector3>, FormulaLaw> law;

  template <class S>
  [[nodiscard]] FieldAt<S> at(double t, const fields::V3<S>& /*r*/, const fields::V3<S>& /*v*/,
                              const fields::M3<S>& /*second*/) const {
    FieldAt<S> field;
    field.a = Vector3(-std::visit([t](const auto& A) { return A(t); }, law)).template cast<S>();
    return field;
  }
  [[nodiscard]] std::size_t courses() const { return std::holds_alternative<FormulaLaw>(law) ? 3 : 0; }
  void course(double t, std::span<double> values) const {
    const Vector3 A = std::visit([t](const auto& given) { return Vector3(given(t)); }, law);
    std::copy(A.begin(), A.end(), values.begin());
  }
  [[nodiscard]] std::vector<double> discontinuities() const {
    const auto* given = std::get_if<TimeLaw<Vector3>>(&law);
    return given == nullptr ? std::vector<double>{} : given->discontinuities();
  }
  [[nodiscard]] double end() const {
    const auto* given = std::get_if<TimeLaw<Vector3>>(&law);
    return given == nullptr ? 0 : given->end();
  }
};

std::optional<FormulaLaw> read_formulas(const Value& p, const MakeContext& context) {
  FormulaLaw law;
  const Value& given = p.at("formula");
  if (given.items().size() != 3) {
    context.diagnostics.error(given.place(), "need three formulas of the time t, one a component");
    return {};
  }
  for (const Value& each : given.items()) {
    try {
      law.components.emplace_back(each.text());
      for (const std::string& name : law.components.back().names())
        if (name != "t") throw std::invalid_argument("there is nothing called '" + name + "'; need the time t alone");
    } catch (const std::invalid_argument& e) {
      context.diagnostics.error(each.place(), "got \"" + each.text() + "\": " + e.what());
      return {};
    }
  }
  return law;
}

std::unique_ptr<Load> make_base_excitation(const Value& p, const MakeContext& context) {
  BaseExcitation excitation;
  const auto has = [&](const char* key) { return p.has(key); };
  const std::array of_law{"law", "value", "amplitude", "table"};
  if (p.has("formula") == std::any_of(of_law.begin(), of_law.end(), has)) {
    context.diagnostics.error(p.place(), "need one of 'law' and 'formula'");
    return nullptr;
  }
  if (p.has("formula")) {
    std::optional<FormulaLaw> law = read_formulas(p, context);
    if (!law) return nullptr;
    excitation.law = std::move(*law);
  } else {
    std::optional<TimeLaw<Vector3>> law = TimeLawReader<Vector3>(p, context).read();
    if (!law) return nullptr;
    excitation.law = std::move(*law);
  }
  return std::make_unique<fields::Field<BaseExcitation>>(std::move(excitation));
}

std::vector<ParameterSpec> base_parameters() {
  std::vector<ParameterSpec> all = time_law_parameters<Vector3>("acceleration of the base, world axes", "m/s^2");
  all.push_back(texts("formula", "acceleration of the base [m/s^2] as three formulas of the time t, in place of a law")
                    .optional());
  return all;
}

}  // namespace

void enroll_base_excitation(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "base-excitation",
                        .summary = "Shaken base: all mass feels the acceleration of the world's axes the other way",
                        .parameters = base_parameters(),
                        .make = &make_base_excitation});
}

}  // namespace withy
