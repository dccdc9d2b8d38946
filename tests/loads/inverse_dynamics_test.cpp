#include <cmath>

#include "withy/core/sweep/rigid_inverse_dynamics.hpp"
#include "withy/tests/loads/load_plugins.hpp"

namespace withy {
namespace {

Pose turned(double angle, const Vector3& axis, const Vector3& p) {
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), p};
}

/// A cloud of particles with no symmetry at all.
std::vector<TestBody::Mass> cloud(double s) {
  return {
      {1.3 * s, {0.3, -0.1, 0.2}}, {0.7, {-0.2, 0.4 * s, 0.1}}, {0.4, {0.1, 0.2, -0.5}}, {0.2 * s, {0.6, 0.1, 0.3}}};
}

std::shared_ptr<const Body> cloud_body(double s) {
  return std::make_shared<TestBody>(cloud(s), Matrix3::Zero(), Vector3::Zero());
}

/// Six bodies with oblique frames, hinge offsets and axes: a branch, welds within the tree and to the world.
Model crooked_tree() {
  std::vector<BodyNode> bodies;
  for (int b = 0; b < 6; ++b) {
    bodies.push_back(test_node("body" + std::to_string(b), cloud_body(1 + 0.3 * b),
                               {{"in", "root", turned(0.4 + b, {1, 2, -1}, {0.1, 0.05 * b, -0.2})},
                                {"out", "root", turned(-0.7 * b, {0, 1, 2}, {0.5, -0.1, 0.1 * b})}}));
  }
  const auto node = [](std::string name, std::shared_ptr<const Hinge> hinge, int parent, int child) {
    return HingeNode{std::move(name), std::move(hinge), parent, 2, turned(0.3, {1, 1, 0}, {0.02, 0.3, -0.1}), child, 1};
  };
  return Model(
      std::move(bodies),
      {node("a", test_hinge("weld"), -1, 0), node("b", test_hinge("revolute", {1, 2, 3}), 0, 1),
       node("c", test_hinge("weld"), 1, 2), node("d", test_hinge("prismatic", {1, -1, 0.5}), 2, 3),
       node("e", test_hinge("revolute", {0, 1, -1}), 1, 4), node("f", test_hinge("revolute", {2, 0, 1}), 3, 5)},
      {1, -2, -9.81});
}

/// World positions and masses of all particles, by the poses alone.
std::vector<TestBody::Mass> particles(const Model& model, std::span<const double> x) {
  std::vector<TestBody::Mass> all;
  std::vector<Pose> poses;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const HingeNode& h = model.hinges()[b];
    const Slot& slot = model.layout().hinges[b];
    const auto frame = [](const BodyNode& n, int i) {
      const Frame& f = n.frames[static_cast<std::size_t>(i)];
      return Pose{Matrix3::Identity(), f.section.X} * f.pose;
    };
    Pose pose = h.offset;
    if (h.parent >= 0) {
      const auto p = static_cast<std::size_t>(h.parent);
      pose = poses[p] * frame(model.bodies()[p], h.parent_frame) * h.offset;
    }
    HingeMotion motion;
    const std::vector<double> rates(slot.speeds);
    h.hinge->motion(x.subspan(slot.position, slot.positions), rates, motion);
    pose = pose * motion.pose * frame(model.bodies()[b], h.child_frame).inverse();
    poses.push_back(pose);
    for (const Particle& p : model.bodies()[b].body->shape().particles)
      all.push_back({p.mass, pose.R * p.at.X + pose.p});
  }
  return all;
}

// Principle of d'Alembert, τ_j = Σ m (a − g) · ∂r/∂x_j, with a and ∂r/∂x_j from differences of positions alone: fourth
// order with step 1e-3 leaves about 1e-9 of truncation and 1e-16/1e-6 = 1e-10 of rounding.
TEST(RecursiveNewtonEuler, agrees_with_dalemberts_principle_on_a_crooked_tree) {
  const Model model = crooked_tree();
  const std::size_t n = model.layout().speeds;
  ASSERT_EQ(n, 4u);
  const auto path = [](double t, int derivative) {
    std::vector<double> x(4);
    for (std::size_t i = 0; i < 4; ++i) {
      const double w = 0.7 + 0.4 * static_cast<double>(i);
      x[i] = 0.8 * std::pow(w, derivative) * std::sin(w * t + static_cast<double>(i) + derivative * M_PI / 2);
    }
    return x;
  };
  const RigidInverseDynamics dynamics(model);
  for (const double t : {0.0, 0.9, 2.7}) {
    std::vector<double> tau(n), scratch(dynamics.scratch(), NAN);
    dynamics.efforts(path(t, 0), path(t, 1), path(t, 2), tau, scratch);
    const double h = 1e-3;
    const auto at = [&](double s) { return particles(model, path(t + s, 0)); };
    const auto m2 = at(-2 * h), m1 = at(-h), p0 = at(0), p1 = at(h), p2 = at(2 * h);
    for (std::size_t j = 0; j < n; ++j) {
      const auto moved = [&](double s) {
        std::vector<double> x = path(t, 0);
        x[j] += s;
        return particles(model, x);
      };
      const auto jm2 = moved(-2 * h), jm1 = moved(-h), jp1 = moved(h), jp2 = moved(2 * h);
      double expected = 0;
      for (std::size_t k = 0; k < p0.size(); ++k) {
        const Vector3 a =
            (-m2[k].at + 16 * m1[k].at - 30 * p0[k].at + 16 * p1[k].at - p2[k].at) / (12 * h * h) - model.gravity();
        const Vector3 partial = (jm2[k].at - 8 * jm1[k].at + 8 * jp1[k].at - jp2[k].at) / (12 * h);
        expected += p0[k].mass * a.dot(partial);
      }
      EXPECT_NEAR(tau[j], expected, 1e-7 * std::max(1.0, std::abs(expected))) << "speed " << j << ", t " << t;
    }
  }
}

// Rotary inertia of sections counts as that of the particles it stands for.
TEST(RecursiveNewtonEuler, sections_count_as_the_particles_they_stand_for) {
  const auto masses = cloud(1.4);
  double mass = 0;
  Vector3 center = Vector3::Zero();
  for (const auto& m : masses) mass += m.mass, center += m.mass * m.at;
  center /= mass;
  Matrix3 inertia = Matrix3::Zero();
  for (const auto& m : masses) {
    const Vector3 r = m.at - center;
    inertia += m.mass * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
  }
  const auto tau = [&](const std::shared_ptr<const Body>& body) {
    std::vector<BodyNode> bodies;
    std::vector<HingeNode> hinges;
    for (int b = 0; b < 2; ++b) {
      bodies.push_back(
          test_node(b == 0 ? "inner" : "outer", body, {{"out", "root", turned(1, {1, 1, 2}, {0.3, 0.2, 0})}}));
      hinges.push_back({b == 0 ? "first" : "second", test_hinge("revolute", {1.0 + b, 1, -1}), b - 1, 1, {}, b, 0});
    }
    const Model model(bodies, hinges, {0, 0, -9.81});
    const RigidInverseDynamics dynamics(model);
    std::vector<double> out(2), scratch(dynamics.scratch());
    dynamics.efforts(std::vector{0.4, -1.1}, std::vector{1.7, 0.6}, std::vector{-2.0, 3.0}, out, scratch);
    return out;
  };
  const std::vector<double> a = tau(cloud_body(1.4)), b = tau(test_rigid(mass, center, inertia));
  EXPECT_NEAR(a[0], b[0], 1e-13 * std::abs(a[0]));
  EXPECT_NEAR(a[1], b[1], 1e-13 * std::abs(a[1]));
}

// Euler's equation with the rate in F: M = R (I α + ω × I ω), α = Rᵀ ω̇_F, ω = Rᵀ ω_F; power is M · ω_F.
TEST(RecursiveNewtonEuler, a_spherical_hinge_gives_eulers_equation) {
  const Matrix3 inertia = Vector3(0.5, 0.9, 1.2).asDiagonal();
  const Model model({test_node("top", test_rigid(3, {0, 0, 0}, inertia))},
                    {{.name = "ball", .hinge = test_hinge("spherical"), .offset = {}, .child = 0}}, {0, 0, -9.81});
  const RigidInverseDynamics dynamics(model);
  const Eigen::Quaterniond q = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
  const Vector3 rate(0.4, -1.2, 2.0), rate_dot(3, -1, 0.5);
  std::vector<double> tau(3), scratch(dynamics.scratch());
  dynamics.efforts(std::vector{q.w(), q.x(), q.y(), q.z()}, std::span(rate.data(), 3), std::span(rate_dot.data(), 3),
                   tau, scratch);
  const Matrix3 R = q.toRotationMatrix();
  const Vector3 w = R.transpose() * rate;
  const Vector3 expected = R * (inertia * (R.transpose() * rate_dot) + w.cross(inertia * w));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(tau[i], expected[static_cast<Eigen::Index>(i)], 1e-13);
}

}  // namespace
}  // namespace withy
