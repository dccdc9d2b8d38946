// What a body says is checked before anything is computed with it.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/compiled_model.hpp"
#include "withy/core/model/validate.hpp"

namespace {

using withy::ModalShape;
using withy::PointExpansion;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A point with every field filled with something unlike its neighbours.
PointExpansion point(Eigen::Index modes) {
  PointExpansion p = PointExpansion::rigid({1, 2, 3}, modes);
  for (Eigen::Index i = 0; i < modes; ++i) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      p.phi(c, i) = 0.1 * static_cast<double>(1 + i + c);
      p.psi(c, i) = 0.2 * static_cast<double>(1 + i - c);
      for (Eigen::Index j = 0; j < modes; ++j) {
        p.gamma[static_cast<std::size_t>(c)](i, j) = static_cast<double>(i + j - c);
        p.theta[static_cast<std::size_t>(c)](i, j) = static_cast<double>(i * j + c);
      }
    }
  }
  return p;
}

ModalShape good() {
  ModalShape s;
  s.mode_names = {"bending_y[1]", "bending_y[2]"};
  s.particles = {{1.5, point(2)}, {0.0, point(2)}};
  s.sections = {{withy::Vector3(0.1, 0, 0).asDiagonal(), point(2)}};
  s.stiffness = Eigen::Vector2d(10, 400).asDiagonal();
  s.damping = Eigen::Vector2d(0.1, 0).asDiagonal();
  s.length = 2;
  return s;
}

std::string fault_after(const std::function<void(ModalShape&)>& harm) {
  ModalShape s = good();
  harm(s);
  return find_fault(s);
}

TEST(Validate, finds_nothing_in_good_shapes_flexible_rigid_or_empty) {
  EXPECT_EQ(find_fault(good()), "");
  EXPECT_EQ(find_fault(ModalShape{}), "");
  ModalShape rigid;
  rigid.particles = {{1, PointExpansion::rigid({0, 0, 0}, 0)}};
  EXPECT_EQ(find_fault(rigid), "");
}

TEST(Validate, tolerates_the_rounding_of_a_quadrature_and_no_more) {
  // Sums of some hundred terms differ by their order of summation by about 1e-14 relative.
  EXPECT_EQ(fault_after([](ModalShape& s) { s.stiffness(0, 1) = 400 * 1e-13; }), "");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.stiffness(0, 1) = 400 * 1e-9; }),
            "the stiffness matrix is not symmetric");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping(1, 1) = -1e-13; }), "");
}

TEST(Validate, names_the_first_number_that_is_not_finite) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.stiffness(1, 0) = nan; }),
            "the stiffness matrix has nan in row 2, column 1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping(0, 1) = infinity; }),
            "the damping matrix has inf in row 1, column 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.length = nan; }), "its length is nan");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[1].mass = infinity; }), "particle 2: its mass is inf");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[1].at.X.z() = nan; }),
            "particle 2: X has nan in row 3, column 1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.phi(1, 1) = nan; }),
            "particle 1: Phi has nan in row 2, column 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].at.psi(2, 0) = -infinity; }),
            "section 1: Psi has -inf in row 3, column 1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.gamma[0](1, 1) = nan; }),
            "particle 1: Gamma_x has nan in row 2, column 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].at.theta[2](0, 0) = nan; }),
            "section 1: Theta_z has nan in row 1, column 1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].inertia(0, 0) = nan; }),
            "section 1: its inertia has nan in row 1, column 1");
}

TEST(Validate, names_sizes_that_do_not_agree_with_the_number_of_modes) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.mode_names.emplace_back("torsion[1]"); }),
            "the stiffness matrix is 2 by 2, not 3 by 3");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping.resize(0, 0); }), "the damping matrix is 0 by 0, not 2 by 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.phi = withy::Matrix3X::Zero(3, 1); }),
            "particle 1: Phi is 3 by 1, not 3 by 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.psi = {}; }), "particle 1: Psi is 3 by 0, not 3 by 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.gamma[1].resize(2, 1); }),
            "particle 1: Gamma_y is 2 by 1, not 2 by 2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].at.theta[0].resize(0, 0); }),
            "section 1: Theta_x is 0 by 0, not 2 by 2");
  EXPECT_EQ(find_fault(point(2), 3), "Phi is 3 by 2, not 3 by 3");
}

TEST(Validate, names_what_should_be_symmetric_and_is_not) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping(0, 1) = 0.01; }), "the damping matrix is not symmetric");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.gamma[2](0, 1) += 0.5; }),
            "particle 1: Gamma_z is not symmetric");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].at.theta[1](1, 0) += 0.5; }),
            "particle 1: Theta_y is not symmetric");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].inertia(0, 2) = 0.05; }),
            "section 1: its inertia is not symmetric");
}

TEST(Validate, names_what_nature_does_not_allow) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.particles[0].mass = -1; }), "particle 1: its mass is -1");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.length = -2; }), "its length is -2");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.damping(1, 1) = -0.5; }),
            "the damping matrix is not positive semidefinite");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.sections[0].inertia(1, 1) = -0.25; }),
            "section 1: its inertia is not positive semidefinite");
}

TEST(Validate, names_modes_that_cannot_be_told_apart) {
  EXPECT_EQ(fault_after([](ModalShape& s) { s.mode_names[1] = s.mode_names[0]; }),
            "two modes are named 'bending_y[1]'");
  EXPECT_EQ(fault_after([](ModalShape& s) { s.mode_names[0].clear(); }), "a mode has no name");
}

TEST(Validate, names_modes_that_no_table_can_hold) {
  const auto named = [](const std::string& first, const std::string& second) {
    return fault_after([&](ModalShape& s) { s.mode_names = {first, second}; });
  };
  const std::string rule = " has a name with a comma, a quotation mark, a slash or a control character";
  EXPECT_EQ(named("a,b", "c"), "mode 1" + rule);
  EXPECT_EQ(named("a", "b\nc"), "mode 2" + rule);
  EXPECT_EQ(named("a[1]", "a.1"), "two modes are named 'a.1'") << "tables spell them alike";
  EXPECT_EQ(named("m", "m.rate"), "a mode is named 'm.rate', as the rate of another");
  EXPECT_EQ(named("größe x", "1.bending"), "");
}

TEST(Validate, names_numbers_of_sensors_that_no_table_can_hold) {
  using Columns = std::vector<withy::SensorColumn>;
  const std::string name = " has a name with a comma, a quotation mark, a slash or a control character";
  const std::string unit = " has a unit with a comma, a quotation mark, a bracket or a control character";
  EXPECT_EQ(find_fault(Columns{}), "there is none");
  EXPECT_EQ(find_fault(Columns{{"x", "m"}, {"x", "m"}}), "two are named 'x'");
  EXPECT_EQ(find_fault(Columns{{"", "m"}, {"", "s"}}), "two have no name");
  EXPECT_EQ(find_fault(Columns{{"x", "m"}, {"a,b", "m"}}), "number 2" + name);
  EXPECT_EQ(find_fault(Columns{{"a\nb", "m"}}), "number 1" + name);
  EXPECT_EQ(find_fault(Columns{{"x", "m,s"}}), "number 1" + unit);
  EXPECT_EQ(find_fault(Columns{{"x", "m]"}}), "number 1" + unit);
  EXPECT_EQ(find_fault(Columns{{"", "m"}, {"position.0", "kg m/s^2"}, {"größe", ""}}), "");
}

TEST(Validate, names_names_that_are_not_utf8) {
  const auto mode = [](const std::string& name) { return fault_after([&](ModalShape& s) { s.mode_names[1] = name; }); };
  const std::string rule = "mode 2 has a name that is not UTF-8";
  EXPECT_EQ(mode("\xC3\xA4\xE2\x82\xAC\xF0\x9F\x99\x82"), "") << "of two, three and four bytes";
  EXPECT_EQ(mode("a\xFF"), rule);
  EXPECT_EQ(mode("\xC3"), rule) << "cut short";
  EXPECT_EQ(mode("\xC3z"), rule);
  EXPECT_EQ(mode("\xC0\xAF"), rule) << "longer than it needs to be";
  EXPECT_EQ(mode("\xE0\x80\xAF"), rule) << "likewise";
  EXPECT_EQ(mode("\xED\xA0\x80"), rule) << "half of a pair of UTF-16";
  EXPECT_EQ(mode("\xF4\x90\x80\x80"), rule) << "beyond the last character";
  using Columns = std::vector<withy::SensorColumn>;
  EXPECT_EQ(find_fault(Columns{{"a\xFF", "m"}}), "number 1 has a name that is not UTF-8");
  EXPECT_EQ(find_fault(Columns{{"a", "\xFF"}}), "number 1 has a unit that is not UTF-8");
}

TEST(Validate, names_what_is_wrong_with_a_cut) {
  const auto fault = [](const std::function<void(withy::BodyCut&)>& harm) {
    withy::BodyCut cut;
    cut.at = point(2);
    cut.particles = {{1.5, point(2)}};
    cut.curvature = withy::Matrix3X::Ones(3, 2);
    harm(cut);
    return find_fault(cut, 2);
  };
  EXPECT_EQ(fault([](withy::BodyCut&) {}), "");
  EXPECT_EQ(fault([](withy::BodyCut& c) { c.at = point(1); }), "Phi is 3 by 1, not 3 by 2");
  EXPECT_EQ(fault([](withy::BodyCut& c) { c.curvature = withy::Matrix3X::Ones(3, 4); }),
            "its curvature is 3 by 4, not 3 by 2");
  EXPECT_EQ(fault([](withy::BodyCut& c) { c.stiffness(0, 1) = 2; }), "its stiffness is not symmetric");
  EXPECT_EQ(fault([](withy::BodyCut& c) { c.particles[0].mass = nan; }), "particle 1: its mass is nan");
  EXPECT_EQ(fault([](withy::BodyCut& c) {
              c.sections = {{withy::Matrix3::Identity(), point(3)}};
            }),
            "section 1: Phi is 3 by 3, not 3 by 2");
}

/// A point at its tip that one mode of a name moves.
class Named final : public withy::Body {
 public:
  explicit Named(std::string mode) {
    shape_.mode_names = {std::move(mode)};
    shape_.particles = {{1, tip()}};
    shape_.stiffness = Eigen::MatrixXd::Ones(1, 1);
    shape_.damping = Eigen::MatrixXd::Zero(1, 1);
  }
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName&) const override { return tip(); }
  std::string stations() const override { return "root, tip"; }
  static PointExpansion tip() {
    PointExpansion at = PointExpansion::rigid({1, 0, 0}, 1);
    at.phi(1, 0) = 1;
    return at;
  }

 private:
  ModalShape shape_;
};

/// Turns about z; its columns are NAME and NAME.rate.
class Turning final : public withy::Hinge {
 public:
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = 0; }
  void motion(std::span<const double>, std::span<const double>, withy::HingeMotion&) const noexcept override {}
  void derivatives(std::span<const double>, std::span<const double>, std::span<double>) const noexcept override {}
  void normalize(std::span<double>) const noexcept override {}
  std::optional<withy::HingeKernel> kernel() const override {
    return withy::HingeKernel{withy::HingeKernel::Kind::revolute, withy::Vector3::UnitZ()};
  }
};

TEST(Validate, names_modes_with_the_name_of_another_column) {
  const auto fault = [](const std::string& mode, const std::string& hinge) {
    withy::BodyNode body{"bar", std::make_shared<Named>(mode), {}};
    body.frames = {{"root", Named::tip(), {}}, {"tip", Named::tip(), {}}};
    withy::HingeNode joint;
    joint.name = hinge;
    joint.hinge = std::make_shared<Turning>();
    return withy::mode_name_fault(withy::Model({body}, {joint}, withy::Vector3::Zero()), 0);
  };
  EXPECT_EQ(fault("bending", "bar"), "");
  EXPECT_EQ(fault("tip", "bar"), "");
  EXPECT_EQ(fault("tip.x", "h"),
            "a mode is named 'tip.x', and tables of results have the column 'bar.tip.x' of the body's tip");
  EXPECT_EQ(fault("tip[deflection_y]", "h"),
            "a mode is named 'tip[deflection_y]', and tables of results have the column 'bar.tip.deflection_y' of the "
            "body's tip");
  EXPECT_EQ(fault("rate", "h"), "");
  EXPECT_EQ(fault("rate", "bar"),
            "a mode is named 'rate', and tables of results have the column 'bar.rate' of the hinge 'bar'");
}

/// Compiles nothing, or throws.
class NoFormulation final : public withy::Formulation {
 public:
  explicit NoFormulation(bool throws) : throws_(throws) {}
  withy::Terms terms() const override { return {}; }
  std::unique_ptr<withy::EquationsOfMotion> compile(std::shared_ptr<const withy::Model>) const override {
    if (throws_) throw std::runtime_error("out of order");
    return nullptr;
  }

 private:
  bool throws_;
};

TEST(Validate, a_formulation_that_gives_no_equations_is_refused_and_what_it_throws_is_told) {
  const auto said = [](bool throws) -> std::string {
    try {
      withy::compile_model(NoFormulation(throws), nullptr);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_EQ(said(false), "it compiles no equations and does not say why");
  EXPECT_EQ(said(true), "it cannot compile the model: out of order");
}

}  // namespace
