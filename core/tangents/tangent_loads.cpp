#include <algorithm>
#include <functional>

#include "withy/core/plugin/refined_difference.hpp"
#include "withy/core/tangents/continuous_tangents.hpp"
#include "withy/core/tangents/displacements.hpp"
#include "withy/core/tangents/load_derivatives.hpp"
#include "withy/core/tangents/load_wrenches.hpp"
#include "withy/core/tangents/tangent_dynamics.hpp"

namespace withy {

using analysis::difference_step;

Eigen::VectorXd TangentDynamics::elastic(std::span<const double> y) const {
  const Layout& layout = model_->layout();
  Eigen::VectorXd r = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.speeds));
  for (std::size_t b = 0; b < slots_.size(); ++b) {
    if (slots_[b] == nullptr) continue;
    const ModalShape& shape = model_->bodies()[b].body->shape();
    const Eigen::Map<const Eigen::VectorXd> q(y.data() + slots_[b]->position, shape.modes());
    const Eigen::Map<const Eigen::VectorXd> q_dot(y.data() + layout.positions + slots_[b]->speed, shape.modes());
    r.segment(static_cast<Eigen::Index>(slots_[b]->speed), shape.modes()) = shape.stiffness * q + shape.damping * q_dot;
  }
  return r;
}

Eigen::VectorXd TangentDynamics::load_efforts(double t, std::span<const double> y) const {
  const Layout& layout = model_->layout();
  std::vector<double> efforts(layout.speeds, 0.0);
  std::vector<double> scratch(model_->load_scratch());
  for (const LoadNode& node : model_->loads())
    node.load->add(t, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), efforts, scratch);
  model_->add_state_efforts(t, y, efforts, scratch);
  return Eigen::Map<const Eigen::VectorXd>(efforts.data(), static_cast<Eigen::Index>(efforts.size()));
}

Eigen::VectorXd TangentDynamics::load_sizes(double t, std::span<const double> y) const {
  const Layout& layout = model_->layout();
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.speeds)), efforts = sizes;
  std::vector<double> scratch(model_->load_scratch());
  for (std::size_t l = 0; l < model_->loads().size(); ++l) {
    efforts.setZero();
    const std::span<double> own(efforts.data(), layout.speeds);
    model_->loads()[l].load->add(t, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), own,
                                 scratch);
    model_->add_state_efforts(t, y, own, scratch, static_cast<int>(l));
    sizes += efforts.cwiseAbs();
  }
  return sizes;
}

void TangentDynamics::add_elastic(Tangents& result) const {
  for (std::size_t b = 0; b < slots_.size(); ++b) {
    if (slots_[b] == nullptr) continue;
    const ModalShape& shape = model_->bodies()[b].body->shape();
    const auto at = static_cast<Eigen::Index>(slots_[b]->speed);
    result.by_position.block(at, at, shape.modes(), shape.modes()) += shape.stiffness;
    result.by_speed.block(at, at, shape.modes(), shape.modes()) += shape.damping;
    result.in_play.segment(at, shape.modes()) += shape.stiffness.diagonal().cwiseAbs();
  }
}

void TangentDynamics::add_loads(double t, std::span<const double> y, const Eigen::VectorXd& a,
                                Tangents& tangents) const {
  const Layout& layout = model_->layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  Eigen::MatrixXd by_position = Eigen::MatrixXd::Zero(n, n), by_speed = by_position;
  const auto displaced = [&](std::span<double> moved, Eigen::Index speed, double h) {
    const Eigen::VectorXd by = h * Eigen::VectorXd::Unit(n, speed);
    withy::displace(*model_, moved, {by.data(), layout.speeds});
  };
  for (const LoadNode& node : model_->loads()) {
    const BoundLoad& load = *node.load;
    const auto positions = y.first(layout.positions), speeds = y.subspan(layout.positions, layout.speeds);
    const Eigen::VectorXd diagonal_before = by_position.diagonal();
    const auto note_terms = [&] { tangents.in_play += (by_position.diagonal() - diagonal_before).cwiseAbs(); };
    if (derivatives_call(node.name,
                         [&] { return load.add_derivatives(t, positions, speeds, by_position, by_speed); })) {
      note_terms();
      continue;
    }
    const Eigen::MatrixXd position_before = by_position, speed_before = by_speed;
    const auto at = [&](std::span<const double> state) -> Eigen::VectorXd {
      Eigen::VectorXd efforts = Eigen::VectorXd::Zero(n);
      std::vector<double> scratch(load.scratch());
      load.add(t, state.first(layout.positions), state.subspan(layout.positions, layout.speeds),
               {efforts.data(), layout.speeds}, scratch);
      return efforts;
    };
    const auto slope = [&](auto&& move) -> Eigen::VectorXd {
      return refined_difference(
          [&](double h) {
            std::vector<double> moved(y.begin(), y.end());
            move(moved, h);
            return at(moved);
          },
          difference_step, greatest_moved(y, move));
    };
    for (Eigen::Index j = 0; j < n; ++j) {
      by_position.col(j) += slope([&](std::span<double> moved, double h) { displaced(moved, j, h); });
      by_speed.col(j) +=
          slope([&](std::span<double> moved, double h) { moved[layout.positions + static_cast<std::size_t>(j)] += h; });
    }
    note_terms();
    if (by_position != position_before || by_speed != speed_before) tangents.differenced.push_back(node.name);
  }
  tangents.by_position -= by_position;
  tangents.by_speed -= by_speed;
  if (!layout.continuous_slots.empty()) add_continuous(t, y, a, tangents);
}

void TangentDynamics::add_continuous(double t, std::span<const double> y, const Eigen::VectorXd& a,
                                     Tangents& tangents) const {
  std::vector<bool> differenced(model_->loads().size(), false);
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  const auto move = [&](std::span<double> moved, std::size_t speed, double h) {
    const Eigen::VectorXd by = h * Eigen::VectorXd::Unit(n, static_cast<Eigen::Index>(speed));
    withy::displace(*model_, moved, {by.data(), model_->layout().speeds});
  };
  // The residual has efforts on its other side.
  const auto of_wrenches = [&](std::span<const double> seen) { return frame_load_efforts(t, y, seen); };
  std::function<Eigen::VectorXd(std::span<const double>)> at_frames;
  if (controlled_frames_) at_frames = of_wrenches;
  ContinuousTangents own =
      continuous_tangents(*model_, t, y, {a.data(), model_->layout().speeds}, move, at_frames, differenced);
  tangents.by_position -= own.effort_by_position;
  tangents.in_play += own.effort_by_position.diagonal().cwiseAbs();
  tangents.by_speed -= own.effort_by_speed;
  tangents.by_state = -own.effort_by_state;
  tangents.rate_by_position = std::move(own.rate_by_position);
  tangents.rate_by_speed = std::move(own.rate_by_speed);
  tangents.rate_by_state = std::move(own.rate_by_state);
  tangents.rate_by_acceleration = std::move(own.rate_by_acceleration);
  for (std::size_t l = 0; l < differenced.size(); ++l) {
    const std::string& name = model_->loads()[l].name;
    const auto begin = tangents.differenced.begin(), end = tangents.differenced.end();
    if (differenced[l] && std::find(begin, end, name) == end) tangents.differenced.push_back(name);
  }
}

}  // namespace withy
