#include "withy/core/equations/lane_equations.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "withy/core/equations/sweep_equations.hpp"
#include "withy/core/sweep/lanes/lane_sweep.hpp"
#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

namespace withy {
namespace {

static_assert(cases_at_once <= most_lanes);

template <class Space>
using One = equations::SweepEquations<sweep::SymmetricSweep<Space>>;

/// The first numbers of an array a lane. In registers: a load waits for stores of its parts.
template <class Number>
void gather(const std::array<Number*, cases_at_once>& from, std::size_t count, Lanes* to) {
  for (std::size_t i = 0; i < count; ++i) {
    if constexpr (cases_at_once == 8) {
      to[i] = Lanes::of(
          LaneNumbers{from[0][i], from[1][i], from[2][i], from[3][i], from[4][i], from[5][i], from[6][i], from[7][i]});
    } else {
      to[i] = Lanes::of(LaneNumbers{from[0][i], from[1][i], from[2][i], from[3][i]});
    }
  }
}
void scatter(const Lanes* from, std::size_t count, const std::array<double*, cases_at_once>& to) {
  for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
    for (std::size_t i = 0; i < count; ++i) to[lane][i] = from[i][lane];
  }
}

/// Efforts that are functions of time alone, by lanes: found once for all lanes with one law that ask for one time, and
/// not again where a lane asks for its last time again, as the stages of a Runge–Kutta step do. The number is that of
/// the law whoever finds it.
class TimedEfforts {
 public:
  /// Another case is in the lane.
  void put(std::size_t lane, const std::vector<TimedLoad>& loads) {
    of_[lane].loads = &loads;
    of_[lane].found.assign(loads.size(), {std::numeric_limits<double>::quiet_NaN(), nullptr});
    of_[lane].values.resize(loads.size());
    const auto timed = [](const TimedLoad& load) { return load.effort != nullptr; };
    of_[lane].any = std::any_of(loads.begin(), loads.end(), timed);
  }
  /// One number a load of the lane's case, at time t; nothing where no load is timed. \param calls those of this
  /// evaluation: of a lane without one nobody knows whether its loads still are
  std::span<const double> at(double t, std::size_t lane, std::span<LaneCall* const> calls) noexcept {
    OfLane& own = of_[lane];
    if (!own.any) return {};
    for (std::size_t i = 0; i < own.values.size(); ++i) {
      const TimedLoad& load = (*own.loads)[i];
      if (load.effort == nullptr || own.found[i].t == t) continue;
      const double* known = elsewhere(load.law, t, lane, calls);
      own.values[i] = known != nullptr ? *known : load.effort->effort(t);
      own.found[i] = {t, load.law};
    }
    return own.values;
  }

 private:
  struct Found {
    double t;  ///< [s]; NaN: at none
    const void* law;
  };
  struct OfLane {
    const std::vector<TimedLoad>* loads = nullptr;
    std::vector<Found> found;
    std::vector<double> values;
    bool any = false;
  };
  /// What a lane before has found; null: none has.
  [[nodiscard]] const double* elsewhere(const void* law, double t, std::size_t lane,
                                        std::span<LaneCall* const> calls) const noexcept {
    for (std::size_t other = 0; other < lane; ++other) {
      if (calls[other] == nullptr) continue;
      const OfLane& of = of_[other];
      for (std::size_t i = 0; i < of.found.size(); ++i)
        if (of.found[i].law == law && of.found[i].t == t) return &of.values[i];
    }
    return nullptr;
  }

  std::array<OfLane, cases_at_once> of_;
};

template <class Space>
class LanesOfSpace final : public LaneEquations {
 public:
  explicit LanesOfSpace(const One<Space>& first)
      : sweep_(first.sweep()),
        work_(sweep_.work_size()),
        positions_(first.layout().positions),
        speeds_(first.layout().speeds),
        numbers_(positions_ + 3 * speeds_, Lanes(0)),
        idle_(positions_ + speeds_, 0.0) {
    equations_.fill(&first);
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) timed_.put(lane, first.loads().timed());
  }

  [[nodiscard]] bool fits(const EquationsOfMotion& equations) const override {
    const auto* one = dynamic_cast<const One<Space>*>(&equations);
    return one != nullptr && one->terms().products_of_speeds &&
           sweep::LaneSweep<Space>::refusal(one->sweep()).empty() && one->layout().positions == positions_ &&
           one->layout().speeds == speeds_ && sweep_.fits(one->sweep());
  }

  void put(std::size_t lane, const EquationsOfMotion& equations) override {
    equations_[lane] = &dynamic_cast<const One<Space>&>(equations);
    sweep_.put(lane, equations_[lane]->sweep());
    timed_.put(lane, equations_[lane]->loads().timed());
  }

  void derivatives(std::span<LaneCall* const> calls) noexcept override {
    [[maybe_unused]] const equations::DenormalsAreZero guard;
    const std::size_t n = positions_, m = speeds_;
    Lanes *positions = numbers_.data(), *speeds = positions + n, *efforts = speeds + m, *result = efforts + m;
    // A lane without a call takes part with what stands here.
    std::array<double*, cases_at_once> applied, rates;
    std::array<const double*, cases_at_once> y;
    applied.fill(idle_.data()), rates.fill(idle_.data()), y.fill(idle_.data());
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      if (calls[lane] == nullptr) continue;
      const LaneCall& call = *calls[lane];
      const std::span<const double> timed = timed_.at(call.t, lane, calls);
      const One<Space>& own = *equations_[lane];
      applied[lane] = (timed.empty() ? own.applied(call.t, call.y, call.y_dot, *call.work)
                                     : own.applied(call.t, call.y, call.y_dot, *call.work, timed))
                          .data();
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

 private:
  sweep::LaneSweep<Space> sweep_;
  Work work_;
  TimedEfforts timed_;
  std::size_t positions_, speeds_;
  std::vector<Lanes> numbers_;  ///< positions, speeds, efforts, accelerations
  std::vector<double> idle_;    ///< state and results of lanes without a call; of no meaning
  std::array<const One<Space>*, cases_at_once> equations_{};  ///< those of a lane without a call may be gone
};

template <class Space>
std::string refusal_of(const One<Space>& one) {
  if (!one.terms().products_of_speeds) return "the formulation drops products of speeds";
  return sweep::LaneSweep<Space>::refusal(one.sweep());
}

}  // namespace

std::size_t lane_count() noexcept { return cases_at_once; }

std::string lane_refusal(const EquationsOfMotion& equations) {
  if (const auto* planar = dynamic_cast<const One<Planar>*>(&equations)) return refusal_of(*planar);
  if (const auto* spatial = dynamic_cast<const One<Spatial>*>(&equations)) return refusal_of(*spatial);
  return "the formulation is none of the symmetric ones";
}

std::unique_ptr<LaneEquations> lane_equations(const EquationsOfMotion& equations) {
  if (!lane_refusal(equations).empty()) return nullptr;
  if (const auto* planar = dynamic_cast<const One<Planar>*>(&equations))
    return std::make_unique<LanesOfSpace<Planar>>(*planar);
  return std::make_unique<LanesOfSpace<Spatial>>(dynamic_cast<const One<Spatial>&>(equations));
}

}  // namespace withy
