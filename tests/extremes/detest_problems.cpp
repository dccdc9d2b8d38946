#include <array>
#include <cmath>
#include <utility>

#include "detest.hpp"

namespace withy::extremes {
namespace {

/// A problem from a right-hand side in any kind of number.
template <class F>
DetestProblem problem(std::string name, std::vector<double> start, std::size_t speeds, F f) {
  return {std::move(name), std::move(start), speeds, [f](double t, const double* y, double* r) { f(t, y, r); },
          [f](long double t, const long double* y, long double* r) { f(t, y, r); }};
}

std::vector<double> unit(std::size_t n) {
  std::vector<double> y(n, 0.0);
  y[0] = 1;
  return y;
}

void add_single_equations(std::vector<DetestProblem>& all) {
  using std::cos;
  all.push_back(problem("A1", {1}, 0, [](auto, auto y, auto f) { f[0] = -y[0]; }));
  all.push_back(problem("A2", {1}, 0, [](auto, auto y, auto f) { f[0] = -y[0] * y[0] * y[0] / 2; }));
  all.push_back(problem("A3", {1}, 0, [](auto t, auto y, auto f) { f[0] = y[0] * cos(t); }));
  all.push_back(problem("A4", {1}, 0, [](auto, auto y, auto f) { f[0] = y[0] / 4 * (1 - y[0] / 20); }));
  all.push_back(problem("A5", {4}, 0, [](auto t, auto y, auto f) { f[0] = (y[0] - t) / (y[0] + t); }));
}

void add_small_systems(std::vector<DetestProblem>& all) {
  all.push_back(problem("B1", {1, 3}, 0, [](auto, auto y, auto f) {
    f[0] = 2 * (y[0] - y[0] * y[1]);
    f[1] = -(y[1] - y[0] * y[1]);
  }));
  all.push_back(problem("B2", {2, 0, 1}, 0, [](auto, auto y, auto f) {
    f[0] = -y[0] + y[1];
    f[1] = y[0] - 2 * y[1] + y[2];
    f[2] = y[1] - y[2];
  }));
  all.push_back(problem("B3", {1, 0, 0}, 0, [](auto, auto y, auto f) {
    f[0] = -y[0];
    f[1] = y[0] - y[1] * y[1];
    f[2] = y[1] * y[1];
  }));
  all.push_back(problem("B4", {3, 0, 0}, 0, [](auto, auto y, auto f) {
    const auto r = std::sqrt(y[0] * y[0] + y[1] * y[1]);
    f[0] = -y[1] - y[0] * y[2] / r;
    f[1] = y[0] - y[1] * y[2] / r;
    f[2] = y[0] / r;
  }));
  all.push_back(problem("B5", {0, 1, 1}, 0, [](auto, auto y, auto f) {
    f[0] = y[1] * y[2];
    f[1] = -y[0] * y[2];
    f[2] = -y[0] * y[1] * 51 / 100;
  }));
}

/// y′ = T y with T tridiagonal of −2 and 1.
DetestProblem heat(std::string name, int n) {
  return problem(std::move(name), unit(static_cast<std::size_t>(n)), 0, [n](auto, auto y, auto f) {
    for (int i = 0; i < n; ++i) f[i] = (i > 0 ? y[i - 1] : 0) - 2 * y[i] + (i + 1 < n ? y[i + 1] : 0);
  });
}

/// Sun and inner planets, Jupiter, Saturn, Uranus, Neptune, Pluto; unit of time 100 days.
DetestProblem planets() {
  std::vector<double> start = {3.42947415189,   3.35386959711,   1.35494901715,   6.64145542550,   5.97156957878,
                               2.18231499728,   11.2630437207,   14.6952576794,   6.27960525067,   -30.1552268759,
                               1.65699966404,   1.43785752721,   -21.1238353380,  28.4465098142,   15.3882659679,
                               -0.557160570446, 0.505696783289,  0.230578543901,  -0.415570776342, 0.365682722812,
                               0.169143213293,  -0.325325669158, 0.189706021964,  0.0877265322780, -0.0240476254170,
                               -0.287659532608, -0.117219543175, -0.176860753121, -0.216393453025, -0.0148647893090};
  return problem("C5", std::move(start), 15, [](auto, auto y, auto f) {
    constexpr double k2 = 2.95912208286, sun = 1.00000597682;
    constexpr std::array<double, 5> m = {0.000954786104043, 0.000285583733151, 0.0000437273164546, 0.0000517759138449,
                                         0.00000277777777778};
    using T = std::remove_cvref_t<decltype(y[0])>;
    const auto cubed = [](T x, T y1, T z) {
      const T square = x * x + y1 * y1 + z * z;
      return square * std::sqrt(square);
    };
    for (std::size_t j = 0; j < 5; ++j) {
      const auto* r = y + 3 * j;
      const T own = cubed(r[0], r[1], r[2]);
      for (std::size_t i = 0; i < 3; ++i) {
        f[3 * j + i] = y[15 + 3 * j + i];
        f[15 + 3 * j + i] = -(sun + m[j]) * r[i] / own;
      }
      for (std::size_t k = 0; k < 5; ++k) {
        if (k == j) continue;
        const auto* s = y + 3 * k;
        const T other = cubed(s[0], s[1], s[2]), between = cubed(s[0] - r[0], s[1] - r[1], s[2] - r[2]);
        for (std::size_t i = 0; i < 3; ++i) f[15 + 3 * j + i] += m[k] * ((s[i] - r[i]) / between - s[i] / other);
      }
      for (std::size_t i = 0; i < 3; ++i) f[15 + 3 * j + i] *= k2;
    }
  });
}

void add_moderate_systems(std::vector<DetestProblem>& all) {
  all.push_back(problem("C1", unit(10), 0, [](auto, auto y, auto f) {
    f[0] = -y[0];
    for (int i = 1; i < 9; ++i) f[i] = y[i - 1] - y[i];
    f[9] = y[8];
  }));
  all.push_back(problem("C2", unit(10), 0, [](auto, auto y, auto f) {
    f[0] = -y[0];
    for (int i = 1; i < 9; ++i) f[i] = i * y[i - 1] - (i + 1) * y[i];
    f[9] = 9 * y[8];
  }));
  all.push_back(heat("C3", 10));
  all.push_back(heat("C4", 51));
  all.push_back(planets());
}

void add_orbits(std::vector<DetestProblem>& all) {
  for (int k = 1; k <= 5; ++k) {
    const double e = 0.2 * k - 0.1;
    all.push_back(
        problem("D" + std::to_string(k), {1 - e, 0, 0, std::sqrt((1 + e) / (1 - e))}, 2, [](auto, auto y, auto f) {
          const auto square = y[0] * y[0] + y[1] * y[1];
          const auto cube = square * std::sqrt(square);
          f[0] = y[2], f[1] = y[3];
          f[2] = -y[0] / cube, f[3] = -y[1] / cube;
        }));
  }
}

void add_second_order_equations(std::vector<DetestProblem>& all) {
  // Bessel's equation of order ½ shifted by 1.
  all.push_back(problem("E1", {0.6713967071418030, 0.09540051444747446}, 1, [](auto t, auto y, auto f) {
    const auto s = t + 1;
    f[0] = y[1];
    f[1] = -(y[1] / s + (1 - 0.25 / (s * s)) * y[0]);
  }));
  // Van der Pol's; Duffing's; a falling body; a pursuit.
  all.push_back(problem("E2", {2, 0}, 1, [](auto, auto y, auto f) {
    f[0] = y[1];
    f[1] = (1 - y[0] * y[0]) * y[1] - y[0];
  }));
  all.push_back(problem("E3", {0, 0}, 1, [](auto t, auto y, auto f) {
    f[0] = y[1];
    f[1] = y[0] * y[0] * y[0] / 6 - y[0] + 2 * std::sin(2.78535 * t);
  }));
  all.push_back(problem("E4", {30, 0}, 1, [](auto, auto y, auto f) {
    f[0] = y[1];
    f[1] = 0.032 - 0.4 * y[1] * y[1];
  }));
  all.push_back(problem("E5", {0, 0}, 1, [](auto t, auto y, auto f) {
    f[0] = y[1];
    f[1] = std::sqrt(1 + y[1] * y[1]) / (25 - t);
  }));
}

}  // namespace

FunctionEquations DetestProblem::equations() const {
  const std::size_t n = start.size();
  return {n - speeds, speeds, [f = slope, n](double t, std::span<const double> y, std::span<double> y_dot) {
            f(t, y.data(), y_dot.data());
            y_dot[n] = 0;
            return Evaluation{};
          }};
}

State DetestProblem::state() const {
  State s{0, start};
  s.y.push_back(0);
  return s;
}

std::vector<DetestProblem> detest_problems() {
  std::vector<DetestProblem> all;
  add_single_equations(all);
  add_small_systems(all);
  add_moderate_systems(all);
  add_orbits(all);
  add_second_order_equations(all);
  return all;
}

std::vector<std::vector<double>> detest_reference(const DetestProblem& problem, int parts, int steps) {
  using Vector = std::vector<long double>;
  constexpr int columns = 8;
  const std::size_t n = problem.start.size();
  Vector y(problem.start.begin(), problem.start.end()), f(n), a(n), b(n), c(n);
  const long double H = static_cast<long double>(DetestProblem::end) / steps;
  std::vector<std::vector<double>> found;
  std::array<Vector, columns> table;
  for (int step = 0; step < steps; ++step) {
    const long double t = H * step;
    for (int j = 0; j < columns; ++j) {
      const int parts_of_step = 2 * (j + 1);
      const long double h = H / parts_of_step;
      problem.fine(t, y.data(), f.data());
      a = y;
      for (std::size_t i = 0; i < n; ++i) b[i] = y[i] + h * f[i];
      for (int k = 1; k < parts_of_step; ++k) {
        problem.fine(t + h * k, b.data(), f.data());
        for (std::size_t i = 0; i < n; ++i) c[i] = a[i] + 2 * h * f[i];
        std::swap(a, b);
        std::swap(b, c);
      }
      Vector now = b;
      // Aitken and Neville in h².
      for (int k = j - 1; k >= 0; --k) {
        const long double ratio = static_cast<long double>(j + 1) / (k + 1);
        Vector& before = table[static_cast<std::size_t>(j - 1 - k)];
        for (std::size_t i = 0; i < n; ++i) {
          const long double finer = now[i] + (now[i] - before[i]) / (ratio * ratio - 1);
          before[i] = std::exchange(now[i], finer);
        }
      }
      table[static_cast<std::size_t>(j)] = now;
      if (j == columns - 1) y = now;
    }
    if ((step + 1) % (steps / parts) == 0) found.emplace_back(y.begin(), y.end());
  }
  return found;
}

}  // namespace withy::extremes
