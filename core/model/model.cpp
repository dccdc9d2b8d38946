#include "withy/core/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/validate.hpp"

namespace withy {
namespace {

const Slot* find_slot(const std::vector<Slot>& slots, std::string_view name) {
  const auto it = std::find_if(slots.begin(), slots.end(), [&](const Slot& s) { return s.name == name; });
  return it == slots.end() ? nullptr : &*it;
}

/// The indices of nodes in the order of their names.
template <class Node>
std::vector<int> by_name(const std::vector<Node>& nodes) {
  std::vector<int> order(nodes.size());
  std::iota(order.begin(), order.end(), 0);
  const auto name = [&](int i) -> const std::string& { return nodes[static_cast<std::size_t>(i)].name; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return name(a) < name(b); });
  return order;
}

/// Index of the first node with a name; −1 where there is none.
template <class Node>
int find_sorted(const std::vector<Node>& nodes, const std::vector<int>& order, std::string_view name) {
  const auto of = [&](int i) -> const std::string& { return nodes[static_cast<std::size_t>(i)].name; };
  const auto it =
      std::lower_bound(order.begin(), order.end(), name, [&](int i, std::string_view n) { return of(i) < n; });
  return it == order.end() || of(*it) != name ? -1 : *it;
}

template <class Node>
int find_index(const std::vector<Node>& nodes, std::string_view name) {
  const auto it = std::find_if(nodes.begin(), nodes.end(), [&](const Node& n) { return n.name == name; });
  return it == nodes.end() ? -1 : static_cast<int>(it - nodes.begin());
}

/// The undeformed body: its mass at q = 0, no modes.
class RigidifiedBody final : public Body {
 public:
  explicit RigidifiedBody(std::shared_ptr<const Body> body) : body_(std::move(body)) {
    for (const Particle& p : body_->shape().particles)
      shape_.particles.push_back({p.mass, PointExpansion::rigid(p.at.X, 0)});
    for (const Section& s : body_->shape().sections)
      shape_.sections.push_back({s.inertia, PointExpansion::rigid(s.at.X, 0)});
  }
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    const auto s = body_->station(name);
    if (!s) return {};
    return PointExpansion::rigid(s->X, 0);
  }
  std::string stations() const override { return body_->stations(); }

 private:
  std::shared_ptr<const Body> body_;
  ModalShape shape_;
};

/// Bodies come from plugins: what they say is checked before anything is computed with it.
void check_content(const BodyNode& node) {
  const ModalShape& shape = node.body->shape();
  if (const std::string fault = find_fault(shape); !fault.empty()) {
    throw std::invalid_argument("the shape of body '" + node.name + "' cannot be used: " + fault);
  }
  for (const Frame& f : node.frames) {
    if (const std::string fault = find_fault(f.section, shape.modes()); !fault.empty()) {
      throw std::invalid_argument("frame '" + f.name + "' of body '" + node.name + "' cannot be used: " + fault);
    }
  }
}

void check_reflected_inertia(const HingeNode& h) {
  if (!(h.reflected_inertia >= 0) || !std::isfinite(h.reflected_inertia))
    throw std::invalid_argument("the reflected inertia of hinge '" + h.name + "' is not finite and at least 0");
  if (h.reflected_inertia > 0 && (h.hinge->speeds() != 1 || h.hinge->coordinates() != 1))
    throw std::invalid_argument("hinge '" + h.name + "' has a reflected inertia, which is for hinges of one rate");
}

/// The hinges parents before children, otherwise in the order they are given: passes go through that order again and
/// again, and place each hinge as soon as its parent is placed. What hangs on no world is left out.
std::vector<std::size_t> placed(const std::vector<HingeNode>& hinges, const std::vector<int>& inboard) {
  const std::size_t n = hinges.size();
  constexpr int never = -1;
  std::vector<int> pass(n, never);
  std::vector<std::vector<std::size_t>> at_pass;
  std::vector<std::size_t> above;
  std::vector<bool> seen(n, false);
  for (std::size_t start = 0; start < n; ++start) {
    // Inwards to a hinge whose pass is known, or to one that was seen: then it never comes to the world.
    above.clear();
    std::size_t h = start;
    while (!seen[h]) {
      seen[h] = true;
      above.push_back(h);
      if (hinges[h].parent < 0) break;
      h = static_cast<std::size_t>(inboard[static_cast<std::size_t>(hinges[h].parent)]);
    }
    for (; !above.empty(); above.pop_back()) {
      const std::size_t at = above.back();
      if (hinges[at].parent < 0) {
        pass[at] = 0;
        continue;
      }
      const auto parent = static_cast<std::size_t>(inboard[static_cast<std::size_t>(hinges[at].parent)]);
      if (pass[parent] != never) pass[at] = pass[parent] + (parent < at ? 0 : 1);
    }
  }
  for (std::size_t h = 0; h < n; ++h) {
    if (pass[h] == never) continue;
    at_pass.resize(std::max(at_pass.size(), static_cast<std::size_t>(pass[h]) + 1));
    at_pass[static_cast<std::size_t>(pass[h])].push_back(h);
  }
  std::vector<std::size_t> order;
  for (const auto& hinges_of_pass : at_pass) order.insert(order.end(), hinges_of_pass.begin(), hinges_of_pass.end());
  return order;
}

}  // namespace

const Slot* Layout::hinge(std::string_view name) const { return find_slot(hinges, name); }
const Slot* Layout::body(std::string_view name) const { return find_slot(bodies, name); }

int BodyNode::frame(std::string_view frame_name) const { return find_index(frames, frame_name); }

Model::Model(std::vector<BodyNode> bodies, std::vector<HingeNode> hinges, Vector3 gravity) : gravity_(gravity) {
  const std::size_t n = bodies.size();
  for (const BodyNode& b : bodies) check_content(b);
  for (const HingeNode& h : hinges) check_reflected_inertia(h);
  std::vector<int> inboard(n, -1);
  for (std::size_t h = 0; h < hinges.size(); ++h) {
    const auto child = static_cast<std::size_t>(hinges[h].child);
    if (inboard[child] >= 0) {
      throw std::invalid_argument("body '" + bodies[child].name + "' is the child of two hinges, '" +
                                  hinges[static_cast<std::size_t>(inboard[child])].name + "' and '" + hinges[h].name +
                                  "'; a tree gives each body one");
    }
    inboard[child] = static_cast<int>(h);
  }
  for (std::size_t b = 0; b < n; ++b) {
    if (inboard[b] < 0) throw std::invalid_argument("body '" + bodies[b].name + "' is the child of no hinge");
  }
  const std::vector<std::size_t> order = placed(hinges, inboard);
  if (order.size() < n) {
    std::string names;
    std::vector<bool> has_place(n, false);
    for (const std::size_t h : order) has_place[h] = true;
    for (std::size_t h = 0; h < n; ++h) {
      if (!has_place[h]) names += (names.empty() ? "'" : ", '") + hinges[h].name + "'";
    }
    throw std::invalid_argument("the hinges " + names + " make a cycle that does not hang on the world");
  }
  std::vector<int> place(n, -1);
  bodies_.reserve(n);
  hinges_.reserve(n);
  for (const std::size_t h : order) {
    HingeNode hinge = std::move(hinges[h]);
    place[static_cast<std::size_t>(hinge.child)] = static_cast<int>(bodies_.size());
    bodies_.push_back(std::move(bodies[static_cast<std::size_t>(hinge.child)]));
    hinge.child = static_cast<int>(bodies_.size()) - 1;
    if (hinge.parent >= 0) hinge.parent = place[static_cast<std::size_t>(hinge.parent)];
    hinges_.push_back(std::move(hinge));
  }
  lay_out();
}

void Model::lay_out() {
  std::size_t x = 0;
  std::size_t u = 0;
  layout_.modes_of.assign(bodies_.size(), -1);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const HingeNode& h = hinges_[b];
    layout_.hinges.push_back({h.name, x, h.hinge->coordinates(), u, h.hinge->speeds()});
    x += h.hinge->coordinates();
    u += h.hinge->speeds();
    for (std::size_t i = 0; i < h.hinge->speeds(); ++i) layout_.speed_names.push_back(h.name + "." + std::to_string(i));
    const ModalShape& shape = bodies_[b].body->shape();
    const std::size_t modes = shape.mode_names.size();
    if (modes == 0) continue;
    layout_.modes_of[b] = static_cast<int>(layout_.bodies.size());
    layout_.bodies.push_back({bodies_[b].name, x, modes, u, modes});
    x += modes;
    u += modes;
    for (const std::string& mode : shape.mode_names) layout_.speed_names.push_back(bodies_[b].name + "." + mode);
  }
  layout_.positions = x;
  layout_.speeds = u;
  bodies_by_name_ = by_name(bodies_);
  hinges_by_name_ = by_name(hinges_);
  driven_.assign(hinges_.size(), false);
  may_be_locked_.assign(hinges_.size(), false);
}

int Model::body(std::string_view name) const { return find_sorted(bodies_, bodies_by_name_, name); }
int Model::hinge(std::string_view name) const { return find_sorted(hinges_, hinges_by_name_, name); }

std::vector<int> Model::segments(std::string_view name) const {
  if (const int index = body(name); index >= 0) return {index};
  std::vector<int> indices;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::optional<Segment>& segment = bodies_[b].segment;
    if (!segment || segment->whole != name) continue;
    indices.resize(std::max(indices.size(), segment->index + 1), -1);
    indices[segment->index] = static_cast<int>(b);
  }
  return indices;
}

std::optional<FrameIndex> Model::find_frame(std::string_view name) const {
  const auto lookup = [&](const std::vector<int>& in, std::string_view frame) -> std::optional<FrameIndex> {
    if (in.empty()) return {};
    // Every segment has a root and a tip of its own; the whole's are those at its ends.
    if (frame == "root") return FrameIndex{in.front(), 0};
    const bool tip = frame == "tip";
    for (auto b = tip ? in.end() - 1 : in.begin(); b != in.end(); ++b) {
      const int index = bodies_[static_cast<std::size_t>(*b)].frame(frame);
      if (index >= 0) return FrameIndex{*b, index};
    }
    return {};
  };
  if (auto root = lookup(segments(name), "root")) return root;
  // Segments have a dot in their names, and places such as "(0.6, -0.2)" may have some.
  for (std::size_t dot = name.find('.'); dot != std::string_view::npos; dot = name.find('.', dot + 1)) {
    if (auto frame = lookup(segments(name.substr(0, dot)), name.substr(dot + 1))) return frame;
  }
  return {};
}

State Model::reference_state() const {
  State s;
  s.y.assign(layout_.size(), 0.0);
  for (std::size_t h = 0; h < hinges_.size(); ++h) {
    const Slot& slot = layout_.hinges[h];
    hinges_[h].hinge->reference(std::span(s.y).subspan(slot.position, slot.positions));
  }
  begin_continuous(s);
  return s;
}

bool Model::is_exact(std::size_t body, const Terms& scene) const {
  const BodyNode& node = bodies_[body];
  const Terms own = node.terms.value_or(scene);
  return node.body->shape().modes() > 0 && own.strain == StrainOrder::exact && own.truncation == Truncation::none;
}

void Model::require_rods(const Terms& scene) const {
  std::set<const Body*> sound;  // equal bodies are one
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!is_exact(b, scene)) continue;
    const BodyNode& node = bodies_[b];
    const Rod* const rod = node.body->rod();
    if (rod == nullptr)
      throw std::invalid_argument("body '" + node.name +
                                  "' has no exact kinematics, which slender bodies offer, as a beam: give it a "
                                  "formulation of its own");
    if (!sound.insert(node.body.get()).second) continue;
    if (const std::string fault = find_fault(*rod, node.body->shape()); !fault.empty())
      throw std::invalid_argument("the rod that body '" + node.name +
                                  "' offers for exact kinematics cannot be used: " + fault);
  }
}

void Model::replace_load(std::size_t index, std::shared_ptr<const BoundLoad> load) {
  LoadNode& node = loads_[index];
  node.continuous = load->continuous();
  load_scratch_ = std::max(load_scratch_, load->scratch());
  node.load = std::move(load);
}

std::shared_ptr<const Model> Model::in_kinematics(std::shared_ptr<const Model> model, const Terms& scene) {
  // Before loads are bound anew, which look for the rods.
  model->require_rods(scene);
  std::shared_ptr<Model> changed;
  std::map<std::pair<const Body*, const StrainKinematics*>, std::shared_ptr<const Body>> made;  // equal bodies are one
  for (std::size_t b = 0; b < model->bodies_.size(); ++b) {
    const BodyNode& node = model->bodies_[b];
    const Terms& terms = node.terms ? *node.terms : scene;
    if (terms.kinematics == nullptr || node.body->shape().modes() == 0) continue;
    std::shared_ptr<const Body>& body = made[{node.body.get(), terms.kinematics.get()}];
    if (body == nullptr) body = node.body->expanded(*terms.kinematics);
    if (body == nullptr) {
      throw std::invalid_argument("body '" + node.name + "' cannot be in strain kinematics '" +
                                  std::string(terms.kinematics->name()) +
                                  "': a slender body offers the linear fields that it needs; give the body a "
                                  "formulation of its own");
    }
    if (changed == nullptr) changed = std::make_shared<Model>(*model);
    BodyNode& own = changed->bodies_[b];
    own.body = body;
    for (Frame& frame : own.frames) frame.section = own.body->station(frame.section.X.x()).value();
  }
  for (std::size_t l = 0; l < model->loads_.size(); ++l) {
    std::shared_ptr<const BoundLoad> load =
        model->loads_[l].load->rebound(changed == nullptr ? *model : *changed, scene);
    if (load == nullptr) continue;
    if (changed == nullptr) changed = std::make_shared<Model>(*model);
    changed->replace_load(l, std::move(load));
  }
  if (changed == nullptr) return model;
  return changed;
}

Model Model::rigidified() const {
  require_tree(*this, "a rigid tree");
  std::vector<BodyNode> bodies = bodies_;
  std::map<const Body*, std::shared_ptr<const Body>> made;  // equal bodies are one
  for (BodyNode& b : bodies) {
    std::shared_ptr<const Body>& rigid = made[b.body.get()];
    if (rigid == nullptr) rigid = std::make_shared<RigidifiedBody>(b.body);
    b.body = rigid;
    for (Frame& f : b.frames) f.section = PointExpansion::rigid(f.section.X, 0);
  }
  return Model(std::move(bodies), hinges_, gravity_);
}

}  // namespace withy
