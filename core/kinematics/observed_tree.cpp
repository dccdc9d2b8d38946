#include "withy/core/kinematics/observed_tree.hpp"

#include <algorithm>

#include "withy/core/kinematics/tree_observation.hpp"
#include "withy/core/shape/section_fields.hpp"
#include "withy/core/tree/invariants.hpp"
#include "withy/core/tree/steps.hpp"

namespace withy {
namespace observed {
namespace {

/// The station of a section; it is added where no other has it.
int station_of(NodeSpec& node, PointExpansion section) {
  const auto found = std::find_if(node.stations.begin(), node.stations.end(),
                                  [&](const StationSpec& s) { return same_section(s.at, section); });
  const auto index = static_cast<int>(found - node.stations.begin());
  if (found == node.stations.end()) node.stations.push_back({std::move(section), {}});
  return index;
}

/// Where a frame is; a section that moves becomes a station of its node.
FramePlace place_frame(PlacedTree& tree, const BodyPlace& body, const Frame& frame) {
  const Pose at_section{Matrix3::Identity(), frame.section.X};
  if (body.node < 0 || !moved_by_modes(frame.section))
    return {body.node, body.station, body.pose * at_section * frame.pose, 0};
  const int station = station_of(tree.nodes[static_cast<std::size_t>(body.node)], moved(frame.section, body.pose));
  return {body.node, station, Pose{body.pose.R, Vector3::Zero()} * frame.pose, 0};
}

/// Whether a node in a plane has its flexible mass at one height, and nothing of it leaves the plane.
bool is_flat(const NodeSpec& node) {
  constexpr double rounding = 1e-12;
  const Vector3 normal = Vector3::UnitZ();
  double extent = 0, low = 0, high = 0;
  const std::vector<Section> sections = node.mass.sections();
  for (std::size_t k = 0; k < node.mass.size(); ++k) {
    const Vector3 X = node.mass.place(k);
    extent = std::max(extent, X.norm());
    low = k > 0 ? std::min(low, X.z()) : X.z();
    high = k > 0 ? std::max(high, X.z()) : X.z();
  }
  const auto across = [&](const Section& s) {
    return std::abs(s.inertia(0, 2)) + std::abs(s.inertia(1, 2)) > rounding * s.inertia.trace();
  };
  const auto leaves = [&](const StationSpec& s) { return !compilation::fields_in_plane(s.at, normal); };
  return high - low <= rounding * extent && std::none_of(sections.begin(), sections.end(), across) &&
         std::none_of(node.stations.begin(), node.stations.end(), leaves);
}

std::vector<double> row_major(const Eigen::MatrixXd& m) {
  std::vector<double> a;
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) a.push_back(m(i, j));
  }
  return a;
}

/// Exact kinematics is that of equations without truncation; else `exact` is the expansion.
StrainOrder order_in(const Terms& terms) {
  const bool expanded = terms.strain == StrainOrder::exact && terms.truncation != Truncation::none;
  return expanded ? StrainOrder::quadratic : terms.strain;
}

}  // namespace

template <class Space>
Node<Space>::Node(const NodeSpec& given, StrainOrder order, std::size_t carrying, double height, const Node* twin)
    : parent(given.parent),
      parent_station(given.parent_station),
      root_station(given.root_station),
      modes(static_cast<int>(given.modes)),
      mode_position(given.mode_position),
      mode_speed(given.mode_speed),
      joint(given),
      M(Space::make(given.M)),
      base(given.base, height),
      stiffness(row_major(given.stiffness)) {
  const NodeSpec spec = in_strain_order(given, order);
  for (const StationSpec& s : spec.stations) {
    const double above = height + s.at.X.z();
    Station<Space> station{{}, {s.carried, above}, above, stations.size() < carrying};
    if (order != StrainOrder::exact) station.fields = sweep::Fields<Space>(s.at);
    if (twin != nullptr && stations.size() < twin->stations.size())
      station.fields.share(twin->stations[stations.size()].fields);
    stations.push_back(std::move(station));
  }
  if (modes == 0) return;
  flexible_height = height + (spec.mass.size() == 0 ? 0.0 : spec.mass.place(0).z());
  if (order == StrainOrder::exact) {
    rod = twin != nullptr && twin->rod.fits(spec) ? twin->rod : sweep::RodKinematics<Space>(spec);
  } else {
    mass = twin != nullptr ? twin->mass : sweep::MassTable<Space>(spec);
    rotary = twin != nullptr ? twin->rotary : sweep::RotaryTable<Space>(spec);
  }
  if (twin != nullptr) stiffness.share(twin->stiffness);
}

template <class Space>
Tree<Space>::Tree(const Model& model, Terms terms, const PlacedTree& tree, const std::vector<std::size_t>& carrying,
                  const std::vector<FramePlace>& frames)
    : plane(tree.plane),
      gravity(tree.plane.R.transpose() * model.gravity()),
      size(model.layout().size()),
      positions(model.layout().positions),
      frames_(frames) {
  nodes.reserve(tree.nodes.size());
  Twins twins;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const NodeSpec& spec = tree.nodes[i];
    const Terms own = model.bodies()[static_cast<std::size_t>(spec.body)].terms.value_or(terms);
    add_node(spec, spec.modes > 0 ? order_in(own) : StrainOrder::quadratic, carrying[i], twins);
  }
  std::size_t next = 0;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodyPlace& place = tree.places[b];
    const Terms own = model.bodies()[b].terms.value_or(terms);
    bodies.push_back({place.pose.R, model.bodies()[b].body->shape().modes() > 0, place.node, place.station,
                      own.kinematics == nullptr && order_in(own) == StrainOrder::quadratic});
    first_frame_.push_back(next);
    for (std::size_t f = 0; f < model.bodies()[b].frames.size(); ++f, ++next) {
      FramePlace& at = frames_[next];
      if (at.node < 0) continue;
      const auto node = static_cast<std::size_t>(at.node);
      const double base =
          at.station < 0 ? heights_[node] : nodes[node].stations[static_cast<std::size_t>(at.station)].height;
      at.height = base + at.pose.p.z();
    }
    if (place.node >= 0) continue;
    for (const Particle& p : model.bodies()[b].body->shape().particles)
      fixed_potential -= p.mass * model.gravity().dot(place.pose.p + place.pose.R * p.at.X);
  }
}

template <class Space>
void Tree<Space>::add_node(const NodeSpec& spec, StrainOrder order, std::size_t carrying, Twins& twins) {
  // In a plane frames have their third axis along its normal, so that heights add up.
  double height = spec.F.p.z();
  if (spec.parent >= 0) {
    const auto parent = static_cast<std::size_t>(spec.parent);
    height += spec.parent_station < 0 ? heights_[parent]
                                      : nodes[parent].stations[static_cast<std::size_t>(spec.parent_station)].height;
  }
  if (spec.root_station >= 0)
    height -= spec.stations[static_cast<std::size_t>(spec.root_station)].at.X.z() + spec.M.p.z();
  heights_.push_back(height);
  const std::optional<std::size_t> twin = twins.of(spec, order, Truncation::none);
  Node<Space> node(spec, order, carrying, height, twin ? &nodes[*twin] : nullptr);
  node.first_station = stations;
  node.rod_work = rod_packs;
  stations += node.stations.size();
  rod_packs += sweep::rod_work(node.rod, node.modes);
  const auto add = [&](const Fixed<Space>& fixed) {
    height_moment += fixed.part.mass * fixed.height.frame + fixed.height.moment;
  };
  add(node.base);
  for (const Station<Space>& s : node.stations) add(s.carried);
  for (std::size_t k = 0; k < spec.mass.size(); ++k) height_moment += spec.mass.mass(k) * node.flexible_height;
  nodes.push_back(std::move(node));
}

template <class Space>
std::unique_ptr<Observation> Tree<Space>::make_observation() const {
  return std::make_unique<TreeObservation<Space>>(this->shared_from_this());
}

template class Tree<Planar>;
template class Tree<Spatial>;

}  // namespace observed

std::shared_ptr<const ObservedModel> observed_model(const Model& model, Terms terms) {
  return observed_model(model, terms, compile_placed_tree(model));
}

std::shared_ptr<const ObservedModel> observed_model(const Model& model, Terms terms, PlacedTree tree) {
  std::vector<std::size_t> carrying;
  for (const NodeSpec& node : tree.nodes) carrying.push_back(node.stations.size());
  std::vector<observed::FramePlace> frames;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    for (const Frame& frame : model.bodies()[b].frames)
      frames.push_back(observed::place_frame(tree, tree.places[b], frame));
  }
  if (!tree.planar) return std::make_shared<observed::Tree<Spatial>>(model, terms, tree, carrying, frames);
  if (std::all_of(tree.nodes.begin(), tree.nodes.end(), observed::is_flat))
    return std::make_shared<observed::Tree<Planar>>(model, terms, tree, carrying, frames);
  return observed_model(model, terms, compile_placed_tree(model, false));
}

}  // namespace withy
