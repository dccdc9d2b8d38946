/// \file
/// Open-loop efforts that take one or two hinges of the rigid tree from rest to rest in least time under limits.
#include <algorithm>
#include <map>
#include <mutex>
#include <random>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/hinge_rate.hpp"
#include "withy/loads/time_optimal.hpp"

namespace withy {
namespace {

/// A hinge as the scene names it.
struct Target {
  std::string hinge;
  double from = 0;
  double to = 0;
  double limit = 0;
};

class BoundBangBangSlew final : public BoundLoad {
 public:
  BoundBangBangSlew(const LimitedTree& tree, SwitchingPlan plan)
      : axes_(tree.axes()),
        plan_(std::move(plan)),
        before_(tree.holding(&LimitedAxis::from)),
        after_(tree.holding(&LimitedAxis::to)) {}
  std::size_t scratch() const override { return 0; }
  void add(double t, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> efforts, std::span<double> /*scratch*/) const noexcept override {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const SwitchingPlan::Axis& axis = plan_.axes[i];
      const auto passed = std::upper_bound(axis.switches.begin(), axis.switches.end(), t) - axis.switches.begin();
      const double driving = passed % 2 == 0 ? axis.first : -axis.first;
      efforts[axes_[i].speed] += t < 0 ? before_[i] : t < plan_.end ? driving : after_[i];
    }
  }
  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const override {
    return true;  // a function of time alone
  }
  std::vector<double> discontinuities() const override {
    std::vector<double> all{0, plan_.end};
    for (const SwitchingPlan::Axis& axis : plan_.axes)
      all.insert(all.end(), axis.switches.begin(), axis.switches.end());
    std::sort(all.begin(), all.end());
    return all;
  }
  double end() const override { return plan_.end; }
  void begin(State& state) const override {
    for (const LimitedAxis& axis : axes_) state.y[axis.position] = axis.from;
  }

 private:
  std::vector<LimitedAxis> axes_;
  SwitchingPlan plan_;
  std::vector<double> before_, after_;  ///< efforts that hold the axes where they rest
};

/// What a plan depends on: the axes, and the accelerations of the tree at more states than it has constants.
std::vector<double> what_counts(const LimitedTree& tree) {
  constexpr int states = 16;
  std::vector<double> all = tree.holding(&LimitedAxis::to);
  for (const LimitedAxis& a : tree.axes()) all.insert(all.end(), {a.from, a.to, a.limit});
  const auto n = static_cast<Eigen::Index>(tree.axes().size());
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  for (int i = 0; i < states; ++i) {
    LimitedTree::Vector state(2 * n);
    for (double& x : state) x = number();
    const double efforts[2] = {number(), number()};
    const LimitedTree::Vector rate = tree.derivative(state, efforts);
    all.insert(all.end(), rate.begin() + n, rate.end());
  }
  return all;
}

/// The plan of a tree, sought once: scenes that differ in modes or formulation alone have the same tree of rigid
/// bodies, to the last bit.
std::optional<SwitchingPlan> plan_of(const LimitedTree& tree) {
  constexpr std::size_t most = 64;
  static std::mutex mutex;
  static std::map<std::vector<double>, std::optional<SwitchingPlan>> known;
  const std::vector<double> key = what_counts(tree);
  {
    const std::lock_guard<std::mutex> lock(mutex);
    const auto found = known.find(key);
    if (found != known.end()) return found->second;
  }
  std::optional<SwitchingPlan> plan = least_time(tree);
  const std::lock_guard<std::mutex> lock(mutex);
  if (known.size() >= most) known.clear();
  known.emplace(key, plan);
  return plan;
}

class BangBangSlew final : public Load {
 public:
  explicit BangBangSlew(std::vector<Target> targets) : targets_(std::move(targets)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    std::vector<LimitedAxis> axes;
    for (const Target& t : targets_) {
      const Slot& slot = single_coordinate(model, t.hinge);
      axes.push_back({slot.position, slot.speed, t.from, t.to, t.limit});
    }
    const LimitedTree tree(model, std::move(axes));
    const auto plan = plan_of(tree);
    if (!plan)
      throw std::invalid_argument(
          "found no bang-bang efforts of least time; the limits must exceed the efforts that carry the weight, and one "
          "switch must do for one hinge, three or four for two");
    return std::make_unique<BoundBangBangSlew>(tree, *plan);
  }

 private:
  std::vector<Target> targets_;
};

std::unique_ptr<Load> make_bang_bang_slew(const Value& p, const MakeContext& context) {
  std::vector<Target> targets;
  for (const auto& [hinge, target] : p.at("hinges").members())
    targets.push_back({hinge, target.number_at("from"), target.number_at("to"), target.number_at("limit")});
  if (targets.empty() || targets.size() > 2) {
    context.diagnostics.error(p.at("hinges").place(),
                              "got " + std::to_string(targets.size()) + " hinges; need one or two to move");
    return nullptr;
  }
  if (std::all_of(targets.begin(), targets.end(), [](const Target& t) { return t.from == t.to; })) {
    context.diagnostics.error(p.at("hinges").place(), "moves nothing; need 'from' and 'to' that differ");
    return nullptr;
  }
  return std::make_unique<BangBangSlew>(std::move(targets));
}

}  // namespace

void enroll_bang_bang_slew(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "bang-bang-slew",
       .summary = "Open-loop efforts of least time, at their limits, that would carry the tree of rigid bodies",
       .parameters = {named("hinges",
                            {number("from", "rad|m", "coordinate at the start, rad or m").otherwise(0.0),
                             number("to", "rad|m", "coordinate at the end, rad or m").otherwise(0.0),
                             number("limit", "N m|N", "greatest effort, N m or N").above(0)},
                            "one or two hinges to move, of one coordinate each; the others count as held at their "
                            "reference")
                          .naming(ParameterSpec::Refers::hinge)},
       .make = &make_bang_bang_slew});
}

}  // namespace withy
