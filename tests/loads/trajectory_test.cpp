#include "withy/loads/trajectory.hpp"

#include <gtest/gtest.h>

namespace withy {
namespace {

const Spline spline({0.5, 1.0, 2.2, 3.0}, {0.3, 1.0, -0.4, 0.2});
const std::vector<Trajectory> trajectories = {Hold{0.7}, Quintic{-0.2, 1.3, 2.5}, BangBang{0.4, -1.1, 2.0},
                                              SineMotion{0.1, 0.8, 0.3, 0.5}, spline};

// Differences over 1e-5 leave 1e-10 of truncation and 1e-11 of rounding; no sample is near a jump.
TEST(Trajectories, rates_and_accelerations_are_derivatives) {
  const double h = 1e-5;
  for (const Trajectory& trajectory : trajectories) {
    for (const double t : {-0.3, 0.2, 0.77, 1.3, 1.9, 2.7, 4.0}) {
      const MotionPoint behind = at(trajectory, t - h), here = at(trajectory, t), ahead = at(trajectory, t + h);
      EXPECT_NEAR(here.rate, (ahead.position - behind.position) / (2 * h), 1e-9) << trajectory.index() << " " << t;
      EXPECT_NEAR(here.acceleration, (ahead.rate - behind.rate) / (2 * h), 1e-9) << trajectory.index() << " " << t;
    }
  }
}

// Across every jump that is declared, position and rate go on; where none is declared, so does the acceleration.
TEST(Trajectories, positions_and_rates_have_no_jumps) {
  for (const Trajectory& trajectory : trajectories) {
    for (const double t : std::visit([](const auto& m) { return m.jumps(); }, trajectory)) {
      const MotionPoint before = at(trajectory, std::nextafter(t, -1)), after = at(trajectory, t);
      EXPECT_NEAR(before.position, after.position, 1e-14) << trajectory.index() << " " << t;
      EXPECT_NEAR(before.rate, after.rate, 1e-14) << trajectory.index() << " " << t;
    }
  }
}

TEST(Trajectories, motions_from_rest_to_rest_keep_their_ends) {
  for (const Trajectory& trajectory : {Trajectory(Quintic{-0.2, 1.3, 2.5}), Trajectory(BangBang{-0.2, 1.3, 2.5})}) {
    EXPECT_EQ(at(trajectory, 0).position, -0.2);
    EXPECT_EQ(at(trajectory, 2.5).position, 1.1);
    EXPECT_EQ(at(trajectory, 2.5).acceleration, 0);
    EXPECT_NEAR(at(trajectory, 1.25).position, 0.45, 1e-15);
  }
}

TEST(BangBang, has_the_one_acceleration_that_arrives_in_time) {
  const BangBang motion{0.4, -1.1, 2.0};
  const double a = 4 * -1.1 / 4;
  EXPECT_EQ(motion(0).acceleration, a);
  EXPECT_EQ(motion(std::nextafter(1, 0)).acceleration, a);
  EXPECT_EQ(motion(1).acceleration, -a);
  EXPECT_EQ(motion(std::nextafter(2, 0)).acceleration, -a);
}

// The cubic 3 r² − 2 r³ is at rest at both ends: the spline through any of its points is the cubic itself.
TEST(Spline, is_exact_for_a_cubic_at_rest_at_its_ends) {
  const auto cubic = [](double r) { return r * r * (3 - 2 * r); };
  std::vector<double> times, positions;
  for (const double r : {0.0, 0.1, 0.45, 0.5, 0.9, 1.0}) {
    times.push_back(1 + 2 * r);
    positions.push_back(cubic(r));
  }
  const Spline motion(times, positions);
  for (double r = 0; r < 1; r += 0.03) {
    const MotionPoint p = motion(1 + 2 * r);
    EXPECT_NEAR(p.position, cubic(r), 1e-15);
    EXPECT_NEAR(p.rate, 6 * r * (1 - r) / 2, 1e-14);
    EXPECT_NEAR(p.acceleration, (6 - 12 * r) / 4, 1e-13);
  }
}

// Any cubic, given its rates at the ends; beyond them the rates stay.
TEST(Spline, is_exact_for_a_cubic_with_its_rates_at_the_ends) {
  const auto cubic = [](double t) { return 0.3 + t * (1.1 + t * (-0.7 + 0.4 * t)); };
  const auto rate = [](double t) { return 1.1 + t * (-1.4 + 1.2 * t); };
  const std::vector<double> times{-0.5, 0.1, 0.4, 1.3, 2.0};
  std::vector<double> positions;
  for (const double t : times) positions.push_back(cubic(t));
  const Spline motion(times, positions, rate(-0.5), rate(2.0));
  for (double t = -0.5; t < 2; t += 0.07) {
    EXPECT_NEAR(motion(t).position, cubic(t), 1e-14);
    EXPECT_NEAR(motion(t).rate, rate(t), 1e-13);
    EXPECT_NEAR(motion(t).acceleration, -1.4 + 2.4 * t, 1e-12);
  }
  EXPECT_NEAR(motion(-1.5).position, cubic(-0.5) - rate(-0.5), 1e-14);
  EXPECT_NEAR(motion(3).position, cubic(2) + rate(2), 1e-14);
  EXPECT_EQ(motion(3).rate, rate(2));
  EXPECT_EQ(motion(3).acceleration, 0);
}

TEST(Spline, goes_through_its_points_and_rests_outside) {
  const double times[] = {0.5, 1.0, 2.2, 3.0}, positions[] = {0.3, 1.0, -0.4, 0.2};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(spline(times[i]).position, positions[i], 1e-15);
  for (const double t : {0.4, 3.0, 9.0}) {
    EXPECT_EQ(spline(t).rate, 0);
    EXPECT_EQ(spline(t).acceleration, 0);
  }
  EXPECT_NEAR(spline(0.5).rate, 0, 1e-15);
  EXPECT_EQ(Spline({2.0}, {0.6})(-1).position, 0.6);
  EXPECT_EQ(Spline({2.0}, {0.6}).end(), 0);
}

}  // namespace
}  // namespace withy
