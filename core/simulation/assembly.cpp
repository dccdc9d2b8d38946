#include "withy/core/simulation/assembly.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy {
namespace {

using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Free = std::vector<Eigen::Index>;

/// Whether it holds an axis or all directions, so that half a turn solves its equations too.
bool holds_directions(const LoopClosure& loop) {
  const auto& all = loop.equations();
  return std::count_if(all.begin(), all.end(), [](const ClosingEquation& e) { return e.of_directions; }) >= 2;
}

/// A state on its way to closure.
class Assembler {
 public:
  Assembler(const Model& model, const EquationsOfMotion& equations, State& state)
      : model_(model),
        equations_(equations),
        loops_(dynamic_cast<const ClosedLoops&>(equations)),
        state_(state),
        work_(equations.make_work()),
        gaps_(static_cast<Eigen::Index>(loops_.closing_equations())),
        rates_(gaps_.size()),
        J_(gaps_.size(), static_cast<Eigen::Index>(model.layout().speeds)),
        length_(length_of_loops(model)),
        reaches_(reaches_of_speeds(model, length_)),
        bound_reaches_(reaches_),
        slides_(reaches_.size(), false) {
    for (const ModelRate& rate : hinge_rates(model)) slides_[rate.speed] = !rate.angular;
    for (const Slot& modes : model.layout().bodies)
      for (std::size_t k = modes.speed; k < modes.speed + modes.speeds; ++k) slides_[k] = true, bound_reaches_[k] = 1;
    for (const LoopClosure* loop : loops_of(model)) holds_directions_ = holds_directions_ || holds_directions(*loop);
    look();
  }

  [[nodiscard]] double gap() const { return gaps_.cwiseAbs().maxCoeff(); }
  [[nodiscard]] double gap_rate() const { return rates_.cwiseAbs().maxCoeff(); }
  [[nodiscard]] const Eigen::VectorXd& gaps() const { return gaps_; }
  [[nodiscard]] const Eigen::VectorXd& gap_rates() const { return rates_; }
  /// ℓ of the loops, see length_of_loops.
  [[nodiscard]] double length() const { return length_; }
  /// How fast what the loops join moves at most by one of the speeds [m/s].
  [[nodiscard]] double fastest() const {
    double most = 0;
    for (std::size_t k = 0; k < reaches_.size(); ++k)
      most = std::max(most, reaches_[k] * std::abs(state_.y[model_.layout().positions + k]));
    return most;
  }

  /// A loop that was closed at another pose than its hinge's; nothing where none was.
  [[nodiscard]] const std::optional<std::size_t>& turned_over() const { return turned_over_; }

  /// Moves the coordinates of free speeds; where they do not close the loops, the state stays. Where the equations lead
  /// to a pose that is none of the hinge's, or nowhere, the turns that are left are followed first; then only what
  /// comes nearer is.
  bool close_positions(const Free& free) {
    if (is_closed_well(closed_gap)) return true;
    if (free.empty()) return false;
    const State start = state_;
    enum class Way { straight, by_turns, downhill };
    for (const Way way : {Way::straight, Way::by_turns, Way::downhill}) {
      if (way == Way::by_turns) {
        if (!holds_directions_) continue;
        turns_ = true;
        look();
        follow(free);
        turns_ = false;
        look();
      }
      if (way == Way::downhill) descend(free);
      follow(free);
      if (is_closed_well(good_gap)) return true;
      state_ = start;
      look();
    }
    return false;
  }
  bool close_rates(const Free& free) {
    const double before = gap_rate();
    if (before <= closed_gap * std::min(length_, fastest())) return true;
    if (free.empty()) return false;
    const std::size_t first = model_.layout().positions;
    const State start = state_;
    for (int i = 0; i < 3 && gap_rate() > 0; ++i) {
      const Eigen::VectorXd change = smallest(free, rates_);
      for (Eigen::Index k = 0; k < change.size(); ++k) state_.y[first + static_cast<std::size_t>(k)] += change[k];
      look();
    }
    if (gap_rate() <= good_gap * std::max(fastest(), before)) return true;
    state_ = start;
    look();
    return false;
  }

 private:
  /// Over ℓ: gaps that stay as they are; that will do where the method comes no nearer, as in a run
  /// (ClosedLoops::close); that are rounding.
  static constexpr double closed_gap = 1e-10, good_gap = 1e-9, finest_gap = 1e-15;

  [[nodiscard]] bool is_closed_well(double gap_over_length) {
    if (!(gap() <= gap_over_length * length_)) return false;
    for (std::size_t i = 0; i < loops_of(model_).size(); ++i) {
      if (loops_.right_way_round(state_.y, i, work_)) continue;
      turned_over_ = i;
      return false;
    }
    return true;
  }
  /// Newton's method for the gaps, until it comes no nearer.
  void follow(const Free& free) {
    constexpr int most = 200;
    double best = gap(), from = best;
    for (int i = 0, idle = 0; i < most && idle < 30; ++i) {
      Eigen::VectorXd change = smallest(free, gaps_);
      if (!change.allFinite()) break;
      move(part_of(change) * change);
      if (gap() <= finest_gap * length_ || (gap() <= closed_gap * length_ && gap() >= 0.5 * best)) break;
      best = std::min(best, gap());
      if (best < 0.9 * from)
        from = best, idle = 0;
      else
        ++idle;
    }
  }
  /// The method of Levenberg and Marquardt: where Newton's goes to and fro beside a state in which J loses rank, it
  /// goes past.
  void descend(const Free& free) {
    constexpr int most = 100;
    constexpr double least_damping = 1e-12, most_damping = 1e8, least_gain = 1e-6;
    double damping = 1e-2;
    for (int i = 0; i < most && gap() > closed_gap * length_ && damping < most_damping; ++i) {
      const State here = state_;
      const double before = gaps_.squaredNorm();
      const Eigen::VectorXd change = damped(free, damping);
      if (!change.allFinite()) break;
      move(part_of(change) * change);
      const double now = gaps_.squaredNorm();
      if (now < before) {
        damping = std::max(damping / 5, least_damping);
        if (now > (1 - least_gain) * before) break;
      } else {
        state_ = here;
        look();
        damping *= 4;
      }
    }
  }
  /// The part of a change that is taken at once, in which nothing moves by more than a third of the loops' size: a turn
  /// by 0.3 rad. What slides may come from farther away.
  [[nodiscard]] double part_of(const Eigen::VectorXd& change) const {
    constexpr double longest = 0.3;
    double part = 1;
    for (std::size_t k = 0; k < reaches_.size(); ++k) {
      const double bound = longest * (slides_[k] ? std::max(length_, gap()) : length_);
      const double moved = bound_reaches_[k] * std::abs(change[static_cast<Eigen::Index>(k)]);
      if (moved > bound) part = std::min(part, bound / moved);
    }
    return part;
  }
  void look() {
    J_.setZero();
    const std::span<double> gaps(gaps_.data(), static_cast<std::size_t>(gaps_.size()));
    const std::span<double> J(J_.data(), static_cast<std::size_t>(J_.size()));
    if (turns_) return loops_.see_turns(state_.y, gaps, J, work_);
    loops_.see(state_.y, gaps, {rates_.data(), static_cast<std::size_t>(rates_.size())}, J, work_);
  }
  /// The change of free speeds with J change = −missing, or as near as they come to it, that is the smallest in M.
  [[nodiscard]] Eigen::VectorXd smallest(const Free& free, const Eigen::VectorXd& missing) const {
    return in_mass(free, [&](const Eigen::MatrixXd& S) -> Eigen::VectorXd {
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
      solver.setThreshold(1e-9);
      solver.compute(S);
      return solver.solve(-missing);
    });
  }
  /// The change for which the gaps that it leaves and its own size in M, times the damping and the mean square of the
  /// rows, are least together.
  [[nodiscard]] Eigen::VectorXd damped(const Free& free, double damping) const {
    return in_mass(free, [&](const Eigen::MatrixXd& S) -> Eigen::VectorXd {
      Eigen::MatrixXd A = S * S.transpose();
      A.diagonal().array() += damping * A.trace() / static_cast<double>(A.rows());
      return S.transpose() * A.llt().solve(-gaps_);
    });
  }
  /// A change of free speeds. \param solve gives it in coordinates in which M is one, of J in these
  template <class Solve>
  [[nodiscard]] Eigen::VectorXd in_mass(const Free& free, Solve&& solve) const {
    const DenseSystem system = equations_.system(state_.time, state_.y);
    const auto n = static_cast<Eigen::Index>(system.size);
    const Eigen::MatrixXd M = Eigen::Map<const DenseMatrix>(system.mass.data(), n, n)(free, free);
    const Eigen::LLT<Eigen::MatrixXd> factor(M);
    const Eigen::MatrixXd S = factor.matrixL().solve(J_(Eigen::all, free).transpose()).transpose();
    Eigen::VectorXd change = Eigen::VectorXd::Zero(n);
    change(free) = factor.matrixU().solve(solve(S)).eval();
    return change;
  }
  void move(const Eigen::VectorXd& change) {
    const std::size_t first = model_.layout().positions;
    std::vector<double> there = state_.y, slopes(there.size());
    std::copy(change.begin(), change.end(), there.begin() + static_cast<std::ptrdiff_t>(first));
    equations_.position_rates(state_.time, there, slopes, work_);
    for (std::size_t i = 0; i < first; ++i) state_.y[i] += slopes[i];
    equations_.normalize(state_.y);
    look();
  }

  const Model& model_;
  const EquationsOfMotion& equations_;
  const ClosedLoops& loops_;
  State& state_;
  Work work_;
  Eigen::VectorXd gaps_, rates_;
  DenseMatrix J_;
  double length_;
  std::vector<double> reaches_;
  std::vector<double> bound_reaches_;  ///< the same, of modes one: beams that close a loop bend far
  std::vector<bool> slides_;           ///< speeds
  bool holds_directions_ = false;      ///< a hinge of some loop holds an axis or all three
  bool turns_ = false;                 ///< gaps and rows are those of ClosedLoops::see_turns
  std::optional<std::size_t> turned_over_;
};

/// Speeds that may change: of hinges, with `modes` those of bodies too; what is given and what motions drive does not.
Free free_speeds(const Model& model, const std::vector<bool>& given, bool modes) {
  const Layout& layout = model.layout();
  Free free;
  const auto add = [&](const Slot& slot) {
    for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i)
      if (!given[i]) free.push_back(static_cast<Eigen::Index>(i));
  };
  for (std::size_t h = 0; h < layout.hinges.size(); ++h)
    if (!model.driven(h)) add(layout.hinges[h]);
  if (modes)
    for (const Slot& slot : layout.bodies) add(slot);
  return free;
}

std::vector<bool> either(std::vector<bool> a, const std::vector<bool>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = a[i] || b[i];
  return a;
}

/// Whether `close` closes the loops, called with the speeds that may change. What is given stays: first with what is
/// kept, then by itself, then with modes free to move. A gap [m, m/s] that is next to nothing, also beside `size`, of
/// the loops or of how fast they move, is closed by all.
template <class Close>
bool closes(const Model& model, const GivenState& given, const GivenState* kept, std::vector<bool> GivenState::*part,
            double gap, double size, Close&& close) {
  constexpr double near_enough = 1e-3;
  return (kept != nullptr && close(free_speeds(model, either(given.*part, kept->*part), false))) ||
         close(free_speeds(model, given.*part, false)) || close(free_speeds(model, given.*part, true)) ||
         (gap <= near_enough * std::min(size, 1.0) &&
          close(free_speeds(model, std::vector<bool>(model.layout().speeds, false), true)));
}

/// The coordinate or speed that has changed most, in words, with its unit.
std::string greatest_change(const Model& model, const State& before, const State& after, bool rates) {
  const Layout& layout = model.layout();
  std::string most;
  double change = 1e-12;
  const auto look = [&](const Slot& slot, const std::vector<Column>& columns) {
    const std::size_t first = rates ? layout.positions + slot.speed : slot.position;
    for (std::size_t i = 0; i < (rates ? slot.speeds : slot.positions); ++i) {
      const double own = std::abs(after.y[first + i] - before.y[first + i]);
      if (own <= change) continue;
      change = own;
      most = "'" + slot.name + "' by " + brief(change);
      if (i >= columns.size() || columns[i].unit.empty()) continue;  // as of modes
      most += columns[i].unit == "1" ? " in its quaternion" : ' ' + columns[i].unit;
    }
  };
  for (std::size_t h = 0; h < layout.hinges.size(); ++h)
    look(layout.hinges[h], rates ? rate_columns(model.hinges()[h]) : coordinate_columns(model.hinges()[h]));
  for (const Slot& slot : layout.bodies) look(slot, {});
  return most;
}

/// A loop with the distance of its frames, or how fast they part [m, m/s].
struct Farthest {
  std::string loop;
  double distance = 0;
};

Farthest farthest(const Model& model, const Eigen::VectorXd& gaps) {
  Farthest most;
  Eigen::Index row = 0;
  for (const LoopClosure* c : loops_of(model)) {
    const auto own = static_cast<Eigen::Index>(c->equations().size());
    const double distance = gaps.segment(row, own).norm();
    if (most.loop.empty() || !(distance <= most.distance)) most = {c->name(), distance};
    row += own;
  }
  return most;
}

/// What keeps loops open: that there is no M to move by, or that nothing was found.
Assembly not_closed(const Model& model, const EquationsOfMotion& equations, const State& start, const Farthest& open) {
  if (const auto rate = unsolvable_rate(model, equations, start))
    return {.fault = rate->why, .remedy = {}, .name = model.hinges()[rate->hinge].name, .of_hinge = true, .remark = {}};
  return {.fault = "the loop cannot be closed from this start: its frames are " + brief(open.distance) +
                   " m apart there (turns count with the length of the largest flexible body, or of what hinges and "
                   "constraints join), and no way to close it was found with what is given and motions prescribe",
          .remedy = "give fewer coordinates, or a nearer `guess`",
          .name = open.loop,
          .of_hinge = false,
          .remark = {}};
}

}  // namespace

Assembly assemble(const Model& model, const EquationsOfMotion& equations, const GivenState& given, State& state,
                  const GivenState* kept) {
  const State before = state;
  Assembler assembler(model, equations, state);
  Assembly result;
  const double gap = assembler.gap();
  if (!closes(model, given, kept, &GivenState::positions, gap, assembler.length(),
              [&](const auto& free) { return assembler.close_positions(free); })) {
    if (assembler.turned_over()) {
      result.name = loops_of(model)[*assembler.turned_over()]->name();
      result.fault =
          "the loop closes the wrong way round from this start, its hinge turned over by half or a third of a turn";
      result.remedy = "give a nearer `guess`";
      return result;
    }
    return not_closed(model, equations, before, farthest(model, assembler.gaps()));
  }
  const double rate = assembler.gap_rate();
  if (!closes(model, given, kept, &GivenState::rates, rate, assembler.fastest(),
              [&](const auto& free) { return assembler.close_rates(free); })) {
    const Farthest open = farthest(model, assembler.gap_rates());
    result.name = open.loop;
    result.fault = "the loop does not stay closed: the initial speeds part its frames at " + brief(open.distance) +
                   " m/s, and what is given and motions prescribe leaves no way";
    result.remedy = "give fewer rates";
    return result;
  }
  const std::string moved = greatest_change(model, before, state, false);
  const std::string sped = greatest_change(model, before, state, true);
  if (!moved.empty()) result.remark = "positions changed, most " + moved;
  if (!sped.empty()) result.remark += (moved.empty() ? "speeds changed, most " : "; speeds too, most ") + sped;
  if (!result.remark.empty()) result.remark = "Loops were closed at the start: " + result.remark + ".";
  return result;
}

std::string fault_and_remedy(const Assembly& assembly) {
  return assembly.fault + (assembly.remedy.empty() ? "" : "; " + assembly.remedy);
}

}  // namespace withy
