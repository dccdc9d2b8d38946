/// \file
/// What any formulation must satisfy, built in or foreign, shown on a model given stiff and soft.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "withy/core/plugin/formulation.hpp"

namespace withy::test {

inline std::vector<double> accelerations(const EquationsOfMotion& e, const State& s) {
  std::vector<double> y_dot(e.size());
  Work work = e.make_work();
  work.poison();
  EXPECT_TRUE(e.derivatives(s.time, s.y, y_dot, work).ok());
  const auto first = y_dot.begin() + static_cast<std::ptrdiff_t>(e.layout().positions);
  return {first, first + static_cast<std::ptrdiff_t>(e.layout().speeds)};
}

/// Scales the modal coordinates and rates of a state.
inline State with_deflection(const Model& model, State s, double factor) {
  for (const Slot& b : model.layout().bodies) {
    for (std::size_t i = 0; i < b.speeds; ++i) {
      s.y[b.position + i] *= factor;
      s.y[model.layout().positions + b.speed + i] *= factor;
    }
  }
  return s;
}

/// Order p in ε of the difference of the force vectors f of two formulations at modal coordinates εq, εq̇: the terms
/// that one neglects. From ε and a tenth of it; −1 where there is no difference.
inline double order_of_difference(const Formulation& a, const Formulation& b, std::shared_ptr<const Model> model,
                                  const State& state, double epsilon = 1e-3) {
  const auto ea = a.compile(model);
  const auto eb = b.compile(model);
  const auto difference = [&](double factor) {
    const State s = with_deflection(*model, state, factor);
    const DenseSystem fa = ea->system(0, s.y), fb = eb->system(0, s.y);
    double d = 0;
    double size = 0;
    for (std::size_t i = 0; i < fa.size; ++i) {
      d = std::max(d, std::abs(fa.force[i] - fb.force[i]));
      size = std::max(size, std::abs(fa.force[i]));
    }
    return d < 1e-13 * size ? 0.0 : d;
  };
  const double large = difference(epsilon);
  const double small = difference(0.1 * epsilon);
  if (large == 0) return -1;
  return std::log10(large / small);
}

/// `derivatives` agrees with the dense system it comes with, at several states, whatever is in the work memory; the
/// same input gives the same bits. The residual may be `tolerance` of a row's terms; more than rounding where the two
/// ways to evaluate are discretized differently.
inline void expect_formulation_conforms(const Formulation& formulation, std::shared_ptr<const Model> model,
                                        const State& state, double tolerance = 1e-11) {
  const auto equations = formulation.compile(model);
  ASSERT_NE(equations, nullptr);
  EXPECT_EQ(equations->layout().speed_names, model->layout().speed_names);
  for (const double factor : {0.0, 0.5, 1.0}) {
    const State s = with_deflection(*model, state, factor);
    const std::vector<double> a = accelerations(*equations, s);
    EXPECT_EQ(a, accelerations(*equations, s));
    const DenseSystem d = equations->system(0, s.y);
    ASSERT_EQ(d.size, a.size());
    for (std::size_t i = 0; i < d.size; ++i) {
      double residual = -d.force[i] - d.applied[i];
      double size = std::abs(d.force[i]);
      for (std::size_t j = 0; j < d.size; ++j) {
        residual += d.mass[i * d.size + j] * a[j];
        size += std::abs(d.mass[i * d.size + j] * a[j]);
      }
      EXPECT_LE(std::abs(residual), tolerance * size) << d.size << " speeds, row " << i;
    }
  }
}

/// Whether hinge accelerations depend on the quasi-static deflection: where the mass matrix and the forces of the rigid
/// motion are those of the undeformed body, they do not.
enum class RigidLimit { approached, reached };

/// With stiffness growing tenfold, the quasi-static deflection that balances a rigid motion shrinks tenfold: at that
/// deflection the hinge accelerations approach those of the rigid model in proportion to 1/EI. `models(EI factor)`
/// makes the model; `rigid` has no modes and the same hinges, of which `speed` is one.
inline void expect_rigid_limit(const Formulation& formulation,
                               const std::function<std::shared_ptr<const Model>(double)>& models,
                               const std::function<State(const Model&)>& state, const std::string& hinge,
                               RigidLimit answer) {
  const auto acceleration = [&](double factor) {
    const auto model = models(factor);
    const auto equations = formulation.compile(model);
    State s = with_deflection(*model, state(*model), 0.0);
    // Newton's iteration for q with q̈ = 0, q̇ = 0: the modal block of the residual, differentiated numerically.
    std::vector<std::size_t> q, v;
    for (const Slot& b : model->layout().bodies) {
      for (std::size_t i = 0; i < b.speeds; ++i) {
        q.push_back(b.position + i);
        v.push_back(b.speed + i);
      }
    }
    const auto n = static_cast<Eigen::Index>(q.size());
    const auto modal = [&](const State& at) {
      const std::vector<double> a = accelerations(*equations, at);
      Eigen::VectorXd r(n);
      for (Eigen::Index i = 0; i < n; ++i) r[i] = a[v[static_cast<std::size_t>(i)]];
      return r;
    };
    for (int iteration = 0; iteration < 6; ++iteration) {
      const Eigen::VectorXd r = modal(s);
      Eigen::MatrixXd J(n, n);
      for (Eigen::Index j = 0; j < n; ++j) {
        State ahead = s;
        const double h = 1e-6 / factor;
        ahead.y[q[static_cast<std::size_t>(j)]] += h;
        J.col(j) = (modal(ahead) - r) / h;
      }
      const Eigen::VectorXd step = J.partialPivLu().solve(r);
      for (Eigen::Index j = 0; j < n; ++j) s.y[q[static_cast<std::size_t>(j)]] -= step[j];
    }
    return accelerations(*equations, s)[model->layout().hinge(hinge)->speed];
  };
  const double far = acceleration(1e2);
  const double near = acceleration(1e3);
  const double nearer = acceleration(1e4);
  if (answer == RigidLimit::reached) {
    EXPECT_NEAR(far, nearer, 1e-9 * std::abs(nearer));
  } else {
    // First differences of a + b/EI: (1e-2 − 1e-3)/(1e-3 − 1e-4) = 10.
    EXPECT_GT(std::abs(far - near), 1e-9 * std::abs(nearer));
    EXPECT_NEAR((far - near) / (near - nearer), 10.0, 0.5);
  }
}

}  // namespace withy::test
