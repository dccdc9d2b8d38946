/// \file
/// Problems with known solutions that integrators are measured on.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "withy/core/plugin/integrator.hpp"
#include "withy/tests/conformance/function_equations.hpp"

namespace withy {

/// Duffing's oscillator ẍ = −x − x³ from (1, 0). Solution x = cn(√2 t, k = ½): with x = A cn(Ωt, k), Ω² = 1 + A²,
/// k² = A²/(2Ω²) (Nayfeh & Mook, Nonlinear Oscillations, section 2.1). Work: ∫ x² dt, which has no part in x.
struct Duffing {
  static FunctionEquations equations() {
    FunctionEquations e(1, 1, [](double, std::span<const double> y, std::span<double> f) {
      f[0] = y[1];
      f[1] = -y[0] - y[0] * y[0] * y[0];
      f[2] = y[0] * y[0];
      return Evaluation{};
    });
    e.stiffness_ = {1};
    return e;
  }
  static State start() { return {0, {1, 0, 0}}; }
  /// Greatest error of x and ẋ.
  static double error(double t, std::span<const double> y) {
    double cn = 0, dn = 0;
    const double sn = boost::math::jacobi_elliptic(0.5, std::sqrt(2.0) * t, &cn, &dn);
    return std::max(std::abs(y[0] - cn), std::abs(y[1] + std::sqrt(2.0) * sn * dn));
  }
};

/// ẍ = −x + s(t).
inline FunctionEquations pushed_oscillator(double (*force)(double)) {
  FunctionEquations e(1, 1, [force](double t, std::span<const double> y, std::span<double> f) {
    f[0] = y[1];
    f[1] = -y[0] + force(t);
    f[2] = 0;
    return Evaluation{};
  });
  e.stiffness_ = {1};
  return e;
}

/// ẍ = −x + s(t) from rest at 0; s jumps at 0.7 and 1.9.
struct SwitchedOscillator {
  static constexpr double first = 0.7, second = 1.9, end = 3.1;
  static double force(double t) { return t < first ? 1 : (t < second ? -1 : 1); }
  static FunctionEquations equations() { return pushed_oscillator(force); }
  static State start() { return {0, {0, 0, 0}}; }
  /// Greatest error of x and ẋ at the end: rotation by the time passed about the force's equilibrium, three times.
  static double error(std::span<const double> y) {
    double x = 0, v = 0;
    const auto turn = [&](double centre, double angle) {
      const double d = x - centre;
      x = centre + d * std::cos(angle) + v * std::sin(angle);
      v = v * std::cos(angle) - d * std::sin(angle);
    };
    turn(1, first);
    turn(-1, second - first);
    turn(1, end - second);
    return std::max(std::abs(y[0] - x), std::abs(y[1] - v));
  }
};

/// A quaternion turned by a constant angular velocity ω about (1, 2, 2)/3.
struct Rotation {
  static constexpr double rate = 3;
  static FunctionEquations equations() {
    FunctionEquations e(4, 3, [](double, std::span<const double> y, std::span<double> f) {
      const double a = y[4], b = y[5], c = y[6];
      f[0] = -0.5 * (a * y[1] + b * y[2] + c * y[3]);
      f[1] = 0.5 * (a * y[0] + b * y[3] - c * y[2]);
      f[2] = 0.5 * (b * y[0] + c * y[1] - a * y[3]);
      f[3] = 0.5 * (c * y[0] + a * y[2] - b * y[1]);
      std::fill(f.begin() + 4, f.end(), 0.0);
      return Evaluation{};
    });
    e.normalize_ = [](std::span<double> y) {
      const double n = norm(y);
      for (std::size_t i = 0; i < 4; ++i) y[i] /= n;
    };
    return e;
  }
  static State start() { return {0, {1, 0, 0, 0, rate / 3, 2 * rate / 3, 2 * rate / 3, 0}}; }
  static double norm(std::span<const double> y) {
    return std::sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3]);
  }
  static double error(double t, std::span<const double> y) {
    const double half = rate * t / 2;
    return std::max(std::abs(y[0] - std::cos(half)), std::abs(y[1] - std::sin(half) / 3));
  }
};

/// The harmonic oscillator, until from `from` on every evaluation fails in a given way.
struct Failing {
  Evaluation evaluation{};  ///< what an evaluation returns from then on
  double rate = 0;          ///< ẋ from then on
  double from = 0.5;        ///< [s]
  FunctionEquations equations() const {
    FunctionEquations e(1, 1, [*this](double t, std::span<const double> y, std::span<double> f) {
      f[0] = y[1];
      f[1] = -y[0];
      f[2] = 0;
      if (t < from) return Evaluation{};
      f[0] = rate;
      return evaluation;
    });
    e.stiffness_ = {1};
    return e;
  }
};

/// Steps to t_limit; returns the first result that is not ok. The number of steps is bounded so that a stepper that
/// does not get on is a failure, not a test that hangs.
inline StepResult drive(Stepper& stepper, double t_limit, std::size_t most_steps = 1'000'000) {
  while (stepper.state().time < t_limit) {
    if (most_steps-- == 0) throw std::runtime_error("the stepper does not get on");
    const StepResult r = stepper.step(t_limit);
    if (r.outcome != StepResult::Outcome::ok) return r;
  }
  return {};
}

/// Discrete states are the step's, bit by bit, at 101 places in each of 20 steps: some are numbers of things, and what
/// is a rounding below 1 is cut off to 0.
template <class Start>
void expect_discrete_states_kept(const Start& start) {
  Layout layout = Duffing::equations().layout();
  layout.discrete = 3;
  FunctionEquations equations(layout, [](double, std::span<const double> y, std::span<double> f) {
    f[0] = y[1];
    f[1] = -y[0];
    f[2] = f[3] = f[4] = f[5] = 0;
    return Evaluation{};
  });
  equations.stiffness_ = {1};
  const std::vector<double> discrete = {1, 0.1, -3};
  const std::unique_ptr<Stepper> stepper = start(equations, State{0, {1, 0, 1, 0.1, -3, 0}});
  std::vector<double> y(6);
  for (int step = 0; step < 20; ++step) {
    const double before = stepper->state().time;
    ASSERT_EQ(stepper->step(10).outcome, StepResult::Outcome::ok);
    for (int i = 0; i <= 100; ++i) {
      stepper->interpolate(before + i / 100.0 * (stepper->state().time - before), y);
      ASSERT_EQ(std::vector<double>(y.begin() + 2, y.begin() + 5), discrete) << i << " hundredths of a step";
    }
  }
}

/// One stepper goes on, another is saved and restored after every step and restarted as often: their states and
/// counts agree bit by bit, and what is within their steps.
template <class Start>
void expect_the_same_when_resumed(const Start& start, const EquationsOfMotion& equations, const State& initial) {
  const std::unique_ptr<Stepper> whole = start(equations, initial);
  std::unique_ptr<Stepper> pieces = start(equations, initial);
  for (const double limit : {0.3, 0.7, 2.3}) {
    while (whole->state().time < limit) {
      ASSERT_EQ(whole->step(limit).outcome, StepResult::Outcome::ok);
      const State state = pieces->state();
      const std::vector<double> memory = pieces->memory();
      pieces = start(equations, initial);
      pieces->resume(state, memory);
      ASSERT_EQ(pieces->step(limit).outcome, StepResult::Outcome::ok);
      ASSERT_EQ(pieces->state().time, whole->state().time);
      ASSERT_EQ(std::memcmp(pieces->state().y.data(), whole->state().y.data(), state.y.size() * sizeof(double)), 0);
      EXPECT_EQ(pieces->memory(), whole->memory());
      std::vector<double> inside(state.y.size()), here(state.y.size());
      const double t = 0.3 * state.time + 0.7 * whole->state().time;
      whole->interpolate(t, inside);
      pieces->interpolate(t, here);
      EXPECT_EQ(here, inside) << "within the step";
    }
    whole->restart();
    pieces->restart();
  }
  std::vector<double> memory = whole->memory();
  memory.push_back(0);
  EXPECT_THROW(pieces->resume(whole->state(), memory), std::invalid_argument);
  memory.resize(memory.size() / 2);
  EXPECT_THROW(pieces->resume(whole->state(), memory), std::invalid_argument);
}

}  // namespace withy
