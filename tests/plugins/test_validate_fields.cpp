// What rods and families of functions say is checked before anything is computed with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/mode_family.hpp"

namespace {

using withy::ModalShape;
using withy::PointExpansion;

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

bool begins(const std::string& text, const std::string& with) { return text.starts_with(with); }

/// A rod of length 1 and 2 kg/m that bends as x² (deflection x², rotation 2x, curvature 2), or says something else.
class Bent final : public withy::Rod {
 public:
  double length_ = 1, wave_number_ = 2, mass_per_length = 2, strain = 2, rotation = 2, deflection = 1, root = 0,
         turn = 0;
  Eigen::Index modes_ = 1, columns = 1, elongations = 0;
  std::vector<double> kinks_;
  withy::Matrix3 inertia = withy::Matrix3::Zero();
  Eigen::Index modes() const override { return modes_; }
  double length() const override { return length_; }
  double wave_number() const override { return wave_number_; }
  std::vector<double> kinks() const override { return kinks_; }
  withy::RodSection section(double x) const override {
    const withy::Matrix3X none = withy::Matrix3X::Zero(3, columns);
    withy::RodSection s{none, none, none, mass_per_length, inertia};
    s.strain(2, 0) = strain;
    s.rotation(2, 0) = rotation * x + turn + (x == 0 ? root : 0);
    s.deflection(1, 0) = deflection * x * x + turn * x;
    s.elongation = withy::Matrix3X::Zero(3, elongations);
    return s;
  }
};

/// The same as particles at the four Gauss points of [0, 1].
ModalShape bent_shape() {
  ModalShape s;
  s.mode_names = {"bending"};
  s.length = 1;
  for (const double side : {-1.0, 1.0}) {
    for (const auto& [node, weight] :
         {std::pair{0.3399810435848563, 0.6521451548625461}, std::pair{0.8611363115940526, 0.3478548451374538}}) {
      const double x = (1 + side * node) / 2;
      PointExpansion at = PointExpansion::rigid({x, 0, 0}, 1);
      at.phi(1, 0) = x * x;
      at.psi(2, 0) = 2 * x;
      s.particles.push_back({weight, at});
    }
  }
  s.stiffness = Eigen::MatrixXd::Constant(1, 1, 40);
  s.damping = Eigen::MatrixXd::Zero(1, 1);
  return s;
}

TEST(ValidateFields, names_what_is_wrong_with_a_rod) {
  const auto fault = [](const std::function<void(Bent&)>& harm) {
    Bent rod;
    harm(rod);
    return find_fault(rod, bent_shape());
  };
  EXPECT_EQ(fault([](Bent&) {}), "");
  EXPECT_EQ(fault([](Bent& r) { r.elongations = 1; }), "") << "it has elongations, of zero";
  EXPECT_EQ(fault([](Bent& r) { r.kinks_ = {0.2, 0.5}; }), "");
  EXPECT_EQ(fault([](Bent& r) { r.modes_ = 2; }), "it has 2 modes, the body 1");
  EXPECT_EQ(fault([](Bent& r) { r.length_ = no_number; }), "its length is nan");
  EXPECT_EQ(fault([](Bent& r) { r.wave_number_ = -1; }), "its greatest wave number is -1");
  EXPECT_EQ(fault([](Bent& r) { r.wave_number_ = 1e12; }),
            "its greatest wave number times its length is 1e+12; need at most 10000");
  const std::string range = "; need increasing ones between 0 and 1 m";
  EXPECT_EQ(fault([](Bent& r) { r.kinks_ = {0.5, 0.2}; }), "its kinks have 0.2 m behind 0.5 m" + range);
  EXPECT_EQ(fault([](Bent& r) { r.kinks_ = {no_number}; }), "its kinks have nan m behind 0 m" + range);
  EXPECT_EQ(fault([](Bent& r) { r.kinks_ = {-1, 3}; }), "its kinks have -1 m behind 0 m" + range);
  const std::string section = "its section at x = 0 m: ";
  EXPECT_EQ(fault([](Bent& r) { r.columns = 2; }), section + "strain is 3 by 2, not 3 by 1");
  EXPECT_EQ(fault([](Bent& r) { r.elongations = 2; }), section + "elongation is 3 by 2, not 3 by 1");
  EXPECT_EQ(fault([](Bent& r) { r.mass_per_length = -2; }), section + "mass_per_length is -2");
  EXPECT_EQ(fault([](Bent& r) { r.deflection = no_number; }), section + "deflection has nan in row 2, column 1");
  EXPECT_EQ(fault([](Bent& r) { r.inertia(0, 0) = -1; }), section + "inertia_per_length is not positive semidefinite");
  EXPECT_EQ(fault([](Bent& r) { r.inertia(0, 1) = 3; }), section + "inertia_per_length is not symmetric");
}

TEST(ValidateFields, names_rods_whose_fields_are_no_integrals_or_not_those_of_their_bodies) {
  const auto fault = [](const std::function<void(Bent&)>& harm) {
    Bent rod;
    harm(rod);
    return find_fault(rod, bent_shape());
  };
  const std::string turned = fault([](Bent& r) { r.rotation = 7; });
  EXPECT_TRUE(begins(turned,
                     "the strain at x = 0.137174 m of mode 1 is (0 0 2); differences of its rotation give "
                     "(0 0 7)"))
      << turned;
  const std::string moved = fault([](Bent& r) { r.deflection = 3; });
  EXPECT_TRUE(begins(moved, "rotation x e_x with elongation at x = 0.137174 m of mode 1 is (")) << moved;
  const std::string root = fault([](Bent& r) { r.root = 0.1; });
  EXPECT_TRUE(begins(root, "the rotation at x = 0 of mode 1 is (  0   0 0.1); next to it (") ||
              begins(root, "the rotation at x = 0 of mode 1 is (0 0 0.1); next to it ("))
      << root;
  const std::string turned_whole = fault([](Bent& r) { r.turn = 0.1; });
  EXPECT_TRUE(begins(turned_whole, "the deflection at x = 0.330009 m of mode 1 is (")) << turned_whole;
  const std::string other = fault([](Bent& r) { r.strain = 4, r.rotation = 4, r.deflection = 2; });
  EXPECT_TRUE(begins(other, "the deflection at x = 0.330009 m of mode 1 is (")) << other;
  EXPECT_EQ(fault([](Bent& r) { r.length_ = 2; }), "its mass is 4 kg, that of the body's particles 2 kg");
  EXPECT_EQ(fault([](Bent& r) { r.mass_per_length = 200; }), "its mass is 200 kg, that of the body's particles 2 kg");
}

/// A rod whose curvature steps from 1 to 3 at a place.
class Kinked final : public withy::Rod {
 public:
  explicit Kinked(double at) : at_(at) {}
  double factor = 1;
  Eigen::Index modes() const override { return 1; }
  double length() const override { return 1; }
  double wave_number() const override { return 2; }
  withy::RodSection section(double x) const override {
    const double beyond = std::max(x - at_, 0.0);
    const withy::Matrix3X none = withy::Matrix3X::Zero(3, 1);
    withy::RodSection s{none, none, none, 2, withy::Matrix3::Zero()};
    s.strain(2, 0) = factor * (beyond > 0 ? 3 : 1);
    s.rotation(2, 0) = x + 2 * beyond;
    s.deflection(1, 0) = x * x / 2 + beyond * beyond;
    return s;
  }
  ModalShape shape() const {
    ModalShape s = bent_shape();
    for (withy::Particle& p : s.particles) {
      const withy::RodSection here = section(p.at.X.x());
      p.at.phi = here.deflection;
      p.at.psi = here.rotation;
    }
    return s;
  }

 private:
  double at_;
};

TEST(ValidateFields, finds_nothing_in_rods_with_a_step_of_strain_where_they_are_looked_at) {
  for (const double at : {0.4142136, 0.4142136 - 1e-12, 0.4142136 + 1e-12, 0.41421, 0.41422, 0.4, 0.1371742}) {
    Kinked rod(at);
    EXPECT_EQ(find_fault(rod, rod.shape()), "") << at;
    rod.factor = 2;
    EXPECT_NE(find_fault(rod, rod.shape()), "") << at << ": seen at the other places";
  }
}

/// sin kx and its derivatives times factors, in the place of some where it fails.
class Waves final : public withy::ShapeFunctions {
 public:
  std::size_t given = 3;
  double slope = 1, curvature = 1, wave_number_ = 3, value = 1;
  std::vector<double> kinks_;
  std::vector<double> kinks() const override { return kinks_; }
  std::size_t count() const override { return given; }
  double wave_number() const override { return wave_number_; }
  void evaluate(double x, std::span<double> phi, std::span<double> first, std::span<double> second) const override {
    for (std::size_t i = 0; i < given; ++i) {
      const double k = static_cast<double>(i + 1);
      phi[i] = value * std::sin(k * x);
      first[i] = slope * k * std::cos(k * x);
      second[i] = -curvature * k * k * std::sin(k * x);
    }
  }
};

TEST(ValidateFields, names_functions_that_are_not_as_many_or_whose_derivatives_are_none) {
  using Strain = withy::BeamData::Strain;
  const auto fault = [](const std::function<void(Waves&)>& harm, Strain strain = Strain::bending) {
    Waves waves;
    harm(waves);
    return find_fault(waves, {.strain = strain, .length = 2}, 3);
  };
  EXPECT_EQ(fault([](Waves&) {}), "");
  EXPECT_EQ(fault([](Waves& w) { w.given = 2; }), "there are 2, where 3 are asked for");
  EXPECT_EQ(fault([](Waves& w) { w.wave_number_ = no_number; }), "their greatest wave number is nan");
  EXPECT_EQ(fault([](Waves& w) { w.wave_number_ = 1e12; }),
            "their greatest wave number times the length is 2e+12; need at most 10000");
  EXPECT_EQ(fault([](Waves& w) { w.kinks_ = {0.5, 1.5}; }), "");
  const std::string range = "; need increasing ones from 0 to 2 m";
  EXPECT_EQ(fault([](Waves& w) { w.kinks_ = {1.5, 0.5}; }), "they have a kink at x = 0.5 m behind 1.5 m" + range);
  EXPECT_EQ(fault([](Waves& w) { w.kinks_ = {-1, 100}; }), "they have a kink at x = -1 m behind 0 m" + range);
  EXPECT_EQ(fault([](Waves& w) { w.kinks_ = {no_number}; }), "they have a kink at x = nan m behind 0 m" + range);
  EXPECT_EQ(fault([](Waves& w) { w.value = no_number; }), "function 1 has the value nan at x = 0.274348 m");
  const std::string slope = fault([](Waves& w) { w.slope = 1.001; });
  EXPECT_TRUE(begins(slope, "function 1 has the slope 0.963")) << slope;
  EXPECT_NE(slope.find(" at x = 0.274348 m; differences of its values give 0.962"), std::string::npos) << slope;
  const std::string curvature = fault([](Waves& w) { w.curvature = 2; });
  EXPECT_TRUE(begins(curvature, "function 1 has the curvature -0.541")) << curvature;
  EXPECT_EQ(fault([](Waves& w) { w.curvature = 2; }, Strain::torsion), "") << "twist has none";
}

/// φ = x²/2 + 1000 b³, b the way behind a place where the curvature, 1 + 6000 b, has a kink.
class KinkedCurvature final : public withy::ShapeFunctions {
 public:
  explicit KinkedCurvature(double at) : at_(at) {}
  double factor = 1;
  std::size_t count() const override { return 1; }
  double wave_number() const override { return 2; }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    const double b = std::max(x - at_, 0.0), steep = 1e3;
    phi[0] = x * x / 2 + steep * b * b * b;
    slope[0] = x + 3 * steep * b * b;
    curvature[0] = factor * (1 + 6 * steep * b);
  }

 private:
  double at_;
};

TEST(ValidateFields, finds_nothing_in_functions_with_a_kink_where_they_are_looked_at) {
  for (const double at : {0.4142136, 0.4142136 - 1e-12, 0.4142136 + 1e-12, 0.41421, 0.41422, 0.4, 0.6830127}) {
    KinkedCurvature functions(at);
    EXPECT_EQ(find_fault(functions, {.length = 1}, 1), "") << at;
    functions.factor = 1.01;
    EXPECT_NE(find_fault(functions, {.length = 1}, 1), "") << at << ": seen at the other places";
  }
}

}  // namespace
