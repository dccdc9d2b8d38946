#include <memory>
#include <numbers>
#include <optional>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/model/validate.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/conformance/hinge_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

Value direction(double x, double y, double z) { return Value::list({Value(x), Value(y), Value(z)}); }

Registry every_plugin() {
  Registry registry;
  enroll_static_plugins(registry);
  return registry;
}

struct HingeCase {
  std::string id;
  std::vector<Value::Member> parameters;
};
void PrintTo(const HingeCase& hinge, std::ostream* out) { *out << hinge.id; }

std::string case_name(const testing::TestParamInfo<HingeCase>& hinge) {
  return hinge.param.id + std::to_string(hinge.index);
}

class Hinges : public testing::TestWithParam<HingeCase> {};

TEST_P(Hinges, conform) {
  Registry registry = every_plugin();
  const auto hinge = make_plugin<Hinge>(registry, GetParam().id, GetParam().parameters);
  ASSERT_NE(hinge, nullptr);
  expect_hinge_conforms(*hinge);
}

const Value oblique = direction(0.3, -2.0, 1.1);

INSTANTIATE_TEST_SUITE_P(BuiltIn, Hinges,
                         testing::Values(HingeCase{"weld", {}}, HingeCase{"revolute", {{"axis", oblique}}},
                                         HingeCase{"prismatic", {{"axis", oblique}}}, HingeCase{"spherical", {}},
                                         HingeCase{"free", {}}, HingeCase{"universal", {}},
                                         HingeCase{"universal",
                                                   {{"first_axis", oblique}, {"second_axis", direction(1, 0.5, 0.2)}}},
                                         HingeCase{"cylindrical", {{"axis", oblique}}}, HingeCase{"planar", {}},
                                         HingeCase{"planar", {{"normal", oblique}, {"along", direction(1, 1, 1)}}},
                                         HingeCase{"screw", {{"axis", oblique}, {"pitch", Value(-0.3)}}}),
                         case_name);

HingeMotion moved(const std::string& id, std::vector<Value::Member> parameters, const std::vector<double>& x) {
  Registry registry = every_plugin();
  const auto hinge = make_plugin<Hinge>(registry, id, std::move(parameters));
  HingeMotion motion;
  const std::vector<double> rates(hinge->speeds());
  hinge->motion(x, rates, motion);
  return motion;
}

constexpr double quarter = 0.5 * std::numbers::pi;

// By hand: x of M is turned by the second angle about y, then by the first about x.
TEST(Universal, turns_about_the_second_axis_within_the_first) {
  const HingeMotion m = moved("universal", {}, {quarter, quarter});
  EXPECT_LT((m.pose.R * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
  EXPECT_LT((m.pose.R * Vector3::UnitY() - Vector3::UnitZ()).norm(), 1e-15);
  EXPECT_EQ(m.pose.p, Vector3::Zero());
}

TEST(Cylindrical, turns_about_and_slides_along_its_axis) {
  const HingeMotion m = moved("cylindrical", {{"axis", direction(0, 0, 2)}}, {quarter, 0.7});
  EXPECT_LT((m.pose.R * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(m.pose.p, Vector3(0, 0, 0.7));
}

TEST(PlanarHinge, slides_in_the_axes_of_the_parent_however_it_is_turned) {
  const HingeMotion m = moved("planar", {}, {quarter, 0.7, -0.2});
  EXPECT_LT((m.pose.R * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(m.pose.p, Vector3(0.7, -0.2, 0));
  // Normal along x, first translation along the part of (1, 0, 2) across it, z; the second along x × z = −y.
  const HingeMotion n =
      moved("planar", {{"normal", direction(3, 0, 0)}, {"along", direction(1, 0, 2)}}, {0, 0.7, -0.2});
  EXPECT_LT((n.pose.p - Vector3(0, 0.2, 0.7)).norm(), 1e-15);
}

TEST(Screw, advances_by_its_pitch_for_each_radian) {
  const HingeMotion m = moved("screw", {{"axis", direction(0, 0, 1)}, {"pitch", Value(0.02)}}, {quarter});
  EXPECT_LT((m.pose.R * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
  EXPECT_NEAR(m.pose.p.z(), 0.02 * quarter, 1e-17);
}

// Up to the ends of the range of numbers, where squares and norms are infinite or zero.
TEST(Hinge, directions_have_any_length) {
  const auto turned = [](double x, double y, double z) {
    return moved("revolute", {{"axis", direction(x, y, z)}}, {quarter}).pose.R;
  };
  EXPECT_LT((turned(1.7e308, 1.7e308, 1.7e308) - turned(1, 1, 1)).norm(), 1e-15);
  EXPECT_LT((turned(0, 5e-324, 5e-324) - turned(0, 1, 1)).norm(), 1e-15);
  EXPECT_LT((turned(1e200, -2e200, 0) - turned(1, -2, 0)).norm(), 1e-15);
}

TEST(Hinge, directions_that_do_not_do_are_errors) {
  Registry registry = every_plugin();
  const auto problem = [&](const std::string& id, std::vector<Value::Member> parameters) {
    Diagnostics diagnostics;
    EXPECT_EQ(make_plugin<Hinge>(registry, id, std::move(parameters), diagnostics), nullptr) << id;
    return diagnostics.errors().size() == 1 ? diagnostics.errors()[0].message : "not one error";
  };
  const Value zero = direction(0, 0, 0);
  for (const char* id : {"revolute", "prismatic", "cylindrical"})
    EXPECT_EQ(problem(id, {{"axis", zero}}), "has no length; need a direction");
  EXPECT_EQ(problem("screw", {{"axis", zero}, {"pitch", Value(1.0)}}), "has no length; need a direction");
  EXPECT_EQ(problem("universal", {{"second_axis", zero}}), "has no length; need a direction");
  EXPECT_EQ(problem("universal", {{"second_axis", direction(-2, 0, 0)}}),
            "is parallel to 'first_axis'; need two directions");
  EXPECT_EQ(problem("planar", {{"normal", direction(1, 0, 0)}}), "is parallel to 'normal'; need a direction across it");
}

/// Slides along x by an angle times a radius of 2 m, or turns about z by an arc over it.
class RollingCoordinate final : public Hinge {
 public:
  RollingCoordinate(bool turns, std::optional<bool> said) : turns_(turns), said_(said) {}
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = 0; }
  void motion(std::span<const double> x, std::span<const double>, HingeMotion& out) const noexcept override {
    out.pose = {};
    out.H.setZero(6, 1);
    out.bias.setZero();
    if (turns_) {
      out.pose.R = Eigen::AngleAxisd(x[0] / 2, Vector3::UnitZ()).toRotationMatrix();
      out.H(2, 0) = 0.5;
    } else {
      out.pose.p.x() = 2 * x[0];
      out.H(3, 0) = 2;
    }
  }
  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = rates[0];
  }
  void normalize(std::span<double>) const noexcept override {}
  std::optional<HingeKernel> kernel() const override { return {}; }
  std::optional<bool> angular(std::size_t) const override { return said_; }

 private:
  bool turns_;
  std::optional<bool> said_;
};

TEST(HingeRates, are_of_angles_or_lengths_as_the_hinge_says_and_else_by_whether_it_turns) {
  const auto column = [](bool turns, std::optional<bool> said) {
    HingeNode node;
    node.name = "h";
    node.hinge = std::make_shared<RollingCoordinate>(turns, said);
    EXPECT_EQ(find_fault(*node.hinge), "");
    return coordinate_columns(node)[0].unit + ", " + rate_columns(node)[0].unit;
  };
  EXPECT_EQ(column(false, {}), "m, m/s");
  EXPECT_EQ(column(true, {}), "rad, rad/s");
  EXPECT_EQ(column(false, true), "rad, rad/s");
  EXPECT_EQ(column(true, false), "m, m/s");
}

// Which rates turn, and which coordinate each is the derivative of; −1: of none.
TEST(HingeRates, are_found_from_the_motion) {
  Registry registry = every_plugin();
  const auto found = [&](const std::string& id, std::vector<Value::Member> parameters) {
    std::vector<std::pair<bool, int>> result;
    for (const HingeRate& r : hinge_rates(*make_plugin<Hinge>(registry, id, std::move(parameters))))
      result.emplace_back(r.angular, r.coordinate ? static_cast<int>(*r.coordinate) : -1);
    return result;
  };
  using Expected = std::vector<std::pair<bool, int>>;
  EXPECT_EQ(found("weld", {}), Expected{});
  EXPECT_EQ(found("revolute", {{"axis", oblique}}), (Expected{{true, 0}}));
  EXPECT_EQ(found("prismatic", {{"axis", oblique}}), (Expected{{false, 0}}));
  EXPECT_EQ(found("screw", {{"axis", oblique}, {"pitch", Value(2.0)}}), (Expected{{true, 0}}));
  EXPECT_EQ(found("universal", {}), (Expected{{true, 0}, {true, 1}}));
  EXPECT_EQ(found("cylindrical", {{"axis", oblique}}), (Expected{{true, 0}, {false, 1}}));
  EXPECT_EQ(found("planar", {}), (Expected{{true, 0}, {false, 1}, {false, 2}}));
  EXPECT_EQ(found("spherical", {}), (Expected{{true, -1}, {true, -1}, {true, -1}}));
  EXPECT_EQ(found("free", {}), (Expected{{true, -1}, {true, -1}, {true, -1}, {false, 4}, {false, 5}, {false, 6}}));
}

}  // namespace
}  // namespace withy::test
