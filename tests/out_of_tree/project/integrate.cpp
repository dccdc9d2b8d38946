// Integrates the equations of motion by a method of its own, ROS2 of Verwer and others (1999): linearly implicit with
// the exact Jacobian, so that steps may be longer than bending modes allow explicit ones.
#include <Eigen/LU>
#include <cstdio>
#include <exception>
#include <withy/host/equations.hpp>
#include <withy/host/simulation.hpp>

using withy::host::Equations;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

static auto span(auto& x) { return std::span(x.data(), static_cast<std::size_t>(x.size())); }

static Eigen::VectorXd rates(Equations& f, double t, const Eigen::VectorXd& y) {
  Eigen::VectorXd y_dot(y.size());
  if (const auto e = f.derivatives(t, span(y), span(y_dot)); !e.ok()) throw std::runtime_error(f.reason(t, e));
  return y_dot;
}

static void step(Equations& f, double t, double h, Eigen::VectorXd& y) {
  constexpr double gamma = 0.2928932188134524;  // 1 − √½
  RowMajor J(y.size(), y.size());
  f.jacobian(t, span(y), span(J));
  const Eigen::PartialPivLU<RowMajor> lu(RowMajor::Identity(y.size(), y.size()) - gamma * h * J);
  const Eigen::VectorXd k1 = lu.solve(rates(f, t, y)), k2 = lu.solve(rates(f, t + h, y + h * k1) - 2 * k1);
  y += h * (1.5 * k1 + 0.5 * k2);
  f.normalize(span(y));  // quaternions, where there are any
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const withy::host::Library library;
    const auto scene = withy::host::Scene::read(library, argv[1]).set("integrator.rtol", 1e-9);
    Equations f(scene, "quadratic");  // one a thread: copies share what is compiled
    f.set_input("command", 2);
    Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(f.y0().data(), static_cast<Eigen::Index>(f.size()));
    for (int k = 0; k < 1000; ++k) step(f, 0.001 * k, 0.001, y);

    withy::host::Simulation simulation(scene);  // the same by the integrator of the scene
    simulation.set_input("command", 2);
    simulation.step(1);
    std::printf("shoulder %.6f rad, %.1e from the simulation's\n", y[0], y[0] - simulation.output("shoulder"));
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
