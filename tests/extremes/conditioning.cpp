/// \file
/// Mass matrices that lose digits, or rank: a hinge with clamped modes under a heavy tip, bodies of no mass.
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>

#include "campaign.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/tests/bodies/textbook_waves.hpp"

namespace withy::extremes {
namespace {

using test::Exact;
using ExactMatrix = Eigen::Matrix<Exact, Eigen::Dynamic, Eigen::Dynamic>;
using ExactVector = Eigen::Matrix<Exact, Eigen::Dynamic, 1>;

constexpr int modes = 10;
constexpr double epsilon = 0x1p-52;

std::string arm(double mass, const std::string& family, double rtol = 1e-6) {
  return fmt::format(
      "format: withy/1\ntime: {{end: 1}}\nintegrator: {{name: dopri5, rtol: {}}}\nbodies:\n"
      "  arm: {{type: beam, length: 1, mass_per_length: 1, bending_y: {{stiffness: 1, modes: {}, family: {}}}}}\n"
      "  load: {{type: rigid, mass: {}}}\nhinges:\n"
      "  axle: {{type: revolute, axis: [0, 0, 1], parent: world, child: arm}}\n"
      "  tip: {{type: weld, parent: arm.tip, child: load}}\n",
      rtol, modes, family, mass);
}

/// Accelerations of the ruthless arm in 330 digits: M from ∫xφᵢ = 2/βᵢ² and φᵢ(1) = ±2, stiffness βᵢ⁴.
std::vector<double> exact_accelerations(double mass, const std::vector<double>& y) {
  ExactMatrix M(modes + 1, modes + 1);
  ExactVector f(modes + 1);
  M(0, 0) = Exact(1) / 3 + Exact(mass);
  f[0] = 0;
  for (int i = 0; i < modes; ++i) {
    const Exact beta = test::textbook_root(test::uniform_families[0], i + 1);
    const Exact tip = i % 2 == 0 ? 2 : -2;
    M(0, i + 1) = M(i + 1, 0) = 2 / (beta * beta) + mass * tip;
    for (int j = 0; j < modes; ++j) M(i + 1, j + 1) = Exact(i == j) + mass * tip * (j % 2 == 0 ? 2 : -2);
    f[i + 1] = -beta * beta * beta * beta * Exact(y[static_cast<std::size_t>(i) + 1]);
  }
  const ExactVector a = M.partialPivLu().solve(f);
  std::vector<double> result;
  for (int i = 0; i <= modes; ++i) result.push_back(static_cast<double>(a[i]));
  return result;
}

/// max |M a − f| over max |M| |a| in long doubles: what a check of the residual sees.
double residual(const DenseSystem& s, const std::vector<double>& a) {
  long double worst = 0, size = 0;
  for (std::size_t i = 0; i < s.size; ++i) {
    long double r = -static_cast<long double>(s.force[i]);
    for (std::size_t j = 0; j < s.size; ++j) {
      r += static_cast<long double>(s.mass[i * s.size + j]) * a[j];
      size = std::max(size, std::abs(static_cast<long double>(s.mass[i * s.size + j]) * a[j]));
    }
    worst = std::max(worst, std::abs(r));
  }
  return static_cast<double>(worst / size);
}

}  // namespace

void tip_mass(Campaign& campaign) {
  double of_clamped_free = 0;
  for (const double mass : {0.0, 1.0, 1e3, 1e6, 1e9}) {
    const Made made(arm(mass, "clamped-free"), "ruthless");
    State state = made.scene.initial;
    for (std::size_t i = 1; i <= modes; ++i) state.y[i] = 1e-3 / std::pow(static_cast<double>(i), 3);
    const std::vector<double> a = made.accelerations(state);
    const double error = difference(a, exact_accelerations(mass, state.y));
    const DenseSystem system = made.equations->system(0, state.y);
    const AttainableAccuracy attainable = attainable_accuracy(system);
    const double estimated = rounding_error(*made.scene.model, *made.equations, state, Probing::any).relative;
    campaign.row(fmt::format("tip {:g} × beam, error of the accelerations", mass), "the arm's M in 330 digits",
                 "≤ 10 κ·2⁻⁵², as the estimate",
                 fmt::format("{:.2g}; estimated {:.2g}; κ = {:.2g}, κ·2⁻⁵² = {:.2g}, residual {:.1g}", error, estimated,
                             attainable.condition, attainable.accuracy, residual(system, a)),
                 error <= 10 * attainable.accuracy && estimated <= 10 * attainable.accuracy);
    of_clamped_free = attainable.condition;
  }
  // The family that knows its load loses fewer digits; that the hinge moves the tip as its first mode does remains.
  const Made loaded(arm(1e9, "{name: clamped-loaded, tip_mass: 1e9}"), "ruthless");
  const AttainableAccuracy good = attainable_accuracy(loaded.equations->system(0, loaded.scene.initial.y));
  campaign.row("tip 1e9 × beam, clamped-loaded modes", "clamped-free modes", "κ at most half of theirs",
               fmt::format("κ = {:.2g} of {:.2g}", good.condition, of_clamped_free),
               good.condition <= 0.5 * of_clamped_free);
  for (const auto& [mass, rtol, refused] : {std::tuple(1e9, 1e-6, true), {1e9, 0.9, false}, {1.0, 1e-6, false}}) {
    const Made made(arm(mass, "clamped-free", rtol), "quadratic");
    const std::string why = unattainable(*made.scene.model, *made.equations, made.scene.initial, rtol);
    campaign.row(fmt::format("tip {:g} × beam, rtol {:g}", mass, rtol), "estimated error of the accelerations",
                 refused ? "refused, the body named" : "accepted", why.empty() ? "accepted" : "refused",
                 refused ? why.find("'arm'") != std::string::npos : why.empty());
  }
}

namespace {

std::string pendulums(double first, double second, double inertia_1, double inertia_2) {
  return fmt::format(
      "format: withy/1\ngravity: [0, -9.81, 0]\ntime: {{end: 1}}\nbodies:\n"
      "  upper: {{type: rigid, mass: {0}, center_of_mass: [0.3, 0.1, 0], inertia: [{2}, {2}, {2}, 0, 0, 0], "
      "frames: {{end: {{position: [0.7, 0, 0]}}}}}}\n"
      "  lower: {{type: rigid, mass: {1}, center_of_mass: [0.25, 0, 0], inertia: [{3}, {3}, {3}, 0, 0, 0]}}\nhinges:\n"
      "  a: {{type: revolute, axis: [0, 0, 1], parent: world, child: upper}}\n"
      "  b: {{type: revolute, axis: [0, 0, 1], parent: upper.end, child: lower}}\n"
      "initial: {{hinges: {{a: {{position: [0.3], rate: [1]}}, b: {{position: [0.8], rate: [-2]}}}}}}\n",
      first, second, inertia_1, inertia_2);
}

/// Outcome of an evaluation with the name of the body it blames.
std::string verdict(const Made& made) {
  std::vector<double> y_dot(made.equations->size());
  Work work = made.equations->make_work();
  const Evaluation e = made.equations->derivatives(0, made.scene.initial.y, y_dot, work);
  const std::string body =
      e.body >= 0 ? " " + made.model().bodies()[static_cast<std::size_t>(e.body)].name : std::string();
  switch (e.outcome) {
    case Evaluation::Outcome::ok:
      return "ok";
    case Evaluation::Outcome::singular:
      return "singular" + body;
    case Evaluation::Outcome::nonfinite:
      return "nonfinite" + body;
  }
  return "?";
}

std::string refusal(const std::string& text) {
  try {
    const Made made(text);
    return verdict(made);
  } catch (const std::exception& e) {
    return e.what();
  }
}

/// Accelerations of the two pendulums in 330 digits, from the textbook's 2 × 2 equations.
std::vector<double> exact_pendulums(double m1, double m2, double I1, double I2) {
  const Exact a = 0.3, b = 0.8, u = 1, w = -2, g = 9.81, l = 0.7, c2 = 0.25, cx = 0.3, cy = 0.1;
  const Exact ab = a + b, rate = u + w;
  // Second body: its centre is at l e(a) + c2 e(a + b).
  const Exact c = l * c2 * cos(b), s = l * c2 * sin(b);
  ExactMatrix M(2, 2);
  ExactVector f(2);
  M(1, 1) = Exact(I2) + m2 * c2 * c2;
  M(0, 1) = M(1, 0) = M(1, 1) + m2 * c;
  M(0, 0) = Exact(I1) + m1 * (cx * cx + cy * cy) + m2 * l * l + 2 * m2 * c + M(1, 1);
  const Exact weight_2 = -m2 * g * c2 * cos(ab);
  f[0] = -m1 * g * (cx * cos(a) - cy * sin(a)) - m2 * g * l * cos(a) + weight_2 + m2 * s * (rate * rate - u * u);
  f[1] = weight_2 - m2 * s * u * u;
  const ExactVector x = M.partialPivLu().solve(f);
  return {static_cast<double>(x[0]), static_cast<double>(x[1])};
}

}  // namespace

void zeros(Campaign& campaign) {
  double worst = 0;
  std::string verdicts;
  for (const double ratio : {1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9}) {
    const Made made(pendulums(1, ratio, 0.02, 0.02 * ratio));
    const auto exact = exact_pendulums(1, ratio, 0.02, 0.02 * ratio);
    // Of each coordinate by itself: neither hides behind the other.
    const auto a = made.accelerations();
    for (std::size_t i = 0; i < 2; ++i) worst = std::max(worst, std::abs(a[i] / exact[i] - 1));
  }
  campaign.at_most("masses 1e±9 of the other's, either order", "two pendulums in 330 digits", worst, 1e-6);
  std::string first;
  const auto same = [&](const char* what, double m1, double m2, double I1, double I2, const std::string& expected) {
    std::string bad;
    for (int k = -300; k <= 300; k += 100) {
      const double f = std::ldexp(1.0, k);
      const std::string v = verdict(Made(pendulums(m1 * f, m2 * f, I1 * f, I2 * f)));
      if (v != expected) bad += fmt::format("at 2^{}: {}; ", k, v);
    }
    campaign.holds(what, "rank of M", fmt::format("'{}' for m·2ᵏ, k = −300 … 300", expected), bad);
  };
  same("second body without mass and inertia", 1, 0, 0.02, 0, "singular lower");
  same("first body without, second with", 0, 1, 0, 0.02, "ok");
  same("both without", 0, 0, 0, 0, "singular lower");
  same("masses 1e-9", 1, 1e-9, 0.02, 2e-11, "ok");
  same("masses 1e9", 1e-9, 1, 2e-11, 0.02, "ok");

  // A point mass on the hinge's axis, which is tilted so that rounding leaves something.
  const auto on_axis = [](double k) {
    return fmt::format(
        "format: withy/1\ntime: {{end: 1}}\nbodies:\n  bob: {{type: rigid, mass: {0}, center_of_mass: [{1}, {2}, "
        "{3}]}}\n"
        "hinges: {{pin: {{type: revolute, axis: [1, 2, 3], parent: world, child: bob}}}}\n",
        std::ldexp(1.0, static_cast<int>(k)), 0.37, 0.74, 1.11);
  };
  std::string bad;
  for (const double k : {-100.0, 0.0, 100.0}) {
    const Made made(on_axis(k));
    const std::string v = verdict(made);
    const std::string why = unattainable(made.model(), *made.equations, made.scene.initial, 1e-6);
    if (v != "singular bob" && why.find("'bob'") == std::string::npos) bad += fmt::format("at 2^{}: {}; ", k, v);
  }
  campaign.holds("a point on its hinge's tilted axis", "rank of M", "singular, or refused, 'bob' named", bad);
  const std::string beam =
      "format: withy/1\ntime: {end: 1}\nbodies: {boom: {type: beam, length: L, mass_per_length: M, "
      "bending_y: {stiffness: 1, modes: 2}}}\nhinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: "
      "boom}}\n";
  const auto with = [&](const std::string& length, const std::string& mass) {
    std::string text = beam;
    text.replace(text.find("length: L"), 9, "length: " + length);
    text.replace(text.find("length: M"), 9, "length: " + mass);
    return refusal(text);
  };
  const auto said = [&](const char* what, const std::string& answer, const std::string& expected) {
    campaign.row(what, "the value's range", "refused or singular, the body named", answer.substr(0, 90),
                 answer.find(expected) != std::string::npos);
  };
  said("a beam of no length", with("0", "1"), "/bodies/boom/length");
  said("a beam of no mass", with("1", "0"), "boom");
  const std::string small = with("1e-9", "1e-9"), large = with("1e9", "1e9");
  campaign.row("a beam of 1e-9 m and 1e-9 kg/m; of 1e9 and 1e9", "rank of M", "ok", small + "; " + large,
               small == "ok" && large == "ok");
}

}  // namespace withy::extremes
