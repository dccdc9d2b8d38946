/// \file
/// Power series in ε, truncated, of vectors and matrices: orders in the elastic coordinates, apart from the derivatives
/// that their numbers carry.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace withy::analysis {

/// Σ a_k ε^k over `count` orders of vectors or matrices.
template <class M, std::size_t count>
struct Series {
  std::array<M, count> order;

  static Series zero() {
    Series s;
    s.order.fill(M::Zero());
    return s;
  }
  static Series constant(const M& value) {
    Series s = zero();
    s.order[0] = value;
    return s;
  }
  /// The first of the orders.
  template <std::size_t fewer>
  [[nodiscard]] Series<M, fewer> first() const {
    Series<M, fewer> s;
    for (std::size_t k = 0; k < fewer; ++k) s.order[k] = order[k];
    return s;
  }
  [[nodiscard]] M total() const {
    M sum = order[0];
    for (std::size_t k = 1; k < count; ++k) sum += order[k];
    return sum;
  }
  Series& operator+=(const Series& b) {
    for (std::size_t k = 0; k < count; ++k) order[k] += b.order[k];
    return *this;
  }
  Series& operator-=(const Series& b) {
    for (std::size_t k = 0; k < count; ++k) order[k] -= b.order[k];
    return *this;
  }
  friend Series operator+(Series a, const Series& b) { return a += b; }
  friend Series operator-(Series a, const Series& b) { return a -= b; }
};

/// Σ a_i b_j ε^(i+j) as far as the shorter of both goes.
template <class A, std::size_t m, class B, std::size_t n, class Product>
auto convolved(const Series<A, m>& a, const Series<B, n>& b, Product&& product) {
  constexpr std::size_t count = std::min(m, n);
  Series<decltype(product(a.order[0], b.order[0])), count> c;
  for (std::size_t k = 0; k < count; ++k) {
    c.order[k] = product(a.order[0], b.order[k]);
    for (std::size_t i = 1; i <= k; ++i) c.order[k] += product(a.order[i], b.order[k - i]);
  }
  return c;
}

template <class T>
using SeriesVector = Eigen::Matrix<T, 3, 1>;
template <class T>
using SeriesMatrix = Eigen::Matrix<T, 3, 3>;

/// Products order by order: of matrices with vectors and matrices, of vectors across each other.
template <class T, std::size_t m, std::size_t n>
auto operator*(const Series<SeriesMatrix<T>, m>& R, const Series<SeriesVector<T>, n>& v) {
  return convolved(R, v, [](const SeriesMatrix<T>& a, const SeriesVector<T>& b) { return SeriesVector<T>(a * b); });
}
template <class T, std::size_t m, std::size_t n>
auto operator*(const Series<SeriesMatrix<T>, m>& A, const Series<SeriesMatrix<T>, n>& B) {
  return convolved(A, B, [](const SeriesMatrix<T>& a, const SeriesMatrix<T>& b) { return SeriesMatrix<T>(a * b); });
}
template <class T, std::size_t m, std::size_t n>
auto cross(const Series<SeriesVector<T>, m>& u, const Series<SeriesVector<T>, n>& v) {
  return convolved(u, v,
                   [](const SeriesVector<T>& a, const SeriesVector<T>& b) { return SeriesVector<T>(a.cross(b)); });
}
/// The sum of all orders of the product.
template <class T, std::size_t m, std::size_t n>
T dot(const Series<SeriesVector<T>, m>& u, const Series<SeriesVector<T>, n>& v) {
  const auto products = convolved(
      u, v, [](const SeriesVector<T>& a, const SeriesVector<T>& b) { return Eigen::Matrix<T, 1, 1>(a.dot(b)); });
  return products.total()(0);
}
template <class T, std::size_t n>
Series<SeriesMatrix<T>, n> transposed(Series<SeriesMatrix<T>, n> R) {
  for (SeriesMatrix<T>& each : R.order) each.transposeInPlace();
  return R;
}
template <class T, std::size_t n>
Series<SeriesVector<T>, n> scaled(Series<SeriesVector<T>, n> v, double s) {
  for (SeriesVector<T>& each : v.order) each *= T(s);
  return v;
}
/// ε v.
template <class T>
Series<SeriesVector<T>, 2> raised(const Series<SeriesVector<T>, 2>& v) {
  return {{SeriesVector<T>::Zero(), v.order[0]}};
}
/// (1 − ε) v.
template <class T>
Series<SeriesVector<T>, 2> less_raised(Series<SeriesVector<T>, 2> v) {
  v.order[1] -= v.order[0];
  return v;
}
/// Without the second order.
template <class T, class Matrix>
Series<Matrix, 2> low(const Series<Matrix, 3>& s) {
  return s.template first<2>();
}

}  // namespace withy::analysis
