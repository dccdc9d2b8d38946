// Hinges, motions, formulations and strain kinematics of plugins that are not what they say they are.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "faulty_plugin.hpp"
#include "scene_fixture.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"

namespace withy::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A slider on the curve y = sin x; told faults are in its pose, H, bias, their derivatives or its kernel.
class OnSine final : public Hinge {
 public:
  explicit OnSine(std::string fault) : fault_(std::move(fault)) {}
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = fault_ == "reference" ? nan : 0; }
  void motion(std::span<const double> x, std::span<const double> rates, HingeMotion& out) const noexcept override {
    out.pose.R.setIdentity();
    if (fault_ == "size-of-R") out.pose.R *= 2;
    if (fault_ == "shear") out.pose.R(0, 1) = 0.2;
    if (fault_ == "mirror") out.pose.R(2, 2) = -1;
    out.pose.p = Vector3(x[0], fault_ == "place" ? nan : std::sin(x[0]), 0);
    out.H.setZero(6, fault_ == "width" ? 2 : 1);
    out.H(3, 0) = 1;
    out.H(4, 0) = (fault_ == "H" ? 1.01 : 1) * std::cos(x[0]);
    out.bias.setZero();
    if (fault_ != "bias") out.bias[4] = -std::sin(x[0]) * rates[0] * rates[0];
  }
  void motion_derivative(std::span<const double> x, std::span<const double> rates, std::size_t along,
                         HingeMotion& out) const override {
    if (fault_ == "throws") throw std::runtime_error("out of order");
    if (fault_ == "default") return Hinge::motion_derivative(x, rates, along, out);
    out.H.setZero(6, fault_ == "width-of-derivative" ? 2 : 1);
    out.H(4, 0) = (fault_ == "derivative-of-H" ? 5 : 1) * -std::sin(x[0]);
    out.bias.setZero();
    out.bias[4] = (fault_ == "derivative-of-bias" ? 5 : 1) * -std::cos(x[0]) * rates[0] * rates[0];
  }
  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = fault_ == "derivatives" ? 2 * rates[0] : rates[0];
  }
  void normalize(std::span<double>) const noexcept override {}
  std::optional<HingeKernel> kernel() const override {
    if (fault_ == "kernel") return HingeKernel{HingeKernel::Kind::prismatic, Vector3::UnitX()};
    if (fault_ == "size") return HingeKernel{HingeKernel::Kind::free, Vector3::UnitX()};
    return {};
  }

 private:
  std::string fault_;
};

/// A bead on a circle of a radius, or on a line that bends at a place into a parabola, or on y = x^1.5, x > 0, from
/// x = 5 mm on. H may be too large.
class Bead final : public Hinge {
 public:
  Bead(std::string line, double size, double factor) : line_(std::move(line)), size_(size), factor_(factor) {}
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = line_ == "root" ? size_ : 0; }
  void motion(std::span<const double> x, std::span<const double> rates, HingeMotion& out) const noexcept override {
    const double u2 = rates[0] * rates[0], beyond = std::max(x[0] - size_, 0.0);
    out.H.setZero(6, 1);
    out.bias.setZero();
    if (line_ == "circle") {
      const double s = std::sin(x[0] / size_), c = std::cos(x[0] / size_);
      out.pose.p = size_ * Vector3(s, 1 - c, 0);
      out.H.bottomRows<3>() = Vector3(c, s, 0);
      out.bias.tail<3>() = u2 / size_ * Vector3(-s, c, 0);
    } else if (line_ == "bend") {
      out.pose.p = Vector3(x[0], beyond * beyond / 2, 0);
      out.H.bottomRows<3>() = Vector3(1, beyond, 0);
      out.bias[4] = beyond > 0 ? u2 : 0;
    } else {
      const double root = std::sqrt(x[0]);
      out.pose.p = Vector3(x[0], x[0] * root, 0);
      out.H.bottomRows<3>() = Vector3(1, 1.5 * root, 0);
      out.bias[4] = 0.75 / root * u2;
    }
    out.H *= factor_, out.bias *= factor_;
  }
  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = rates[0];
  }
  void normalize(std::span<double>) const noexcept override {}
  std::optional<HingeKernel> kernel() const override { return {}; }

 private:
  std::string line_;
  double size_, factor_;
};

/// sin 3t with one mistake.
class Wave final : public Motion {
 public:
  explicit Wave(std::string fault) : fault_(std::move(fault)) {}
  bool locks() const override {
    if (fault_ == "throws") throw std::runtime_error("out of order");
    return false;
  }
  MotionPoint at(double t) const noexcept override {
    const double w = fault_ == "fast" ? 3e9 : 3;
    MotionPoint p{std::sin(w * t), w * std::cos(w * t), -w * w * std::sin(w * t)};
    if (fault_ == "step" && t > 0.5) p.position += 1;
    if (fault_ == "rate") p.rate *= 2, p.acceleration *= 2;
    if (fault_ == "acceleration") p.acceleration += 1;
    if (fault_ == "no-rate" && t > 0.5) p.rate = nan;
    return p;
  }
  std::vector<double> discontinuities() const override {
    if (fault_ == "jumps-back") return {0.5, 0.25};
    return {};
  }
  double end() const override { return 0; }

 private:
  std::string fault_;
};

/// Throws where it is asked what it is.
class Mute final : public Formulation {
 public:
  explicit Mute(std::string fault) : fault_(std::move(fault)) {}
  Terms terms() const override {
    if (fault_ == "terms") throw std::runtime_error("out of order");
    return {};
  }
  Standing standing() const override {
    if (fault_ == "standing") throw std::runtime_error("out of order");
    return {};
  }
  std::unique_ptr<EquationsOfMotion> compile(std::shared_ptr<const Model>) const override { return nullptr; }

 private:
  std::string fault_;
};

/// A share of the complete second order, and where it is lopsided of one field alone.
class Shared final : public StrainKinematics {
 public:
  Shared(double share, bool lopsided) : share_(share), lopsided_(lopsided) {}
  std::string_view name() const override { return "shared"; }
  StrainOrder order() const override { return StrainOrder::quadratic; }
  Vector3 displacement_slope(const SectionField& i, const SectionField& j, const Vector3& theta) const override {
    if (lopsided_) return share_ * i.rotation.cross(j.rotation.cross(Vector3::UnitX()));
    return share_ * StrainKinematics::displacement_slope(i, j, theta);
  }

 private:
  double share_;
  bool lopsided_;
};

template <bool lopsided>
std::unique_ptr<StrainKinematics> shared(const Value& p, const MakeContext&) {
  return std::make_unique<Shared>(p.number_at("share"), lopsided);
}

class HostileMotions : public SceneTest {
 protected:
  HostileMotions() {
    Enrollment e;
    e.add(faulty_plugin<Hinge, OnSine>("sine"));
    e.add(faulty_plugin<Motion, Wave>("wave"));
    Plugin<Hinge> bead;
    bead.id = "bead";
    bead.parameters = {text("line", "that it is on"), number("size", "m", "of the line"),
                       number("factor", "1", "of H and the bias").otherwise(1)};
    bead.make = [](const Value& p, const MakeContext&) -> std::unique_ptr<Hinge> {
      return std::make_unique<Bead>(p.text_at("line"), p.number_at("size"), p.number_at("factor"));
    };
    e.add(std::move(bead));
    e.add(faulty_plugin<Formulation, Mute>("mute"));
    const auto add_kinematics = [&](const char* id, ParameterSpec share, auto make) {
      Plugin<StrainKinematics> plugin;
      plugin.id = id;
      plugin.parameters = {std::move(share)};
      plugin.make = make;
      e.add(std::move(plugin));
    };
    const auto share = [] { return number("share", "1", "of the complete second order"); };
    add_kinematics("with-default", share().otherwise(0.5), &shared<false>);
    add_kinematics("with-need", share(), &shared<false>);
    add_kinematics("lopsided", share().otherwise(0.5), &shared<true>);
    registry.admit(std::move(e), "test");
  }
  static std::string with(const std::string& hinge) {
    return "format: withy/1\ntime: {end: 1}\nbodies: {b: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}\n"
           "hinges:\n  h: {type: " +
           hinge + ", parent: world, child: b}\n";
  }
  static std::string with_sine(const std::string& fault) { return with("sine, fault: " + fault); }
};

TEST_F(HostileMotions, WhoseHingesDoNotMoveAsTheySayAreReported) {
  const auto hinge = [&](const std::string& fault) { return problems(with_sine(fault), registry); };
  const std::string made = "s.yaml:5:3: /hinges/h: hinge 'sine' made a motion that cannot be: ";
  EXPECT_EQ(hinge("nothing"), "");
  EXPECT_EQ(hinge("default"), "");
  EXPECT_THAT(hinge("H"), testing::StartsWith(made + "column 1 of H is (0 0 0 1 1.01 0) in the axes of M"));
  EXPECT_THAT(hinge("bias"), testing::StartsWith(made + "the bias is (0 0 0 0 0 0) in the axes of M"));
  EXPECT_EQ(hinge("kernel"), made + "it does not move as the kernel that it says it is");
  EXPECT_EQ(hinge("derivatives"), made +
                                      "it has as many rates as coordinates, and the derivative of coordinate 1 is 2 "
                                      "where rate 1 is 1; need rates that are the derivatives, or more coordinates, "
                                      "as a quaternion has");
  EXPECT_EQ(hinge("size"), made + "it has 1 coordinates and 1 rates, the kernel that it says it is has 7 and 6");
  EXPECT_EQ(hinge("width"), made + "H has 2 columns; need one a rate, 1");
}

// R^T R - 1: 3 times the identity; of the shear by a, a in two corners and a² in one.
TEST_F(HostileMotions, WhoseHingesHaveNoPoseThatIsARotationAreReported) {
  const auto hinge = [&](const std::string& fault) { return problems(with_sine(fault), registry); };
  const std::string made = "s.yaml:5:3: /hinges/h: hinge 'sine' made a motion that cannot be: ";
  EXPECT_EQ(hinge("size-of-R"), made + "R of its pose is no rotation: R^T R is off the identity by 5.19615");
  EXPECT_EQ(hinge("shear"), made + "R of its pose is no rotation: R^T R is off the identity by 0.285657");
  EXPECT_EQ(hinge("mirror"), made + "R of its pose is a reflection, of determinant -1");
  EXPECT_EQ(hinge("reference"), made + "coordinate 1 of its reference is nan");
  EXPECT_EQ(hinge("place"), made + "its pose is not finite near its reference");
}

TEST_F(HostileMotions, WhoseHingesGiveDerivativesThatAreNoneAreReported) {
  const auto hinge = [&](const std::string& fault) { return problems(with_sine(fault), registry); };
  const std::string at = "s.yaml:5:3: /hinges/h: hinge 'sine' ", made = at + "made a motion that cannot be: ";
  EXPECT_EQ(hinge("throws"), at + "does not say what it is: out of order");
  EXPECT_EQ(hinge("width-of-derivative"), made + "the derivative of H along rate 1 has 2 columns; need one a rate, 1");
  EXPECT_THAT(hinge("derivative-of-H"), testing::StartsWith(made + "the derivative of H along rate 1, column 1, is "));
  EXPECT_THAT(hinge("derivative-of-bias"), testing::StartsWith(made + "the derivative of the bias along rate 1 is "));
}

TEST_F(HostileMotions, WhoseHingesAreSmallKinkedOrAtTheEndOfWhereTheyCanBeAreRightAndTheirFaultsAreSeen) {
  const auto bead = [&](const std::string& line, const std::string& size, const std::string& factor) {
    return problems(with("bead, line: " + line + ", size: " + size + ", factor: " + factor), registry);
  };
  const auto expect_told = [&](const std::string& line, const std::string& size) {
    EXPECT_EQ(bead(line, size, "1"), "") << line << " of " << size;
    EXPECT_THAT(bead(line, size, "1.01"), testing::HasSubstr("a motion that cannot be: column 1 of H is (0 0 0 "))
        << line << " of " << size;
  };
  for (const char* radius : {"1", "1e-2", "1e-3", "1e-4", "1e-5", "1e-6"}) expect_told("circle", radius);
  for (const char* place : {"0.0137", "0.0931", "0.01", "0.1", "0.05", "0.0137000001", "0.0136999999"})
    expect_told("bend", place);
  for (const char* from : {"1", "0.005", "1e-4"}) expect_told("root", from);
  // Of what turns in less than the shortest step nobody can tell.
  EXPECT_EQ(bead("circle", "1e-12", "1"), "");
}

// Seconds since 1980, or since the beginning: doubles tell times that are 1e-7 s apart, or 1e-4 s.
TEST_F(HostileMotions, WhoseMotionsAreFormulasOfAFarTimeAreRight) {
  for (const char* law :
       {"type: expression, value: '0.1 * sin(25.2 * (t + 1012587058.1))'", "type: expression, value: (1e12 + t) - 1e12",
        "type: sine, amplitude: 1, period: 1, phase: 1.0e11", "type: expression, value: '0.1 * sin(3 * (t + 2.1e13))'",
        "type: expression, value: 'max(t - 0.4142136, 0)^2'"}) {
    SCOPED_TRACE(law);
    EXPECT_EQ(problems(with_sine("nothing") + "motions:\n  m: {hinge: h, " + law + "}\n", registry), "");
  }
}

// sin 3t, its rate and its acceleration, or others.
TEST_F(HostileMotions, WhoseMotionsHaveRatesThatAreNoneAreReported) {
  const auto motion = [&](const std::string& fault) {
    return problems(with_sine("nothing") + "motions:\n  m: {type: wave, hinge: h, fault: " + fault + "}\n", registry);
  };
  const std::string at = "s.yaml:7:3: /motions/m: motion 'wave' ", made = at + "made a course that cannot be: ";
  EXPECT_EQ(motion("nothing"), "");
  EXPECT_EQ(motion("step"), "") << "what jumps between the times that are looked at";
  EXPECT_EQ(motion("fast"), "") << "what no difference follows";
  EXPECT_THAT(motion("rate"), testing::StartsWith(made + "at t = 0.137174 s its rate is 5.49908; differences of its "
                                                         "coordinate give 2.7495"));
  EXPECT_THAT(motion("acceleration"), testing::StartsWith(made + "at t = 0.137174 s its acceleration is -2.60005; "
                                                                 "differences of its rate give -3.6000"));
  EXPECT_EQ(motion("no-rate"), made + "at t = 0.683013 s its rate is nan, where its coordinate is finite");
  EXPECT_EQ(motion("throws"), at + "does not say what it is: out of order");
}

TEST_F(HostileMotions, WhoseMotionsJumpAtTimesThatDoNotIncreaseAreReported) {
  EXPECT_EQ(
      problems(with_sine("nothing") + "motions:\n  m: {type: wave, hinge: h, fault: jumps-back}\n", registry),
      "s.yaml:7:3: /motions/m: motion 'm' says that it jumps at 0.5 s and then at 0.25 s; need times that increase");
}

TEST_F(HostileMotions, WhoseFormulationsThrowWhereTheyAreAskedForTheirTermsAreReported) {
  const auto formulation = [&](const std::string& fault) {
    return problems(with("free") + "formulation: {name: mute, fault: " + fault + "}\n", registry);
  };
  EXPECT_THAT(formulation("terms"), testing::HasSubstr("'mute' does not say what it is: out of order"));
  EXPECT_THAT(formulation("standing"), testing::HasSubstr("'mute' does not say what it is: out of order"));
}

TEST_F(HostileMotions, WhoseStrainKinematicsAreNoneAreReportedWhereTheyAreNamed) {
  const auto kinematics = [&](const std::string& id) {
    return problems(with("free") + "formulation: {kinematics: " + id + ", truncation: none}\n", registry);
  };
  const std::string at = "/formulation/kinematics: strain kinematics '";
  EXPECT_EQ(kinematics("with-default"), "") << "its parameter has its default";
  EXPECT_THAT(kinematics("with-need"), testing::HasSubstr(at + "with-need' needs 'share', and a scene names strain "
                                                               "kinematics without parameters"));
  EXPECT_THAT(kinematics("lopsided"), testing::HasSubstr(at + "lopsided' made one that cannot be: displacement_slope "
                                                              "is not symmetric: it gives ("));
}

}  // namespace
}  // namespace withy::test
