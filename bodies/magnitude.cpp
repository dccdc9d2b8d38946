#include "magnitude.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace withy {
namespace {

/// Decimal exponents up to this have squares that doubles hold, with some margin for sums.
constexpr double greatest_exponent = 150;

/// Of a mean that has left the range of doubles itself, that of the bound.
double exponent(double value) {
  using Limits = std::numeric_limits<double>;
  return std::log10(std::clamp(value, Limits::denorm_min(), Limits::max()));
}

}  // namespace

bool held(const char* what, std::initializer_list<Factor> product, Diagnostics& diagnostics) {
  double sum = 0;
  for (const Factor& f : product) sum += f.power * exponent(f.value);
  if (std::abs(sum) <= greatest_exponent) return true;
  const double sign = sum > 0 ? 1 : -1;
  const Factor* worst = product.begin();
  const auto share = [sign](const Factor& f) { return sign * f.power * exponent(f.value); };
  for (const Factor& f : product)
    if (share(f) > share(*worst)) worst = &f;
  const double bound = (sign * greatest_exponent - (sum - worst->power * exponent(worst->value))) / worst->power;
  std::string formula;
  for (const Factor& f : product) {
    formula += (formula.empty() ? "" : " ") + std::string(f.name);
    if (f.power != 1) formula += fmt::format("^{}", f.power);
  }
  const bool table = worst->given->kind() != Value::Kind::number;
  const bool small = sign * worst->power < 0;
  diagnostics.error(
      worst->given->place(),
      fmt::format(
          "got {}{:.3g}, with which {}, {}, is about 1e{:.0f}, and its square is outside of the range of doubles; "
          "need at {} about 1e{:.0f}{}",
          table ? "a mean of " : "", worst->value, what, formula, sum, small ? "least" : "most",
          small ? std::ceil(bound) : std::floor(bound), product.size() > 1 ? " with the other numbers" : ""));
  return false;
}

}  // namespace withy
