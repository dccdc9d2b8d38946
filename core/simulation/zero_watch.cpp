#include "withy/core/simulation/zero_watch.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/simulation/cubic.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/parabola.hpp"

namespace withy {
namespace {

int sign(double value) { return (value > 0) - (value < 0); }

const DiscretePart& switching_part(const Model& model, const LoadSlot& slot) {
  return *model.loads()[slot.load].load->discrete();
}

std::span<const double> positions(const Model& model, std::span<const double> y) {
  return y.first(model.layout().positions);
}
std::span<const double> speeds(const Model& model, std::span<const double> y) {
  return y.subspan(model.layout().positions, model.layout().speeds);
}

}  // namespace

/// Of the coordinates that are integrals of a rate.
std::vector<ZeroWatch::Moving> ZeroWatch::moving_coordinates(const Model& model) {
  std::vector<Moving> moving;
  for (const ModelRate& rate : hinge_rates(model))
    if (rate.position) moving.push_back({*rate.position, model.layout().positions + rate.speed});
  return moving;
}

ZeroWatch::ZeroWatch(const Model& model, std::span<const RunEvent> events, const State& start, double end, bool kinks)
    : model_(model), events_(events), inside_(start) {
  for (const LoadSlot& slot : model.layout().discrete_slots) {
    if (switching_part(model, slot).switches() == 0) continue;
    switches_ += switching_part(model, slot).switches();
    slots_.push_back(slot);
  }
  std::size_t of_kinks = 0;
  for (const LoadNode& node : model.loads()) {
    const auto* kinked = kinks ? dynamic_cast<const Kinks*>(node.load.get()) : nullptr;
    if (kinked == nullptr || kinked->kinks() == 0) continue;
    kinks_.push_back(kinked);
    of_kinks += kinked->kinks();
  }
  values_.resize(switches_ + events.size() + of_kinks);
  signs_.resize(values_.size());
  unsure_.assign(values_.size(), -1);
  near_.resize(values_.size());
  landed_.resize(values_.size());
  just_before_.resize(values_.size());
  end_signs_.resize(values_.size());
  ends_.resize(values_.size());
  for (Row& row : rows_) row.values.resize(values_.size());
  if (!empty()) parts_.emplace(model, start.time, end);
  if (of_kinks > 0) moving_ = moving_coordinates(model);
  begin_at(start);
  if (parts_) leave_out_what_does_not_matter(start, end);
}

/// What a watched number does not depend on at one state it may depend on at another: at the start much is zero, and so
/// are its products with all else. So it is asked at states at which nothing is zero or like another, at other times.
void ZeroWatch::leave_out_what_does_not_matter(const State& start, double end) {
  constexpr int states = 7;
  const Layout& layout = model_.layout();
  std::vector<double> y, turned;
  const auto matters_at = [&](int k, std::size_t coordinate) {
    y = start.y;
    const double t = start.time + (std::isfinite(end) ? (end - start.time) / states : 1.0) * (k + 0.618);
    const auto move = [&](std::size_t i) { y[i] += std::sin(1.3 + 0.7 * k + 2.1 * static_cast<double>(i)); };
    for (std::size_t i = 0; i < layout.positions + layout.speeds; ++i) move(i);
    for (const LoadSlot& slot : layout.continuous_slots)
      for (std::size_t i = slot.first; i < slot.first + slot.count; ++i) move(i);
    for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
      const Slot& slot = layout.hinges[h];
      model_.hinges()[h].hinge->normalize(std::span(y).subspan(slot.position, slot.positions));
    }
    turned = y;
    turned[coordinate] += 0.7 + 1.1 * k;
    evaluate(t, y, values_);
    evaluate(t, turned, ends_);
    // A number of outputs is rounded otherwise in other places.
    return !std::equal(values_.begin(), values_.end(), ends_.begin(), [](double a, double b) {
      return std::abs(a - b) <= 1e-12 * std::max(std::abs(a), std::abs(b));
    });
  };
  parts_->leave_out([&](std::size_t coordinate) {
    for (int k = 0; k < states; ++k)
      if (matters_at(k, coordinate)) return true;
    return false;
  });
}

void ZeroWatch::evaluate(double t, std::span<const double> y, std::span<double> values) const {
  std::size_t at = 0;
  for (const LoadSlot& slot : slots_) {
    const DiscretePart& part = switching_part(model_, slot);
    part.switching(t, positions(model_, y), speeds(model_, y), y.subspan(slot.first, slot.count),
                   values.subspan(at, part.switches()));
    at += part.switches();
  }
  for (const RunEvent& event : events_) values[at++] = event.function(t, y);
  for (const Kinks* kinked : kinks_) {
    kinked->kinks(positions(model_, y), speeds(model_, y), values.subspan(at, kinked->kinks()));
    at += kinked->kinks();
  }
}

bool ZeroWatch::noticed(std::size_t function, int direction) const {
  return function < switches_ || is_kink(function) || event(function).direction == 0 ||
         event(function).direction == direction;
}

void ZeroWatch::begin_at(const State& state) {
  evaluate(state.time, state.y, values_);
  std::transform(values_.begin(), values_.end(), signs_.begin(), sign);
}

const std::vector<ZeroWatch::Zero>& ZeroWatch::land(const State& before, const State& state,
                                                    std::span<const Zero> known) {
  zeros_.clear();
  const double time_before = std::nextafter(state.time, before.time);
  evaluate(before.time, before.y, ends_);
  evaluate(time_before, state.y, just_before_);
  evaluate(state.time, state.y, values_);
  landed_ = values_;
  signs_ = start_signs_;  // what else `find` has seen lies beyond this state, or is seen again
  const auto is_near = [&](std::size_t f) { return std::abs(landed_[f]) <= 1e-9 * std::abs(ends_[f]); };
  const auto has_passed = [&](std::size_t f, int direction) {
    signs_[f] = direction;
    values_[f] = 0;  // up to rounding of either sign
  };
  // What passes here in the direction that nobody notices has passed too, as it is seen beyond this state.
  for (std::size_t f = 0; f < signs_.size(); ++f)
    if (is_near(f) && signs_[f] * before_[f] < 0 && !noticed(f, before_[f])) has_passed(f, before_[f]);
  for (const Zero& zero : known) has_passed(zero.function, zero.direction);
  for (std::size_t f = 0; f < signs_.size(); ++f) {
    const int now = sign(values_[f]);
    if (now == 0) continue;
    if (signs_[f] * now < 0 && noticed(f, now) && !is_kink(f)) zeros_.push_back({state.time, f, now});
    signs_[f] = now;
  }
  // As near as interpolation and root finding come, and as near as this state is; a jump leaves no doubt.
  const auto passed = [&](const Zero& zero) {
    const std::size_t f = zero.function;
    const bool jumped = has_jumped(f, state.time - before.time, state.time - time_before);
    unsure_[f] = std::max(jumped ? 0 : 2 * std::abs(landed_[f]), 1e-9 * std::abs(ends_[f]));
  };
  std::for_each(known.begin(), known.end(), passed);
  std::for_each(zeros_.begin(), zeros_.end(), passed);
  // Functions that look for the same zero in the other direction are as near.
  for (std::size_t f = 0; f < signs_.size(); ++f)
    if (is_near(f)) passed({state.time, f, 0});
  return zeros_;
}

bool ZeroWatch::has_jumped(std::size_t function, double length, double instant) const {
  const double from = just_before_[function], to = landed_[function];
  if (!(from * to < 0)) return false;
  // What it has been in the step, which `find` has looked into. No smooth function changes by as much in an instant.
  double size = std::abs(ends_[function]);
  for (const Row& row : rows_) size = std::max(size, std::abs(row.values[function]));
  constexpr double smooth = 1e-6, instants = 64;
  return std::abs(to - from) > std::max(smooth, instants * instant / length) * size;
}

const std::vector<ZeroWatch::Zero>& ZeroWatch::leap(const State& state) {
  zeros_.clear();
  evaluate(state.time, state.y, values_);
  for (std::size_t f = 0; f < signs_.size(); ++f) {
    if (unsure_[f] >= 0 && std::abs(values_[f] - landed_[f]) <= unsure_[f]) continue;
    const int now = sign(values_[f]);
    if (now == 0 && looks(f, state.y)) continue;  // on its zero: the side that it came from says whether it passes
    if (signs_[f] * now < 0 && noticed(f, now) && !is_kink(f)) zeros_.push_back({state.time, f, now});
    signs_[f] = now;
  }
  return zeros_;
}

bool ZeroWatch::is_due_to(double moved, const Zero& zero) const {
  const double known_to = std::max(unsure_[zero.function], 1e-9 * std::abs(moved));
  return zero.direction * (values_[zero.function] - moved) <= known_to;
}

bool ZeroWatch::looks(std::size_t function, std::span<const double> y) const {
  if (function < switches_ || is_kink(function)) return true;
  const RunEvent& own = event(function);
  return !own.looks || own.looks(y);
}

void ZeroWatch::look_at(const Course& course, double t) {
  if (course.by_ends) {
    between(course.before, course.stepper.state(), t);
  } else {
    interpolate_step(course.stepper, t, inside_.y);
  }
  evaluate(t, inside_.y, values_);
}

void ZeroWatch::between(const State& before, const State& after, double t) {
  const double length = after.time - before.time, s = (t - before.time) / length;
  for (std::size_t i = 0; i < inside_.y.size(); ++i) inside_.y[i] = std::lerp(before.y[i], after.y[i], s);
  for (const Moving& x : moving_)
    inside_.y[x.position] =
        cubic(s, before.y[x.position], length * before.y[x.rate], after.y[x.position], length * after.y[x.rate]);
}

double ZeroWatch::zero_between(const Course& course, std::size_t f, double a, double b, double value_at_b) {
  const auto value = [&](double t) {
    look_at(course, t);
    return values_[f];
  };
  const double value_at_a = value(a);
  if (value_at_a * value_at_b >= 0) return a;  // rounding: it has passed at the last state already
  std::uintmax_t most = 100;
  return boost::math::tools::toms748_solve(value, a, b, value_at_a, value_at_b,
                                           boost::math::tools::eps_tolerance<double>(50), most)
      .second;
}

void ZeroWatch::cross(const Course& course, std::size_t f, const Row& begin, const Row& end) {
  if (std::abs(end.values[f]) <= near_[f]) return;  // its sign is rounding's still
  near_[f] = -1;
  const int now = sign(end.values[f]);
  if (now == 0 || now == before_[f]) return;
  // Else it began on its zero.
  if (before_[f] != 0 && noticed(f, now))
    zeros_.push_back({zero_between(course, f, begin.time, end.time, end.values[f]), f, now});
  before_[f] = now;
}

void ZeroWatch::leave(std::size_t f, double from) {
  const double value = rows_.back().values[f];
  const int now = sign(value);
  if (std::abs(value) <= near_[f] || now == 0) return;
  near_[f] = -1;
  if (before_[f] * now < 0 && noticed(f, now)) zeros_.push_back({from, f, now});
  before_[f] = now;
}

void ZeroWatch::cross_there_and_back(const Course& course, std::size_t f, std::size_t interval) {
  const Row &a = rows_[interval], &b = rows_[interval + 1];
  const int outside = sign(a.values[f]);
  if (near_[f] >= 0 || outside == 0 || sign(b.values[f]) != outside || before_[f] == 0) return;
  std::array<double, 3> t{}, x{};
  for (std::size_t k = 0; k < 3; ++k) t[k] = rows_[k].time, x[k] = rows_[k].values[f];
  constexpr int most_looks = 3;
  for (int look = 0; look < most_looks; ++look) {
    const double at = vertex(t, x);
    const bool within = at > a.time && at < b.time;
    const double nearer = std::min(std::abs(a.values[f]), std::abs(b.values[f]));
    if (!within || !(outside * along(t, x, at) < nearer)) return;
    look_at(course, at);
    const double there = values_[f];
    if (sign(there) == -outside) {
      const auto found = [&](const Zero& z) { return z.function == f && z.time >= a.time && z.time <= b.time; };
      if (std::any_of(zeros_.begin(), zeros_.end(), found)) return;
      if (noticed(f, -outside)) zeros_.push_back({zero_between(course, f, a.time, at, there), f, -outside});
      if (noticed(f, outside)) zeros_.push_back({zero_between(course, f, at, b.time, b.values[f]), f, outside});
      return;
    }
    t = {a.time, at, b.time};
    x = {a.values[f], there, b.values[f]};
  }
}

bool ZeroWatch::may_pass(const State& before, const State& after) {
  evaluate(after.time, after.y, values_);
  std::transform(values_.begin(), values_.end(), before_.begin(), sign);
  if (before_ != signs_) return true;
  const auto tangent_passes = [&](const State& state, double step) {
    inside_.y = state.y;
    for (const Moving& x : moving_) inside_.y[x.position] += step * state.y[x.rate];
    evaluate(state.time + step, inside_.y, values_);
    return !std::equal(values_.begin(), values_.end(), signs_.begin(), [](double v, int s) { return sign(v) == s; });
  };
  const double length = after.time - before.time;
  return tangent_passes(before, length) || tangent_passes(after, -length);
}

void ZeroWatch::take(const Course& course, double t) {
  std::rotate(rows_.begin(), rows_.begin() + 1, rows_.end());
  look_at(course, t);
  rows_.back().time = t;
  rows_.back().values = values_;
}

void ZeroWatch::look_through(const Course& course, std::size_t first, std::size_t looks,
                             const std::function<bool(const Zero&)>& cuts) {
  const double from = course.before.time, to = course.stepper.state().time;
  const double interval = (to - from) / static_cast<double>(looks);
  take(course, from);
  // What has just passed its zero has, there, the sign that rounding leaves.
  constexpr double little_later = 0x1p-10;
  const auto near = [&](std::size_t f) { return near_[f] >= 0; };
  bool any_near = false;
  for (std::size_t f = first; f < before_.size(); ++f) any_near = any_near || near(f);
  if (any_near) {
    take(course, from + little_later * interval);
    for (std::size_t f = first; f < before_.size(); ++f) {
      if (near(f)) {
        leave(f, from);
      } else {
        cross(course, f, rows_[1], rows_[2]);
      }
    }
  }
  for (std::size_t look = 1; look <= looks; ++look) {
    take(course, look == looks ? to : from + interval * static_cast<double>(look));
    for (std::size_t f = first; f < before_.size(); ++f) {
      cross(course, f, rows_[1], rows_[2]);
      if (look == 2) cross_there_and_back(course, f, 0);
      if (look >= 2) cross_there_and_back(course, f, 1);
    }
    if (look >= 2 && std::any_of(zeros_.begin(), zeros_.end(), cuts)) return;
  }
}

/// The first steps after an event may be far shorter than rounding is of what has passed there.
void ZeroWatch::doubt_what_stays_near(const State& after) {
  const bool any = std::any_of(unsure_.begin(), unsure_.end(), [](double unsure) { return unsure >= 0; });
  if (any) evaluate(after.time, after.y, values_);
  for (std::size_t f = 0; f < unsure_.size(); ++f) {
    if (unsure_[f] < 0) continue;
    if (std::abs(values_[f]) <= unsure_[f])
      landed_[f] = 0;
    else
      unsure_[f] = -1;
  }
}

const std::vector<ZeroWatch::Zero>& ZeroWatch::find(const Stepper& stepper, const State& before,
                                                    const std::function<bool(const Zero&)>& cuts) {
  // A function may pass zero and come back within a step: between looks a parabola through three of them tells.
  constexpr std::size_t looks_in_a_part = 4, looks_at_kinks = 2;
  const State& after = stepper.state();
  zeros_.clear();
  for (std::size_t f = 0; f < signs_.size(); ++f) near_[f] = signs_[f] == 0 ? std::max(unsure_[f], 0.0) : unsure_[f];
  doubt_what_stays_near(after);
  before_ = start_signs_ = signs_;
  // The kinks are those of coordinates, which a parabola follows over a step.
  const std::size_t first_kink = switches_ + events_.size();
  if (first_kink == 0 && !may_pass(before, after)) return zeros_;
  evaluate(after.time, after.y, values_);
  std::transform(values_.begin(), values_.end(), end_signs_.begin(), sign);
  // A step that ends beyond a kink was made with it in sight.
  const auto counts = [&](const Zero& z) {
    return !is_kink(z.function) || end_signs_[z.function] == signs_[z.function];
  };
  const std::function<bool(const Zero&)> ends = [&](const Zero& z) { return counts(z) && cuts(z); };
  before_ = signs_;
  look_through(
      {stepper, before, false}, 0,
      first_kink == 0 ? looks_at_kinks : looks_in_a_part * (*parts_)(after.time - before.time, before.y, after.y),
      ends);
  if (!kinks_.empty() &&
      std::none_of(zeros_.begin(), zeros_.end(), [&](const Zero& z) { return is_kink(z.function); })) {
    std::copy(signs_.begin() + first_kink, signs_.end(), before_.begin() + first_kink);
    look_through({stepper, before, true}, first_kink, looks_at_kinks, ends);
  }
  std::erase_if(zeros_, [&](const Zero& z) { return !counts(z); });
  std::stable_sort(zeros_.begin(), zeros_.end(), [](const Zero& a, const Zero& b) { return a.time < b.time; });
  // What nobody notices has passed.
  const auto waits = [&](std::size_t f) {
    return std::any_of(zeros_.begin(), zeros_.end(), [f](const Zero& z) { return z.function == f; });
  };
  for (std::size_t f = 0; f < signs_.size(); ++f)
    if (!waits(f)) signs_[f] = before_[f];
  return zeros_;
}

std::optional<std::pair<LoadSlot, int>> ZeroWatch::switching(std::size_t function) const {
  if (function >= switches_) return {};
  std::size_t index = function;
  for (const LoadSlot& slot : slots_) {
    const std::size_t count = switching_part(model_, slot).switches();
    if (index < count) return std::pair{slot, static_cast<int>(index)};
    index -= count;
  }
  return {};
}

}  // namespace withy
