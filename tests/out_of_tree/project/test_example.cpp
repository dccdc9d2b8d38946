// The plugins of this project and those of the installed package, loaded side by side.
#include <gtest/gtest.h>

#include <cmath>
#include <withy/core/model/validate.hpp>
#include <withy/core/plugin/body.hpp>
#include <withy/core/plugin/mode_family.hpp>
#include <withy/core/plugin/registry.hpp>
#include <withy/core/simulation/elastic_modes.hpp>
#include <withy/plugins/host/plugin_host.hpp>

namespace {

using withy::PointExpansion;
using withy::Value;
using withy::Vector3;

class Example : public testing::Test {
 protected:
  Example() { host_.attach(registry_); }

  std::unique_ptr<withy::Body> body(const std::string& type, std::vector<Value::Member> parameters) {
    withy::Diagnostics diagnostics;
    auto made = registry_.find<withy::Body>(type)->make(Value::map(std::move(parameters)), {registry_, diagnostics});
    if (made == nullptr) throw std::runtime_error(diagnostics.errors().front().message);
    EXPECT_EQ(find_fault(made->shape()), "");
    return made;
  }
  std::unique_ptr<withy::Body> tapered(double taper, double modes, const std::string& family) {
    return body("tapered-beam", {{"length", Value(2.0)},
                                 {"mass_per_length", Value(1.5)},
                                 {"stiffness", Value(40.0)},
                                 {"taper", Value(taper)},
                                 {"modes", Value(modes)},
                                 {"family", Value(family)},
                                 {"damping_ratio", Value(0.01)}});
  }
  std::unique_ptr<withy::ShapeFunctions> polynomials(withy::BeamData::Strain strain, double length, std::size_t count) {
    withy::Diagnostics diagnostics;
    return registry_.find<withy::ModeFamily>("polynomial-clamped")
        ->make(Value::map({}), {registry_, diagnostics})
        ->functions({strain, length, 1, 1}, count);
  }

  withy::Registry registry_;
  withy::PluginHost host_{{WITHY_PLUGINS, OWN_PLUGINS}};
};

/// Composite Simpson rule on [0, length]; 4000 intervals leave 1e-10 for the functions below.
template <class Function>
double integral(double length, const Function& f) {
  const int intervals = 4000;
  const double h = length / intervals;
  double sum = f(0.0) + f(length);
  for (int i = 1; i < intervals; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(i * h);
  return sum * h / 3;
}

TEST_F(Example, loads_from_its_own_directory_and_from_the_package_only_what_is_asked_for) {
  tapered(0.5, 2, "polynomial-clamped");
  for (const withy::PluginRecord& record : host_.plugins()) {
    const bool asked = record.id == "tapered-beam" || record.id == "rod" || record.id == "unturned" ||
                       record.id == "polynomial-clamped";
    EXPECT_EQ(record.state, asked ? withy::PluginRecord::State::loaded : withy::PluginRecord::State::available)
        << record.kind << "/" << record.id << " " << record.reason;
  }
  EXPECT_NE(registry_.find<withy::Body>("beam"), nullptr) << "the package's own";
}

TEST_F(Example, a_rod_has_the_mass_and_moments_of_a_solid_cylinder) {
  // m = 3 kg, L = 2 m, r = 0.1 m: m L/2 = 3; about the root m r²/2 = 0.015 and m (r²/4 + L²/3) = 4.0075.
  const auto rod = body("rod", {{"length", Value(2.0)}, {"mass", Value(3.0)}, {"radius", Value(0.1)}});
  double mass = 0;
  Vector3 first = Vector3::Zero();
  withy::Matrix3 inertia = withy::Matrix3::Zero();
  for (const auto& p : rod->shape().particles) {
    mass += p.mass;
    first += p.mass * p.at.X;
    inertia += p.mass * (p.at.X.squaredNorm() * withy::Matrix3::Identity() - p.at.X * p.at.X.transpose());
  }
  for (const auto& s : rod->shape().sections) inertia += s.inertia;
  EXPECT_NEAR(mass, 3, 1e-15);
  EXPECT_TRUE(first.isApprox(Vector3(3, 0, 0), 1e-15));
  EXPECT_TRUE(inertia.isApprox(withy::Matrix3(Vector3(0.015, 4.0075, 4.0075).asDiagonal()), 1e-15));
  EXPECT_EQ(rod->station("tip")->X, Vector3(2, 0, 0));
  EXPECT_EQ(rod->station(0.5)->X, Vector3(0.5, 0, 0));
  EXPECT_FALSE(rod->station(2.5).has_value());
  EXPECT_FALSE(rod->station("middle").has_value());
}

TEST_F(Example, a_beam_tapered_to_half_its_depth_has_kirchhoffs_frequencies) {
  // Exact: the deflection is d^(−1/2) times Bessel functions J₁, Y₁, I₁, K₁ of 2λ√d with d = h/h₀ (Kirchhoff 1879);
  // clamped at d = 1 and free at d = ½ they give ω L² √(m₀/EI₀) = 3.82378485, 18.31726090, 47.26482701.
  // Ten polynomials come from above, to 1e-8 of the third.
  const auto beam = tapered(0.5, 10, "polynomial-clamped");
  const Eigen::VectorXd found = withy::elastic_modes(beam->shape()).frequencies;
  const double unit = std::sqrt(40.0 / 1.5) / 4;
  const double exact[] = {3.8237848473, 18.3172609042, 47.2648270105};
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k] / unit / exact[k], 1, 1e-8) << k;
}

TEST_F(Example, a_beam_without_taper_is_the_beam_of_the_package) {
  for (const std::string family : {"clamped-free", "polynomial-clamped"}) {
    const auto own = tapered(1, 4, family);
    const auto theirs =
        body("beam",
             {{"length", Value(2.0)},
              {"mass_per_length", Value(1.5)},
              {"bending_y", Value::map({{"stiffness", Value(40.0)}, {"modes", Value(4.0)}, {"family", Value(family)}})},
              {"segments", Value(1.0)},
              {"damping_ratio", Value(0.01)}});
    const auto& a = own->shape();
    const auto& b = theirs->shape();
    // Both integrate to rounding; a few thousand terms of relative error 1e-16.
    EXPECT_TRUE(a.stiffness.isApprox(b.stiffness, 1e-12)) << family;
    // The package damps the modes of the beam, the example each of its functions: the same where these are its modes.
    EXPECT_EQ(a.damping.isApprox(b.damping, 1e-12), family == "clamped-free") << family;
    EXPECT_TRUE(withy::elastic_modes(a).mass.isApprox(withy::elastic_modes(b).mass, 1e-12)) << family;
    EXPECT_EQ(a.mode_names, b.mode_names);
    const PointExpansion p = *own->station(1.3);
    const PointExpansion q = *theirs->station(1.3);
    EXPECT_TRUE(p.X.isApprox(q.X));
    EXPECT_TRUE(p.phi.isApprox(q.phi, 1e-12)) << family;
    EXPECT_TRUE(p.psi.isApprox(q.psi, 1e-12)) << family;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_LT((p.gamma[c] - q.gamma[c]).norm(), 1e-11 * p.gamma[0].norm()) << family << c;
      EXPECT_LT((p.theta[c] - q.theta[c]).norm(), 1e-11 * p.gamma[0].norm()) << family << c;
    }
  }
}

TEST_F(Example, polynomials_are_clamped_orthonormal_and_have_the_derivatives_they_say) {
  const double length = 1.7;
  const std::size_t count = 6;
  const auto f = polynomials(withy::BeamData::Strain::bending, length, count);
  std::vector<double> p(count), dp(count), ddp(count), ahead(count), behind(count), slope(count), unused(count);
  f->evaluate(0, p, dp, ddp);
  for (const double value : p) EXPECT_EQ(value, 0);
  for (const double value : dp) EXPECT_EQ(value, 0);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double product = integral(length, [&](double x) {
        f->evaluate(x, p, dp, ddp);
        return p[i] * p[j];
      });
      EXPECT_NEAR(product, i == j ? length : 0, 1e-8) << i << j;
    }
  }
  // Central differences with step 1e-5 leave h² φ‴ ≈ 1e-10 × 1e4 and rounding 1e-16 / 1e-5.
  const double h = 1e-5;
  for (const double x : {0.2, 0.9, 1.5}) {
    f->evaluate(x, p, dp, ddp);
    f->evaluate(x + h, ahead, slope, unused);
    f->evaluate(x - h, behind, unused, unused);
    for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR((ahead[i] - behind[i]) / (2 * h), dp[i], 1e-5) << i;
    f->evaluate(x + h, unused, ahead, slope);
    f->evaluate(x - h, unused, behind, slope);
    for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR((ahead[i] - behind[i]) / (2 * h), ddp[i], 1e-5) << i;
  }
}

TEST_F(Example, polynomials_of_twist_vanish_at_the_root_and_have_amplitude_one) {
  const std::size_t count = 8;
  const auto f = polynomials(withy::BeamData::Strain::torsion, 3.0, count);
  std::vector<double> p(count), dp(count), ddp(count), greatest(count, 0);
  f->evaluate(0, p, dp, ddp);
  for (const double value : p) EXPECT_EQ(value, 0);
  for (int k = 0; k <= 3000; ++k) {
    f->evaluate(k * 0.001, p, dp, ddp);
    for (std::size_t i = 0; i < count; ++i) greatest[i] = std::max(greatest[i], std::abs(p[i]));
  }
  for (const double value : greatest) EXPECT_NEAR(value, 1, 1e-12);
}

TEST_F(Example, a_strain_kinematics_gives_the_beam_of_the_package_other_maps) {
  const auto beam = body("beam", {{"length", Value(2.0)},
                                  {"mass_per_length", Value(1.5)},
                                  {"bending_y", Value::map({{"stiffness", Value(40.0)},
                                                            {"modes", Value(2.0)},
                                                            {"family", Value(std::string("clamped-free"))}})},
                                  {"torsion", Value::map({{"stiffness", Value(20.0)},
                                                          {"inertia", Value(0.1)},
                                                          {"modes", Value(1.0)},
                                                          {"family", Value(std::string("clamped-free"))}})},
                                  {"segments", Value(1.0)},
                                  {"damping_ratio", Value(0.01)}});
  withy::Diagnostics diagnostics;
  const auto kinematics =
      registry_.find<withy::StrainKinematics>("unturned")->make(Value::map({}), {registry_, diagnostics});
  const auto expanded = beam->expanded(*kinematics);
  ASSERT_NE(expanded, nullptr);
  const PointExpansion own = *beam->station("tip"), anew = *expanded->station("tip");
  EXPECT_EQ(own.phi, anew.phi);
  EXPECT_TRUE(own.gamma[0].isApprox(anew.gamma[0], 1e-12)) << "foreshortening";
  EXPECT_GT((own.gamma[2] - anew.gamma[2]).norm(), 1e-3) << "bending and twist";
  for (const auto& theta : anew.theta) EXPECT_TRUE(theta.isZero(0));
  EXPECT_EQ(tapered(0.5, 2, "polynomial-clamped")->expanded(*kinematics), nullptr) << "it reads its own maps";
}

TEST_F(Example, says_what_is_wrong_with_a_scene) {
  try {
    tapered(0.5, 21, "polynomial-clamped");
    FAIL() << "21 modes were given";
  } catch (const std::runtime_error& e) {
    EXPECT_STREQ(e.what(), "got 21 modes; mode family 'polynomial-clamped' gives at most 20");
  }
  EXPECT_THROW(tapered(0.5, 2, "nobodys-modes"), std::runtime_error);
}

}  // namespace
