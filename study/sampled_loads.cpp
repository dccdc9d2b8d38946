#include "withy/study/sampled_loads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

constexpr double most_instants = 1000;
/// Periods whose ratio is a whole number but for this are multiples.
constexpr double same_instant = 1e-9;

bool whole(double x) { return std::abs(x - std::round(x)) <= same_instant * std::max(1.0, x); }

const DiscretePart& part_of(const Model& model, const LoadSlot& slot) {
  return *model.loads()[slot.load].load->discrete();
}

}  // namespace

SampledLoads::SampledLoads(const SmallMotions& motions) : motions_(motions) {
  const Model& model = motions.model();
  for (const LoadSlot& slot : model.layout().discrete_slots) {
    const double period = part_of(model, slot).period();
    if (!(period > 0)) continue;
    loads_.push_back({slot, period, size()});
    for (std::size_t i = 0; i < slot.count; ++i)
      names_.push_back(fmt::format("{}.held[{}]", model.loads()[slot.load].name, i));
  }
  if (none()) return;
  find_period();
  differentiate();
}

void SampledLoads::find_period() {
  double least = loads_[0].period;
  for (const Part& part : loads_) least = std::min(least, part.period);
  double greatest = 0;
  for (const Part& part : loads_) greatest = std::max(greatest, part.period);
  for (int k = 1; k * greatest <= most_instants * least; ++k) {
    if (!std::all_of(loads_.begin(), loads_.end(), [&](const Part& part) { return whole(k * greatest / part.period); }))
      continue;
    period_ = k * greatest;
    break;
  }
  if (!(period_ > 0))
    throw InputError(
        fmt::format("the periods of the sampled loads, {:g} s to {:g} s, have no common multiple within {:g} "
                    "samples of the shortest",
                    least, greatest, most_instants));
  for (const Part& part : loads_) {
    const auto count = static_cast<int>(std::lround(period_ / part.period));
    for (int k = 0; k < count; ++k) instants_.push_back(k * part.period);
  }
  std::sort(instants_.begin(), instants_.end());
  const auto same = [&](double a, double b) { return b - a <= same_instant * period_; };
  instants_.erase(std::unique(instants_.begin(), instants_.end(), same), instants_.end());
}

Eigen::VectorXd SampledLoads::renewed(const Part& part, State state) const {
  const Layout& layout = motions_.model().layout();
  const BoundLoad& load = *motions_.model().loads()[part.slot.load].load;
  std::vector<double> scratch(load.scratch());
  const std::span<double> y(state.y);
  const auto held = y.subspan(part.slot.first, part.slot.count);
  load.discrete()->renew(state.time, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), {}, held,
                         scratch);
  return Eigen::Map<const Eigen::VectorXd>(held.data(), static_cast<Eigen::Index>(held.size()));
}

State SampledLoads::displaced(Eigen::Index i, double h) const {
  State state = motions_.state();
  for (const Part& part : loads_) {
    const Eigen::Index own = i - part.first;
    if (own >= 0 && own < static_cast<Eigen::Index>(part.slot.count))
      state.y[part.slot.first + static_cast<std::size_t>(own)] += h;
  }
  return state;
}

void SampledLoads::differentiate() {
  const Eigen::Index n = motions_.size();
  efforts_.setZero(motions_.by_effort().cols(), size());
  renewal_.setZero(n + size(), n + size());
  renewal_.topLeftCorner(n, n).setIdentity();
  for (const Part& part : loads_) {
    const auto count = static_cast<Eigen::Index>(part.slot.count);
    const Eigen::Map<const Eigen::VectorXd> held(motions_.state().y.data() + part.slot.first, count);
    const double size_of_held = std::max(1.0, held.cwiseAbs().maxCoeff());
    if ((renewed(part, motions_.state()) - held).cwiseAbs().maxCoeff() > 1e-9 * size_of_held) steady_ = false;
    const auto by = [&](auto&& state_at, double step) {
      return adaptive_difference([&](double h) { return renewed(part, state_at(h)); }, step).slope;
    };
    for (Eigen::Index i = 0; i < n; ++i)
      renewal_.block(n + part.first, i, count, 1) =
          by([&](double h) { return motions_.displaced(i, h); }, motions_.step(i));
    for (Eigen::Index i = part.first; i < part.first + count; ++i) {
      const auto at = [&](double h) { return displaced(i, h); };
      renewal_.block(n + part.first, n + i, count, 1) = by(at, size_of_held);
      efforts_.col(i) =
          adaptive_difference([&](double h) { return motions_.efforts(at(h), part.slot.load); }, size_of_held).slope;
    }
  }
}

Eigen::MatrixXd SampledLoads::renewal(double t) const {
  const Eigen::Index n = motions_.size();
  Eigen::MatrixXd R = renewal_;
  for (const Part& part : loads_) {
    if (whole(t / part.period)) continue;
    const auto count = static_cast<Eigen::Index>(part.slot.count);
    R.middleRows(n + part.first, count).setZero();
    R.block(n + part.first, n + part.first, count, count).setIdentity();
  }
  return R;
}

double SampledLoads::period_of(std::size_t load) const {
  for (const Part& part : loads_)
    if (part.slot.load == load) return part.period;
  return 0;
}

std::pair<Eigen::Index, Eigen::Index> SampledLoads::held_by(std::size_t load) const {
  for (const Part& part : loads_)
    if (part.slot.load == load) return {part.first, static_cast<Eigen::Index>(part.slot.count)};
  return {0, 0};
}

std::pair<Eigen::MatrixXd, Eigen::MatrixXd> SampledLoads::map(const Eigen::MatrixXd& A, const Eigen::MatrixXd& by_held,
                                                              const Eigen::MatrixXd& B) const {
  const Eigen::Index n = A.rows(), all = n + size();
  Eigen::MatrixXd both(n, size() + B.cols());
  both << by_held, B;
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(all, all), input = Eigen::MatrixXd::Zero(all, B.cols());
  for (std::size_t k = 0; k < instants_.size(); ++k) {
    const double next = k + 1 < instants_.size() ? instants_[k + 1] : period_;
    const auto [Phi, Gamma] = hold(A, both, next - instants_[k]);
    Eigen::MatrixXd step = Eigen::MatrixXd::Identity(all, all);
    step.topLeftCorner(n, n) = Phi;
    step.topRightCorner(n, size()) = Gamma.leftCols(size());
    step = step * renewal(instants_[k]);
    map = step * map;
    input = step * input;
    input.topRows(n) += Gamma.rightCols(B.cols());
  }
  return {map, input};
}

}  // namespace withy::study
