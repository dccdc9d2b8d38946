#include "withy/core/tangents/tangent_dynamics.hpp"

#include <Eigen/QR>
#include <stdexcept>

#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/tangents/continuous_tangents.hpp"
#include "withy/core/tangents/first_order_recursion.hpp"
#include "withy/core/tangents/load_wrenches.hpp"
#include "withy/core/tangents/recursion.hpp"

namespace withy {

using analysis::AppliedWrench;
using analysis::BodyState;
using analysis::difference_step;
using analysis::Dual;
using analysis::FrameState;
using analysis::HingeState;
using analysis::Recursion;

namespace {

template <class S>
using VX = Eigen::Matrix<S, Eigen::Dynamic, 1>;

}  // namespace

/// Which directions the derivatives of one pass are along: 8 from `first`, where directions 0 … n−1 are displacements,
/// then speeds, then accelerations.
struct TangentDynamics::Seeds {
  std::size_t first = 0;
  /// Whether any of `count` directions from `from` on is among them.
  [[nodiscard]] bool meet(std::size_t from, std::size_t count) const {
    return from < first + 8 && first < from + count;
  }
};

/// States of hinges and bodies in numbers T, double or Jet.
template <class T>
struct TangentDynamics::Builder {
  const TangentDynamics& dynamics;
  std::span<const double> y;
  const Eigen::VectorXd& a;
  Seeds seeds;
  bool at_rest = false;  ///< all speeds count as zero

  /// `value`, with a unit derivative along direction `direction`.
  [[nodiscard]] T seeded(double value, std::size_t direction) const {
    T x(value);
    if constexpr (std::is_same_v<T, Jet>) {
      if (const std::size_t i = direction - seeds.first; direction >= seeds.first && i < jet_directions)
        x.derivatives()[i] = 1;
    }
    return x;
  }
  [[nodiscard]] std::size_t speeds() const { return dynamics.model_->layout().speeds; }

  [[nodiscard]] HingeState<T> hinge(std::size_t h) const {
    const Layout& layout = dynamics.model_->layout();
    const Slot& slot = layout.hinges[h];
    const Hinge& hinge = *dynamics.model_->hinges()[h].hinge;
    const auto n = static_cast<Eigen::Index>(slot.speeds);
    const auto x = y.subspan(slot.position, slot.positions);
    const std::vector<double> none(at_rest ? slot.speeds : 0, 0.0);
    const auto rates = at_rest ? std::span<const double>(none) : y.subspan(layout.positions + slot.speed, slot.speeds);
    HingeMotion m;
    m.H.resize(6, n);
    hinge.motion(x, rates, m);
    HingeState<T> s{m.pose.R.cast<T>(), m.pose.p.cast<T>(), m.H.cast<T>(), m.bias.cast<T>(), VX<T>(n), VX<T>(n)};
    for (Eigen::Index k = 0; k < n; ++k) {
      const std::size_t at = slot.speed + static_cast<std::size_t>(k);
      s.rates[k] = at_rest ? T(0.0) : seeded(rates[static_cast<std::size_t>(k)], speeds() + at);
      s.accelerations[k] = seeded(a[static_cast<Eigen::Index>(at)], 2 * speeds() + at);
    }
    if constexpr (std::is_same_v<T, Jet>) differentiate(hinge, slot, x, rates, m, s);
    return s;
  }

  /// Fills in the derivatives of pose, H and bias.
  void differentiate(const Hinge& hinge, const Slot& slot, std::span<const double> x, std::span<const double> rates,
                     const HingeMotion& m, HingeState<Jet>& s) const {
    const std::size_t n = slot.speeds;
    for (std::size_t k = 0; k < n; ++k) {
      if (const std::size_t i = slot.speed + k - seeds.first; slot.speed + k >= seeds.first && i < 8) {
        const auto set = [&](auto& target, const auto& derivative) {
          for (Eigen::Index e = 0; e < target.size(); ++e) target(e).derivatives()[i] = derivative(e);
        };
        const auto column = m.H.col(static_cast<Eigen::Index>(k));
        set(s.R, Matrix3(m.pose.R * skew<double>(Vector3(column.template head<3>()))));
        set(s.p, Vector3(m.pose.R * column.template tail<3>()));
        HingeMotion derivative;
        hinge.motion_derivative(x, rates, k, derivative);
        set(s.H, derivative.H);
        set(s.bias, derivative.bias);
      }
      if (const std::size_t i = speeds() + slot.speed + k - seeds.first;
          speeds() + slot.speed + k >= seeds.first && i < 8) {
        // The bias is a quadratic form of the rates, b(u, u): its derivative is 2 b(u, e) = b(u+e, u+e) − b(u, u) −
        // b(e, e).
        std::vector<double> unit(n, 0.0), sum(rates.begin(), rates.end());
        unit[k] = 1;
        sum[k] += 1;
        HingeMotion along, both;
        along.H.resize(6, static_cast<Eigen::Index>(n));
        both.H.resize(6, static_cast<Eigen::Index>(n));
        hinge.motion(x, unit, along);
        hinge.motion(x, sum, both);
        const Vector6 derivative = both.bias - m.bias - along.bias;
        for (Eigen::Index e = 0; e < 6; ++e) s.bias[e].derivatives()[i] = derivative[e];
      }
    }
  }

  /// q, q̇, q̈ of a body. Which of them a truncation keeps is the caller's.
  [[nodiscard]] BodyState<T> body(std::size_t b) const {
    const Layout& layout = dynamics.model_->layout();
    BodyState<T> s;
    s.order = dynamics.terms_[b].strain;
    s.rod = dynamics.rods_[b].get();
    const Slot* slot = dynamics.slots_[b];
    const auto n = static_cast<Eigen::Index>(slot != nullptr ? slot->speeds : 0);
    s.q.resize(n), s.q_dot.resize(n), s.q_ddot.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t at = slot->speed + static_cast<std::size_t>(i);
      s.q[i] = seeded(y[slot->position + static_cast<std::size_t>(i)], at);
      s.q_dot[i] = at_rest ? T(0.0) : seeded(y[layout.positions + at], speeds() + at);
      s.q_ddot[i] = seeded(a[static_cast<Eigen::Index>(at)], 2 * speeds() + at);
    }
    s.plain = std::is_same_v<T, Jet> && (slot == nullptr || (!seeds.meet(slot->speed, slot->speeds) &&
                                                             !seeds.meet(speeds() + slot->speed, slot->speeds)));
    return s;
  }

  [[nodiscard]] std::vector<HingeState<T>> hinges() const {
    std::vector<HingeState<T>> all;
    for (std::size_t h = 0; h < dynamics.model_->hinges().size(); ++h) all.push_back(hinge(h));
    return all;
  }
  /// Bodies with q, q̇ zero where `undeformed` says so.
  template <class Undeformed>
  [[nodiscard]] std::vector<BodyState<T>> bodies(Undeformed&& undeformed) const {
    std::vector<BodyState<T>> all;
    for (std::size_t b = 0; b < dynamics.model_->bodies().size(); ++b) {
      all.push_back(body(b));
      if (!undeformed(b)) continue;
      all.back().q.setZero();
      all.back().q_dot.setZero();
    }
    return all;
  }
};

TangentDynamics::TangentDynamics(std::shared_ptr<const Model> model, Terms terms)
    : model_(Model::in_kinematics(std::move(model), terms)), products_of_speeds_(terms.products_of_speeds) {
  for (std::size_t b = 0; b < model_->bodies().size(); ++b) {
    const BodyNode& body = model_->bodies()[b];
    slots_.push_back(model_->layout().modes(b));
    terms_.push_back(body.terms.value_or(terms));
    rods_.emplace_back();
    if (slots_.back() == nullptr) continue;
    const Terms own = terms_.back();
    strict_ = strict_ || own.truncation == Truncation::strict;
    symmetric_ = symmetric_ || own.truncation == Truncation::symmetric;
    if (own.strain != StrainOrder::exact || own.truncation != Truncation::none) continue;
    const Rod* rod = body.body->rod();
    if (rod == nullptr) throw std::invalid_argument("body '" + body.name + "' has no exact kinematics");
    rods_.back() = std::make_shared<const RodTable>(*rod);
  }
  for (const LoadNode& node : model_->loads())
    controlled_frames_ = controlled_frames_ || (node.continuous != nullptr && !node.load->frames().empty());
}

template <class T>
std::vector<AppliedWrench<T>> TangentDynamics::wrenches(double t, std::span<const double> y, const Recursion<T>& shown,
                                                        std::vector<bool>* differenced) const {
  std::vector<AppliedWrench<T>> all;
  for (std::size_t l = 0; l < model_->loads().size(); ++l) {
    const BoundLoad& load = *model_->loads()[l].load;
    if (load.frames().empty()) continue;
    std::vector<FrameState<T>> frames;
    for (const FrameIndex& at : load.frames()) frames.push_back(shown.frame_state(at));
    bool depends = false;
    for (AppliedWrench<T>& w : analysis::wrenches_of(model_->loads()[l], *model_, t, y, frames, depends))
      all.push_back(std::move(w));
    if (differenced != nullptr && depends) (*differenced)[l] = true;
  }
  return all;
}

template <class T>
VX<T> TangentDynamics::efforts(double t, std::span<const double> y, const Eigen::VectorXd& a, Seeds seeds,
                               std::vector<bool>* differenced, std::span<const double> seen) const {
  const Builder<T> build{*this, y, a, seeds};
  const auto ruthless = [&](std::size_t b) { return terms_[b].truncation == Truncation::ruthless; };
  const Recursion<T> shown(*model_, build.hinges(), build.bodies(ruthless));
  const std::vector<AppliedWrench<T>> wrenches = this->wrenches(t, seen.empty() ? y : seen, shown, differenced);
  if (!products_of_speeds_) {
    const Builder<T> still{*this, y, a, seeds, true};
    return Recursion<T>(*model_, still.hinges(), still.bodies(ruthless)).efforts(wrenches);
  }
  if (symmetric_)
    return analysis::FirstOrderRecursion<T>(*model_, build.hinges(), build.bodies(ruthless)).efforts(wrenches);
  if (!strict_) return shown.efforts(wrenches);

  // Theory (3): the undeformed tree with q̈, and the part of first order in ε of the tree with εq, εq̇ and without q̈.
  const auto all = [](std::size_t) { return true; };
  VX<T> r = Recursion<T>(*model_, build.hinges(), build.bodies(all)).efforts(wrenches);
  using D = Dual<T>;
  std::vector<HingeState<D>> hinges;
  for (const HingeState<T>& h : build.hinges()) {
    hinges.push_back({h.R.template cast<D>(), h.p.template cast<D>(), h.H.template cast<D>(), h.bias.template cast<D>(),
                      h.rates.template cast<D>(), h.accelerations.template cast<D>()});
  }
  std::vector<BodyState<D>> bodies;
  for (const BodyState<T>& b : build.bodies(ruthless)) {
    const auto first_order = [](const T& x) {
      D d(T(0.0));
      d.derivatives()[0] = x;
      return d;
    };
    BodyState<D> s;
    s.order = b.order;
    s.q = b.q.unaryExpr(first_order);
    s.q_dot = b.q_dot.unaryExpr(first_order);
    s.q_ddot = VX<D>::Zero(b.q.size());
    s.plain = b.plain;
    bodies.push_back(std::move(s));
  }
  std::vector<AppliedWrench<D>> constant;
  for (const AppliedWrench<T>& w : wrenches)
    constant.push_back({w.at, w.moment.template cast<D>(), w.force.template cast<D>()});
  const VX<D> first = Recursion<D>(*model_, std::move(hinges), std::move(bodies)).efforts(constant);
  for (Eigen::Index i = 0; i < r.size(); ++i) r[i] += first[i].derivatives()[0];
  return r;
}

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

Eigen::VectorXd TangentDynamics::steady_accelerations(double t) const {
  Eigen::VectorXd a = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model_->layout().speeds));
  model_->prescribe_accelerations(t, {a.data(), model_->layout().speeds});
  return a;
}

Eigen::VectorXd TangentDynamics::residual(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  return efforts<double>(t, y, a, {}) + elastic(y) - load_efforts(t, y);
}

Eigen::VectorXd TangentDynamics::differentiate(double t, std::span<const double> y, const Eigen::VectorXd& a,
                                               std::size_t from, Eigen::Ref<Eigen::MatrixXd> columns,
                                               std::vector<bool>* differenced) const {
  const Eigen::Index n = columns.rows();
  Eigen::VectorXd values = Eigen::VectorXd::Zero(n);
  for (Eigen::Index first = 0; first < columns.cols(); first += 8) {
    const VX<Jet> r = efforts<Jet>(t, y, a, {from + static_cast<std::size_t>(first)}, differenced);
    const Eigen::Index count = std::min<Eigen::Index>(8, columns.cols() - first);
    for (Eigen::Index i = 0; i < n; ++i) {
      values[i] = r[i].value();
      columns.block(i, first, 1, count) = derivatives_of(r[i]).head(count).transpose();
    }
  }
  return values + elastic(y) - load_efforts(t, y);
}

Stiffness TangentDynamics::stiffness(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  Tangents result;
  result.by_position.resize(n, n);
  result.by_speed.setZero(n, n);
  result.residual = differentiate(t, y, a, 0, result.by_position, nullptr);
  add_elastic(result);
  add_loads(t, y, a, result);
  return {std::move(result.residual), std::move(result.by_position)};
}

Eigen::VectorXd TangentDynamics::mass_diagonal(double t, std::span<const double> y) const {
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  Eigen::MatrixXd mass(n, n);
  differentiate(t, y, Eigen::VectorXd::Zero(n), 2 * model_->layout().speeds, mass, nullptr);
  return mass.diagonal();
}

Tangents TangentDynamics::tangents(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  Eigen::MatrixXd all(n, 3 * n);
  std::vector<bool> differenced(model_->loads().size(), false);
  Tangents result;
  result.residual = differentiate(t, y, a, 0, all, &differenced);
  result.by_position = all.leftCols(n);
  result.by_speed = all.middleCols(n, n);
  result.mass = all.rightCols(n);
  add_elastic(result);
  for (std::size_t l = 0; l < differenced.size(); ++l) {
    if (differenced[l]) result.differenced.push_back(model_->loads()[l].name);
  }
  add_loads(t, y, a, result);
  result.drift = drift(y);
  return result;
}

void TangentDynamics::add_elastic(Tangents& result) const {
  for (std::size_t b = 0; b < slots_.size(); ++b) {
    if (slots_[b] == nullptr) continue;
    const ModalShape& shape = model_->bodies()[b].body->shape();
    const auto at = static_cast<Eigen::Index>(slots_[b]->speed);
    result.by_position.block(at, at, shape.modes(), shape.modes()) += shape.stiffness;
    result.by_speed.block(at, at, shape.modes(), shape.modes()) += shape.damping;
  }
}

void TangentDynamics::add_loads(double t, std::span<const double> y, const Eigen::VectorXd& a,
                                Tangents& tangents) const {
  const Layout& layout = model_->layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  Eigen::MatrixXd by_position = Eigen::MatrixXd::Zero(n, n), by_speed = by_position;
  for (const LoadNode& node : model_->loads()) {
    const BoundLoad& load = *node.load;
    const auto positions = y.first(layout.positions), speeds = y.subspan(layout.positions, layout.speeds);
    if (load.add_derivatives(t, positions, speeds, by_position, by_speed)) continue;
    const Eigen::MatrixXd position_before = by_position, speed_before = by_speed;
    const auto at = [&](std::span<const double> state) -> Eigen::VectorXd {
      Eigen::VectorXd efforts = Eigen::VectorXd::Zero(n);
      std::vector<double> scratch(load.scratch());
      load.add(t, state.first(layout.positions), state.subspan(layout.positions, layout.speeds),
               {efforts.data(), layout.speeds}, scratch);
      return efforts;
    };
    for (Eigen::Index j = 0; j < n; ++j) {
      by_position.col(j) += central_difference(
          [&](double h) {
            std::vector<double> moved(y.begin(), y.end());
            displace(moved, h * Eigen::VectorXd::Unit(n, j));
            return at(moved);
          },
          difference_step);
      by_speed.col(j) += central_difference(
          [&](double h) {
            std::vector<double> moved(y.begin(), y.end());
            moved[layout.positions + static_cast<std::size_t>(j)] += h;
            return at(moved);
          },
          difference_step);
    }
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
    displace(moved, h * Eigen::VectorXd::Unit(n, static_cast<Eigen::Index>(speed)));
  };
  // The residual has efforts on its other side.
  const auto of_wrenches = [&, none = Eigen::VectorXd(Eigen::VectorXd::Zero(n))](std::span<const double> seen) {
    return Eigen::VectorXd(-efforts<double>(t, y, none, {}, nullptr, seen));
  };
  std::function<Eigen::VectorXd(std::span<const double>)> at_frames;
  if (controlled_frames_) at_frames = of_wrenches;
  ContinuousTangents own =
      continuous_tangents(*model_, t, y, {a.data(), model_->layout().speeds}, move, at_frames, differenced);
  tangents.by_position -= own.effort_by_position;
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

void TangentDynamics::displace(std::span<double> y, const Eigen::VectorXd& delta) const {
  const Layout& layout = model_->layout();
  const std::span<const double> d(delta.data(), layout.speeds);
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    const Hinge& hinge = *model_->hinges()[h].hinge;
    const auto x = y.subspan(slot.position, slot.positions);
    std::vector<double> change(slot.positions);
    hinge.derivatives(x, d.subspan(slot.speed, slot.speeds), change);
    for (std::size_t i = 0; i < slot.positions; ++i) x[i] += change[i];
    hinge.normalize(x);
  }
  for (const Slot& slot : layout.bodies) {
    for (std::size_t i = 0; i < slot.positions; ++i) y[slot.position + i] += d[slot.speed + i];
  }
}

Eigen::MatrixXd TangentDynamics::drift(std::span<const double> y) const {
  const Layout& layout = model_->layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    if (slot.positions == slot.speeds || slot.speeds == 0) continue;
    // With ẋ = N(x) u and δx = N δ along the motion, N δ̇ = N δu + (∂N[N δ] u − ∂N[N u] δ). N is linear in quaternions,
    // for which a difference is exact.
    const Hinge& hinge = *model_->hinges()[h].hinge;
    const auto x = y.subspan(slot.position, slot.positions);
    const auto u = y.subspan(layout.positions + slot.speed, slot.speeds);
    const auto count = static_cast<Eigen::Index>(slot.positions), m = static_cast<Eigen::Index>(slot.speeds);
    const auto rate = [&](std::span<const double> at, std::span<const double> speeds) {
      Eigen::VectorXd x_dot(count);
      hinge.derivatives(at, speeds, {x_dot.data(), slot.positions});
      return x_dot;
    };
    const auto change = [&](const Eigen::VectorXd& direction, std::span<const double> speeds) {
      return central_difference(
          [&](double s) {
            Eigen::VectorXd moved = s * direction;
            for (Eigen::Index i = 0; i < count; ++i) moved[i] += x[static_cast<std::size_t>(i)];
            return rate({moved.data(), slot.positions}, speeds);
          },
          0.02);
    };
    Eigen::MatrixXd N(count, m), bracket(count, m);
    std::vector<double> unit(slot.speeds);
    const Eigen::VectorXd along = rate(x, u);
    for (Eigen::Index k = 0; k < m; ++k) {
      std::fill(unit.begin(), unit.end(), 0.0);
      unit[static_cast<std::size_t>(k)] = 1;
      N.col(k) = rate(x, unit);
      bracket.col(k) = change(N.col(k), u) - change(along, unit);
    }
    const Eigen::MatrixXd change_of_speeds = N.colPivHouseholderQr().solve(bracket);
    C.block(static_cast<Eigen::Index>(slot.speed), static_cast<Eigen::Index>(slot.speed), m, m) = change_of_speeds;
  }
  return C;
}

FrameTangent TangentDynamics::frame(std::span<const double> y, int body, int frame) const {
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(n);
  FrameTangent result;
  result.by_position.resize(3, n);
  result.deflection_by_position.resize(3, n);
  for (Eigen::Index first = 0; first < n; first += 8) {
    const Builder<Jet> build{*this, y, rest, {static_cast<std::size_t>(first)}};
    const auto none = [](std::size_t) { return false; };
    const auto [p, d] = Recursion<Jet>(*model_, build.hinges(), build.bodies(none)).frame_position(body, frame);
    const Eigen::Index count = std::min<Eigen::Index>(8, n - first);
    for (Eigen::Index i = 0; i < 3; ++i) {
      result.position[i] = p[i].value();
      result.by_position.block(i, first, 1, count) = derivatives_of(p[i]).head(count).transpose();
      result.deflection[i] = d[i].value();
      result.deflection_by_position.block(i, first, 1, count) = derivatives_of(d[i]).head(count).transpose();
    }
  }
  return result;
}

}  // namespace withy
