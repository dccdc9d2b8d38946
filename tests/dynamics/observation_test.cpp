/// \file
/// What runs report – energies, momenta, poses, velocities, deflections by one pass – against the dense reference.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "random_case.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

using Rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

class Observations : public testing::TestWithParam<std::string> {
 protected:
  /// Relative. In space the sections of a rod are turned by another method than the reference's, which differs from it
  /// by less than 1e-8 here.
  static double tolerance() { return GetParam() == "exact" ? 1e-8 : 1e-12; }
};

Vector3 vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// Size of what cancels in a sum over the bodies.
double mass_of(const Model& model) {
  double mass = 0;
  for (const BodyNode& b : model.bodies()) {
    for (const Particle& p : b.body->shape().particles) mass += p.mass;
  }
  return mass;
}

void expect_as_the_reference(const Case& c, const std::string& what, double tolerance) {
  const Model& model = *c.scene.model;
  const auto seen = c.equations->make_observation();
  seen->observe(c.state.y);
  const Energies a = seen->energies(), b = c.equations->energies(c.state.y);
  // Bodies of about a metre at speeds of about a metre per second, some metres from the origin.
  const double size = mass_of(model) * 10, close = tolerance * size;
  EXPECT_NEAR(a.kinetic, b.kinetic, close) << what;
  EXPECT_NEAR(a.potential, b.potential, 10 * close) << what;
  EXPECT_LT((vector(a.linear_momentum) - vector(b.linear_momentum)).norm(), close) << what;
  EXPECT_LT((vector(a.angular_momentum) - vector(b.angular_momentum)).norm(), 3 * close) << what;
  for (std::size_t body = 0; body < model.bodies().size(); ++body) {
    for (std::size_t frame = 0; frame < model.bodies()[body].frames.size(); ++frame) {
      const int i = static_cast<int>(body), j = static_cast<int>(frame);
      const std::string where = what + ", " + model.bodies()[body].name + "." + model.bodies()[body].frames[frame].name;
      const WorldPose p = seen->frame_pose(i, j), q = c.equations->frame_pose(c.state.y, i, j);
      EXPECT_LT((vector(p.position) - vector(q.position)).norm(), 10 * tolerance) << where;
      EXPECT_LT((Rotation(p.rotation.data()) - Rotation(q.rotation.data())).norm(), 10 * tolerance) << where;
      const auto d = seen->deflection(i, j), e = c.equations->deflection(c.state.y, i, j);
      EXPECT_LT((vector(d) - vector(e)).norm(), tolerance) << where;
    }
  }
}

/// Deflections need no pass over the tree: what has been asked for before changes none of them, nor they what follows.
TEST_P(Observations, tell_the_same_in_any_order) {
  int flexible = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Case c(seed, {.bodies = 5, .planar = seed % 2 == 0}, GetParam());
    const auto first = c.equations->make_observation(), last = c.equations->make_observation();
    // They come from another state.
    first->observe(c.scene.initial.y), last->observe(c.scene.initial.y);
    first->energies(), last->energies();
    first->observe(c.state.y), last->observe(c.state.y);
    const Energies e = last->energies();
    for (std::size_t b = 0; b < c.scene.model->bodies().size(); ++b) {
      const BodyNode& body = c.scene.model->bodies()[b];
      for (std::size_t f = 0; f < body.frames.size(); ++f) {
        const auto d = first->deflection(static_cast<int>(b), static_cast<int>(f));
        EXPECT_EQ(d, last->deflection(static_cast<int>(b), static_cast<int>(f)))
            << "seed " << seed << ", " << body.name;
        flexible += d != std::array<double, 3>{} ? 1 : 0;
      }
    }
    EXPECT_EQ(first->energies().kinetic, e.kinetic) << "seed " << seed;
    EXPECT_EQ(first->energies().potential, e.potential) << "seed " << seed;
  }
  EXPECT_GT(flexible, 5);
}

TEST_P(Observations, agree_with_the_reference_in_space) {
  for (unsigned seed = 1; seed <= 25; ++seed)
    expect_as_the_reference(Case(seed, {.bodies = 2 + static_cast<int>(seed % 7)}, GetParam()),
                            "seed " + std::to_string(seed), tolerance());
}

/// Bodies of a planar tree are at different heights and have products of inertia across the plane.
TEST_P(Observations, agree_with_the_reference_in_a_plane) {
  for (unsigned seed = 1; seed <= 25; ++seed)
    expect_as_the_reference(Case(seed, {.bodies = 2 + static_cast<int>(seed % 7), .planar = true}, GetParam()),
                            "seed " + std::to_string(seed), tolerance());
}

TEST_P(Observations, agree_with_the_reference_where_beams_stretch_and_shear) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 5),
                         .planar = seed % 3 == 0,
                         .any_root = seed % 4 == 0,
                         .rotary = seed % 2 == 0,
                         .stretching = true};
    expect_as_the_reference(Case(seed, wish, GetParam()), "seed " + std::to_string(seed), tolerance());
  }
}

TEST_P(Observations, agree_with_the_reference_where_beams_are_held_at_their_tip_or_their_root_moves) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 5),
                         .planar = seed % 3 == 0,
                         .any_root = seed % 2 == 0,
                         .any_family = seed > 15};
    expect_as_the_reference(Case(seed, wish, GetParam()), "seed " + std::to_string(seed), tolerance());
  }
}

/// Velocities are the rates of the reference's poses, by differences over a step along the motion.
TEST_P(Observations, velocities_are_the_rates_of_poses) {
  constexpr double h = 1e-5;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const SceneWish wish{.bodies = 5, .planar = seed % 3 == 0, .any_root = seed % 2 == 0, .any_family = seed > 6};
    const Case c(seed, wish, GetParam());
    if (c.equations->layout().speeds == 0) continue;
    std::vector<double> rates(c.equations->size());
    Work work = c.equations->make_work();
    ASSERT_TRUE(c.equations->derivatives(0, c.state.y, rates, work).ok());
    const auto seen = c.equations->make_observation();
    seen->observe(c.state.y);
    const auto moved = [&](double by) {
      std::vector<double> y = c.state.y;
      for (std::size_t i = 0; i < c.equations->layout().positions; ++i) y[i] += by * rates[i];
      return y;
    };
    const std::vector<double> before = moved(-h), after = moved(h);
    const Model& model = *c.scene.model;
    for (std::size_t body = 0; body < model.bodies().size(); ++body) {
      for (std::size_t frame = 0; frame < model.bodies()[body].frames.size(); ++frame) {
        const int i = static_cast<int>(body), j = static_cast<int>(frame);
        const WorldPose p = c.equations->frame_pose(before, i, j), q = c.equations->frame_pose(after, i, j);
        const WorldVelocity v = seen->frame_velocity(i, j);
        const Vector3 rate = (vector(q.position) - vector(p.position)) / (2 * h);
        const Matrix3 turn = Rotation(q.rotation.data()) * Rotation(p.rotation.data()).transpose();
        const Eigen::AngleAxisd spin(turn);
        EXPECT_LT((vector(v.linear) - rate).norm(), 1e-6) << "seed " << seed << " body " << body << " frame " << frame;
        EXPECT_LT((vector(v.angular) - spin.angle() * spin.axis() / (2 * h)).norm(), 1e-6)
            << "seed " << seed << " body " << body << " frame " << frame;
      }
    }
  }
}

TEST_P(Observations, allocate_nothing_and_do_not_remember_another_state) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Case c(seed, {.bodies = 6, .planar = seed % 2 == 0, .any_root = true}, GetParam());
    const auto seen = c.equations->make_observation(), other = c.equations->make_observation();
    other->observe(c.state.y);
    const Energies first = other->energies();
    const std::size_t before = allocations();
    seen->observe(c.scene.initial.y);
    seen->observe(c.state.y);
    const Energies second = seen->energies();
    for (std::size_t b = 0; b < c.scene.model->bodies().size(); ++b) {
      static_cast<void>(seen->frame_pose(static_cast<int>(b), 0));
      static_cast<void>(seen->frame_velocity(static_cast<int>(b), 0));
      static_cast<void>(seen->deflection(static_cast<int>(b), 0));
    }
    EXPECT_EQ(allocations(), before);
    EXPECT_EQ(first.kinetic, second.kinetic);
    EXPECT_EQ(first.potential, second.potential);
    EXPECT_EQ(first.angular_momentum, second.angular_momentum);
  }
}

/// Who watches a run does not ask for a deflection that the expansion of the body's own station gives.
TEST_P(Observations, deflections_of_bodies_that_expand_are_those_of_their_stations) {
  int asked = 0, expanded = 0, of_second_order = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Case c(seed, {.bodies = 5, .planar = seed % 2 == 0}, GetParam());
    const auto seen = c.equations->make_observation();
    seen->observe(c.state.y);
    const Model& model = *c.scene.model;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      if (model.bodies()[b].body->shape().modes() == 0) continue;
      ++asked;
      of_second_order += c.scene.formulation->terms().strain == StrainOrder::quadratic ? 1 : 0;
      if (!seen->expands(static_cast<int>(b))) continue;
      ++expanded;
      for (std::size_t f = 0; f < model.bodies()[b].frames.size(); ++f) {
        const PointExpansion& at = model.bodies()[b].frames[f].section;
        const Eigen::Map<const Eigen::VectorXd> q(c.state.y.data() + model.layout().modes(b)->position, at.phi.cols());
        Vector3 d = at.phi * q;
        for (int k = 0; k < 3; ++k) d[k] += 0.5 * q.dot(at.gamma[static_cast<std::size_t>(k)] * q);
        EXPECT_LT((vector(seen->deflection(static_cast<int>(b), static_cast<int>(f))) - d).norm(), 1e-12)
            << "seed " << seed << ", " << model.bodies()[b].name;
      }
    }
  }
  EXPECT_GT(asked, 5);
  EXPECT_EQ(expanded, of_second_order);
}

INSTANTIATE_TEST_SUITE_P(Formulations, Observations, testing::ValuesIn(formulations), formulation_name);

}  // namespace
}  // namespace withy::test
