#include "withy/core/analysis/frequency_response.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "withy/core/analysis/balance_with_ends.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// Relative width to which crossings and peaks are found.
constexpr double narrow = 1e-13;
/// A root with less damping than this is on the edge of stability.
constexpr double undamped = 1e-9;

bool finite(Complex x) { return std::isfinite(x.real()) && std::isfinite(x.imag()); }

/// Where `side` changes between two frequencies, by bisection.
template <class Side>
double change_between(double a, double b, Side&& side) {
  const bool at_a = side(a);
  while (b - a > narrow * b) {
    const double middle = 0.5 * (a + b);
    if (middle <= a || middle >= b) break;
    (side(middle) == at_a ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

/// The greatest of a function with one maximum between a and b, by the golden section.
template <class Function>
double maximum_between(double a, double b, Function&& f) {
  constexpr double golden = 0.6180339887498949;
  double c = b - golden * (b - a), d = a + golden * (b - a), at_c = f(c), at_d = f(d);
  // A maximum is flat: half the digits are all there are.
  while (b - a > 1e-9 * b) {
    if (at_c > at_d) {
      b = d, d = c, at_d = at_c;
      at_c = f(c = b - golden * (b - a));
    } else {
      a = c, c = d, at_c = at_d;
      at_d = f(d = a + golden * (b - a));
    }
  }
  return 0.5 * (a + b);
}

/// The best of those that count; null where none does.
template <class Item, class Counts, class Better>
const Item* best(const std::vector<Item>& items, Counts&& counts, Better&& better) {
  const Item* found = nullptr;
  for (const Item& item : items)
    if (counts(item) && (found == nullptr || better(item, *found))) found = &item;
  return found;
}

/// What an error of a root is to its exponent; none where it is infinite: of what is not known nothing else is the
/// same.
double error_of_exponent(const LinearSystem& system, Complex value, double error) {
  if (!std::isfinite(error)) return 0;
  return system.sampled() ? error / (std::abs(value) * system.period) : error;
}

/// The roots with one left out for each of `others` that is the same but for rounding of both; what was left out goes
/// to `same`.
KnownRoots without(const LinearSystem& system, const KnownRoots& roots, const KnownRoots& others, KnownRoots& same) {
  // What differences of loads and sensors, and the displacements that make a root, are known to.
  constexpr double known = 1e-6;
  std::vector<Eigen::Index> left(static_cast<std::size_t>(roots.values.size())), gone;
  std::iota(left.begin(), left.end(), Eigen::Index{0});
  // Multipliers of motions that are over after a sample, or after some, are rounding of zero, and its root where these
  // follow each other: their logarithms differ.
  const auto over = [&](const KnownRoots& of, Eigen::Index i) {
    return system.sampled() &&
           std::abs(of.values[i]) < std::max(1e-9, std::isfinite(of.errors[i]) ? 10 * of.errors[i] : 0);
  };
  for (Eigen::Index k = 0; k < others.values.size(); ++k) {
    const Complex other = others.values[k], s = exponent_of(system, other);
    const bool is_over = over(others, k);
    const auto apart = [&](Eigen::Index i) {
      if (is_over || over(roots, i)) return is_over && over(roots, i) ? 0.0 : std::numeric_limits<double>::infinity();
      return std::abs(exponent_of(system, roots.values[i]) - s);
    };
    const auto nearest =
        std::min_element(left.begin(), left.end(), [&](Eigen::Index a, Eigen::Index b) { return apart(a) < apart(b); });
    if (nearest == left.end()) break;
    const double errors = error_of_exponent(system, roots.values[*nearest], roots.errors[*nearest]) +
                          error_of_exponent(system, other, others.errors[k]);
    if (!(apart(*nearest) <= (is_over ? 0.0 : known * std::abs(s) + errors))) continue;
    gone.push_back(*nearest);
    left.erase(nearest);
  }
  same = {roots.values(gone), roots.errors(gone)};
  return {roots.values(left), roots.errors(left)};
}

/// At half the rate of the samples, z = −1; zero where that is rounding of what makes it.
Complex at_half_rate(const TransferFunction& G) {
  constexpr double rounding = 1e-12;
  const LinearSystem& s = G.system();
  const Complex value = G(-1.0)(0, 0);
  Eigen::MatrixXd held = -s.A;
  held.diagonal().array() -= 1;
  const Eigen::VectorXd states = held.inverse().cwiseAbs() * s.B.col(0).cwiseAbs();
  const double terms = s.C.row(0).cwiseAbs().dot(states) + std::abs(s.D(0, 0));
  return std::isfinite(terms) && std::abs(value) <= rounding * terms ? 0.0 : value;
}

/// The gains at the ends of the frequencies, where G is real, and the size of the last.
void look_at_ends(const TransferFunction& G, std::optional<double> static_gain, Margins& margins) {
  const auto add = [&](double omega, Complex value) {
    if (finite(value) && value.real() < 0) margins.gains.push_back({omega, -1 / value.real()});
  };
  const LinearSystem& s = G.system();
  if (static_gain) add(0, *static_gain);
  const Complex last = s.sampled() ? at_half_rate(G) : Complex(s.D(0, 0));
  add(s.sampled() ? pi / s.period : std::numeric_limits<double>::infinity(), last);
  margins.last = std::abs(last);
}

/// Of the loop's own poles, and of hidden ones that grow all the same. One that neither grows nor decays, as of a
/// motion that nothing holds, is no matter of the loop.
void find_growth(const TransferFunction& G, const Eigen::VectorXcd& hidden, Margins& m) {
  m.growth = -std::numeric_limits<double>::infinity();
  m.period = G.system().period;
  KnownRoots unmoved;
  const KnownRoots others{hidden, Eigen::VectorXd::Zero(hidden.size())};
  for (const Complex pole : without(G.system(), known_poles(closed_loop(G.given(), 1)), others, unmoved).values)
    m.growth = std::max(m.growth, exponent_of(G.system(), pole).real());
  for (Eigen::Index i = 0; i < unmoved.values.size(); ++i) {
    const Complex s = exponent_of(G.system(), unmoved.values[i]);
    const double least = undamped * std::abs(s) + error_of_exponent(G.system(), unmoved.values[i], unmoved.errors[i]);
    if (s.real() > least) m.hidden_growth = std::max(m.hidden_growth, s.real());
  }
  m.growth = m.hidden_growth > 0 ? std::max(m.growth, m.hidden_growth) : m.growth;
  m.stable = m.growth < 0;
}

/// What is left of an angle in (−π, π].
double wrapped(double angle) { return angle - 2 * pi * std::ceil((angle - pi) / (2 * pi)); }

}  // namespace

Complex exponent_of(const LinearSystem& system, Complex value) {
  if (!system.sampled()) return value;
  return value == 0.0 ? Complex(-std::numeric_limits<double>::infinity(), 0) : std::log(value) / system.period;
}

SeenRoots seen_roots(const LinearSystem& system, const KnownRoots& poles, const KnownRoots& zeros) {
  KnownRoots hidden, same;
  SeenRoots seen;
  seen.zeros = without(system, zeros, poles, same).values;
  seen.poles = without(system, poles, same, hidden).values;
  seen.hidden = std::move(hidden.values);
  return seen;
}

std::vector<ResponseAt> frequency_response(const TransferFunction& G, double low, double high, int per_decade,
                                           const Eigen::VectorXcd& marks) {
  const double last = G.system().sampled() ? std::min(high, pi / G.system().period) : high;
  std::vector<double> at;
  const int count = std::max(2, static_cast<int>(std::ceil(per_decade * std::log10(last / low))));
  for (int i = 0; i <= count; ++i) at.push_back(low * std::pow(last / low, static_cast<double>(i) / count));
  at.back() = last;
  for (const Complex mark : marks) {
    const Complex s = exponent_of(G.system(), mark);
    const double half_width = std::abs(s.real());
    if (!(s.imag() > 0) || !(half_width < 0.5 * s.imag())) continue;
    const double width = std::max(half_width, 1e-6 * s.imag());
    for (int k = half_width <= undamped * s.imag() ? 1 : 0; k <= 6; ++k) {
      const double away = k == 0 ? 0 : 0.25 * std::exp2(k) * width;
      at.push_back(s.imag() - away);
      at.push_back(s.imag() + away);
    }
  }
  std::sort(at.begin(), at.end());
  std::vector<ResponseAt> response;
  for (const double omega : at) {
    if (omega < low || omega > last || (!response.empty() && omega <= response.back().omega)) continue;
    if (const Complex value = G.at_frequency(omega); finite(value)) response.push_back({omega, value});
  }
  return response;
}

bool is_felt(const LinearSystem& system, const Eigen::VectorXcd& poles) {
  constexpr double rounding = 1e-12;
  constexpr double beside = 1.03;  // of a pole, where nothing is finite
  constexpr std::size_t most = 16;
  LinearSystem wide = system;
  balance_with_ends(wide);
  const Eigen::Index n = wide.A.rows();
  if (n == 0) return wide.D(0, 0) != 0;
  const double half_rate = system.sampled() ? pi / system.period : std::numeric_limits<double>::infinity();
  std::vector<double> at;
  for (const Complex pole : poles)
    if (const double size = beside * std::abs(exponent_of(system, pole)); size > 0 && size < half_rate)
      at.push_back(size);
  if (at.empty()) at.push_back(std::min(1.0, half_rate / 2));
  std::sort(at.begin(), at.end());

  wide.B.conservativeResize(n, 2), wide.C.conservativeResize(2, n);
  wide.B.col(1) = Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return std::cos(1 + 2.4 * double(i)); });
  wide.C.row(1) = wide.B.col(1).transpose();
  const double direct = wide.D(0, 0);
  wide.D = Eigen::MatrixXd::Zero(2, 2);
  wide.D(0, 0) = direct;
  const TransferFunction G(wide);
  const std::size_t every = (at.size() + most - 1) / most;
  for (std::size_t i = 0; i < at.size(); i += every) {
    const Eigen::MatrixXcd g = G(G.system().at_frequency(at[i]));
    // Where that is not finite nothing is known.
    if (!(std::abs(g(0, 0) * g(1, 1)) <= rounding * std::abs(g(0, 1) * g(1, 0)))) return true;
  }
  return false;
}

std::vector<Peak> peaks(const TransferFunction& G, const std::vector<ResponseAt>& response,
                        const Eigen::VectorXcd& poles) {
  std::vector<Peak> found;
  for (const Complex pole : poles) {
    const Complex s = exponent_of(G.system(), pole);
    if (s.imag() > 0 && std::abs(s.real()) <= undamped * s.imag() && !response.empty() &&
        s.imag() >= response.front().omega && s.imag() <= response.back().omega)
      found.push_back({s.imag(), {}});
  }
  const auto gain = [&](double omega) { return std::abs(G.at_frequency(omega)); };
  const std::size_t bare = found.size();
  for (std::size_t i = 1; i + 1 < response.size(); ++i) {
    const double here = std::abs(response[i].value);
    if (!(here > std::abs(response[i - 1].value)) || !(here >= std::abs(response[i + 1].value))) continue;
    const double omega = maximum_between(response[i - 1].omega, response[i + 1].omega, gain);
    const bool known = std::any_of(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(bare),
                                   [&](const Peak& p) { return std::abs(p.omega - omega) <= 1e-5 * omega; });
    if (!known) found.push_back({omega, gain(omega)});
  }
  std::sort(found.begin(), found.end(), [](const Peak& a, const Peak& b) { return a.omega < b.omega; });
  return found;
}

LinearSystem closed_loop(const LinearSystem& s, double k) {
  const double loop = 1 + k * s.D(0, 0);
  if (std::abs(loop) < 1e-14) throw std::domain_error("the loop is not well posed: 1 + k D is zero");
  LinearSystem closed = s;
  closed.A -= s.B * s.C * (k / loop);
  closed.B /= loop;
  closed.C /= loop;
  closed.D /= loop;
  return closed;
}

Margins margins(const TransferFunction& G, const std::vector<ResponseAt>& response, const Eigen::VectorXcd& hidden,
                std::optional<double> static_gain) {
  Margins m;
  look_at_ends(G, static_gain, m);
  const auto above = [&](double omega) { return G.at_frequency(omega).imag() > 0; };
  const auto beyond_one = [&](double omega) { return std::abs(G.at_frequency(omega)) > 1; };
  const auto rounding = [](Complex x) { return std::abs(x.imag()) <= 1e-11 * std::abs(x); };
  const ResponseAt* sided = nullptr;  // the last whose side of the real axis is known: one may stand on it
  for (const ResponseAt& b : response) {
    if (rounding(b.value)) continue;
    if (sided != nullptr && (sided->value.imag() > 0) != (b.value.imag() > 0)) {
      const double omega = change_between(sided->omega, b.omega, above);
      const Complex value = G.at_frequency(omega);
      // Through a pole on the axis the sign changes too.
      if (value.real() < 0 && std::abs(value.imag()) <= 1e-4 * std::abs(value))
        m.gains.push_back({omega, -1 / value.real()});
    }
    sided = &b;
  }
  for (std::size_t i = 0; i + 1 < response.size(); ++i) {
    const ResponseAt &a = response[i], &b = response[i + 1];
    if ((std::abs(a.value) > 1) != (std::abs(b.value) > 1)) {
      const double omega = change_between(a.omega, b.omega, beyond_one);
      const double angle = wrapped(std::arg(G.at_frequency(omega)) + pi);
      m.phases.push_back({omega, angle, (angle < 0 ? angle + 2 * pi : angle) / omega});
    }
  }
  std::stable_sort(m.gains.begin(), m.gains.end(),
                   [](const GainMargin& a, const GainMargin& b) { return a.omega < b.omega; });
  find_growth(G, hidden, m);
  return m;
}

const GainMargin* Margins::upper() const {
  return best(
      gains, [](const GainMargin& g) { return g.factor > 1; },
      [](const GainMargin& a, const GainMargin& b) { return a.factor < b.factor; });
}

const GainMargin* Margins::lower() const {
  return best(
      gains, [](const GainMargin& g) { return g.factor < 1; },
      [](const GainMargin& a, const GainMargin& b) { return a.factor > b.factor; });
}

// From a stable loop on, the first pole that reaches the edge is the one that makes it unstable, in each direction.
const PhaseMargin* Margins::lag() const {
  return best(
      phases, [this](const PhaseMargin& p) { return stable && p.angle > 0; },
      [](const PhaseMargin& a, const PhaseMargin& b) { return a.angle < b.angle; });
}

const PhaseMargin* Margins::lead() const {
  return best(
      phases, [this](const PhaseMargin& p) { return stable && p.angle < 0; },
      [](const PhaseMargin& a, const PhaseMargin& b) { return a.angle > b.angle; });
}

std::optional<int> Margins::samples() const {
  if (!(period > 0) || delay() == nullptr) return {};
  return static_cast<int>(std::ceil(delay()->delay / period * (1 - undamped))) - 1;
}

const PhaseMargin* Margins::delay() const {
  return best(
      phases, [this](const PhaseMargin&) { return stable && last < 1; },
      [](const PhaseMargin& a, const PhaseMargin& b) { return a.delay < b.delay; });
}

}  // namespace withy
