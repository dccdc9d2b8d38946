#include "withy/core/analysis/named_parts.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "withy/core/plugin/refined_difference.hpp"
#include "withy/core/tangents/displacements.hpp"
#include "withy/core/tangents/load_derivatives.hpp"
#include "withy/core/tangents/load_wrenches.hpp"

namespace withy {
namespace {

/// Efforts of a load on speeds, those that go by its states too.
Eigen::VectorXd efforts_of(const Model& model, std::size_t load, double t, std::span<const double> y) {
  const Layout& layout = model.layout();
  Eigen::VectorXd efforts = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.speeds));
  const std::span<double> own(efforts.data(), layout.speeds);
  std::vector<double> scratch(model.load_scratch());
  model.loads()[load].load->add(t, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), own, scratch);
  model.add_state_efforts(t, y, own, scratch, static_cast<int>(load));
  return efforts;
}

/// Their derivatives by differences.
void add_differences(const TangentDynamics& dynamics, std::size_t load, const State& state, NamedPart& part) {
  const Model& model = dynamics.model();
  const Eigen::Index n = part.by_speed.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto slope = [&](auto&& move) {
      return refined_difference(
          [&](double h) {
            std::vector<double> moved = state.y;
            move(moved, h);
            return efforts_of(model, load, state.time, moved);
          },
          analysis::difference_step, greatest_moved(state.y, move));
    };
    part.by_position.col(j) +=
        slope([&](std::vector<double>& y, double h) { dynamics.displace(y, h * Eigen::VectorXd::Unit(n, j)); });
    part.by_speed.col(j) += slope(
        [&](std::vector<double>& y, double h) { y[model.layout().positions + static_cast<std::size_t>(j)] += h; });
  }
}

/// Adds what a load's continuous part does by displacements and speeds, where it says so.
bool add_of_states(const LoadNode& node, const Model& model, const State& state, NamedPart& part) {
  const Layout& layout = model.layout();
  const auto slot = std::find_if(layout.continuous_slots.begin(), layout.continuous_slots.end(),
                                 [&](const LoadSlot& s) { return &model.loads()[s.load] == &node; });
  if (slot == layout.continuous_slots.end()) return false;
  const auto n = static_cast<Eigen::Index>(layout.speeds), z = static_cast<Eigen::Index>(slot->count);
  Eigen::MatrixXd by_state(n, z), rate_by_position(z, n), rate_by_speed(z, n), rate_by_state(z, z);
  ContinuousDerivatives to{part.by_position, part.by_speed, by_state, rate_by_position, rate_by_speed, rate_by_state};
  std::vector<double> scratch(model.load_scratch());
  return derivatives_call(
      node.name, [&] { return node.continuous->add_derivatives(node.view(state.time, state.y, layout, scratch), to); });
}

/// What a load does on speeds; nothing where all it does is at frames.
std::optional<NamedPart> part_of_load(const TangentDynamics& dynamics, std::size_t load, const State& state,
                                      const Tangents& tangents) {
  const Model& model = dynamics.model();
  const Layout& layout = model.layout();
  const LoadNode& node = model.loads()[load];
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(n, n);
  const std::span<const double> y(state.y);
  NamedPart part{"load '" + node.name + "'", none, none, true};
  const bool by_itself = derivatives_call(node.name, [&] {
    return node.load->add_derivatives(state.time, y.first(layout.positions), y.subspan(layout.positions, layout.speeds),
                                      part.by_position, part.by_speed);
  });
  const bool by_states = add_of_states(node, model, state, part);
  const auto& differenced = tangents.differenced;
  if (node.load->frames().empty() &&
      std::find(differenced.begin(), differenced.end(), node.name) != differenced.end()) {
    part.by_position.setZero();
    part.by_speed.setZero();
    add_differences(dynamics, load, state, part);
  } else if (!by_itself && !by_states) {
    return {};
  }
  // Efforts stand on the other side of the equation.
  part.by_position = -part.by_position;
  part.by_speed = -part.by_speed;
  return part;
}

}  // namespace

std::vector<NamedPart> named_parts(const TangentDynamics& dynamics, const State& state, const Tangents& tangents) {
  const Model& model = dynamics.model();
  const Layout& layout = model.layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(n, n);
  std::vector<NamedPart> parts;
  NamedPart rest{"inertia and weight", tangents.by_position, tangents.by_speed};
  const auto take = [&](NamedPart part) {
    rest.by_position -= part.by_position;
    rest.by_speed -= part.by_speed;
    parts.push_back(std::move(part));
  };
  for (const BodyNode& body : model.bodies()) {
    const Slot* slot = layout.body(body.name);
    if (slot == nullptr) continue;
    const ModalShape& shape = body.body->shape();
    const auto at = static_cast<Eigen::Index>(slot->speed);
    NamedPart part{"'" + body.name + "'", none, none};
    part.by_position.block(at, at, shape.modes(), shape.modes()) = shape.stiffness;
    part.by_speed.block(at, at, shape.modes(), shape.modes()) = shape.damping;
    take(std::move(part));
  }
  bool at_frames = false;
  for (std::size_t l = 0; l < model.loads().size(); ++l) {
    at_frames = at_frames || !model.loads()[l].load->frames().empty();
    if (std::optional<NamedPart> part = part_of_load(dynamics, l, state, tangents)) take(std::move(*part));
  }
  // Wrenches at frames are not told from what the frames' bodies do.
  if (at_frames) rest.name += ", and loads at frames", rest.of_load = true;
  parts.push_back(std::move(rest));
  return parts;
}

}  // namespace withy
