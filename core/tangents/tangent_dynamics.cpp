#include "withy/core/tangents/tangent_dynamics.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/tangents/closed_motions.hpp"
#include "withy/core/tangents/first_order_recursion.hpp"
#include "withy/core/tangents/load_wrenches.hpp"
#include "withy/core/tangents/seeded_states.hpp"

namespace withy {

using analysis::AppliedWrench;
using analysis::BodyState;
using analysis::Dual;
using analysis::FrameState;
using analysis::HingeState;
using analysis::Recursion;

namespace {

template <class S>
using VX = Eigen::Matrix<S, Eigen::Dynamic, 1>;

}  // namespace

/// Of each of the trees that efforts are made of, by what its bodies' q, q̇ are.
struct TangentDynamics::Plain {
  template <class T>
  using Known = std::shared_ptr<analysis::PlainBodies<T>>;
  template <class T>
  static Known<T> none() {
    return std::make_shared<analysis::PlainBodies<T>>();
  }
  Known<double> shown = none<double>(), at_rest = none<double>(), undeformed = none<double>();
  Known<Dual<double>> first_order = none<Dual<double>>();

  /// Of numbers that carry no derivatives nothing is known beforehand.
  template <class S, class T>
  static Known<typename Recursion<S>::Plain> of(const Known<T>& known) {
    if constexpr (std::is_same_v<typename Recursion<S>::Plain, T> && !std::is_same_v<S, T>)
      return known;
    else
      return nullptr;
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
    if (model_->is_exact(b, terms)) rods_.back() = std::make_shared<const RodTable>(*body.body->rod());
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
VX<T> TangentDynamics::efforts(double t, std::span<const double> y, const Eigen::VectorXd& a, Seeds seeds, Plain& plain,
                               std::vector<bool>* differenced, std::span<const double> seen) const {
  const Builder<T> build{*this, y, a, seeds};
  const auto ruthless = [&](std::size_t b) { return terms_[b].truncation == Truncation::ruthless; };
  const Recursion<T> shown(*model_, build.hinges(), build.bodies(ruthless), Plain::of<T>(plain.shown));
  const std::vector<AppliedWrench<T>> wrenches = this->wrenches(t, seen.empty() ? y : seen, shown, differenced);
  if (!products_of_speeds_) {
    const Builder<T> still{*this, y, a, seeds, true};
    return Recursion<T>(*model_, still.hinges(), still.bodies(ruthless), Plain::of<T>(plain.at_rest)).efforts(wrenches);
  }
  if (symmetric_)
    return analysis::FirstOrderRecursion<T>(*model_, build.hinges(), build.bodies(ruthless)).efforts(wrenches);
  if (!strict_) return shown.efforts(wrenches);

  // Theory (3): the undeformed tree with q̈, and the part of first order in ε of the tree with εq, εq̇ and without q̈.
  const auto all = [](std::size_t) { return true; };
  VX<T> r = Recursion<T>(*model_, build.hinges(), build.bodies(all), Plain::of<T>(plain.undeformed)).efforts(wrenches);
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
  const VX<D> first =
      Recursion<D>(*model_, std::move(hinges), std::move(bodies), Plain::of<D>(plain.first_order)).efforts(constant);
  for (Eigen::Index i = 0; i < r.size(); ++i) r[i] += first[i].derivatives()[0];
  return r;
}

Eigen::VectorXd TangentDynamics::frame_load_efforts(double t, std::span<const double> y,
                                                    std::span<const double> seen) const {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model_->layout().speeds));
  Plain plain;
  return -efforts<double>(t, y, none, {}, plain, nullptr, seen);
}

Eigen::VectorXd TangentDynamics::steady_accelerations(double t) const {
  Eigen::VectorXd a = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model_->layout().speeds));
  model_->prescribe_accelerations(t, {a.data(), model_->layout().speeds});
  return a;
}

Eigen::VectorXd TangentDynamics::reflected() const {
  const Layout& layout = model_->layout();
  Eigen::VectorXd inertia = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.speeds));
  for (std::size_t h = 0; h < layout.hinges.size(); ++h)
    if (layout.hinges[h].speeds == 1)
      inertia[static_cast<Eigen::Index>(layout.hinges[h].speed)] = model_->hinges()[h].reflected_inertia;
  return inertia;
}

Eigen::VectorXd TangentDynamics::open_residual(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  Plain plain;
  return efforts<double>(t, y, a, {}, plain) + reflected().cwiseProduct(a) + elastic(y) - load_efforts(t, y);
}

Eigen::VectorXd TangentDynamics::terms_in_play(double t, std::span<const double> y,
                                               const Eigen::VectorXd& moving) const {
  const Eigen::VectorXd a = whole(y, moving);
  const Builder<double> build{*this, y, a, {}};
  const Recursion<double> tree(*model_, build.hinges(), build.bodies([](std::size_t) { return false; }));
  const Eigen::VectorXd sizes = analysis::sizes_of(tree, wrenches(t, y, tree, nullptr)) +
                                reflected().cwiseProduct(a).cwiseAbs() + elastic(y).cwiseAbs() + load_sizes(t, y);
  return closed_ ? Eigen::VectorXd(closed_->at(y).Z.cwiseAbs().transpose() * sizes) : sizes;
}

Eigen::VectorXd TangentDynamics::stiffness_in_play(double t, std::span<const double> y, const Eigen::VectorXd& moving,
                                                   const Eigen::VectorXd& terms, const Eigen::VectorXd& mass) const {
  /// Data are seldom typed more exactly than to 1e-9, a hundred times what derivatives are known to.
  constexpr double typed = 100;
  const Eigen::VectorXd a = whole(y, moving);
  const Builder<double> build{*this, y, a, {}};
  const Recursion<double> tree(*model_, build.hinges(), build.bodies([](std::size_t) { return false; }));
  const Eigen::VectorXd sizes = analysis::sizes_of(tree, wrenches(t, y, tree, nullptr));
  double squared = 0;
  for (const ModelRate& rate : hinge_rates(*model_)) {
    if (!rate.angular) continue;
    const auto i = static_cast<Eigen::Index>(rate.speed);
    const double turned = y[model_->layout().positions + rate.speed];
    squared = std::max({squared, turned * turned, mass[i] > 0 ? typed * sizes[i] / mass[i] : 0.0});
  }
  return terms + squared * mass.cwiseAbs();
}

Eigen::VectorXd TangentDynamics::rates(double t, std::span<const double> y, const Eigen::VectorXd& moving) const {
  const Layout& layout = model_->layout();
  const Eigen::VectorXd a = whole(y, moving);
  std::vector<double> y_dot(layout.size()), scratch(model_->load_scratch());
  std::copy_n(a.data(), a.size(), y_dot.begin() + static_cast<std::ptrdiff_t>(layout.positions));
  // Of states that are not finite the rates are not finite.
  static_cast<void>(model_->continuous_rates(t, y, y_dot, scratch));
  return Eigen::Map<const Eigen::VectorXd>(y_dot.data() + layout.positions + layout.speeds,
                                           static_cast<Eigen::Index>(layout.continuous));
}

std::vector<std::size_t> TangentDynamics::directions(std::size_t from, std::size_t count) const {
  const Layout& layout = model_->layout();
  std::vector<std::size_t> all;
  const auto add = [&](const std::vector<Slot>& slots, std::size_t kind) {
    for (const Slot& slot : slots) {
      for (std::size_t i = 0; i < slot.speeds; ++i)
        if (const std::size_t d = kind * layout.speeds + slot.speed + i; d >= from && d < from + count)
          all.push_back(d);
    }
  };
  for (const Slot& slot : layout.bodies)
    for (const std::size_t kind : {0, 1}) add({slot}, kind);
  for (const std::size_t kind : {0, 1, 2}) add(layout.hinges, kind);
  add(layout.bodies, 2);
  return all;
}

Eigen::VectorXd TangentDynamics::differentiate(double t, std::span<const double> y, const Eigen::VectorXd& a,
                                               std::size_t from, Eigen::Ref<Eigen::MatrixXd> columns,
                                               std::vector<bool>* differenced) const {
  const Eigen::Index n = columns.rows();
  Eigen::VectorXd values = Eigen::VectorXd::Zero(n);
  Plain plain;
  const std::vector<std::size_t> all = directions(from, static_cast<std::size_t>(columns.cols()));
  for (std::size_t first = 0; first < all.size(); first += jet_directions) {
    const Seeds seeds{std::span(all).subspan(first, std::min(jet_directions, all.size() - first))};
    const VX<Jet> r = efforts<Jet>(t, y, a, seeds, plain, differenced);
    for (Eigen::Index i = 0; i < n; ++i) {
      values[i] = r[i].value();
      for (std::size_t k = 0; k < seeds.directions.size(); ++k)
        columns(i, static_cast<Eigen::Index>(seeds.directions[k] - from)) = r[i].derivatives()[k];
    }
  }
  const Eigen::VectorXd inertia = reflected();
  // Columns of accelerations come last.
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index of_acceleration = 2 * n + i - static_cast<Eigen::Index>(from);
    if (of_acceleration < columns.cols()) columns(i, of_acceleration) += inertia[i];
  }
  return values + inertia.cwiseProduct(a) + elastic(y) - load_efforts(t, y);
}

Stiffness TangentDynamics::open_stiffness(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  Tangents result;
  result.by_position.resize(n, n);
  result.by_speed.setZero(n, n);
  result.residual = differentiate(t, y, a, 0, result.by_position, nullptr);
  result.in_play = result.by_position.diagonal().cwiseAbs();
  add_elastic(result);
  add_loads(t, y, a, result);
  return {std::move(result.residual),         std::move(result.by_position),   std::move(result.by_state),
          std::move(result.rate_by_position), std::move(result.rate_by_state), std::move(result.in_play)};
}

Eigen::MatrixXd TangentDynamics::open_mass(double t, std::span<const double> y) const {
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  Eigen::MatrixXd mass(n, n);
  differentiate(t, y, Eigen::VectorXd::Zero(n), 2 * model_->layout().speeds, mass, nullptr);
  return mass;
}

Tangents TangentDynamics::open_tangents(double t, std::span<const double> y, const Eigen::VectorXd& a) const {
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  Eigen::MatrixXd all(n, 3 * n);
  std::vector<bool> differenced(model_->loads().size(), false);
  Tangents result;
  result.residual = differentiate(t, y, a, 0, all, &differenced);
  result.by_position = all.leftCols(n);
  result.by_speed = all.middleCols(n, n);
  result.mass = all.rightCols(n);
  result.in_play = result.by_position.diagonal().cwiseAbs();
  add_elastic(result);
  for (std::size_t l = 0; l < differenced.size(); ++l) {
    if (differenced[l]) result.differenced.push_back(model_->loads()[l].name);
  }
  add_loads(t, y, a, result);
  result.drift = drift(y);
  return result;
}

FrameTangent TangentDynamics::frame(std::span<const double> y, int body, int frame) const {
  const auto n = static_cast<Eigen::Index>(model_->layout().speeds);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(n);
  FrameTangent result;
  result.by_position.resize(3, n);
  result.deflection_by_position.resize(3, n);
  std::vector<std::size_t> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), std::size_t{0});
  for (Eigen::Index first = 0; first < n; first += 8) {
    const Eigen::Index count = std::min<Eigen::Index>(8, n - first);
    const Seeds seeds{std::span(all).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count))};
    const Builder<Jet> build{*this, y, rest, seeds};
    const auto none = [](std::size_t) { return false; };
    const auto [p, d] = Recursion<Jet>(*model_, build.hinges(), build.bodies(none)).frame_position(body, frame);
    for (Eigen::Index i = 0; i < 3; ++i) {
      result.position[i] = p[i].value();
      result.by_position.block(i, first, 1, count) = derivatives_of(p[i]).head(count).transpose();
      result.deflection[i] = d[i].value();
      result.deflection_by_position.block(i, first, 1, count) = derivatives_of(d[i]).head(count).transpose();
    }
  }
  if (closed_) {
    const Eigen::MatrixXd Z = closed_->at(y).Z;
    result.by_position *= Z;
    result.deflection_by_position *= Z;
  }
  return result;
}

}  // namespace withy
