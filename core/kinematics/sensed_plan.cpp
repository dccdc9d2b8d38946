#include "withy/core/kinematics/sensed_plan.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <string>

#include "withy/core/shape/section_fields.hpp"
#include "withy/core/sweep/mass_table.hpp"
#include "withy/core/tree/invariants.hpp"
#include "withy/core/tree/rigid_inertia.hpp"

namespace withy::sensed {
namespace {

SectionFrame placed_at(BodyPlan& body, const PointExpansion& section, const Pose& pose) {
  const auto found = std::find_if(body.sections.begin(), body.sections.end(),
                                  [&](const SectionFields& s) { return same_section(s.at, section); });
  const auto index = static_cast<std::size_t>(found - body.sections.begin());
  if (found == body.sections.end()) body.sections.push_back({section, moved_by_modes(section)});
  return {index, pose};
}

/// The mass of a flexible body as generalized particles.
std::vector<PointFields> points_of(const ModalShape& shape, StrainOrder order) {
  NodeSpec node;
  node.modes = static_cast<std::size_t>(shape.modes());
  node.mass = PlacedMass(std::make_shared<ModalShape>(shape));
  const sweep::MassTable<Spatial> table(in_strain_order(std::move(node), order));
  const auto n = static_cast<std::size_t>(shape.modes());
  std::vector<PointFields> points(table.rank);
  for (std::size_t k = 0; k < table.rank; ++k) {
    const Pack* data = table.data.data() + (k / lanes) * table.stride;
    const auto field = [&](std::size_t at) {
      return Vector3(data[3 * at][k % lanes], data[3 * at + 1][k % lanes], data[3 * at + 2][k % lanes]);
    };
    points[k].constant = k == 0 ? table.root_mass : 0;
    for (std::size_t i = 0; i <= n; ++i) points[k].first.push_back(field(i));
    for (std::size_t i = 0; table.second_order && i < n * (n + 1) / 2; ++i)
      points[k].second.push_back(field(n + 1 + i));
  }
  return points;
}

std::string digits_of(double x) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

/// Whether a body is the piece of a beam in segments that lies before another on the side of its root.
bool is_piece_before(const Model& model, std::size_t body, std::size_t other) {
  const std::optional<Segment>&a = model.bodies()[body].segment, &b = model.bodies()[other].segment;
  return a && b && a->whole == b->whole && a->index + 1 == b->index;
}

}  // namespace

Plan::Plan(const Model& m, Terms terms, std::span<const SectionPlace> places)
    : model(m), fields(m), products_of_speeds(terms.products_of_speeds) {
  for (std::size_t b = 0; b < model.bodies().size(); ++b) add_body(b, terms);
  for (const SectionPlace& place : places) add_cut(place);
  add_rods();
}

void Plan::add_cut(const SectionPlace& place) {
  CutPlan cut;
  cut.body = static_cast<std::size_t>(place.body);
  const BodyNode& node = model.bodies()[cut.body];
  const std::optional<BodyCut> given = node.body->cut(place.x);
  if (!given) {
    throw std::invalid_argument("body '" + node.name + "' cannot be cut at x = " + digits_of(place.x) +
                                " m; need a slender body and a place on it");
  }
  BodyPlan& body = bodies[cut.body];
  cut.section = placed_at(body, given->at, Pose{}).section;
  cut.curvature = given->curvature;
  cut.stiffness = given->stiffness;
  ModalShape beyond;
  beyond.mode_names.resize(static_cast<std::size_t>(body.modes));
  beyond.particles = given->particles;
  beyond.sections = given->sections;
  if (body.rod != nullptr) {
    cut.of_rod = RodTable(*node.body->rod()).beyond(place.x);
  } else if (body.modes > 0) {
    cut.points = points_of(beyond, body.order);
    for (const Section& s : beyond.sections) cut.rotary.push_back({s.inertia, {s.at, true}});
  } else {
    cut.rigid = rigid_inertia(beyond);
  }
  // What is at the section is beyond it, but for the piece before it, and at the root for the hinge that holds it
  // there.
  const double close = 1e-9 * node.body->shape().length;
  const auto x_of = [&](std::size_t frame) { return body.sections[body.frames[frame].section].at.X.x(); };
  for (std::size_t f = 0; f < body.named; ++f) cut.frames.push_back(x_of(f) >= place.x - close ? 1 : 0);
  if (const FieldLoad* field = field_of(model)) {
    std::vector<double> shares = mass_beyond(*node.body, place.x);
    if (shares.empty()) {
      // The points of the whole body are not those of its part: the part has its own.
      shares.resize(field->points_of(place.body).size(), 0.0);
      cut.mass = mass_points(beyond.particles, beyond.sections, body.modes);
      cut.first_point = body.frames.size();
      for (const MassPoint& point : cut.mass) body.frames.push_back(placed_at(body, point.at, Pose{}));
    }
    cut.frames.insert(cut.frames.end(), shares.begin(), shares.end());
  }
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const HingeNode& hinge = model.hinges()[h];
    if (hinge.parent == place.body && cut.frames[static_cast<std::size_t>(hinge.parent_frame)] > 0 &&
        !is_piece_before(model, h, cut.body))
      cut.hinges.push_back(h);
  }
  const int parent = model.hinges()[cut.body].parent;
  const bool first = !node.segment || node.segment->index == 0;
  const bool behind = first || (parent >= 0 && is_piece_before(model, static_cast<std::size_t>(parent), cut.body));
  cut.inboard = x_of(body.M) >= place.x - close && !(behind && x_of(body.M) <= close);
  cuts.push_back(std::move(cut));
}

void Plan::add_rods() {
  for (BodyPlan& body : bodies) {
    sections += body.sections.size();
    if (body.rod == nullptr) continue;
    // The rod wants its sections as stations of a node.
    NodeSpec node;
    node.modes = static_cast<std::size_t>(body.modes);
    node.rod = model.bodies()[static_cast<std::size_t>(body.hinge->child)].body->rod();
    for (const SectionFields& s : body.sections) node.stations.push_back({s.at, {}});
    auto rod = std::make_shared<RodPlan>();
    rod->kinematics = sweep::RodKinematics<Spatial>(node);
    rod->inertias = RodTable(*node.rod).inertias;
    rod->work = rod_packs;
    rod_packs += sweep::rod_work(rod->kinematics, static_cast<int>(body.modes));
    body.rod = std::move(rod);
  }
}

void Plan::add_body(std::size_t index, Terms terms) {
  const BodyNode& node = model.bodies()[index];
  const HingeNode& hinge = model.hinges()[index];
  const ModalShape& shape = node.body->shape();
  const Terms own = node.terms.value_or(terms);
  BodyPlan body;
  body.hinge = &hinge;
  body.slot = model.layout().hinges[index];
  body.modes = shape.modes();
  body.order = own.strain;
  body.truncation = own.truncation;
  for (const Frame& frame : node.frames) body.frames.push_back(placed_at(body, frame.section, frame.pose));
  body.named = body.frames.size();
  if (const FieldLoad* field = field_of(model)) {
    for (const MassPoint& point : field->points_of(static_cast<int>(index)))
      body.frames.push_back(placed_at(body, point.at, Pose{}));
  }
  body.M = static_cast<std::size_t>(hinge.child_frame);
  body.F.pose = hinge.offset;
  if (hinge.parent >= 0) {
    const SectionFrame& on =
        bodies[static_cast<std::size_t>(hinge.parent)].frames[static_cast<std::size_t>(hinge.parent_frame)];
    body.F = {on.section, on.pose * hinge.offset};
  }
  if (body.modes > 0) {
    body.modal = *model.layout().modes(index);
    body.first_mode = modes;
    modes += static_cast<std::size_t>(body.modes);
    most_modes = std::max(most_modes, static_cast<std::size_t>(body.modes));
    if (own.truncation != Truncation::ruthless) truncation = own.truncation;
    const bool exact = own.strain == StrainOrder::exact && own.truncation == Truncation::none;
    if (exact) body.rod = std::make_shared<RodPlan>();
    if (!exact) {
      body.points = points_of(shape, body.order);
      for (const Section& s : shape.sections) body.rotary.push_back({s.inertia, {s.at, true}});
    }
  } else {
    body.rigid = rigid_inertia(shape);
  }
  bodies.push_back(std::move(body));
}

}  // namespace withy::sensed
