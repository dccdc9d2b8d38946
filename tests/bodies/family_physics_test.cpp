/// \file
/// A beam's frequencies do not depend on the functions they are found with.
#include <cmath>

#include "family_fixture.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/conformance/body_suite.hpp"

namespace withy::test {
namespace {

constexpr double span = 1.3, mass_per_length = 0.7, stiffness = 40;

Value choice(const std::string& id, std::vector<Value::Member> options = {}) {
  if (options.empty()) return Value(id);
  options.emplace_back("name", Value(id));
  return Value::map(std::move(options));
}

class Families : public testing::Test {
 protected:
  Families() { enroll_static_plugins(registry_); }

  std::unique_ptr<Body> beam(const Value& family, double modes, Diagnostics* diagnostics = nullptr) {
    const Value strain = Value::map({{"stiffness", Value(stiffness)}, {"modes", Value(modes)}, {"family", family}});
    const std::vector<Value::Member> p = {
        {"length", Value(span)}, {"mass_per_length", Value(mass_per_length)}, {"bending_y", strain}};
    if (diagnostics != nullptr) return make_plugin<Body>(registry_, "beam", p, *diagnostics);
    return make_plugin<Body>(registry_, "beam", p);
  }

  /// Squared frequencies of the beam with its root section held, over EI/(ρA L⁴), and a body of these properties (in
  /// units of the beam's ρAL, ρAL³ and L) at its tip. Where the family moves the root, displacements are relative to
  /// it.
  Eigen::VectorXd cantilever(const Value& family, double modes, double tip_mass = 0, double tip_inertia = 0,
                             double tip_offset = 0) {
    const auto body = beam(family, modes);
    if (body == nullptr) return Eigen::VectorXd::Zero(3);
    const PointExpansion root = *body->station(std::string("root"));
    const auto deflection = [&](const PointExpansion& e) {
      return Eigen::RowVectorXd(e.phi.row(1) - root.phi.row(1) - root.psi.row(2) * e.X.x());
    };
    const auto n = static_cast<Eigen::Index>(modes);
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
    for (const Particle& p : body->shape().particles) M += p.mass * deflection(p.at).transpose() * deflection(p.at);
    const PointExpansion tip = *body->station(std::string("tip"));
    const double m = mass_per_length * span;
    const Eigen::RowVectorXd slope = tip.psi.row(2) - root.psi.row(2);
    const Eigen::RowVectorXd center = deflection(tip) + tip_offset * span * slope;
    M += tip_mass * m * center.transpose() * center;
    M += tip_inertia * m * span * span * slope.transpose() * slope;
    // The greatest 1/ω²: the lowest frequencies without loss to the highest.
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(M, body->shape().stiffness);
    return eigen.eigenvalues().reverse().cwiseInverse() * mass_per_length * std::pow(span, 4) / stiffness;
  }

  /// Squared frequencies, over EI/(ρA L⁴), of the beam alone in a tree, at rest: M from the equations of motion, so
  /// with all that the compilation does to a root that moves.
  Eigen::VectorXd in_tree(const std::string& hinge, const std::string& family, int modes,
                          const std::string& formulation) {
    const std::string text =
        "format: withy/1\ntime: {end: 1}\nbodies:\n  b: {type: beam, length: " + std::to_string(span) +
        ", mass_per_length: " + std::to_string(mass_per_length) +
        ", bending_y: {stiffness: " + std::to_string(stiffness) + ", modes: " + std::to_string(modes) +
        ", family: " + family + "}}\nhinges:\n  h: {parent: world, child: b, " + hinge + "}\n";
    const Scene scene = parse_scene(text, "beam", registry_, {formulation, "", {}});
    const auto equations = scene.formulation->compile(scene.model);
    const DenseSystem s = equations->system(0, scene.initial.y);
    const auto n = static_cast<Eigen::Index>(s.size);
    const Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(s.mass.data(), n, n);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
    const auto first = static_cast<Eigen::Index>(scene.model->layout().body("b")->speed);
    K.block(first, first, modes, modes) = scene.model->bodies()[0].body->shape().stiffness;
    Eigen::MatrixXd used = M, of = K;
    if (n > modes + 1) {
      // A free hinge in the plane: the rotation about and the translations out of the beam's plane have their own
      // inertia.
      std::vector<Eigen::Index> keep = {2, 4};
      for (Eigen::Index i = 0; i < modes; ++i) keep.push_back(first + i);
      used = M(keep, keep);
      of = K(keep, keep);
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(of, used);
    return eigen.eigenvalues() * mass_per_length * std::pow(span, 4) / stiffness;
  }

  Registry registry_;
};

double fourth(double beta) { return std::pow(beta, 4); }

/// βL of the cantilever (Blevins 1979): every complete clamped family comes within 1e-4 of the frequency (2e-4 of its
/// square), from above.
TEST_F(Families, complete_and_clamped_find_the_cantilever_s_frequencies) {
  struct Complete {
    Value family;
    double modes;
  };
  const Complete families[] = {{choice("clamped-free"), 3},
                               {choice("orthogonal-polynomials"), 8},
                               {choice("craig-bampton"), 10},
                               {choice("clamped-loaded", {{"tip_mass", Value(0.3)}, {"tip_offset", Value(0.0)}}), 16}};
  for (const Complete& f : families) {
    const Eigen::VectorXd w2 = cantilever(f.family, f.modes);
    Eigen::Index k = 0;
    for (const double beta : {1.87510407, 4.69409113, 7.85475744}) {
      EXPECT_NEAR(w2[k] / fourth(beta), 1, 2e-4) << k;
      EXPECT_GT(w2[k] / fourth(beta), 1 - 1e-7) << k;
      ++k;
    }
  }
}

/// With a heavy body at the tip one loaded mode is exact: β₁ from its own characteristic equation. Clamped-free
/// functions carry neither moment nor shear at the tip: their error, 14 % of ω² with one, falls as 1/n only, from
/// above, and its extrapolation is the same frequency. Static modes and polynomials need few.
TEST_F(Families, one_loaded_mode_is_worth_many_free_ones) {
  const double mass = 5, inertia = 0.8, offset = 0.2;
  const double m = mass_per_length * span;
  const Value loaded = choice("clamped-loaded", {{"tip_mass", Value(mass * m)},
                                                 {"tip_inertia", Value(inertia * m * span * span)},
                                                 {"tip_offset", Value(offset * span)}});
  // 1 + cosh β cos β − p (cosh β sin β − sinh β cos β) − 2q sinh β sin β − r (sinh β cos β + cosh β sin β)
  // + (pr − q²)(1 − cosh β cos β) = 0, by bisection between 0 and the bare beam's root.
  const auto characteristic = [&](double b) {
    const double p = mass * b, q = mass * offset * b * b, r = (inertia + mass * offset * offset) * b * b * b;
    const double ch = std::cosh(b), sh = std::sinh(b), c = std::cos(b), s = std::sin(b);
    return 1 + ch * c - p * (ch * s - sh * c) - 2 * q * sh * s - r * (sh * c + ch * s) + (p * r - q * q) * (1 - ch * c);
  };
  double low = 0.1, high = 0.9;
  ASSERT_GT(characteristic(low), 0);
  ASSERT_LT(characteristic(high), 0);
  for (int i = 0; i < 60; ++i) (characteristic(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
  const double exact = fourth(low);
  EXPECT_NEAR(cantilever(loaded, 1, mass, inertia, offset)[0] / exact, 1, 1e-11);
  const auto error = [&](const char* id, double modes) {
    return cantilever(choice(id), modes, mass, inertia, offset)[0] / exact - 1;
  };
  EXPECT_GT(error("clamped-free", 1), 0.1);
  EXPECT_GT(error("clamped-free", 5), 1e-2);
  EXPECT_GT(error("clamped-free", 40), 1e-3);
  EXPECT_NEAR(2 * error("clamped-free", 40) - error("clamped-free", 20), 0, 1e-4);
  EXPECT_NEAR(error("craig-bampton", 3), 0, 1e-6);
  EXPECT_NEAR(error("orthogonal-polynomials", 4), 0, 1e-6);
}

/// Held at the root, families that are free or pinned there carry no moment where it is greatest: their error falls as
/// 1/n, from above, and its extrapolation is the cantilever's frequency.
TEST_F(Families, whose_root_moves_find_the_cantilever_s_frequencies_in_the_limit) {
  for (const char* id : {"pinned-free", "free-free"}) {
    const double a = cantilever(choice(id), 15)[0], b = cantilever(choice(id), 30)[0];
    const double c = cantilever(choice(id), 60)[0];
    const double exact = fourth(1.87510407);
    EXPECT_GT(a, b);
    EXPECT_GT(b, c);
    EXPECT_GT(c, exact);
    EXPECT_NEAR((a - b) / (b - c), 2, 0.1) << id;
    EXPECT_NEAR((2 * c - b) / exact, 1, 2e-4) << id;
  }
}

/// On its hinge, which moves the root section, a beam in its own functions is exact with one mode; other families get
/// there with more. Every formulation has the same M at rest.
TEST_F(Families, on_a_revolute_hinge_find_the_pinned_free_frequencies) {
  const std::string hinge = "type: revolute, axis: [0, 0, 1]";
  for (const char* formulation : {"quadratic", "linear", "ruthless", "consistent", "inconsistent"}) {
    const Eigen::VectorXd own = in_tree(hinge, "pinned-free", 1, formulation);
    EXPECT_NEAR(own[0], 0, 1e-9 * own[1]) << formulation;
    EXPECT_NEAR(own[1] / fourth(3.926602312), 1, 1e-8) << formulation;
    EXPECT_NEAR(in_tree(hinge, "clamped-free", 6, formulation)[1] / fourth(3.926602312), 1, 1e-4);
    EXPECT_NEAR(in_tree(hinge, "orthogonal-polynomials", 6, formulation)[1] / fourth(3.926602312), 1, 1e-4);
    EXPECT_NEAR(in_tree(hinge, "craig-bampton", 8, formulation)[1] / fourth(3.926602312), 1, 1e-4);
    EXPECT_NEAR(in_tree(hinge, "free-free", 18, formulation)[1] / fourth(3.926602312), 1, 1e-4);
  }
}

TEST_F(Families, on_a_free_hinge_find_the_free_free_frequencies) {
  for (const char* formulation : {"quadratic", "linear", "ruthless", "consistent", "inconsistent"}) {
    const Eigen::VectorXd own = in_tree("type: free", "free-free", 2, formulation);
    EXPECT_NEAR(own[2] / fourth(4.730040745), 1, 1e-8) << formulation;
    EXPECT_NEAR(own[3] / fourth(7.853204624), 1, 1e-8) << formulation;
    EXPECT_NEAR(in_tree("type: free", "clamped-free", 8, formulation)[2] / fourth(4.730040745), 1, 1e-4);
    EXPECT_NEAR(in_tree("type: free", "orthogonal-polynomials", 6, formulation)[2] / fourth(4.730040745), 1, 1e-4);
    EXPECT_NEAR(in_tree("type: free", "pinned-free", 8, formulation)[2] / fourth(4.730040745), 1, 1e-4);
  }
}

TEST_F(Families, of_every_kind_make_conforming_beams) {
  for (const char* id : {"clamped-free", "clamped-clamped", "clamped-pinned", "pinned-pinned", "pinned-free",
                         "free-free", "craig-bampton", "orthogonal-polynomials"}) {
    const auto body = beam(choice(id), 4);
    ASSERT_NE(body, nullptr) << id;
    expect_body_conforms(*body);
    // Only families that say so have a root that moves.
    const PointExpansion root = *body->station(std::string("root"));
    const bool pinned = std::string(id).starts_with("pinned"), free = std::string(id).starts_with("free");
    EXPECT_EQ(root.phi.isZero(0), !free) << id;
    EXPECT_EQ(root.psi.isZero(0), !free && !pinned) << id;
  }
}

TEST_F(Families, say_how_many_functions_they_have) {
  Diagnostics diagnostics;
  EXPECT_EQ(beam(choice("orthogonal-polynomials"), 101, &diagnostics), nullptr);
  ASSERT_EQ(diagnostics.errors().size(), 1U);
  EXPECT_EQ(diagnostics.errors()[0].message, "got 101 modes; mode family 'orthogonal-polynomials' gives at most 100");
}

}  // namespace
}  // namespace withy::test
