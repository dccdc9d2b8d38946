#include "withy/core/equations/lane_equations.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "withy/core/equations/lane_efforts.hpp"
#include "withy/core/equations/steps_ahead.hpp"
#include "withy/core/equations/sweep_equations.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/forwarding_equations.hpp"
#include "withy/core/spatial/lane_transfer.hpp"
#include "withy/core/sweep/lanes/lane_sweep.hpp"
#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

namespace withy {
namespace {

static_assert(cases_at_once <= most_lanes);

template <class Space>
using One = equations::SweepEquations<sweep::SymmetricSweep<Space>>;

template <class Space>
std::string refusal_of(const One<Space>& one) {
  if (!one.terms().products_of_speeds) return "the formulation drops products of speeds";
  return sweep::LaneSweep<Space>::refusal(one.sweep());
}

/// The lanes that have a call.
template <class Call>
LaneSet called(std::span<Call* const> calls) {
  LaneSet set;
  for (std::size_t lane = 0; lane < cases_at_once; ++lane) set.bits |= calls[lane] != nullptr ? 1U << lane : 0U;
  return set;
}

template <class Space>
class LanesOfSpace final : public LaneEquations {
 public:
  explicit LanesOfSpace(const One<Space>& first)
      : sweep_(first.sweep()),
        energies_(lane_energies(first.observed())),
        work_(sweep_.work_size()),
        copies_(first.rates().copies()),
        positions_(first.layout().positions),
        speeds_(first.layout().speeds),
        size_(first.size()),
        numbers_(positions_ + 3 * speeds_, Lanes(0)),
        efforts_(speeds_, Lanes(0)),
        start_(size_, Lanes(0)),
        stage_(size_, Lanes(0)),
        ahead_(size_, speeds_),
        slopes_(StageTable::most * size_, Lanes(0)),
        idle_(size_, 0.0) {
    for (std::vector<double>& y : stages_) y.resize(size_);
    for (std::vector<double>& y_dot : rates_) y_dot.resize(size_);
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) take_in(lane, first);
  }

  [[nodiscard]] bool fits(const EquationsOfMotion& equations) const override {
    const auto* one = dynamic_cast<const One<Space>*>(&equations);
    return one != nullptr && refusal_of(*one).empty() && one->layout().positions == positions_ &&
           one->layout().speeds == speeds_ && one->size() == size_ && one->rates().copies() == copies_ &&
           sweep_.fits(one->sweep()) &&
           (energies_ != nullptr ? energies_->fits(one->observed()) : lane_energies(one->observed()) == nullptr);
  }

  void put(std::size_t lane, const EquationsOfMotion& equations) override {
    const auto& one = dynamic_cast<const One<Space>&>(equations);
    sweep_.put(lane, one.sweep());
    if (energies_ != nullptr) energies_->put(lane, one.observed());
    take_in(lane, one);
  }

  void derivatives(std::span<LaneCall* const> calls) noexcept override {
    [[maybe_unused]] const equations::DenormalsAreZero guard;
    const std::size_t n = positions_, m = speeds_;
    Lanes *positions = numbers_.data(), *speeds = positions + n, *efforts = speeds + m, *result = efforts + m;
    // A lane without a call takes part with what stands here.
    std::array<double*, cases_at_once> applied, rates;
    std::array<const double*, cases_at_once> y;
    applied.fill(idle_.data()), rates.fill(idle_.data()), y.fill(idle_.data());
    equations::LaneTimes times{0, called(calls)};
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      if (calls[lane] == nullptr) continue;
      const LaneCall& call = *calls[lane];
      times.t.set(lane, call.t);
      applied[lane] = apply(lane, times, call.y, call.y_dot, *call.work).data();
      y[lane] = call.y.data();
      rates[lane] = call.y_dot.data() + n;
    }
    gather(y, n + m, positions);  // the speeds follow
    gather(applied, m, efforts);
    if (sweep_.driven()) gather(rates, m, result);
    std::array<Evaluation, cases_at_once> evaluations;
    sweep_.accelerations(positions, speeds, efforts, result, work_.data(), evaluations.data());
    scatter(result, m, rates);
    if (sweep_.driven()) scatter(efforts, m, applied);
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      if (calls[lane] == nullptr) continue;
      LaneCall& call = *calls[lane];
      call.evaluation = evaluations[lane];
      if (!call.evaluation.ok()) continue;
      call.evaluation = equations_[lane]->finish(call.t, call.y, call.y.subspan(n, m), {applied[lane], m}, call.y_dot,
                                                 evaluations[lane], *call.work);
    }
  }

  void steps(std::span<LaneStep* const> calls) noexcept override {
    const LaneSet live = called(calls);
    const StageTable* table = nullptr;
    std::array<const double*, cases_at_once> y, slope;
    y.fill(idle_.data()), slope.fill(idle_.data());
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      if (!live.has(lane)) {
        ahead_.drop(lane);
        continue;
      }
      const StagedSteps::Step& step = *calls[lane]->step;
      table = step.table;
      y[lane] = step.y.data(), slope[lane] = step.slope.data();
      ahead_.begin(lane, step, !plain_.has(lane));
    }
    gather(y, size_, start_.data());
    gather(slope, size_, slopes_.data());
    from_ = {start_.data(), slopes_.data()};
    LaneSet good = live;
    for (std::size_t k = 0; !none(good = ahead_.wanting(k, good)); ++k) {
      good = whole_step(*table, k, calls, good);
      if (k == 0) tell_slopes(*table, calls, good);
      if (energies_ != nullptr && ahead_.expects_energies(k)) find_energies(k, good);
      from_ = {ahead_.y(k), ahead_.slope(k)};
    }
    for (std::size_t lane = 0; lane < cases_at_once; ++lane)
      if (live.has(lane)) give(lane, *calls[lane]);
  }
  bool made_ahead(std::size_t lane, LaneStep& call) noexcept override {
    if (!ahead_.has_next(lane, *call.step)) return false;
    give(lane, call);
    return true;
  }
  bool made_ahead(std::size_t lane, LaneEnergy& call) noexcept override { return ahead_.find(lane, call); }

  [[nodiscard]] bool has_energies() const override { return energies_ != nullptr; }
  void energies(std::span<LaneEnergy* const> calls) noexcept override { energies_->find(calls); }

 private:
  void take_in(std::size_t lane, const One<Space>& one) {
    equations_[lane] = &one;
    ahead_.forget(lane);
    timed_.put(lane, one.loads().timed());
    damping_.put(lane, one.elastic());
    plain_.bits &= ~(1U << lane);
    if (one.only_timed()) plain_.bits |= 1U << lane;
  }

  /// The efforts of a lane's case, in its own work memory.
  std::span<double> apply(std::size_t lane, const equations::LaneTimes& times, std::span<const double> y,
                          std::span<double> y_dot, Work& work) noexcept {
    const std::span<const double> timed = timed_.at(lane, times);
    const One<Space>& own = *equations_[lane];
    return timed.empty() ? own.applied(times.t[lane], y, y_dot, work)
                         : own.applied(times.t[lane], y, y_dot, work, timed);
  }

  /// What a step begins with: the state, and the slope there.
  struct From {
    const Lanes *y, *slope;
  };
  /// Where a stage is made: its state, the slope there, the efforts.
  struct Stage {
    Lanes *y, *slope, *efforts;
  };

  /// Makes step k of some lanes from `from_`, and leaves what it gives in `ahead_`. \returns the lanes where it is ok
  LaneSet whole_step(const StageTable& table, std::size_t k, std::span<LaneStep* const> calls, LaneSet live) noexcept {
    [[maybe_unused]] const equations::DenormalsAreZero guard;  // not of the energies, which are found without as well
    h_ = ahead_.length(k);
    for (std::size_t lane = 0; lane < cases_at_once; ++lane)
      if (!live.has(lane)) h_.set(lane, 0);
    LaneSet good = live;
    for (std::size_t i = 1; i + 1 < table.stages && !none(good); ++i)
      good = stage(table, i, k, {stage_.data(), slopes_.data() + i * size_, efforts_.data()}, calls, good);
    if (none(good)) return good;
    return stage(table, table.stages - 1, k, {ahead_.y(k), ahead_.slope(k), ahead_.efforts(k)}, calls, good);
  }

  /// The slopes between the first and the last, to the lanes that want them.
  void tell_slopes(const StageTable& table, std::span<LaneStep* const> calls, LaneSet good) noexcept {
    std::array<double*, cases_at_once> to;
    for (std::size_t i = 1; i + 1 < table.stages; ++i) {
      for (std::size_t lane = 0; lane < cases_at_once; ++lane)
        to[lane] = good.has(lane) ? calls[lane]->step->slopes[i - 1].data() : nullptr;
      scatter(slopes_.data() + i * size_, size_, to);
    }
  }

  void find_energies(std::size_t k, LaneSet good) noexcept {
    std::array<Energies*, cases_at_once> to{};
    for (std::size_t lane = 0; lane < cases_at_once; ++lane)
      if (good.has(lane)) to[lane] = &ahead_.energies(lane, k);
    energies_->find(ahead_.y(k), to);
  }

  void give(std::size_t lane, LaneStep& call) noexcept {
    ahead_.give(lane, *call.step, equations_[lane]->efforts(*call.step->work), call.outcome);
  }

  /// Makes a stage of step k of some lanes. \returns those of them where it is ok
  LaneSet stage(const StageTable& table, std::size_t i, std::size_t k, const Stage& at,
                std::span<LaneStep* const> calls, LaneSet live) noexcept {
    go_to_stage(table, i, at.y);
    const equations::LaneTimes times{earlier(ahead_.start(k) + Lanes(table.c[i]) * h_, ahead_.latest()), live};
    std::fill_n(at.efforts, speeds_, Lanes(0));
    const LaneSet plain = live & plain_;
    timed_.add(times, plain, at.efforts);
    const LaneSet others{live.bits & ~plain.bits};
    if (!none(others)) apply_others(others, calls, times, at);
    const LaneSet solved = sweep_.accelerations(at.y, at.y + positions_, at.efforts, at.slope + positions_,
                                                work_.data(), failures_.data());
    const LaneSet finite = finish_plain(at);
    const bool last = i + 1 == table.stages;
    if ((plain & finite & solved).bits == live.bits) {
      for (std::size_t lane = 0; lane < cases_at_once && last; ++lane)
        if (live.has(lane)) ahead_.made(lane, k, {{}, i});
      return live;
    }
    std::array<Evaluation, cases_at_once> evaluations;
    for (std::size_t lane = 0; lane < cases_at_once; ++lane)
      if (!solved.has(lane)) evaluations[lane] = failures_[lane];
    // What is not finite is looked into case by case.
    const LaneSet lost{plain.bits & ~finite.bits};
    for (std::size_t lane = 0; lane < cases_at_once && !none(lost); ++lane)
      if (lost.has(lane)) take_lane(at.y, lane, stages_[lane]);
    if (const LaneSet rest{others.bits | lost.bits}; !none(rest)) finish_rest(rest, calls, times, at, evaluations);
    LaneSet good;
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      if (!live.has(lane)) continue;
      if (evaluations[lane].ok()) good.bits |= 1U << lane;
      if (last || !good.has(lane)) ahead_.made(lane, k, {evaluations[lane], i});
    }
    return good;
  }

  /// The state of a stage: the sums go from the first slope to the last.
  void go_to_stage(const StageTable& table, std::size_t i, Lanes* y) const noexcept {
    std::array<Lanes, StageTable::most> factors;
    std::array<const Lanes*, StageTable::most> slopes;
    std::size_t count = 0;
    for (std::size_t j = 0; j < i; ++j) {
      if (table.a[i][j] == 0) continue;
      factors[count] = h_ * Lanes(table.a[i][j]);
      slopes[count++] = j == 0 ? from_.slope : slopes_.data() + j * size_;
    }
    if (count == 1) {
      const Lanes factor = factors[0];
      for (std::size_t e = 0; e < size_; ++e) y[e] = from_.y[e] + factor * slopes[0][e];
      return;
    }
    for (std::size_t e = 0; e < size_; ++e) {
      Lanes sum = from_.y[e];
      for (std::size_t j = 0; j < count; ++j) sum += factors[j] * slopes[j][e];
      y[e] = sum;
    }
  }
  /// a, or b where that is less.
  static Lanes earlier(Lanes a, const Lanes& b) noexcept {
    const LaneSet later = positive(a - b);
    for (std::size_t lane = 0; lane < cases_at_once && !none(later); ++lane)
      if (later.has(lane)) a.set(lane, b[lane]);
    return a;
  }

  /// Rates of positions and the power of lanes whose loads are timed. \returns where all is finite
  LaneSet finish_plain(const Stage& at) noexcept {
    const Lanes* const speeds = at.y + positions_;
    Lanes* const y_dot = at.slope;
    for (const equations::RateMap::Run& run : copies_)
      for (std::size_t k = 0; k < run.count; ++k) y_dot[run.position + k] = speeds[run.speed + k];
    Lanes power(0);
    for (std::size_t k = 0; k < speeds_; ++k) power += at.efforts[k] * speeds[k];
    power += damping_.power(speeds);
    for (std::size_t k = positions_ + speeds_; k + 1 < size_; ++k) y_dot[k] = Lanes(0);
    y_dot[size_ - 1] = power;
    Lanes nothing = power * Lanes(0);  // or NaN
    for (std::size_t k = 0; k < speeds_; ++k) nothing += y_dot[positions_ + k] * Lanes(0);
    return positive(nothing + Lanes(1));
  }

  /// Efforts and driven accelerations of lanes with loads of other kinds, case by case.
  void apply_others(LaneSet others, std::span<LaneStep* const> calls, const equations::LaneTimes& times,
                    const Stage& at) noexcept {
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      if (!others.has(lane)) continue;
      take_lane(at.y, lane, stages_[lane]);
      const std::span<const double> applied = apply(lane, times, stages_[lane], rates_[lane], *calls[lane]->step->work);
      for (std::size_t k = 0; k < speeds_; ++k) at.efforts[k].set(lane, applied[k]);
      if (!sweep_.driven()) continue;
      for (std::size_t k = positions_; k < positions_ + speeds_; ++k) at.slope[k].set(lane, rates_[lane][k]);
    }
  }

  /// What some have beside their accelerations, case by case.
  void finish_rest(LaneSet rest, std::span<LaneStep* const> calls, const equations::LaneTimes& times, const Stage& at,
                   std::array<Evaluation, cases_at_once>& evaluations) noexcept {
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      if (!rest.has(lane) || !evaluations[lane].ok()) continue;
      const One<Space>& own = *equations_[lane];
      Work& work = *calls[lane]->step->work;
      const std::span<double> efforts = own.efforts(work);
      for (std::size_t k = 0; k < speeds_; ++k) efforts[k] = at.efforts[k][lane];
      std::vector<double>& rates = rates_[lane];
      for (std::size_t k = 0; k < speeds_; ++k) rates[positions_ + k] = at.slope[positions_ + k][lane];
      const std::span<const double> y = stages_[lane];
      evaluations[lane] =
          own.finish(times.t[lane], y, y.subspan(positions_, speeds_), efforts, rates, evaluations[lane], work);
      for (std::size_t k = 0; k < size_; ++k) at.slope[k].set(lane, rates[k]);
    }
  }

  static void take_lane(const Lanes* from, std::size_t lane, std::vector<double>& to) noexcept {
    for (std::size_t k = 0; k < to.size(); ++k) to[k] = from[k][lane];
  }

  sweep::LaneSweep<Space> sweep_;
  std::unique_ptr<LaneEnergies> energies_;  ///< null: there are none
  Work work_;
  equations::TimedEfforts timed_;
  equations::LaneDamping damping_;
  std::vector<equations::RateMap::Run> copies_;
  std::size_t positions_, speeds_, size_;
  std::vector<Lanes> numbers_;  ///< positions, speeds, efforts, accelerations
  // Of whole steps.
  std::vector<Lanes> efforts_, start_, stage_;
  From from_{};
  Lanes h_ = 0;  ///< length of the step [s]
  std::array<Evaluation, cases_at_once> failures_;
  equations::StepsAhead ahead_;
  std::vector<Lanes> slopes_;                              ///< one after the other
  std::array<std::vector<double>, cases_at_once> stages_;  ///< the stage's state where a case has it by itself
  std::array<std::vector<double>, cases_at_once> rates_;   ///< and the rates there
  std::vector<double> idle_;                               ///< state and results of lanes without a call; of no meaning
  std::array<const One<Space>*, cases_at_once> equations_{};  ///< those of a lane without a call may be gone
  LaneSet plain_;                                             ///< lanes whose loads are functions of time alone
};

}  // namespace

std::size_t lane_count() noexcept { return cases_at_once; }

std::string lane_refusal(const EquationsOfMotion& equations) {
  if (const auto* planar = dynamic_cast<const One<Planar>*>(&equations)) return refusal_of(*planar);
  if (const auto* spatial = dynamic_cast<const One<Spatial>*>(&equations)) return refusal_of(*spatial);
  // What stands before other equations chooses or corrects them case by case.
  if (dynamic_cast<const ClosedLoops*>(&equations) != nullptr) return "constraints close loops";
  if (dynamic_cast<const ForwardingEquations*>(&equations) != nullptr)
    return "events lock or let go of hinges, and the equations are others then";
  return "the formulation is none of the symmetric ones";
}

std::unique_ptr<LaneEquations> lane_equations(const EquationsOfMotion& equations) {
  if (!lane_refusal(equations).empty()) return nullptr;
  if (const auto* planar = dynamic_cast<const One<Planar>*>(&equations))
    return std::make_unique<LanesOfSpace<Planar>>(*planar);
  return std::make_unique<LanesOfSpace<Spatial>>(dynamic_cast<const One<Spatial>&>(equations));
}

}  // namespace withy
