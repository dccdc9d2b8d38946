#include "withy/core/analysis/term_ledger.hpp"

#include <algorithm>
#include <cmath>

namespace withy {
namespace {

using Forces = std::vector<double>;

Forces minus(const Forces& a, const Forces& b) {
  Forces f(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) f[i] = a[i] - b[i];
  return f;
}

Forces plus(const Forces& a, const Forces& b) {
  Forces f(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) f[i] = a[i] + b[i];
  return f;
}

/// What one formulation makes of a state: M u̇, its velocity terms with damping, the rest with weight and −K q, and
/// loads.
struct Parts {
  Forces inertia, velocity, rest, loads;
  Parts(const EquationsOfMotion& equations, const State& state, const State& at_rest, std::span<const double> u_dot)
      : inertia(u_dot.size()), rest(u_dot.size()), loads(u_dot.size()) {
    Work work = equations.make_work();
    equations.mass_times(state.y, u_dot, inertia, work);
    const Forces none(u_dot.size());
    Forces moving(u_dot.size());
    equations.inverse_dynamics(state.y, none, moving, work);
    equations.inverse_dynamics(at_rest.y, none, rest, work);
    velocity = minus(rest, moving);
    for (double& f : rest) f = -f;
    equations.load_efforts(state.time, state.y, EquationsOfMotion::all_loads, loads, work);
  }
};

}  // namespace

std::string_view name(Term term) {
  static constexpr std::array<std::string_view, terms_of_motion> names = {
      "M0 a",     "M*1 a",    "M*2 a",    "M*3 a", "f1",   "f2-1",  "f2-2",    "f3",      "weight",
      "weight*1", "weight*2", "weight*3", "K q",   "D q'", "loads", "loads*1", "loads*2", "loads*3"};
  return names.at(static_cast<std::size_t>(term));
}

TermForces TermLedger::evaluate(const State& state, std::span<const double> u_dot) const {
  const Layout& layout = model_.layout();
  State at_rest = state;
  std::fill_n(at_rest.y.begin() + static_cast<std::ptrdiff_t>(layout.positions), layout.speeds, 0.0);
  const Parts ruthless(*of_.ruthless, state, at_rest, u_dot), inconsistent(*of_.inconsistent, state, at_rest, u_dot),
      consistent(*of_.consistent, state, at_rest, u_dot), quadratic(*of_.quadratic, state, at_rest, u_dot);
  TermForces forces;
  const auto set = [&forces](Term term, Forces f) { forces[static_cast<std::size_t>(term)] = std::move(f); };
  Forces stiffness(layout.speeds), damping(layout.speeds);
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    const ModalShape& shape = model_.bodies()[b].body->shape();
    if (shape.modes() == 0) continue;
    const Slot& slot = *layout.modes(b);
    const Eigen::Map<const Eigen::VectorXd> q(state.y.data() + slot.position, shape.modes()),
        rate(state.y.data() + layout.positions + slot.speed, shape.modes());
    Eigen::Map<Eigen::VectorXd>(stiffness.data() + slot.speed, shape.modes()) = shape.stiffness * q;
    Eigen::Map<Eigen::VectorXd>(damping.data() + slot.speed, shape.modes()) = shape.damping * rate;
  }
  // Every formulation has the same stiffness, −K q, and the same damping, −D q̇.
  const auto set_orders = [&](Term zero, Forces Parts::*part, const Forces& beside) {
    const auto first = static_cast<std::size_t>(zero);
    forces[first] = plus(ruthless.*part, beside);
    forces[first + 1] = minus(inconsistent.*part, ruthless.*part);
    forces[first + 2] = minus(consistent.*part, inconsistent.*part);
    forces[first + 3] = minus(quadratic.*part, consistent.*part);
  };
  const Forces none(layout.speeds);
  set_orders(Term::inertia, &Parts::inertia, none);
  set_orders(Term::velocity_rigid, &Parts::velocity, damping);
  set_orders(Term::weight, &Parts::rest, stiffness);
  Forces motions(layout.speeds);
  if (!model_.motions().empty()) {
    Work work = of_.quadratic->make_work();
    if (!of_.quadratic->motion_efforts(state.time, state.y, motions, work).ok()) motions = none;
  }
  set_orders(Term::loads, &Parts::loads, motions);
  set(Term::stiffness, std::move(stiffness));
  set(Term::damping, std::move(damping));
  return forces;
}

std::vector<double> force_balance(const EquationsOfMotion& equations, const State& state,
                                  std::span<const double> u_dot) {
  Work work = equations.make_work();
  Forces force(u_dot.size()), loads(u_dot.size());
  equations.inverse_dynamics(state.y, u_dot, force, work);
  equations.load_efforts(state.time, state.y, EquationsOfMotion::all_loads, loads, work);
  return minus(force, loads);
}

std::vector<CoordinateGroup> coordinate_groups(const Layout& layout) {
  std::vector<CoordinateGroup> groups{{"hinges", {}}, {"bending", {}}, {"torsion", {}}, {"elastic", {}}};
  for (const Slot& hinge : layout.hinges) {
    for (std::size_t i = 0; i < hinge.speeds; ++i) groups[0].speeds.push_back(hinge.speed + i);
  }
  for (const Slot& body : layout.bodies) {
    for (std::size_t i = body.speed; i < body.speed + body.speeds; ++i) {
      const std::string mode = layout.speed_names[i].substr(body.name.size() + 1);
      groups[mode.starts_with("bending") ? 1 : (mode.starts_with("torsion") ? 2 : 3)].speeds.push_back(i);
    }
  }
  std::erase_if(groups, [](const CoordinateGroup& g) { return g.speeds.empty(); });
  return groups;
}

double size_of(const std::vector<double>& forces, const CoordinateGroup& group, const std::vector<double>& inertias) {
  double sum = 0;
  for (const std::size_t i : group.speeds) sum += forces[i] * forces[i] / inertias[i];
  return std::sqrt(sum);
}

}  // namespace withy
