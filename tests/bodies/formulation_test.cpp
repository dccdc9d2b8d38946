#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/conformance/formulation_suite.hpp"
#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"
#include "withy/tests/conformance/test_bodies.hpp"

namespace withy::test {
namespace {

/// A flexible pendulum in space on a revolute hinge, in its own weight, with a tip body.
std::string pendulum(double stiffness, double modes, const std::string& family = "clamped-free") {
  const std::string m = std::to_string(static_cast<int>(modes)) + ", family: " + family;
  return "format: withy/1\ntime: {end: 1}\ngravity: [0, 0, -9.81]\nbodies:\n  rod: {type: beam, length: 1.2, "
         "mass_per_length: 0.8, "
         "bending_y: {stiffness: " +
         std::to_string(30 * stiffness) + ", modes: " + m +
         "}, bending_z: {stiffness: " + std::to_string(20 * stiffness) + ", modes: " + m +
         "}}\n  bob: {type: rigid, mass: 0.5, inertia: [0.01, 0.01, 0.01, 0, "
         "0, 0], center_of_mass: [0.1, 0.02, 0]}\nhinges:\n  pivot: {type: revolute, axis: [0, 1, 0.2], parent: world, "
         "child: "
         "rod}\n  tip: {type: weld, parent: rod.tip, child: bob}\nloads:\n  motor: {type: hinge-effort, hinge: pivot, "
         "law: sine, "
         "amplitude: 2, period: 0.7, phase: 1}\n";
}

class Formulations : public testing::TestWithParam<std::string> {
 protected:
  Formulations() { enroll_static_plugins(registry_); }
  Scene scene(double stiffness = 1, double modes = 2, const std::string& formulation = GetParam()) {
    return parse_scene(pendulum(stiffness, modes), "pendulum", registry_, {formulation, "", {}});
  }
  static State moving(const Model& model) {
    State s = model.reference_state();
    for (std::size_t i = 0; i < s.y.size(); ++i) s.y[i] = 0.02 * std::sin(1.0 + 2.3 * static_cast<double>(i));
    s.y[model.layout().hinge("pivot")->position] = 0.7;
    s.y[model.layout().positions + model.layout().hinge("pivot")->speed] = 1.1;
    return s;
  }
  Registry registry_;
};

TEST_P(Formulations, conform) {
  const Scene s = scene();
  // Sweep and reference turn the sections of a rod in space by different methods.
  expect_formulation_conforms(*s.formulation, s.model, moving(*s.model), GetParam() == "exact" ? 1e-9 : 1e-11);
}

TEST_P(Formulations, approach_the_rigid_body_as_one_over_stiffness) {
  const Scene s = scene();
  expect_rigid_limit(
      *s.formulation, [&](double factor) { return scene(factor).model; }, &Formulations::moving, "pivot",
      GetParam() == "ruthless" ? RigidLimit::reached : RigidLimit::approached);
}

TEST_P(Formulations, without_modes_are_bitwise_the_same_rigid_body) {
  const Scene own = scene(1, 0);
  const Scene quadratic = scene(1, 0, "quadratic");
  const State s = moving(*own.model);
  EXPECT_EQ(accelerations(*own.formulation->compile(own.model), s),
            accelerations(*quadratic.formulation->compile(quadratic.model), s));
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, Formulations,
                         testing::Values("ruthless", "inconsistent", "consistent", "quadratic", "linear", "exact",
                                         "rate-linear", "auto", "symmetric", "symmetric-linear"));

struct Neglect {
  const char* formulation;
  double order;
  double epsilon = 1e-3;  ///< small enough for the order to show
};

/// The forces of a formulation differ from those without truncation by terms of the order it drops: ruthless drops the
/// first, inconsistent drops first-order terms too (those of second-order kinematics), consistent only the second.
/// The symmetric forms drop ½ ẋᵀ M₂ ẋ of the kinetic energy, with it first-order terms: what rotation does to
/// stiffness. Exact kinematics differ from quadratic ones in P at second order, and first-order terms are the same: the
/// strict truncation of `exact` is `consistent`.
void expect_orders(const std::string& family) {
  SCOPED_TRACE(family);
  Registry registry;
  enroll_static_plugins(registry);
  const Scene s = parse_scene(pendulum(1, 2, family), "pendulum", registry, {});
  State state = s.model->reference_state();
  for (std::size_t i = 0; i < state.y.size(); ++i) state.y[i] = std::sin(1.0 + 2.3 * static_cast<double>(i));
  const auto quadratic = make_plugin<Formulation>(registry, "quadratic");
  const auto exact = make_plugin<Formulation>(registry, "exact");
  for (const Neglect& n :
       {Neglect{"ruthless", 1}, Neglect{"inconsistent", 1}, Neglect{"linear", 1}, Neglect{"consistent", 2},
        Neglect{"exact", 2}, Neglect{"symmetric", 1, 1e-5}, Neglect{"symmetric-linear", 1, 1e-5}}) {
    const auto formulation = make_plugin<Formulation>(registry, n.formulation);
    EXPECT_NEAR(order_of_difference(*formulation, *quadratic, s.model, state, n.epsilon), n.order, 0.1)
        << n.formulation;
  }
  const auto consistent = make_plugin<Formulation>(registry, "consistent");
  EXPECT_NEAR(order_of_difference(*consistent, *exact, s.model, state), 2, 0.1);
}
TEST(Truncation, neglected_terms_have_the_order_the_name_says) { expect_orders("clamped-free"); }
TEST(Truncation, neglected_terms_have_the_order_the_name_says_where_modes_turn_the_root) {
  expect_orders("pinned-free");
}

/// Inertia, weight, stiffness and damping are those of `quadratic`; what else depends on speeds there is missing.
TEST(RateLinear, lacks_the_products_of_speeds_alone) {
  Registry registry;
  enroll_static_plugins(registry);
  const Scene s = parse_scene(pendulum(1, 2), "pendulum", registry, {});
  const Layout& layout = s.model->layout();
  State moving = s.model->reference_state();
  for (std::size_t i = 0; i < moving.y.size(); ++i) moving.y[i] = 0.1 * std::sin(1.0 + 2.3 * static_cast<double>(i));
  State still = moving;
  std::fill_n(still.y.begin() + static_cast<std::ptrdiff_t>(layout.positions), layout.speeds, 0.0);
  State twice = moving;
  for (std::size_t i = 0; i < layout.speeds; ++i) twice.y[layout.positions + i] *= 2;
  const auto rate_linear = make_plugin<Formulation>(registry, "rate-linear")->compile(s.model);
  const auto quadratic = make_plugin<Formulation>(registry, "quadratic")->compile(s.model);
  const DenseSystem a = rate_linear->system(0, moving.y), b = rate_linear->system(0, twice.y),
                    rest = quadratic->system(0, still.y), whole = quadratic->system(0, moving.y);
  EXPECT_EQ(a.mass, rest.mass);
  double dropped = 0;
  for (std::size_t i = 0; i < a.size; ++i) {
    EXPECT_NEAR(b.force[i] - rest.force[i], 2 * (a.force[i] - rest.force[i]), 1e-12) << "only damping is left";
    dropped = std::max(dropped, std::abs(whole.force[i] - a.force[i]));
  }
  EXPECT_GT(dropped, 1e-3);
  EXPECT_EQ(rate_linear->system(0, still.y).force, rest.force);
}

/// At q = 0 nothing distinguishes exact kinematics: inertia and, at rest, forces are those of the undeformed body.
TEST(Exact, is_ruthless_at_zero_deflection) {
  Registry registry;
  enroll_static_plugins(registry);
  const Scene s = parse_scene(pendulum(1, 3), "pendulum", registry, {});
  State state = s.model->reference_state();
  state.y[s.model->layout().hinge("pivot")->position] = 0.7;
  const DenseSystem exact = make_plugin<Formulation>(registry, "exact")->compile(s.model)->system(0, state.y);
  const DenseSystem ruthless = make_plugin<Formulation>(registry, "ruthless")->compile(s.model)->system(0, state.y);
  for (std::size_t i = 0; i < exact.size; ++i) {
    EXPECT_NEAR(exact.force[i], ruthless.force[i], 1e-12);
    for (std::size_t j = 0; j < exact.size; ++j) {
      const std::size_t k = i * exact.size + j;
      EXPECT_NEAR(exact.mass[k], ruthless.mass[k], 1e-12);
    }
  }
}

TEST(Exact, names_a_body_that_does_not_offer_it) {
  const std::shared_ptr<const Body> rod = test_rod(1, 1, 2);
  Registry registry;
  enroll_static_plugins(registry);
  const auto model = [&](std::optional<Terms> own) {
    std::vector<BodyNode> bodies;
    bodies.push_back(test_node("whip", rod));
    bodies.back().terms = own;
    std::vector<HingeNode> hinges(1);
    hinges[0].name = "pivot";
    hinges[0].hinge =
        make_plugin<Hinge>(registry, "revolute", {{"axis", Value::list({Value(0.0), Value(0.0), Value(1.0)})}});
    return std::make_shared<const Model>(std::move(bodies), std::move(hinges), Vector3::Zero());
  };
  const auto exact = make_plugin<Formulation>(registry, "exact");
  try {
    exact->compile(model({}));
    ADD_FAILURE() << "compiled";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("'whip'"), std::string::npos) << e.what();
  }
  EXPECT_NE(exact->compile(model(Terms{StrainOrder::quadratic, Truncation::none})), nullptr);
}

/// A body's own formulation: ruthless terms for one body in an untruncated tree; strict and untruncated do not mix.
TEST(OwnTerms, of_a_body_are_taken_and_impossible_mixtures_refused) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto with = [&](const char* own) {
    return parse_scene(pendulum(1, 2), "pendulum", registry,
                       {"quadratic", "", {std::string("bodies.rod.formulation=") + own}});
  };
  const Scene mixed = with("ruthless");
  const Scene ruthless = parse_scene(pendulum(1, 2), "pendulum", registry, {"ruthless", "", {}});
  State state = mixed.model->reference_state();
  for (std::size_t i = 0; i < state.y.size(); ++i) state.y[i] = 0.01 * std::sin(1.0 + 2.3 * static_cast<double>(i));
  EXPECT_EQ(accelerations(*mixed.formulation->compile(mixed.model), state),
            accelerations(*ruthless.formulation->compile(ruthless.model), state));
}

TEST(Loads, conform) {
  Registry registry;
  enroll_static_plugins(registry);
  const Scene s = parse_scene(pendulum(1, 2), "pendulum", registry, {});
  const auto motor = make_plugin<Load>(registry, "hinge-effort",
                                       {{"hinge", Value(std::string("pivot"))},
                                        {"law", Value(std::string("sine"))},
                                        {"amplitude", Value(2.0)},
                                        {"period", Value(0.5)}});
  ASSERT_NE(motor, nullptr);
  expect_load_conforms(*motor, *s.model);
  const auto slew =
      make_plugin<Load>(registry, "rigid-inverse-dynamics",
                        {{"law", Value(std::string("quintic"))},
                         {"duration", Value(2.0)},
                         {"hinges", Value::map({{"pivot", Value::map({{"from", Value(0.2)}, {"to", Value(1.0)}})}})}});
  ASSERT_NE(slew, nullptr);
  expect_load_conforms(*slew, *s.model);
}

}  // namespace
}  // namespace withy::test
