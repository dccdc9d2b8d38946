/// \file
/// Numbers that carry derivatives of first order along several directions at once, and may be nested.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>

namespace withy {

/// a + Σ b_k ε_k over N directions with ε_k ε_l = 0; a, b_k of type T, a number or such numbers again. Operators are
/// always inlined: by its own rules g++ calls those of nested numbers, and the dense equations take 1.2 times as long.
template <class T, std::size_t N>
class DualNumber {
 public:
  DualNumber() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): constants among dual numbers
  DualNumber(double value) : value_(value) { derivatives_.fill(T(0.0)); }
  explicit DualNumber(const T& value) requires(!std::same_as<T, double>) : value_(value) { derivatives_.fill(T(0.0)); }
  DualNumber(const T& value, const std::array<T, N>& derivatives) : value_(value), derivatives_(derivatives) {}

  [[nodiscard]] const T& value() const { return value_; }
  [[nodiscard]] const std::array<T, N>& derivatives() const { return derivatives_; }
  [[nodiscard]] std::array<T, N>& derivatives() { return derivatives_; }

  [[gnu::always_inline]] DualNumber& operator+=(const DualNumber& b) {
    value_ += b.value_;
    for (std::size_t k = 0; k < N; ++k) derivatives_[k] += b.derivatives_[k];
    return *this;
  }
  [[gnu::always_inline]] DualNumber& operator-=(const DualNumber& b) {
    value_ -= b.value_;
    for (std::size_t k = 0; k < N; ++k) derivatives_[k] -= b.derivatives_[k];
    return *this;
  }
  DualNumber& operator*=(const DualNumber& b) { return *this = *this * b; }
  DualNumber& operator/=(const DualNumber& b) { return *this = *this / b; }

  [[gnu::always_inline]] friend inline DualNumber operator-(const DualNumber& a) {
    return a.chained(-a.value_, T(-1.0));
  }
  // Into a result of its own: a copy that is added to is written number by number and read again by pairs, which
  // stalls.
  [[gnu::always_inline]] friend inline DualNumber operator+(const DualNumber& a, const DualNumber& b) {
    DualNumber c;
    c.value_ = a.value_ + b.value_;
    for (std::size_t k = 0; k < N; ++k) c.derivatives_[k] = a.derivatives_[k] + b.derivatives_[k];
    return c;
  }
  [[gnu::always_inline]] friend inline DualNumber operator-(const DualNumber& a, const DualNumber& b) {
    DualNumber c;
    c.value_ = a.value_ - b.value_;
    for (std::size_t k = 0; k < N; ++k) c.derivatives_[k] = a.derivatives_[k] - b.derivatives_[k];
    return c;
  }
  [[gnu::always_inline]] friend inline DualNumber operator*(const DualNumber& a, const DualNumber& b) {
    DualNumber c;
    c.value_ = a.value_ * b.value_;
    for (std::size_t k = 0; k < N; ++k) c.derivatives_[k] = a.derivatives_[k] * b.value_ + b.derivatives_[k] * a.value_;
    return c;
  }
  [[gnu::always_inline]] friend inline DualNumber operator*(const DualNumber& a, double b) {
    return a.chained(a.value_ * b, T(b));
  }
  [[gnu::always_inline]] friend inline DualNumber operator*(double a, const DualNumber& b) { return b * a; }
  [[gnu::always_inline]] friend inline DualNumber operator/(const DualNumber& a, const DualNumber& b) {
    DualNumber c;
    c.value_ = a.value_ / b.value_;
    const T inverse = T(1.0) / b.value_;
    for (std::size_t k = 0; k < N; ++k)
      c.derivatives_[k] = (a.derivatives_[k] - c.value_ * b.derivatives_[k]) * inverse;
    return c;
  }

  friend bool operator<(const DualNumber& a, const DualNumber& b) { return a.value_ < b.value_; }
  friend bool operator>(const DualNumber& a, const DualNumber& b) { return a.value_ > b.value_; }
  friend bool operator<=(const DualNumber& a, const DualNumber& b) { return a.value_ <= b.value_; }
  friend bool operator>=(const DualNumber& a, const DualNumber& b) { return a.value_ >= b.value_; }
  friend bool operator==(const DualNumber& a, const DualNumber& b) { return a.value_ == b.value_; }

  friend DualNumber sqrt(const DualNumber& a) {
    using std::sqrt;
    const T root = sqrt(a.value_);
    return a.chained(root, T(0.5) / root);
  }
  friend DualNumber sin(const DualNumber& a) {
    using std::cos;
    using std::sin;
    return a.chained(sin(a.value_), cos(a.value_));
  }
  friend DualNumber cos(const DualNumber& a) {
    using std::cos;
    using std::sin;
    return a.chained(cos(a.value_), -sin(a.value_));
  }

 private:
  /// f(a) of this a, whose f(a) and f′(a) are given.
  [[nodiscard]] DualNumber chained(const T& f, const T& slope) const {
    DualNumber c;
    c.value_ = f;
    for (std::size_t k = 0; k < N; ++k) c.derivatives_[k] = slope * derivatives_[k];
    return c;
  }

  T value_;
  std::array<T, N> derivatives_;
};

/// A value and its derivatives along eight directions: one or two vector registers of them.
inline constexpr std::size_t jet_directions = 8;
using Jet = DualNumber<double, jet_directions>;

using JetDerivatives = Eigen::Matrix<double, jet_directions, 1>;

/// The derivatives as a vector, where they are.
inline Eigen::Map<const JetDerivatives> derivatives_of(const Jet& x) {
  return Eigen::Map<const JetDerivatives>(x.derivatives().data());
}
inline Eigen::Map<JetDerivatives> derivatives_of(Jet& x) { return Eigen::Map<JetDerivatives>(x.derivatives().data()); }

inline double value_of(double x) { return x; }
inline double value_of(const Jet& x) { return x.value(); }

/// The greatest of |x| and its derivatives, for stopping criteria.
inline double magnitude(double x) { return std::abs(x); }
inline double magnitude(const Jet& x) { return std::max(std::abs(x.value()), derivatives_of(x).cwiseAbs().maxCoeff()); }

}  // namespace withy

namespace Eigen {

template <class T, std::size_t N>
struct NumTraits<withy::DualNumber<T, N>> : GenericNumTraits<withy::DualNumber<T, N>> {
  using Real = withy::DualNumber<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1 + static_cast<int>(N),
    AddCost = (1 + static_cast<int>(N)) * int{NumTraits<T>::AddCost},
    MulCost = (1 + 2 * static_cast<int>(N)) * int{NumTraits<T>::MulCost}
  };
};

template <class T, std::size_t N, class Operation>
struct ScalarBinaryOpTraits<withy::DualNumber<T, N>, double, Operation> {
  using ReturnType = withy::DualNumber<T, N>;
};
template <class T, std::size_t N, class Operation>
struct ScalarBinaryOpTraits<double, withy::DualNumber<T, N>, Operation> {
  using ReturnType = withy::DualNumber<T, N>;
};

}  // namespace Eigen
