#include "withy/study/sampled_steady.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "withy/core/analysis/unreached.hpp"
#include "withy/core/plugin/digital_part.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/sampled_loads.hpp"

namespace withy::study {
namespace {

constexpr int most_iterations = 50;
/// A change this small against what there is and what has changed is rounding.
constexpr double converged_change = 1e-11;
/// Below this share of the greatest singular value the equations count as singular.
constexpr double singular_share = 1e-12;
constexpr double shortest_part = 1e-4;
/// A sample that adds to what is held keeps it: a derivative this near to one is one, and rounding holds nothing.
constexpr double kept_exactly = 1e-12;

/// A state with the equations of a change (δ of the free speeds, continuous states, what is held) that balances it.
class Balance {
 public:
  explicit Balance(Configuration at)
      : configuration_(std::move(at)),
        motions_(configuration_, {}),
        sampled_(motions_),
        m_(static_cast<Eigen::Index>(motions_.free().size())),
        states_(motions_.size() - 2 * m_) {
    const Eigen::Index d = sampled_.size(), n = motions_.size(), all = m_ + states_ + d;
    const SampledLoads::Held held{
        motions_.A(), sampled_.moved(sampled_.efforts()), Eigen::MatrixXd::Zero(n, 0), {}, {}};
    Eigen::MatrixXd rows(n + d, n + d);
    rows.topLeftCorner(n, n) = held.A;
    rows.topRightCorner(n, d) = held.by_held;
    rows.bottomRows(d) = sampled_.renewal(held).bottomRows(d);
    for (double& kept : rows.bottomRightCorner(d, d).diagonal())
      kept = std::abs(kept - 1) <= kept_exactly ? 0.0 : kept - 1;
    J_.resize(all, all);
    J_.leftCols(m_) = rows.bottomRows(all).leftCols(m_);
    J_.rightCols(states_ + d) = rows.bottomRows(all).rightCols(states_ + d);
    left_.resize(all);
    left_.head(m_) = motions_.accelerations()(motions_.free());
    left_.segment(m_, states_) = motions_.rates(motions_.state());
    left_.tail(d) = sampled_.change();
    choose_units();
  }

  [[nodiscard]] bool finite() const { return J_.allFinite() && left_.allFinite(); }
  [[nodiscard]] const Configuration& configuration() const { return configuration_; }
  [[nodiscard]] const Eigen::VectorXd& columns() const { return columns_; }  ///< units of changes
  [[nodiscard]] Eigen::Index displacements() const { return m_; }
  [[nodiscard]] Eigen::VectorXd rates() const { return left_.segment(m_, states_); }
  [[nodiscard]] Eigen::VectorXd renewed() const { return left_.tail(sampled_.size()); }
  [[nodiscard]] bool singular() const { return solver_.rank() < J_.rows(); }

  /// The change that these equations ask for where so much is left over, in their units.
  [[nodiscard]] Eigen::VectorXd change(const Balance& of) const { return -solver_.solve(rows_.cwiseProduct(of.left_)); }
  /// Whether data that are typed with some digits could balance.
  [[nodiscard]] bool balanced() const {
    return !singular() || reaches(scaled(), solver_.rank(), rows_.cwiseProduct(left_), rows_.cwiseProduct(in_play()));
  }
  /// Whether what is left over is what rounding leaves of the terms in it: no change makes it less.
  [[nodiscard]] bool rounding() const {
    const double share = rounding_of_sums(configuration_.prepared().model().bodies().size());
    return (left_.array().abs() <= share * in_play().array()).all();
  }
  /// Where a change leads to.
  [[nodiscard]] Configuration moved(const Eigen::VectorXd& change) const {
    Configuration there = configuration_;
    State state = configuration_.state();
    const Layout& layout = configuration_.layout();
    Eigen::VectorXd displaced = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.speeds));
    displaced(motions_.free()) = change.head(m_);
    configuration_.dynamics().displace(state.y, displaced);
    for (Eigen::Index i = 0; i < states_; ++i)
      state.y[layout.positions + layout.speeds + static_cast<std::size_t>(i)] += change[m_ + i];
    Eigen::Index next = m_ + states_;
    for (const LoadSlot& slot : sampled_slots(configuration_.prepared().model()))
      for (std::size_t i = slot.first; i < slot.first + slot.count; ++i) state.y[i] += change[next++];
    there.set_state(std::move(state));
    return there;
  }
  /// What a change is measured against: coordinates, not less than what no drawing shows; of the rest what there is and
  /// what does as much as that.
  [[nodiscard]] Eigen::VectorXd sizes() const {
    const Layout& layout = configuration_.layout();
    Eigen::VectorXd all(J_.rows());
    all.head(m_).setConstant(size());
    const double like = size() / (m_ > 0 ? columns_.head(m_).minCoeff() : 1.0);
    all.tail(J_.rows() - m_) = like * columns_.tail(J_.rows() - m_);
    Eigen::Index next = m_;
    for (std::size_t i = layout.positions + layout.speeds; i < layout.moving(); ++i)
      all[next++] += std::abs(configuration_.state().y[i]);
    for (const LoadSlot& slot : sampled_slots(configuration_.prepared().model()))
      for (std::size_t i = slot.first; i < slot.first + slot.count; ++i)
        all[next++] += std::abs(configuration_.state().y[i]);
    return all;
  }
  /// Displacements that nothing holds, a unit vector, one a speed.
  [[nodiscard]] Eigen::VectorXd neutral() const {
    const Eigen::VectorXd direction = unheld(scaled(), solver_.rank(), rows_.cwiseProduct(left_));
    Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(configuration_.layout().speeds));
    all(motions_.free()) = columns_.cwiseProduct(direction).head(m_);
    return all.norm() > 0 ? Eigen::VectorXd(all / all.norm()) : Eigen::VectorXd();
  }

 private:
  /// What the terms of what is left over amount to.
  [[nodiscard]] Eigen::VectorXd in_play() const {
    Eigen::VectorXd all(J_.rows());
    all << accelerations_in_play(), J_.bottomRows(J_.rows() - m_).cwiseAbs() * sizes();
    return all;
  }
  [[nodiscard]] double size() const {
    double s = 1e-6;
    for (std::size_t i = 0; i < configuration_.layout().positions; ++i)
      s = std::max(s, std::abs(configuration_.state().y[i]));
    return s;
  }
  /// What the terms of the free accelerations amount to.
  [[nodiscard]] Eigen::VectorXd accelerations_in_play() const {
    const State& state = configuration_.state();
    const TangentDynamics& dynamics = configuration_.dynamics();
    const Eigen::VectorXd& a = motions_.accelerations();
    const std::vector<Eigen::Index>& free = motions_.free();
    const Eigen::MatrixXd mass = dynamics.tangents(state.time, state.y, a).mass(free, free);
    return mass.inverse().cwiseAbs() * dynamics.terms_in_play(state.time, state.y, a)(free);
  }
  [[nodiscard]] Eigen::MatrixXd scaled() const { return rows_.asDiagonal() * J_ * columns_.asDiagonal(); }
  /// Units as in find_steady_state: displacements in which inertias are one, what forces as much as the stiffest of
  /// them does, and rows as large as that.
  void choose_units() {
    rows_ = columns_ = Eigen::VectorXd::Ones(J_.rows());
    if (!finite() || J_.size() == 0) return;
    const State& state = configuration_.state();
    const Eigen::VectorXd mass = configuration_.dynamics().mass(state.time, state.y).diagonal()(motions_.free());
    rows_.head(m_) = mass.cwiseAbs().cwiseSqrt();
    for (double& root : rows_.head(m_)) root = root > 0 ? root : 1.0;
    columns_.head(m_) = rows_.head(m_).cwiseInverse();
    const auto greatest = [](const auto& part) { return part.size() > 0 ? part.cwiseAbs().maxCoeff() : 0.0; };
    const Eigen::Index rest = J_.rows() - m_;
    Eigen::MatrixXd now = scaled();
    const double stiffest = greatest(now.topLeftCorner(m_, m_)), like = stiffest > 0 ? stiffest : 1.0;
    for (Eigen::Index j = m_; j < J_.rows(); ++j) {
      const double force = greatest(now.col(j).head(m_));
      const double felt = force > 0 ? force : greatest(now.col(j).tail(rest));
      if (felt > 0) columns_[j] = like / felt;
    }
    now = scaled();
    for (Eigen::Index i = m_; i < J_.rows(); ++i)
      if (const double row = greatest(now.row(i)); row > 0) rows_[i] = like / row;
    solver_.setThreshold(singular_share);
    solver_.compute(scaled());
  }

  Configuration configuration_;
  SmallMotions motions_;
  SampledLoads sampled_;
  Eigen::Index m_, states_;
  Eigen::MatrixXd J_;
  Eigen::VectorXd left_, rows_, columns_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver_;
};

/// No mode moves.
Configuration at_rest(Configuration c) {
  State state = c.state();
  for (const Slot& slot : c.layout().bodies)
    for (std::size_t i = 0; i < slot.speeds; ++i) state.y[c.layout().positions + slot.speed + i] = 0;
  c.set_state(std::move(state));
  return c;
}

/// Whether there is such a state: where its loops could not be closed it is no number, and nothing samples it.
bool has_place(const Configuration& c) {
  const auto first = c.state().y.begin();
  return std::all_of(first, first + static_cast<std::ptrdiff_t>(c.layout().moving()),
                     [](double y) { return std::isfinite(y); });
}

/// The balance a part of the change further on, where the next change is smaller; nothing where none is.
std::unique_ptr<Balance> advanced(const Balance& here, const Eigen::VectorXd& change, Eigen::VectorXd& changed) {
  for (double part = 1; part > shortest_part; part *= 0.5) {
    const Eigen::VectorXd taken = part * here.columns().cwiseProduct(change);
    Configuration at = here.moved(taken);
    if (!has_place(at)) continue;
    auto there = std::make_unique<Balance>(std::move(at));
    if (!there->finite()) continue;
    const bool rounding = part == 1 && (taken.array().abs() <= 1e-9 * here.sizes().array()).all();
    if (!rounding && !(here.change(*there).norm() <= (1 - 0.25 * part) * change.norm())) continue;
    changed += taken.cwiseAbs();
    return there;
  }
  return nullptr;
}

/// The load that draws a number at each sample, which leaves nothing as it is; null: none does.
const LoadNode* drawing(const Model& model) {
  for (const LoadSlot& slot : sampled_slots(model)) {
    const LoadNode& load = model.loads()[slot.load];
    const auto* digital = dynamic_cast<const DigitalPart*>(load.load->discrete());
    if (digital != nullptr && digital->draws()) return &load;
  }
  return nullptr;
}

void refuse_draws(const Prepared& prepared) {
  if (const LoadNode* load = drawing(prepared.model()))
    throw InputError(
        fmt::format("{}: load '{}' draws a number at each sample, and nothing stays as it is: take its "
                    "deviation away (--set loads.{}.deviation=0)",
                    prepared.scene.file, load->name, load->name));
}

}  // namespace

bool is_steady(const Configuration& c) {
  if (!c.sampled()) return is_steady_state(c.dynamics(), c.state(), c.held());
  constexpr double kept_change = 1e-9;
  if (drawing(c.prepared().model()) != nullptr) return false;
  const Balance balance(c);
  if (!balance.finite()) return false;
  const Eigen::VectorXd step = balance.columns().cwiseProduct(balance.change(balance));
  return step.allFinite() && (step.array().abs() <= kept_change * balance.sizes().array()).all() && balance.balanced();
}

SteadyState steady_state_of(const Configuration& c) {
  if (!c.sampled()) return find_steady_state(c.dynamics(), c.state(), c.held());
  refuse_draws(c.prepared());
  SteadyState result;
  auto balance = std::make_unique<Balance>(at_rest(c));
  Eigen::VectorXd changed = Eigen::VectorXd::Zero(balance->columns().size());
  Eigen::VectorXd change;
  double before = std::numeric_limits<double>::infinity();  // size of the change before
  for (; balance->finite() && result.iterations < most_iterations; ++result.iterations) {
    change = balance->change(*balance);
    const Eigen::VectorXd step = balance->columns().cwiseProduct(change);
    if (!step.allFinite()) break;
    if ((step.array().abs() <= converged_change * (balance->sizes() + changed).array()).all()) {
      result.converged = balance->balanced();
      break;
    }
    // As find_steady_state: where steps shrink no more, rounding may be all that is left over.
    const bool shrinks = change.norm() <= 0.25 * before;
    before = change.norm();
    auto next = shrinks || !balance->rounding() ? advanced(*balance, change, changed) : nullptr;
    if (next == nullptr) {
      result.converged = balance->rounding() && balance->balanced();
      break;
    }
    balance = std::move(next);
  }
  const Configuration& found = balance->configuration();
  const Eigen::VectorXd rest = found.dynamics().steady_accelerations(found.state().time);
  Renewal renewal(found.prepared().model(), *found.prepared().equations);
  result.state = told_at(found.prepared().model(), renewal, found.state());
  result.efforts = found.dynamics().residual(found.state().time, found.state().y, rest);
  result.rates = balance->rates();
  result.renewed = balance->renewed();
  result.step = 0 * rest;
  if (change.size() > 0)
    result.step(free_speeds(c.held())) = balance->columns().cwiseProduct(change).head(balance->displacements());
  if (balance->finite() && balance->singular()) result.neutral = balance->neutral();
  return result;
}

}  // namespace withy::study
