#include "withy/core/plugin/formula.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace withy {
namespace {

using Numbers = std::span<const double>;

/// A number with its first and second derivative.
using Series = std::array<double, 3>;

Series operator+(const Series& a, const Series& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Series operator*(const Series& a, const Series& b) {
  return {a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2 * a[1] * b[1] + a[0] * b[2]};
}
/// f(a) from f and its derivatives at a[0].
Series chained(const Series& a, double f, double slope, double bend) {
  return {f, slope * a[1], bend * a[1] * a[1] + slope * a[2]};
}
Series inverse(const Series& a) {
  const double f = 1 / a[0];
  return chained(a, f, -f * f, 2 * f * f * f);
}
Series root(const Series& a) {
  const double f = std::sqrt(a[0]);
  return chained(a, f, 0.5 / f, -0.25 / (f * a[0]));
}
Series power(const Series& a, const Series& b) {
  const double f = std::pow(a[0], b[0]);
  // A constant exponent leaves numbers of any sign their powers.
  if (b[1] == 0 && b[2] == 0) {
    const double slope = b[0] == 0 ? 0 : b[0] * std::pow(a[0], b[0] - 1);
    return chained(a, f, slope, b[0] == 0 || b[0] == 1 ? 0 : b[0] * (b[0] - 1) * std::pow(a[0], b[0] - 2));
  }
  const Series exponent = b * chained(a, std::log(a[0]), 1 / a[0], -1 / (a[0] * a[0]));
  return chained(exponent, f, f, f);
}
/// Of y over x, in any quadrant.
Series turn(const Series& y, const Series& x) {
  const double size = x[0] * x[0] + y[0] * y[0], area = x[0] * y[1] - y[0] * x[1];
  return {std::atan2(y[0], x[0]), area / size,
          (x[0] * y[2] - y[0] * x[2]) / size - 2 * area * (x[0] * x[1] + y[0] * y[1]) / (size * size)};
}

using AllSeries = std::span<const Series>;

struct Function {
  std::string_view name;
  std::size_t least, most;  ///< numbers that it takes
  double (*of)(Numbers x);
  Series (*series)(AllSeries x);
};

constexpr std::size_t any_number = Formula::most_pending;

bool less(const Series& a, const Series& b) { return a[0] < b[0]; }

constexpr std::array formula_functions = {
    Function{"sqrt", 1, 1, [](Numbers x) { return std::sqrt(x[0]); }, [](AllSeries x) { return root(x[0]); }},
    Function{"abs", 1, 1, [](Numbers x) { return std::abs(x[0]); },
             [](AllSeries x) { return chained(x[0], std::abs(x[0][0]), x[0][0] < 0 ? -1 : 1, 0); }},
    Function{"sin", 1, 1, [](Numbers x) { return std::sin(x[0]); },
             [](AllSeries x) { return chained(x[0], std::sin(x[0][0]), std::cos(x[0][0]), -std::sin(x[0][0])); }},
    Function{"cos", 1, 1, [](Numbers x) { return std::cos(x[0]); },
             [](AllSeries x) { return chained(x[0], std::cos(x[0][0]), -std::sin(x[0][0]), -std::cos(x[0][0])); }},
    Function{"tan", 1, 1, [](Numbers x) { return std::tan(x[0]); },
             [](AllSeries x) {
               const double f = std::tan(x[0][0]), slope = 1 + f * f;
               return chained(x[0], f, slope, 2 * f * slope);
             }},
    Function{"atan", 1, 1, [](Numbers x) { return std::atan(x[0]); },
             [](AllSeries x) {
               const double slope = 1 / (1 + x[0][0] * x[0][0]);
               return chained(x[0], std::atan(x[0][0]), slope, -2 * x[0][0] * slope * slope);
             }},
    Function{"exp", 1, 1, [](Numbers x) { return std::exp(x[0]); },
             [](AllSeries x) {
               const double f = std::exp(x[0][0]);
               return chained(x[0], f, f, f);
             }},
    Function{"log", 1, 1, [](Numbers x) { return std::log(x[0]); },
             [](AllSeries x) {
               const double slope = 1 / x[0][0];
               return chained(x[0], std::log(x[0][0]), slope, -slope * slope);
             }},
    Function{"atan2", 2, 2, [](Numbers x) { return std::atan2(x[0], x[1]); },
             [](AllSeries x) { return turn(x[0], x[1]); }},
    Function{"min", 1, any_number, [](Numbers x) { return *std::min_element(x.begin(), x.end()); },
             [](AllSeries x) { return *std::min_element(x.begin(), x.end(), less); }},
    Function{"max", 1, any_number, [](Numbers x) { return *std::max_element(x.begin(), x.end()); },
             [](AllSeries x) { return *std::max_element(x.begin(), x.end(), less); }},
    Function{"norm", 1, any_number,
             [](Numbers x) {
               double size = 0;
               for (const double value : x) size = std::hypot(size, value);
               return size;
             },
             [](AllSeries x) {
               Series squares{};
               for (const Series& each : x) squares = squares + each * each;
               return root(squares);
             }},
};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

/// Recursive descent; every step is written behind those of its operands.
class FormulaReader {
 public:
  FormulaReader(std::string_view text, Formula& formula) : text_(text), formula_(formula) {}
  void read() {
    sum();
    if (peek() != '\0') fail("expected an operator or the end");
  }

 private:
  using Operation = Formula::Operation;

  char peek() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw std::invalid_argument(why + " at character " + std::to_string(at_ + 1));
  }
  void put(Formula::Step step, std::size_t operands) {
    pending_ += 1;
    pending_ -= operands;
    if (pending_ > Formula::most_pending) fail("too deep");
    formula_.steps_.push_back(step);
  }

  void sum() {
    if (++depth_ > Formula::most_pending) fail("too deep");
    product();
    for (;;) {
      const bool plus = take('+');
      if (!plus && !take('-')) break;
      product();
      put({.operation = plus ? Operation::add : Operation::subtract}, 2);
    }
    --depth_;
  }
  void product() {
    signed_power();
    for (;;) {
      const bool times = take('*');
      if (!times && !take('/')) break;
      signed_power();
      put({.operation = times ? Operation::multiply : Operation::divide}, 2);
    }
  }
  /// −a^b is −(a^b), and a^−b is a^(−b).
  void signed_power() {
    if (++depth_ > Formula::most_pending) fail("too deep");
    if (take('-')) {
      signed_power();
      put({.operation = Operation::negate}, 1);
    } else {
      operand();
      if (take('^')) {
        signed_power();
        put({.operation = Operation::power}, 2);
      }
    }
    --depth_;
  }
  void operand() {
    if (take('(')) {
      sum();
      if (!take(')')) fail("expected ')'");
    } else if (is_letter(peek())) {
      named();
    } else {
      number();
    }
  }
  void number() {
    peek();
    double value = 0;
    const char* first = text_.data() + at_;
    const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value) || !(is_digit(*first) || *first == '.'))
      fail("expected a number, a name or '('");
    at_ += static_cast<std::size_t>(end - first);
    put({.operation = Operation::number, .number = value}, 0);
  }
  void named() {
    const std::size_t first = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]) || text_[at_] == '.')) ++at_;
    const std::string name(text_.substr(first, at_ - first));
    if (peek() == '(') return call(name);
    if (name == "pi") return put({.operation = Operation::number, .number = std::numbers::pi}, 0);
    std::vector<std::string>& names = formula_.names_;
    auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      if (names.size() == Formula::most_names) fail("too many names");
      found = names.insert(names.end(), name);
    }
    put({.operation = Operation::name, .index = static_cast<std::size_t>(found - names.begin())}, 0);
  }
  void call(const std::string& name) {
    const auto* function = std::find_if(formula_functions.begin(), formula_functions.end(),
                                        [&](const Function& f) { return f.name == name; });
    if (function == formula_functions.end()) {
      std::string known;
      for (const Function& f : formula_functions) known += (known.empty() ? "" : ", ") + std::string(f.name);
      fail("no function '" + name + "'; known: " + known);
    }
    take('(');
    std::size_t count = 0;
    do {
      sum();
      ++count;
    } while (take(','));
    if (!take(')')) fail("expected ',' or ')'");
    if (count < function->least || count > function->most)
      fail(name + " takes " + std::to_string(function->least) + (function->least == 1 ? " number" : " numbers") +
           ", got " + std::to_string(count));
    put({.operation = Operation::function,
         .index = static_cast<std::size_t>(function - formula_functions.begin()),
         .count = count},
        count);
  }

  std::string_view text_;
  Formula& formula_;
  std::size_t at_ = 0, pending_ = 0, depth_ = 0;
};

Formula::Formula(std::string_view text) { FormulaReader(text, *this).read(); }

std::vector<Formula> Formula::parts_of(std::string_view name) const {
  // Steps from `first` on to where the part stands on the stack; `named`, `other`: it has that name, another.
  struct Part {
    std::size_t first, end;
    bool named, other;
  };
  std::vector<Formula> parts;
  const auto keep = [&](const Part& part) {
    if (!part.named || part.other) return;
    Formula own;
    own.steps_.assign(steps_.begin() + static_cast<std::ptrdiff_t>(part.first),
                      steps_.begin() + static_cast<std::ptrdiff_t>(part.end));
    for (Step& step : own.steps_)
      if (step.operation == Operation::name) step.index = 0;
    own.names_ = {std::string(name)};
    parts.push_back(std::move(own));
  };
  std::vector<Part> stack;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Step& step = steps_[i];
    const std::size_t operands = step.operation == Operation::function                                      ? step.count
                                 : step.operation == Operation::number || step.operation == Operation::name ? 0
                                 : step.operation == Operation::negate                                      ? 1
                                                                                                            : 2;
    Part whole{i, i + 1, false, false};
    if (step.operation == Operation::name) (names_[step.index] == name ? whole.named : whole.other) = true;
    const std::span<const Part> of(stack.end() - static_cast<std::ptrdiff_t>(operands), stack.end());
    for (const Part& part : of) {
      whole.first = std::min(whole.first, part.first);
      whole.named |= part.named, whole.other |= part.other;
    }
    // What has another name beside it grows no further.
    if (whole.other) std::for_each(of.begin(), of.end(), keep);
    stack.resize(stack.size() - operands);
    stack.push_back(whole);
  }
  keep(stack.back());
  return parts;
}

double Formula::operator()(std::span<const double> values) const noexcept {
  std::array<double, most_pending + 1> stack{};
  std::size_t size = 0;
  for (const Step& step : steps_) {
    switch (step.operation) {
      case Operation::number:
        stack[size++] = step.number;
        continue;
      case Operation::name:
        stack[size++] = values[step.index];
        continue;
      case Operation::negate:
        stack[size - 1] = -stack[size - 1];
        continue;
      case Operation::function:
        size -= step.count;
        stack[size] = formula_functions[step.index].of(Numbers(stack).subspan(size, step.count));
        ++size;
        continue;
      default:
        break;
    }
    double& a = stack[size - 2];
    const double b = stack[--size];
    if (step.operation == Operation::add) a += b;
    if (step.operation == Operation::subtract) a -= b;
    if (step.operation == Operation::multiply) a *= b;
    if (step.operation == Operation::divide) a /= b;
    if (step.operation == Operation::power) a = std::pow(a, b);
  }
  return stack[0];
}

std::array<double, 3> Formula::with_derivatives(double x) const noexcept {
  std::array<Series, most_pending + 1> stack{};
  std::size_t size = 0;
  for (const Step& step : steps_) {
    switch (step.operation) {
      case Operation::number:
        stack[size++] = {step.number, 0, 0};
        continue;
      case Operation::name:
        stack[size++] = {x, 1, 0};
        continue;
      case Operation::negate:
        stack[size - 1] = stack[size - 1] * Series{-1, 0, 0};
        continue;
      case Operation::function:
        size -= step.count;
        stack[size] = formula_functions[step.index].series(AllSeries(stack).subspan(size, step.count));
        ++size;
        continue;
      default:
        break;
    }
    Series& a = stack[size - 2];
    const Series& b = stack[--size];
    if (step.operation == Operation::add) a = a + b;
    if (step.operation == Operation::subtract) a = a + b * Series{-1, 0, 0};
    if (step.operation == Operation::multiply) a = a * b;
    if (step.operation == Operation::divide) a = a * inverse(b);
    if (step.operation == Operation::power) a = power(a, b);
  }
  return stack[0];
}

}  // namespace withy
