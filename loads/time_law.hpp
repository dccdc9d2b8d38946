/// \file
/// Values as functions of time, as scenes state them: a number (an effort) or a vector (a force, a moment).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "withy/core/plugin/registry.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy {

/// x, or a vector of it; T: double or Vector3.
template <class T>
T constant_value(double x) {
  if constexpr (std::is_same_v<T, double>) {
    return x;
  } else {
    return T::Constant(x);
  }
}

template <class T>
struct ConstantLaw {
  T value;
  T operator()(double /*t*/) const noexcept { return value; }
};

template <class T>
struct SineLaw {
  T amplitude;
  double frequency = 0;  ///< [Hz]
  double phase = 0;      ///< [rad]
  T operator()(double t) const noexcept { return amplitude * std::sin(2 * std::numbers::pi * frequency * t + phase); }
};

template <class T>
struct LawRows {
  std::vector<double> times;
  std::vector<T> values;
};

/// Linear between rows, zero outside them.
template <class T>
struct TableLaw : LawRows<T> {
  T operator()(double t) const noexcept {
    if (std::isnan(t)) return constant_value<T>(t);
    if (!(t >= this->times.front() && t < this->times.back())) return constant_value<T>(0);
    const auto i =
        static_cast<std::size_t>(std::upper_bound(this->times.begin(), this->times.end(), t) - this->times.begin());
    const double r = (t - this->times[i - 1]) / (this->times[i] - this->times[i - 1]);
    return (1 - r) * this->values[i - 1] + r * this->values[i];
  }
};

/// The value of each row until the next, of the last for ever; zero before the first.
template <class T>
struct StepsLaw : LawRows<T> {
  T operator()(double t) const noexcept {
    if (std::isnan(t)) return constant_value<T>(t);
    const auto next = std::upper_bound(this->times.begin(), this->times.end(), t);
    if (next == this->times.begin()) return constant_value<T>(0);
    return this->values[static_cast<std::size_t>(next - this->times.begin()) - 1];
  }
};

/// A law that acts for start ≤ t < stop [s].
template <class T>
struct TimeLaw {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  std::variant<ConstantLaw<T>, SineLaw<T>, TableLaw<T>, StepsLaw<T>> law;
  double start = -infinity;
  double stop = infinity;

  T operator()(double t) const noexcept {
    if (t < start || t >= stop) return constant_value<T>(0);
    return std::visit([t](const auto& f) -> T { return f(t); }, law);
  }
  [[nodiscard]] std::vector<double> discontinuities() const {
    std::vector<double> jumps;
    if (const auto* table = std::get_if<TableLaw<T>>(&law)) jumps = table->times;
    if (const auto* steps = std::get_if<StepsLaw<T>>(&law)) jumps = steps->times;
    std::erase_if(jumps, [this](double t) { return t <= start || t >= stop; });
    if (start > -infinity) jumps.insert(jumps.begin(), start);
    if (stop < infinity && !(end() > 0 && end() < stop)) jumps.push_back(stop);
    return jumps;
  }
  /// When it has done its work [s]; 0 where it never has.
  [[nodiscard]] double end() const {
    double last = stop;
    if (const auto* table = std::get_if<TableLaw<T>>(&law)) last = std::min(stop, table->times.back());
    if (const auto* steps = std::get_if<StepsLaw<T>>(&law);
        steps != nullptr && steps->values.back() == constant_value<T>(0))
      last = std::min(stop, steps->times.back());
    return last < infinity ? last : 0;
  }
};

/// The parameters that state a law; `what` and its unit go into their descriptions.
template <class T>
std::vector<ParameterSpec> time_law_parameters(const std::string& what, const std::string& unit) {
  constexpr bool scalar = std::is_same_v<T, double>;
  const auto value = [&](const std::string& key, const std::string& meaning) {
    return scalar ? number(key, unit, meaning).optional() : vector(key, 3, unit, meaning).optional();
  };
  std::vector<std::string> columns{"s"};
  columns.insert(columns.end(), scalar ? 1 : 3, unit);
  return {text("law", what + " as a function of time; where left out what is given says it: a value is constant, an "
                             "amplitude that of a sine")
              .one_of({"constant", "sine", "table", "steps"})
              .optional(),
          value("value", what + " (constant)"),
          value("amplitude", "greatest " + what + " (sine)"),
          number("period", "s", "period (sine)").above(0).optional(),
          number("frequency", "Hz", "frequency, in place of the period (sine)").above(0).optional(),
          number("phase", "rad", "phase at time 0 (sine)").optional(),
          table("table", columns,
                "time and " + what + ": linear in between and zero outside (table), or each from its time on (steps)")
              .optional(),
          number("start", "s", "the " + what + " is zero before").optional(),
          number("stop", "s", "the " + what + " is zero from here on").optional()};
}

/// Reads a law; reports keys that it lacks or does not take.
template <class T>
class TimeLawReader {
 public:
  TimeLawReader(const Value& p, const MakeContext& context) : p_(p), context_(context), law_(law_of(p)) {}

  /// Nothing after a reported error.
  std::optional<TimeLaw<T>> read() {
    if (law_.empty()) {
      context_.diagnostics.error(p_.place(), p_.has("table")
                                                 ? "a 'table' needs a 'law': table, linear between its rows, or steps"
                                                 : "needs a 'law', or a 'value', which is constant");
      return {};
    }
    std::optional<TimeLaw<T>> law = read_law();
    if (!law) return {};
    if (const Value* v = p_.find("start")) law->start = v->number();
    if (const Value* v = p_.find("stop")) law->stop = v->number();
    if (law->start < law->stop) return law;
    context_.diagnostics.error(p_.at("stop").place(), "'stop' is not after 'start'");
    return {};
  }

 private:
  /// Empty where nothing says it.
  static std::string law_of(const Value& p) {
    if (p.has("law")) return p.text_at("law");
    if (p.has("value")) return "constant";
    return p.has("amplitude") ? "sine" : "";
  }
  std::optional<TimeLaw<T>> read_law() {
    if (law_ == "constant") {
      if (!only({"value"})) return {};
      if (!p_.has("value")) return lacking("'value'");
      return TimeLaw<T>{ConstantLaw<T>{value(p_.at("value"))}};
    }
    if (law_ == "sine") {
      if (!only({"amplitude", "period", "frequency", "phase"})) return {};
      if (!p_.has("amplitude")) return lacking("'amplitude'");
      if (p_.has("period") == p_.has("frequency")) return lacking("one of 'period' and 'frequency'");
      const double frequency = p_.has("period") ? 1 / p_.number_at("period") : p_.number_at("frequency");
      return TimeLaw<T>{SineLaw<T>{value(p_.at("amplitude")), frequency, p_.has("phase") ? p_.number_at("phase") : 0}};
    }
    if (!only({"table"})) return {};
    const std::size_t least = law_ == "table" ? 2 : 1;
    if (!p_.has("table") || p_.at("table").items().size() < least)
      return lacking(least == 2 ? "a 'table' of two rows or more" : "a 'table'");
    LawRows<T> rows;
    for (const Value& row : p_.at("table").items()) {
      rows.times.push_back(row.items()[0].number());
      if constexpr (std::is_same_v<T, double>) {
        rows.values.push_back(row.items()[1].number());
      } else {
        const std::vector<double> x = row.numbers();
        rows.values.emplace_back(x[1], x[2], x[3]);
      }
    }
    if (law_ == "table") return TimeLaw<T>{TableLaw<T>{std::move(rows)}};
    return TimeLaw<T>{StepsLaw<T>{std::move(rows)}};
  }

  static T value(const Value& v) {
    if constexpr (std::is_same_v<T, double>) {
      return v.number();
    } else {
      const std::vector<double> x = v.numbers();
      return T(x[0], x[1], x[2]);
    }
  }

  /// Reports the keys that another law takes, and returns whether there were none.
  bool only(std::initializer_list<std::string_view> taken) {
    bool ok = true;
    for (const std::string_view key : {"value", "amplitude", "period", "frequency", "phase", "table"}) {
      const Value* v = p_.find(key);
      if (v == nullptr || std::find(taken.begin(), taken.end(), key) != taken.end()) continue;
      context_.diagnostics.error(v->place(),
                                 "the law '" + law_ + "' takes no '" + std::string(key) + "'" + another(key));
      ok = false;
    }
    return ok;
  }

  /// The law that an option belongs to.
  static std::string another(std::string_view key) {
    if (key == "value") return "; law: constant does";
    return key == "table" ? "; law: table and law: steps do" : "; law: sine does";
  }

  std::optional<TimeLaw<T>> lacking(const std::string& what) {
    context_.diagnostics.error(p_.place(), "the law '" + law_ + "' needs " + what);
    return {};
  }

  const Value& p_;
  const MakeContext& context_;
  std::string law_;
};

}  // namespace withy
