#include "withy/core/model/closing.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "withy/core/model/model.hpp"

namespace withy {
namespace {

/// Two unit vectors across a direction and each other.
std::pair<Vector3, Vector3> across(const Vector3& n) {
  Eigen::Index least = 0;
  n.cwiseAbs().minCoeff(&least);
  const Vector3 first = n.cross(Vector3::Unit(least)).normalized();
  return {first, n.cross(first)};
}

double left_over(const ClosingEquation& e, const Pose& M) {
  return (e.of_directions ? e.a.dot(M.R * e.b) : e.a.dot(M.p)) - e.value;
}

/// The directions that a hinge turns about and slides along, at its reference.
struct Freedoms {
  std::vector<Vector3> turns, slides;
  bool pure = true;  ///< each rate does one of both
};

Freedoms freedoms_of(const HingeMotion& motion) {
  Freedoms f;
  for (Eigen::Index i = 0; i < motion.H.cols(); ++i) {
    const Vector3 w = motion.H.col(i).head<3>(), v = motion.H.col(i).tail<3>();
    f.pure = f.pure && (w.isZero(0) != v.isZero(0));
    if (!w.isZero(0)) f.turns.emplace_back(w.normalized());
    if (!v.isZero(0)) f.slides.emplace_back(v.normalized());
  }
  return f;
}

void add_directions(const std::vector<Vector3>& turns, std::vector<ClosingEquation>& equations) {
  if (turns.empty()) {
    for (Eigen::Index i = 0; i < 3; ++i) equations.push_back({true, Vector3::Unit(i), Vector3::Unit((i + 1) % 3), 0});
  } else if (turns.size() == 1) {
    const auto [first, second] = across(turns[0]);
    equations.push_back({true, first, turns[0], 0});
    equations.push_back({true, second, turns[0], 0});
  } else if (turns.size() == 2) {
    equations.push_back({true, turns[0], turns[1], turns[0].dot(turns[1])});
  }
}

void add_positions(const std::vector<Vector3>& slides, std::vector<ClosingEquation>& equations) {
  if (slides.empty()) {
    for (Eigen::Index i = 0; i < 3; ++i) equations.push_back({false, Vector3::Unit(i), {0, 0, 0}, 0});
  } else if (slides.size() == 1) {
    const auto [first, second] = across(slides[0]);
    equations.push_back({false, first, {0, 0, 0}, 0});
    equations.push_back({false, second, {0, 0, 0}, 0});
  } else if (slides.size() == 2) {
    equations.push_back({false, slides[0].cross(slides[1]).normalized(), {0, 0, 0}, 0});
  }
}

/// reaches_of_speeds of a hinge, of which `motion` is that at its reference.
void reaches_of_hinge(const HingeMotion& motion, double length, double* reaches) {
  for (Eigen::Index i = 0; i < motion.H.cols(); ++i)
    reaches[i] = length * motion.H.col(i).head<3>().norm() + motion.H.col(i).tail<3>().norm();
}

/// reaches_of_speeds of a body's modes.
void reaches_of_modes(const BodyNode& body, double length, double* reaches) {
  const auto look = [&](const PointExpansion& at, bool turns) {
    for (Eigen::Index i = 0; i < at.phi.cols(); ++i)
      reaches[i] = std::max(reaches[i], at.phi.col(i).norm() + (turns ? length * at.psi.col(i).norm() : 0));
  };
  const ModalShape& shape = body.body->shape();
  for (const Particle& p : shape.particles) look(p.at, false);
  for (const Section& s : shape.sections) look(s.at, true);
  for (const Frame& f : body.frames) look(f.section, true);
}

/// The motion of a hinge that stands at its reference.
HingeMotion at_reference(const Hinge& hinge) {
  std::vector<double> x(hinge.coordinates());
  const std::vector<double> rates(hinge.speeds(), 0.0);
  hinge.reference(x);
  HingeMotion motion;
  motion.H.resize(6, static_cast<Eigen::Index>(hinge.speeds()));
  hinge.motion(x, rates, motion);
  return motion;
}

/// Whether a body, −1 being the world, is `carrier` or carried by it.
bool carries(const Model& model, std::size_t carrier, int body) {
  while (body >= 0 && static_cast<std::size_t>(body) != carrier)
    body = model.hinges()[static_cast<std::size_t>(body)].parent;
  return body >= 0;
}

}  // namespace

std::optional<std::vector<ClosingEquation>> closing_equations(const Hinge& hinge) {
  constexpr double rounding = 1e-12;
  std::vector<double> x(hinge.coordinates()), rates(hinge.speeds(), 0.0), x_dot(hinge.coordinates());
  hinge.reference(x);
  HingeMotion motion = at_reference(hinge);
  const Freedoms freedoms = freedoms_of(motion);
  if (!freedoms.pure || !motion.pose.R.isIdentity(rounding) || !motion.pose.p.isZero(rounding)) return {};
  std::vector<ClosingEquation> equations;
  add_positions(freedoms.slides, equations);
  add_directions(freedoms.turns, equations);
  if (equations.empty() || equations.size() + hinge.speeds() != 6) return {};
  // A hinge that moves otherwise elsewhere is none of those: it is taken through poses along all its rates.
  for (int step = 1; step <= 24; ++step) {
    for (std::size_t i = 0; i < rates.size(); ++i) rates[i] = std::sin(1.7 * step + 2.3 * static_cast<double>(i));
    hinge.derivatives(x, rates, x_dot);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 0.4 * x_dot[i];
    hinge.normalize(x);
    hinge.motion(x, rates, motion);
    for (const ClosingEquation& e : equations)
      if (!(std::abs(left_over(e, motion.pose)) <= rounding * (1 + motion.pose.p.norm()))) return {};
  }
  return equations;
}

LoopClosure::LoopClosure(const Model& model, std::string name, FrameIndex a, FrameIndex b, Pose offset,
                         std::vector<ClosingEquation> equations)
    : name_(std::move(name)), a_(a), b_(b), offset_(std::move(offset)), equations_(std::move(equations)) {
  if (a.body < 0 && b.body < 0) throw std::invalid_argument("both its frames are in the world: it closes nothing");
  if (a.body == b.body)
    throw std::invalid_argument("both its frames are on body '" +
                                model.bodies()[static_cast<std::size_t>(a.body)].name +
                                "'; a loop is closed between two bodies, or a body and the world");
}

std::vector<const LoopClosure*> loops_of(const Model& model) {
  std::vector<const LoopClosure*> loops;
  for (const LoadNode& load : model.loads())
    if (const auto* loop = dynamic_cast<const LoopClosure*>(load.load.get())) loops.push_back(loop);
  return loops;
}

bool in_loop(const Model& model, std::size_t body) {
  for (const LoopClosure* loop : loops_of(model))
    if (carries(model, body, loop->a().body) != carries(model, body, loop->b().body)) return true;
  return false;
}

std::vector<bool> hinges_in_loops(const Model& model) {
  std::vector<bool> all(model.hinges().size()), way(all.size());
  for (const LoopClosure* loop : loops_of(model)) {
    std::fill(way.begin(), way.end(), false);
    for (int end : {loop->a().body, loop->b().body})
      for (; end >= 0; end = model.hinges()[static_cast<std::size_t>(end)].parent) {
        const auto body = static_cast<std::size_t>(end);
        way[body] = !way[body];  // what carries both ends is met twice
      }
    for (std::size_t h = 0; h < all.size(); ++h) all[h] = all[h] || way[h];
  }
  return all;
}

std::vector<bool> speeds_in_loops(const Model& model) {
  const Layout& layout = model.layout();
  std::vector<bool> all(layout.speeds);
  const auto add = [&all](const Slot* slot) {
    for (std::size_t i = 0; slot != nullptr && i < slot->speeds; ++i) all[slot->speed + i] = true;
  };
  const std::vector<bool> in_loops = hinges_in_loops(model);
  for (std::size_t h = 0; h < in_loops.size(); ++h) {
    if (!in_loops[h]) continue;
    add(&layout.hinges[h]);
    add(layout.modes(h));
    if (const int parent = model.hinges()[h].parent; parent >= 0) add(layout.modes(static_cast<std::size_t>(parent)));
  }
  return all;
}

// Frames that nothing joins do not count: they are no part of what moves, and reactions that depend on this length, as
// those of redundant loops do, are the same whatever else a scene watches or loads.
double length_of_loops(const Model& model) {
  double size = 0;
  const auto reach = [&](int body, int frame) {
    if (body < 0) return;
    const Frame& f = model.bodies()[static_cast<std::size_t>(body)].frames[static_cast<std::size_t>(frame)];
    size = std::max(size, (f.section.X + f.pose.p).norm());
  };
  for (const BodyNode& body : model.bodies())
    if (body.body->shape().modes() > 0) size = std::max(size, body.body->shape().length);
  for (const HingeNode& hinge : model.hinges()) {
    reach(hinge.parent, hinge.parent_frame);
    reach(hinge.child, hinge.child_frame);
    size = std::max(size, hinge.offset.p.norm());
  }
  for (const LoopClosure* c : loops_of(model)) {
    for (const FrameIndex& f : {c->a(), c->b()}) reach(f.body, f.frame);
    size = std::max(size, c->offset().p.norm());
  }
  return size > 0 ? size : 1;
}

std::vector<double> reaches_of_speeds(const Model& model, double length) {
  const Layout& layout = model.layout();
  std::vector<double> all(layout.speeds, 0.0);
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    reaches_of_hinge(at_reference(*model.hinges()[h].hinge), length, all.data() + layout.hinges[h].speed);
    if (const Slot* modes = layout.modes(h)) reaches_of_modes(model.bodies()[h], length, all.data() + modes->speed);
  }
  for (double& reach : all)
    if (!(reach > 0)) reach = 1;
  return all;
}

void require_tree(const Model& model, const std::string& what) {
  if (const auto loops = loops_of(model); !loops.empty())
    throw std::invalid_argument(what + " knows nothing of closed loops (constraints." + loops.front()->name() + ")");
}

}  // namespace withy
