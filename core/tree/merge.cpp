#include <algorithm>

#include "withy/core/shape/section_fields.hpp"
#include "withy/core/tree/rigid_inertia.hpp"
#include "withy/core/tree/steps.hpp"

namespace withy::compilation {
namespace {

double largest(const Eigen::MatrixXd& m) { return m.size() > 0 ? m.cwiseAbs().maxCoeff() : 0; }

/// Whether the modes of a body move a section of it, beyond what rounding leaves of shape functions that vanish there:
/// 1e-12 of how they move its mass, rotations times the body's extent.
bool moves(const PointExpansion& e, const ModalShape& shape) {
  double extent = 0, first = 0, second = 0;
  for (const Particle& p : shape.particles) {
    extent = std::max(extent, p.at.X.norm());
    first = std::max(first, largest(p.at.phi));
    for (const Eigen::MatrixXd& gamma : p.at.gamma) second = std::max(second, largest(gamma));
  }
  constexpr double rounding = 1e-12;
  const auto beyond = [](const Eigen::MatrixXd& m, double size) { return largest(m) > rounding * size; };
  bool any = beyond(e.phi, first) || beyond(extent * e.psi, first);
  for (std::size_t c = 0; c < 3; ++c) any = any || beyond(e.gamma[c], second) || beyond(extent * e.theta[c], second);
  return any;
}

/// Turns the model's bodies into nodes.
class Merger {
 public:
  explicit Merger(const Model& model) : model_(model) { tree_.places.resize(model.bodies().size()); }

  PlacedTree run() {
    for (const std::size_t b : by_name()) place(b);
    return std::move(tree_);
  }

 private:
  /// The bodies, each before those that hang on it, siblings by the names of their hinges: sums over siblings then do
  /// not depend on the order in which a scene has them, to the last bit.
  [[nodiscard]] std::vector<std::size_t> by_name() const {
    const std::size_t n = model_.bodies().size();
    std::vector<std::vector<std::size_t>> children(n + 1);  // of the world last
    for (std::size_t b = 0; b < n; ++b) {
      const int parent = model_.hinges()[b].parent;
      children[parent < 0 ? n : static_cast<std::size_t>(parent)].push_back(b);
    }
    std::vector<std::size_t> order, open{n};
    while (!open.empty()) {
      const std::size_t b = open.back();
      open.pop_back();
      if (b < n) order.push_back(b);
      // The last is taken first.
      std::sort(children[b].begin(), children[b].end(),
                [&](std::size_t a, std::size_t c) { return model_.hinges()[a].name > model_.hinges()[c].name; });
      open.insert(open.end(), children[b].begin(), children[b].end());
    }
    return order;
  }

  void place(std::size_t b) {
    const HingeNode& h = model_.hinges()[b];
    const BodyNode& body = model_.bodies()[b];
    const Frame& root = body.frames[static_cast<std::size_t>(h.child_frame)];
    const bool flexible = body.body->shape().modes() > 0;
    const bool clamped = !moves(root.section, body.body->shape());
    const auto kernel = h.hinge->kernel();
    const bool weld = kernel && kernel->kind == HingeKernel::Kind::weld;
    BodyPlace F{-1, -1, h.offset};
    if (h.parent >= 0) F = place_of(static_cast<std::size_t>(h.parent), h.parent_frame, h.offset);

    if (weld && clamped) {
      // The child's frame where it is fixed; X_FB of the body frame in the hinge frame.
      const BodyPlace at_frame{F.node, F.station, F.pose * (at(root.section.X) * root.pose).inverse()};
      if (!flexible) {
        fix_rigid(b, at_frame);
        return;
      }
      if (F.node >= 0 && F.station < 0 && node(F.node).modes == 0) {
        absorb_flexible(b, at_frame);
        return;
      }
    }
    new_node(b, F, root, clamped);
  }

  NodeSpec& node(int i) { return tree_.nodes[static_cast<std::size_t>(i)]; }

  /// BodyPlace of `offset` in a frame of a body.
  BodyPlace place_of(std::size_t b, int frame, const Pose& offset) {
    const Frame& f = model_.bodies()[b].frames[static_cast<std::size_t>(frame)];
    const BodyPlace& body = tree_.places[b];
    const Pose in_section = f.pose * offset;
    // Where the hinge holds a section that the modes move, the body's own frame moves too: no place on it is rigid.
    const bool floats = body.node >= 0 && body.station < 0 && node(body.node).root_station >= 0;
    if (!moves(f.section, model_.bodies()[b].body->shape()) && !floats)
      return {body.node, body.station, body.pose * at(f.section.X) * in_section};
    // A flexible body's frame is always placed on its node's frame.
    return {body.node, station(body.node, moved(f.section, body.pose)), turned(body.pose.R) * in_section};
  }

  int station(int node_index, PointExpansion e) {
    std::vector<StationSpec>& stations = node(node_index).stations;
    for (std::size_t i = 0; i < stations.size(); ++i) {
      if (same_section(stations[i].at, e)) return static_cast<int>(i);
    }
    stations.push_back({std::move(e), {}});
    return static_cast<int>(stations.size()) - 1;
  }

  void fix_rigid(std::size_t b, const BodyPlace& where) {
    const std::string& name = model_.bodies()[b].name;
    tree_.places[b] = where;
    if (where.node < 0) {
      tree_.savings.push_back("'" + name + "' is fixed to the world: not modelled");
      return;
    }
    const RigidInertia I = rigid_inertia(model_.bodies()[b].body->shape()).seen_from(where.pose);
    NodeSpec& n = node(where.node);
    if (where.station < 0) {
      n.base += I;
      tree_.savings.push_back("'" + name + "' is rigidly part of '" + n.name + "'");
    } else {
      n.stations[static_cast<std::size_t>(where.station)].carried += I;
      tree_.savings.push_back("'" + name + "' is carried by a section of '" + n.name + "'");
    }
  }

  void take_modes(std::size_t b, NodeSpec& n, const Pose& where) {
    const BodyNode& body = model_.bodies()[b];
    const ModalShape& shape = body.body->shape();
    const Slot& slot = *model_.layout().modes(b);
    n.body = static_cast<int>(b);
    n.modes = slot.speeds;
    n.mode_position = slot.position;
    n.mode_speed = slot.speed;
    n.stiffness = shape.stiffness;
    n.damping = shape.damping;
    n.rod = body.body->rod();
    n.rod_frame = where;
    n.mass = PlacedMass(std::shared_ptr<const ModalShape>(body.body, &shape));
    n.mass.move(where);
  }

  void absorb_flexible(std::size_t b, const BodyPlace& where) {
    NodeSpec& n = node(where.node);
    const std::string rigid = n.name;
    n.name = model_.bodies()[b].name;
    take_modes(b, n, where.pose);
    tree_.places[b] = where;
    tree_.savings.push_back("'" + rigid + "' is rigidly part of '" + n.name + "'");
  }

  void new_node(std::size_t b, const BodyPlace& F, const Frame& root, bool clamped) {
    const HingeNode& h = model_.hinges()[b];
    const BodyNode& body = model_.bodies()[b];
    NodeSpec n;
    n.name = body.name;
    n.body = static_cast<int>(b);
    n.parent = F.node;
    n.parent_station = F.station;
    n.F = F.pose;
    n.hinge = h.hinge;
    n.kernel = h.hinge->kernel();
    n.slot = model_.layout().hinges[b];
    n.driven = model_.driven(b);
    n.reflected = h.reflected_inertia;
    n.M = root.pose;
    if (body.body->shape().modes() > 0) {
      take_modes(b, n, Pose{});
    } else {
      n.base = rigid_inertia(body.body->shape());
      n.stiffness = n.damping = Eigen::MatrixXd::Zero(0, 0);
    }
    if (clamped) n.M = at(root.section.X) * root.pose;
    tree_.nodes.push_back(std::move(n));
    const int index = static_cast<int>(tree_.nodes.size()) - 1;
    if (!clamped) node(index).root_station = station(index, root.section);
    tree_.places[b] = {index, -1, Pose{}};
  }

  const Model& model_;
  PlacedTree tree_;
};

}  // namespace

PlacedTree merge(const Model& model) { return Merger(model).run(); }

}  // namespace withy::compilation
