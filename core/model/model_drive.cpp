// What moves a model from outside its tree: motions that prescribe hinges, and loads with their states.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/kinks.hpp"
#include "withy/core/plugin/plugin_call.hpp"

namespace withy {

namespace {

/// Of a load or a motion.
template <class Part>
void check_times(const std::string& who, const Part& part) {
  const auto [jumps, end] = plugin_call(who + " does not say when it jumps or ends",
                                        [&] { return std::pair(part.discontinuities(), part.end()); });
  if (std::isinf(end))
    throw std::invalid_argument(who + " ends at no finite time; one that has no end of its own says 0");
  if (std::isnan(end) || std::any_of(jumps.begin(), jumps.end(), [](double t) { return std::isnan(t); }))
    throw std::invalid_argument(who + " jumps or ends at a time that is no number");
  const auto behind = std::is_sorted_until(jumps.begin(), jumps.end());
  if (behind == jumps.end()) return;
  std::ostringstream text;
  text << who << " says that it jumps at " << *std::prev(behind) << " s and then at " << *behind
       << " s; need times that increase";
  throw std::invalid_argument(text.str());
}

/// What a load says of its states and of the scratch space it needs.
struct Kept {
  std::size_t scratch = 0;
  const ContinuousPart* continuous = nullptr;
  std::vector<std::string> names;  ///< of the continuous states
  std::size_t discrete = 0;        ///< count of states
};

/// A count that a load says. One of a number that was never set is told here, before memory for it is asked for.
std::size_t counted(std::size_t count, const std::string& who, const char* what) {
  constexpr std::size_t most = std::size_t{1} << 32U;
  if (count <= most) return count;
  throw std::invalid_argument(who + " says that it has " + std::to_string(count) + " " + what + "; " +
                              std::to_string(most) + " are the most");
}

/// The count of discrete states, of a part whose clock can be kept.
std::size_t discrete_states(const DiscretePart& part, const std::string& who) {
  static_cast<void>(counted(part.switches(), who, "switching functions"));
  const double period = part.period();
  if (period >= 0 && std::isfinite(period)) return counted(part.states(), who, "discrete states");
  std::ostringstream text;
  text << who << " is renewed every " << period << " s; need a finite period, or 0 where no clock renews it";
  throw std::invalid_argument(text.str());
}

/// Names of the continuous states, each as that of an element of State.
std::vector<std::string> continuous_names(const ContinuousPart& part, const std::string& name, const std::string& who) {
  std::vector<std::string> names;
  for (std::size_t i = 0, count = counted(part.states(), who, "continuous states"); i < count; ++i)
    names.push_back(part.name(i));
  if (const std::string fault = state_names_fault(names); !fault.empty())
    throw std::invalid_argument(who + " has continuous states that cannot be: " + fault);
  for (std::string& each : names) each.insert(0, name + ".");
  return names;
}

Kept kept_by(const BoundLoad& load, const std::string& name, const std::string& who) {
  Kept kept{counted(load.scratch(), who, "numbers of scratch space"), load.continuous(), {}, 0};
  if (kept.continuous != nullptr) kept.names = continuous_names(*kept.continuous, name, who);
  if (const DiscretePart* part = load.discrete(); part != nullptr) kept.discrete = discrete_states(*part, who);
  if (const auto* kinked = dynamic_cast<const Kinks*>(&load); kinked != nullptr)
    static_cast<void>(counted(kinked->kinks(), who, "kinks"));
  return kept;
}

}  // namespace

bool Model::driven(std::size_t hinge) const { return driven_[hinge]; }

void Model::prescribe(State& state) const {
  for (const MotionNode& node : motions_) {
    if (dynamic_cast<const MotionByLoad*>(node.motion.get()) != nullptr) continue;  // it goes on as the state has it
    const Slot& slot = layout_.hinges[static_cast<std::size_t>(node.hinge)];
    double* rates = state.y.data() + layout_.positions + slot.speed;
    std::fill(rates, rates + slot.speeds, 0.0);
    if (node.motion->locks()) continue;
    const MotionPoint point = node.motion->at(state.time);
    state.y[slot.position] = point.position;
    rates[0] = point.rate;
  }
}

void Model::prescribe_accelerations(double t, std::span<double> u_dot) const noexcept {
  for (const MotionNode& node : motions_) {
    const Slot& slot = layout_.hinges[static_cast<std::size_t>(node.hinge)];
    for (std::size_t i = 0; i < slot.speeds; ++i) u_dot[slot.speed + i] = 0;
    if (!node.motion->locks()) u_dot[slot.speed] = node.motion->at(t).acceleration;
  }
}

void Model::add_motion(std::string name, const std::string& hinge_name, std::shared_ptr<const Motion> motion) {
  const int index = hinge(hinge_name);
  if (index < 0) throw std::invalid_argument("there is no hinge '" + hinge_name + "'");
  const Slot& slot = layout_.hinges[static_cast<std::size_t>(index)];
  if (slot.speeds == 0) throw std::invalid_argument("hinge '" + hinge_name + "' does not move: it needs no motion");
  if (!motion->locks() && (slot.positions != 1 || slot.speeds != 1))
    throw std::invalid_argument("hinge '" + hinge_name + "' has " + std::to_string(slot.speeds) +
                                " rates; a motion moves hinges with one coordinate, and 'locked' holds any");
  if (driven(static_cast<std::size_t>(index))) {
    const auto other =
        std::find_if(motions_.begin(), motions_.end(), [&](const MotionNode& m) { return m.hinge == index; });
    throw std::invalid_argument("hinge '" + hinge_name + "' is driven by motion '" + other->name + "' already");
  }
  check_times("motion '" + name + "'", *motion);
  driven_[static_cast<std::size_t>(index)] = true;
  layout_.prescribed += slot.speeds;
  motions_.push_back({std::move(name), index, std::move(motion)});
}

void LoadNode::wrenches(double t, std::span<const double> y, const Layout& layout, std::span<const FrameMotion> motions,
                        std::span<Wrench> wrenches, std::span<double> scratch) const noexcept {
  load->wrenches(t, motions, wrenches);
  if (slot.count > 0) load->discrete()->add_wrenches(t, discrete(y), motions, wrenches);
  if (continuous != nullptr) continuous->add_wrenches(view(t, y, layout, scratch), motions, wrenches);
}

void Model::add_state_efforts(double t, std::span<const double> y, std::span<double> efforts, std::span<double> scratch,
                              int only) const noexcept {
  const auto wanted = [only](const LoadSlot& slot) { return only < 0 || slot.load == static_cast<std::size_t>(only); };
  for (const LoadSlot& slot : layout_.discrete_slots) {
    if (wanted(slot)) loads_[slot.load].load->discrete()->add(t, y.subspan(slot.first, slot.count), efforts);
  }
  for (const LoadSlot& slot : layout_.continuous_slots) {
    const LoadNode& node = loads_[slot.load];
    if (wanted(slot)) node.continuous->add(node.view(t, y, layout_, scratch), efforts);
  }
}

bool Model::continuous_rates(double t, std::span<const double> y, std::span<double> y_dot,
                             std::span<double> scratch) const noexcept {
  double sum = 0;
  for (const LoadSlot& slot : layout_.continuous_slots) {
    const LoadNode& node = loads_[slot.load];
    const std::span<double> rates = y_dot.subspan(slot.first, slot.count);
    LoadView view = node.view(t, y, layout_, scratch);
    view.accelerations = y_dot.subspan(layout_.positions, layout_.speeds);
    node.continuous->rates(view, rates);
    for (const double rate : rates) sum += 0.0 * rate;
  }
  return sum == 0.0;
}

void Model::begin_continuous(State& state) const {
  std::vector<double> scratch(load_scratch_), begun;
  for (const LoadSlot& slot : layout_.continuous_slots) {
    const LoadNode& node = loads_[slot.load];
    begun.assign(slot.count, 0.0);
    node.continuous->begin(node.view(state.time, state.y, layout_, scratch), begun);
    std::copy(begun.begin(), begun.end(), state.y.begin() + static_cast<std::ptrdiff_t>(slot.first));
  }
}

void Model::add_load(std::string name, const Load& load) {
  const std::string who = "load '" + name + "'";
  const std::shared_ptr<const BoundLoad> bound =
      plugin_call(who + " cannot be bound", [&]() -> std::shared_ptr<const BoundLoad> { return load.bind(*this); });
  if (bound == nullptr) throw std::invalid_argument(who + " cannot be bound and does not say why");
  check_times(who, *bound);
  LoadNode node{std::move(name), bound};
  const Kept kept = plugin_call(who + " does not say what it keeps", [&] { return kept_by(*bound, node.name, who); });
  load_scratch_ = std::max(load_scratch_, kept.scratch);
  const std::size_t index = loads_.size();
  if (kept.continuous != nullptr) {
    const std::size_t count = kept.names.size();
    node.continuous = kept.continuous;
    node.continuous_slot = {index, layout_.moving(), count};
    layout_.continuous_slots.push_back(node.continuous_slot);
    layout_.continuous_names.insert(layout_.continuous_names.end(), kept.names.begin(), kept.names.end());
    layout_.continuous += count;
    // Discrete states stand behind the continuous ones.
    for (LoadSlot& slot : layout_.discrete_slots) loads_[slot.load].slot.first = slot.first += count;
  }
  if (kept.discrete > 0) {
    if (layout_.discrete_slots.empty()) layout_.discrete = 1;  // behind all, whether they are those of a run
    node.slot = {index, layout_.moving() + layout_.discrete - 1, kept.discrete};
    layout_.discrete_slots.push_back(node.slot);
    layout_.discrete += kept.discrete;
  }
  loads_.push_back(std::move(node));
}

}  // namespace withy
