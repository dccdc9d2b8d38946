/// \file
/// Modes of beams as they vary: against those of the uniform beam, against the integral equation of vibration, and
/// against Castigliano's deflections.
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "family_fixture.hpp"

namespace withy::test {
namespace {

/// ∫ f dx between two kinks and on, by panels of 20 Gauss nodes that halve towards the tip, where stiffness is least.
template <class F>
double integral_over(double from, double to, const std::vector<double>& kinks, F&& f) {
  double sum = 0;
  std::vector<double> ends = kinks;
  ends.push_back(to);
  for (const double end : ends) {
    if (end <= from || end > to) continue;
    double a = from;
    for (int part = 0; part < 8; ++part) {
      const double b = part == 7 ? end : 0.5 * (a + end);
      sum += boost::math::quadrature::gauss<double, 20>::integrate(f, a, b);
      a = b;
    }
    from = end;
  }
  return sum;
}

/// A blade: mass and stiffness by a table, steep where the root ends and towards the tip.
struct TabledBlade {
  static constexpr double length = 40;
  std::vector<double> x{0, 2, 3, 11, 20, 31, 38, 40}, mass{800, 700, 420, 330, 250, 140, 60, 12},
      stiffness{9e9, 8e9, 3e9, 1.1e9, 4e8, 9e7, 1.2e7, 4e5};

  static double at(const std::vector<double>& x, const std::vector<double>& y, double where) {
    std::size_t i = 1;
    while (i + 1 < x.size() && where > x[i]) ++i;
    return y[i - 1] + (y[i] - y[i - 1]) * (where - x[i - 1]) / (x[i] - x[i - 1]);
  }
  [[nodiscard]] BeamData::Section section(double where) const { return {at(x, mass, where), at(x, stiffness, where)}; }
  [[nodiscard]] BeamData data(BeamData::Strain strain = BeamData::Strain::bending) const {
    BeamData beam{strain, length, 300, 2e9};
    beam.section = [*this](double where) { return section(where); };
    beam.kinks = x;
    return beam;
  }
};

struct CarriedBody {
  double mass, inertia, offset;
  [[nodiscard]] std::vector<Value::Member> options(int shapes) const {
    return {{"tip_mass", Value(mass)},
            {"tip_inertia", Value(inertia)},
            {"tip_offset", Value(offset)},
            {"static", Value(static_cast<double>(shapes))}};
  }
};

TEST(VibrationModes, conform) {
  for (const int shapes : {0, 1, 2}) {
    const auto f = family("vibration-modes", {{"static", Value(static_cast<double>(shapes))}});
    expect_family_conforms(*f, bending_beam(1.7));
    expect_family_conforms(*f, torsion_rod(1.7));
  }
}

/// Rounding leaves 1e-16 (β_n/β_1)⁴ ≈ 1e-8 of 1/ω² of the sixtieth mode beside that of the first.
TEST(VibrationModes, of_an_even_beam_are_those_of_its_closed_forms) {
  const CarriedBody tip{1.3, 0.2, 0.15};
  const std::vector<Value::Member> load{
      {"tip_mass", Value(1.3)}, {"tip_inertia", Value(0.2)}, {"tip_offset", Value(0.15)}};
  for (const BeamData& beam : {bending_beam(), torsion_rod()}) {
    const bool bends = beam.strain == BeamData::Strain::bending;
    const auto free = family("vibration-modes", {{"static", Value(0.0)}})->functions(beam, 60),
               free_waves = family("clamped-free")->functions(beam, 60),
               loaded = family("vibration-modes", tip.options(0))->functions(beam, 60),
               loaded_waves = family("clamped-loaded", load)->functions(beam, 60);
    for (const auto& [ours, textbook] :
         {std::pair(free.get(), free_waves.get()), std::pair(loaded.get(), loaded_waves.get())}) {
      EXPECT_NEAR(ours->wave_number(), textbook->wave_number(), 1e-9 * textbook->wave_number());
      const Eigen::MatrixXd sizes = gram(*textbook, 1.0);
      for (const double x : {0.0, 0.1, 0.43, 0.8, 1.0}) {
        const FunctionValues a(*ours, x), b(*textbook, x);
        for (std::size_t i = 0; i < 60; ++i) {
          const auto c = static_cast<Eigen::Index>(i);
          const double wave = (static_cast<double>(i) + 1) * 3.14, size = std::sqrt((bends ? 1 : 0.5) / sizes(c, c));
          EXPECT_NEAR(a.phi[i], size * b.phi[i], 1e-8) << i;
          EXPECT_NEAR(a.slope[i], size * b.slope[i], 1e-8 * wave) << i;
          EXPECT_NEAR(a.curvature[i], size * b.curvature[i], 1e-8 * wave * wave) << i;
        }
      }
    }
  }
}

/// EI φ″ at x is the moment of what is beyond: ω² (∫ₓᴸ μ φ (s − x) ds + m (φ + aφ′)(L + a − x) + J φ′), with ω² from
/// the same equation at the root. Ten iterations leave rounding.
TEST(VibrationModes, of_a_beam_that_varies_satisfy_the_equation_of_vibration) {
  const TabledBlade blade;
  for (const CarriedBody& tip : {CarriedBody{0, 0, 0}, CarriedBody{900, 400, 0.5}}) {
    const auto f = family("vibration-modes", tip.options(0))->functions(blade.data(), 4);
    for (std::size_t i = 0; i < 4; ++i) {
      const FunctionValues end(*f, TabledBlade::length);
      const auto moment = [&](double x) {
        const double beam = integral_over(x, TabledBlade::length, blade.x, [&](double s) {
          return blade.section(s).inertia * FunctionValues(*f, s).phi[i] * (s - x);
        });
        return beam + tip.mass * (end.phi[i] + tip.offset * end.slope[i]) * (TabledBlade::length + tip.offset - x) +
               tip.inertia * end.slope[i];
      };
      const auto strain_moment = [&](double x) {
        return blade.section(x).stiffness * FunctionValues(*f, x).curvature[i];
      };
      const double root = strain_moment(0), squared = root / moment(0);
      EXPECT_GT(squared, 0);
      for (const double x : {1.0, 2.5, 9.0, 17.0, 26.0, 35.0, 39.0})
        EXPECT_NEAR(strain_moment(x), squared * moment(x), 1e-10 * std::abs(root)) << "mode " << i + 1 << " at " << x;
    }
  }
}

/// Two functions are one mode and what it leaves of the tip's static deflection: Ritz's answer to a force at the tip is
/// then the exact one, F ∫ (L − x)²/EI dx, and with two static shapes that to a moment too.
TEST(VibrationModes, with_static_shapes_know_how_the_tip_gives_way) {
  const TabledBlade blade;
  const double L = TabledBlade::length;
  const auto over_stiffness = [&](auto&& f) {
    return integral_over(0, L, blade.x, [&](double x) { return f(x) / blade.section(x).stiffness; });
  };
  for (const int shapes : {1, 2}) {
    const auto count = static_cast<std::size_t>(shapes) + 1;
    const auto f = family("vibration-modes", CarriedBody{500, 100, 0}.options(shapes))->functions(blade.data(), count);
    const auto n = static_cast<Eigen::Index>(count);
    Eigen::MatrixXd K(n, n), M(n, n);
    const FunctionValues tip(*f, L);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        K(i, j) = integral_over(0, L, blade.x, [&](double x) {
          const FunctionValues v(*f, x);
          return blade.section(x).stiffness * v.curvature[a] * v.curvature[b];
        });
        M(i, j) = integral_over(0, L, blade.x, [&](double x) {
          const FunctionValues v(*f, x);
          return blade.section(x).inertia * v.phi[a] * v.phi[b];
        });
        M(i, j) += 500 * tip.phi[a] * tip.phi[b] + 100 * tip.slope[a] * tip.slope[b];
      }
    }
    // Orthogonal in mass and stiffness, static shapes too.
    const Eigen::VectorXd k = K.diagonal().cwiseSqrt(), m = M.diagonal().cwiseSqrt();
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);
    EXPECT_LT((k.cwiseInverse().asDiagonal() * K * k.cwiseInverse().asDiagonal() - I).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((m.cwiseInverse().asDiagonal() * M * m.cwiseInverse().asDiagonal() - I).cwiseAbs().maxCoeff(), 1e-9);
    const Eigen::Map<const Eigen::VectorXd> phi(tip.phi.data(), n), slope(tip.slope.data(), n);
    const Eigen::LDLT<Eigen::MatrixXd> solver(K);
    const double by_force = over_stiffness([&](double x) { return (L - x) * (L - x); });
    EXPECT_NEAR(phi.dot(solver.solve(phi)), by_force, 1e-9 * by_force);
    const double by_moment = over_stiffness([](double) { return 1.0; });
    const double turned = slope.dot(solver.solve(slope));
    if (shapes == 2) {
      EXPECT_NEAR(turned, by_moment, 1e-9 * by_moment);
    } else {
      EXPECT_LT(turned, 0.9 * by_moment) << "a moment's shape is not among them";
    }
  }
}

/// Twist by GJ(x), the same equation one integral lower.
TEST(VibrationModes, of_a_rod_that_varies_satisfy_the_equation_of_torsion) {
  const TabledBlade blade;
  const CarriedBody tip{0, 300, 0};
  const auto f = family("vibration-modes", tip.options(0))->functions(blade.data(BeamData::Strain::torsion), 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double end = FunctionValues(*f, TabledBlade::length).phi[i];
    const auto torque = [&](double x) {
      return tip.inertia * end + integral_over(x, TabledBlade::length, blade.x, [&](double s) {
               return blade.section(s).inertia * FunctionValues(*f, s).phi[i];
             });
    };
    const auto strained = [&](double x) { return blade.section(x).stiffness * FunctionValues(*f, x).slope[i]; };
    const double root = strained(0), squared = root / torque(0);
    for (const double x : {1.0, 2.5, 9.0, 17.0, 26.0, 35.0, 39.0})
      EXPECT_NEAR(strained(x), squared * torque(x), 1e-10 * std::abs(root)) << "mode " << i + 1 << " at " << x;
  }
}

/// Beyond a million times the beam's own inertia a load counts as that: its shapes are the same to 1e-6 and no less.
TEST(VibrationModes, carry_loads_of_any_size) {
  const auto heavy = family("vibration-modes", CarriedBody{1e12, 1e9, 0.1}.options(1))->functions(bending_beam(), 6),
             less = family("vibration-modes", CarriedBody{1e5, 1e2, 0.1}.options(1))->functions(bending_beam(), 6);
  for (const double x : {0.2, 0.5, 0.9, 1.0}) {
    const FunctionValues a(*heavy, x), b(*less, x);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(a.phi[i], b.phi[i], 1e-3) << i << " at " << x;
  }
}

}  // namespace
}  // namespace withy::test
