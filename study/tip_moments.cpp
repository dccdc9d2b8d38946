#include "withy/study/tip_moments.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "withy/core/simulation/tips.hpp"

namespace withy::study {
namespace {

/// Part of its own mass from which what a flexible body carries is looked at; part of the deflection by which other
/// functions have to do better, and bodies of a tree that are looked at; a gravity [m/s²] that bends nothing far.
constexpr double carries_something = 0.2, noticeable = 0.015, weak = 1e-6;
constexpr std::size_t few_enough = 20;
constexpr std::size_t most_functions = 100;  ///< that polynomials have

/// Of each body, its own mass, and that of all that hangs on it without itself.
struct Masses {
  std::vector<double> own, carried;
};

Masses masses_of(const Model& model) {
  Masses m{std::vector<double>(model.bodies().size()), std::vector<double>(model.bodies().size())};
  for (std::size_t b = model.bodies().size(); b-- > 0;) {
    for (const Particle& p : model.bodies()[b].body->shape().particles) m.own[b] += p.mass;
    const int parent = model.hinges()[b].parent;
    if (parent >= 0) m.carried[static_cast<std::size_t>(parent)] += m.carried[b] + m.own[b];
  }
  return m;
}

/// Deflections of tips by their body's name, under its weight and that of all it carries along the world's axes in
/// turn, all hinges held and all other bodies straight, over the acceleration [s²]; nothing of bodies that have no tip.
using Sags = std::map<std::string, std::vector<std::array<double, 3>>>;

Sags sags_of(const SceneValues& values, const std::set<std::string>& bodies, Registry& registry) {
  Sags all;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    SceneValues weighed = values;
    std::vector<Value> gravity(3, Value(0.0));
    gravity[axis] = Value(weak);
    const std::string origin = "a load to compare functions by";
    const Prepared p = prepare(weighed.set("gravity", Value::list(gravity), origin), registry);
    const Layout& layout = p.model().layout();
    State state = p.scene.initial;
    for (const Slot& s : layout.bodies)
      std::fill_n(state.y.begin() + static_cast<std::ptrdiff_t>(s.position), s.positions, 0.0);
    std::fill_n(state.y.begin() + static_cast<std::ptrdiff_t>(layout.positions), layout.speeds, 0.0);
    const std::vector<double> still(layout.speeds, 0.0);
    std::vector<double> needed(layout.speeds);
    Work work = p.equations->make_work();
    p.equations->inverse_dynamics(state.y, still, needed, work);
    for (const Tip& tip : tips(p.model())) {
      if (!bodies.contains(tip.body) || tip.in_segments()) continue;
      const auto b = static_cast<std::size_t>(tip.tip.body);
      const Slot& slot = *layout.modes(b);
      const Eigen::MatrixXd& stiffness = p.model().bodies()[b].body->shape().stiffness;
      const Eigen::VectorXd q = -stiffness.ldlt().solve(
          Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(needed.data() + slot.speed, stiffness.rows())));
      std::copy(q.begin(), q.end(), state.y.begin() + static_cast<std::ptrdiff_t>(slot.position));
      all[tip.body].push_back(p.equations->deflection(state.y, tip.tip.body, tip.tip.frame));
    }
  }
  return all;
}

double norm(const std::array<double, 3>& v) { return std::hypot(v[0], v[1], v[2]); }

/// Gives the bending of a body functions that carry a moment at the tip, as many as it has of those that do not; says
/// which, nothing where it has none.
std::string carry_moments(const Prepared& prepared, const std::string& name, SceneValues& values) {
  std::string counts;
  for (const BodyModes& body : prepared.scene.modes) {
    if (body.body != name) continue;
    for (const ModeCount& count : body.counts) {
      if (count.family_path.empty() || count.family_id() != "clamped-free" || count.modes == 0 ||
          count.modes > most_functions)
        continue;
      values.set("bodies." + name + "." + count.family_path, Value(std::string("orthogonal-polynomials")),
                 "functions with a moment at the tip");
      counts += fmt::format("{}{} {}", counts.empty() ? "" : " and ", count.modes, count.strain);
    }
  }
  return counts;
}

/// How far two lists of deflections are apart, over the greatest of the second.
double relative_distance(const std::vector<std::array<double, 3>>& ours,
                         const std::vector<std::array<double, 3>>& theirs) {
  double greatest = 0, apart = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    greatest = std::max(greatest, norm(theirs[i]));
    apart = std::max(apart, norm({ours[i][0] - theirs[i][0], ours[i][1] - theirs[i][1], ours[i][2] - theirs[i][2]}));
  }
  return greatest > 0 ? apart / greatest : 0;
}

}  // namespace

void look_at_tip_moments(const Prepared& prepared, Registry& registry, std::vector<Remark>& all) {
  const Model& model = prepared.model();
  const Masses masses = masses_of(model);
  // Functions without a moment at the tip converge like 1/n where another body hangs there. How far they are, as many
  // functions that carry one tell: all bodies at once, for each is looked at with all others straight.
  SceneValues values = prepared.values;
  std::map<std::string, std::string> counts;
  std::set<std::string> bodies;
  for (std::size_t b = 0; b < model.bodies().size() && bodies.size() < few_enough; ++b) {
    const BodyNode& node = model.bodies()[b];
    if (node.body->shape().modes() == 0 || node.segment) continue;
    if (masses.carried[b] < carries_something * masses.own[b]) continue;
    std::string changed = carry_moments(prepared, node.name, values);
    if (changed.empty()) continue;
    counts.emplace(node.name, std::move(changed));
    bodies.insert(node.name);
  }
  if (bodies.empty()) return;
  const Sags ours = sags_of(prepared.values, bodies, registry), theirs = sags_of(values, bodies, registry);
  for (const BodyNode& node : model.bodies()) {
    const auto own = ours.find(node.name);
    if (own == ours.end() || node.segment) continue;
    const double off = relative_distance(own->second, theirs.at(node.name));
    if (!(off > noticeable)) continue;
    all.push_back({prepared.scene.source.at("bodies").at(node.name).place(),
                   fmt::format("{} modes of clamped-free carry no moment at the tip, where other bodies hang: under "
                               "their weight it deflects {:.2g} % otherwise than with as many of family: "
                               "orthogonal-polynomials, and that error falls like 1/n only; choose these, or "
                               "clamped-loaded with that load",
                               counts.at(node.name), 100 * off)});
  }
}

}  // namespace withy::study
