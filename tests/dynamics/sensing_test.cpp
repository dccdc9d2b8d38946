/// \file
/// What sensors see – motion and accelerations of frames, energies of bodies – against differences along the motion and
/// the dense reference.
#include <Eigen/Geometry>
#include <algorithm>

#include "sensed_case.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

class SensedStates : public testing::TestWithParam<std::string> {};

TEST_P(SensedStates, frames_move_as_observations_say_and_their_accelerations_are_the_rates_of_velocities) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Case c(seed, {.bodies = 5, .planar = seed % 3 == 0, .any_root = seed % 2 == 0}, GetParam());
    const auto sensed = c.equations->make_sensed_state({});
    ASSERT_TRUE(sensed->observe(c.state));
    const auto seen = c.equations->make_observation();
    const Model& model = *c.scene.model;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      for (std::size_t f = 0; f < model.bodies()[b].frames.size(); ++f) {
        const FrameIndex at{static_cast<int>(b), static_cast<int>(f)};
        seen->observe(c.state.y);
        const FrameMotion m = sensed->motion(at);
        const WorldPose X = seen->frame_pose(at.body, at.frame);
        const WorldVelocity V = seen->frame_velocity(at.body, at.frame);
        const std::string where = "seed " + std::to_string(seed) + " " + model.bodies()[b].name;
        EXPECT_LT((m.position - arrow(X.position)).norm(), 1e-11) << where;
        EXPECT_LT((m.angular_velocity - arrow(V.angular)).norm(), 1e-11) << where;
        EXPECT_LT((m.velocity - arrow(V.linear)).norm(), 1e-11) << where;
        const Vector6 slope = central_difference(
            [&](double h) -> Vector6 {
              seen->observe(moved(c, h).y);
              const WorldVelocity at_h = seen->frame_velocity(at.body, at.frame);
              Vector6 both;
              both << arrow(at_h.angular), arrow(at_h.linear);
              return both;
            },
            1e-3);
        const FrameAcceleration a = sensed->acceleration(at);
        const double size = 1 + slope.norm();
        EXPECT_LT((a.angular - slope.head<3>()).norm(), 1e-7 * size) << where;
        EXPECT_LT((a.linear - slope.tail<3>()).norm(), 1e-7 * size) << where;
      }
    }
  }
}

/// Kinetic energy of the rotors that drive hinges [J]; the others belong to a body.
double of_rotors(const Model& model, const State& state) {
  double energy = 0;
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (const Slot& slot = model.layout().hinges[h]; slot.speeds == 1)
      energy += 0.5 * model.hinges()[h].reflected_inertia * std::pow(state.y[model.layout().positions + slot.speed], 2);
  return energy;
}

TEST_P(SensedStates, energies_and_momenta_of_the_bodies_add_up_to_those_of_the_reference) {
  for (unsigned seed = 1; seed <= 15; ++seed) {
    const Case c(seed, {.bodies = 5, .planar = seed % 3 == 0, .any_root = seed % 2 == 0 && GetParam() != "exact"},
                 GetParam());
    const auto sensed = c.equations->make_sensed_state({});
    ASSERT_TRUE(sensed->observe(c.state));
    BodyEnergies sum;
    for (int b = 0; b < 5; ++b) {
      const BodyEnergies own = sensed->energies(b);
      sum.kinetic += own.kinetic;
      sum.strain += own.strain + own.weight;
      sum.linear += own.linear;
      sum.angular += own.angular;
    }
    const Energies whole = c.equations->energies(c.state.y);
    const double close = GetParam() == "exact" ? 1e-7 : 1e-10;
    EXPECT_NEAR(sum.kinetic + of_rotors(*c.scene.model, c.state), whole.kinetic, close * (1 + whole.kinetic))
        << "seed " << seed;
    EXPECT_NEAR(sum.strain, whole.potential, 10 * close * (1 + std::abs(whole.potential))) << "seed " << seed;
    EXPECT_LT((sum.linear - arrow(whole.linear_momentum)).norm(), close * (1 + sum.linear.norm())) << "seed " << seed;
    EXPECT_LT((sum.angular - arrow(whole.angular_momentum)).norm(), close * (10 + sum.angular.norm()))
        << "seed " << seed;
  }
}

/// The numbers of a scene's outputs at the state moved along its motion.
Eigen::VectorXd outputs_at(const Case& c, SensorReader& reader, double by) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(reader.columns().size()));
  EXPECT_TRUE(reader.read(moved(c, by), {values.data(), reader.columns().size()}));
  return values;
}

/// Seen from a moving frame velocities are the rates of positions, and accelerations those of velocities.
TEST(SensorsOfFrames, seen_from_a_moving_frame_are_rates_of_each_other) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    RandomScene random(seed, {.bodies = 4});
    Case c(random.text() +
               "outputs:\n  eye: {type: frame, of: b3.a, in: b1.m}\n  gap: {type: distance, from: b0.m, to: b3.a}\n",
           "quadratic");
    c.state = random.state(*c.scene.model, c.scene.initial);
    SensorReader reader(c.scene.outputs, *c.equations);
    const auto at = [&](const std::string& name) {
      const auto found = std::find_if(reader.columns().begin(), reader.columns().end(),
                                      [&](const Column& column) { return column.name == name; });
      EXPECT_NE(found, reader.columns().end()) << name;
      return found - reader.columns().begin();
    };
    const Eigen::VectorXd values = outputs_at(c, reader, 0);
    const Eigen::VectorXd rates = central_difference([&](double h) { return outputs_at(c, reader, h); }, 1e-3);
    const auto expect_rate = [&](const std::string& of, const std::string& is, Eigen::Index count) {
      const Eigen::VectorXd slope = rates.segment(at(of), count);
      EXPECT_LT((values.segment(at(is), count) - slope).norm(), 1e-7 * (1 + slope.norm())) << "seed " << seed << is;
    };
    expect_rate("eye.x", "eye.vx", 3);
    expect_rate("eye.vx", "eye.ax", 3);
    expect_rate("eye.wx", "eye.alphax", 3);
    expect_rate("gap", "gap.rate", 1);
    const auto q = values.segment<4>(at("eye.qw")), q_dot = rates.segment<4>(at("eye.qw"));
    const Eigen::Quaterniond attitude(q[0], q[1], q[2], q[3]), turn(q_dot[0], q_dot[1], q_dot[2], q_dot[3]);
    const Vector3 spin = 2 * (turn * attitude.conjugate()).vec();
    EXPECT_LT((values.segment<3>(at("eye.wx")) - spin).norm(), 1e-7 * (1 + spin.norm()));
    const Vector3 r = values.segment<3>(at("eye.rx"));
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(r.x(), Vector3::UnitX()) *
                                    Eigen::AngleAxisd(r.y(), Vector3::UnitY()) *
                                    Eigen::AngleAxisd(r.z(), Vector3::UnitZ()));
    EXPECT_LT(turned.angularDistance(attitude), 1e-12);
  }
}

TEST(SensorsOfExpressions, have_the_value_that_arithmetic_gives) {
  const Case c(
      "format: withy/1\ntime: {end: 1}\nbodies: {hub: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}\n"
      "hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}}\n"
      "initial: {hinges: {axle: {position: [0.5], rate: [3]}}}\noutputs:\n"
      "  turn: {type: hinge, hinge: axle}\n  motion: {type: energy}\n"
      "  a: {type: expression, value: \"-2^2 + norm(3, 4) * max(1, 2, t) / 2 - 2^-1\", unit: m}\n"
      "  b: {type: expression, value: \"sin(turn.position)^2 + cos(turn.position)^2 - (a - .5) * pi / pi\"}\n"
      "  c: {type: expression, value: motion.kinetic - turn.rate^2 / 2}\n",
      "quadratic");
  SensorReader reader(c.scene.outputs, *c.equations);
  std::vector<double> values(reader.columns().size());
  ASSERT_TRUE(reader.read(c.state, values));
  const std::size_t a = values.size() - 3;
  EXPECT_EQ(reader.columns()[a].name, "a");
  EXPECT_EQ(reader.columns()[a].unit, "m");
  EXPECT_NEAR(values[a], 0.5, 1e-15);
  EXPECT_NEAR(values[a + 1], 1, 1e-15);
  EXPECT_NEAR(values[a + 2], 0, 1e-15);
}

/// What stands in the memory from another state does not matter, and nothing is allocated.
TEST_P(SensedStates, allocate_nothing_and_do_not_remember_another_state) {
  const Case c(5, {.bodies = 6, .any_root = GetParam() != "exact"}, GetParam());
  const auto one = c.equations->make_sensed_state({}), other = c.equations->make_sensed_state({});
  ASSERT_TRUE(other->observe(c.state));
  const Vector3 first = other->reaction(1).moment, a = other->acceleration({3, 0}).linear;
  ASSERT_TRUE(one->observe(c.scene.initial));
  static_cast<void>(one->reaction(1));
  const std::size_t before = allocations();
  ASSERT_TRUE(one->observe(c.state));
  const Vector3 second = one->reaction(1).moment, b = one->acceleration({3, 0}).linear;
  static_cast<void>(one->motion({2, 0}));
  static_cast<void>(one->load_efforts(EquationsOfMotion::all_loads));
  static_cast<void>(one->motion_efforts());
  static_cast<void>(one->energies());
  EXPECT_EQ(allocations(), before);
  EXPECT_EQ(first, second);
  EXPECT_EQ(a, b);
}

INSTANTIATE_TEST_SUITE_P(Formulations, SensedStates, testing::ValuesIn(formulations), formulation_name);

}  // namespace
}  // namespace withy::test
