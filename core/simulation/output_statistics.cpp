#include "withy/core/simulation/output_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/plugin/just_before.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/parabola.hpp"

namespace withy {
namespace {

/// The sensors up to the last that is watched: formulas refer to those before them.
std::vector<SensorNode> needed(const std::vector<SensorNode>& sensors, const std::vector<std::string>& watched) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < sensors.size(); ++i)
    if (std::find(watched.begin(), watched.end(), sensors[i].name) != watched.end()) count = i + 1;
  return {sensors.begin(), sensors.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

double OutputStatistics::rms() const { return span > 0 ? std::sqrt(std::max(0.0, square / span)) : std::abs(least); }

StatisticsWatch::StatisticsWatch(const std::vector<SensorNode>& sensors, const std::vector<std::string>& watched,
                                 const EquationsOfMotion& equations, std::vector<double> jumps, StepParts parts)
    : reader_(needed(sensors, watched), equations), jumps_(std::move(jumps)), parts_(std::move(parts)) {
  std::size_t column = 0;
  for (const SensorNode& node : needed(sensors, watched)) {
    const bool asked = std::find(watched.begin(), watched.end(), node.name) != watched.end();
    for (const Column& c : columns_of(node)) {
      if (asked) {
        columns_.push_back(column);
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        results_.push_back({.name = c.name, .unit = c.unit, .least = none, .greatest = none});
      }
      ++column;
    }
  }
  all_.resize(column);
  now_.resize(results_.size());
  for (std::vector<double>& values : within_) values.resize(results_.size());
  between_.y.resize(equations.size());
}

void StatisticsWatch::read(const State& state, std::vector<double>& values) {
  const bool any = reader_.read(state, all_);
  for (std::size_t i = 0; i < columns_.size(); ++i)
    values[i] = any ? all_[columns_[i]] : std::numeric_limits<double>::quiet_NaN();
}

void StatisticsWatch::read_end(const State& state, std::vector<double>& values) {
  if (!std::binary_search(jumps_.begin(), jumps_.end(), state.time)) return read(state, values);
  between_ = state;
  between_.time = just_before(state.time, from_);
  read(between_, values);
}

void StatisticsWatch::note(double t, const std::vector<double>& values) {
  for (std::size_t i = 0; i < results_.size(); ++i) {
    OutputStatistics& r = results_[i];
    if (!std::isfinite(values[i])) continue;
    if (!(values[i] >= r.least)) r.least = values[i], r.least_at = t;
    if (!(values[i] <= r.greatest)) r.greatest = values[i], r.greatest_at = t;
  }
}

void StatisticsWatch::begin_at(const State& state) {
  from_ = state.time;
  read(state, within_.front());
  note(from_, within_.front());
}

void StatisticsWatch::observe(const Stepper& stepper) {
  const double from = from_, h = stepper.state().time - from;
  if (!(h > 0)) {
    begin_at(stepper.state());
    return;
  }
  interpolate_step(stepper, from, between_.y);
  const std::size_t parts = parts_(h, between_.y, stepper.state().y);
  for (std::size_t k = 1; k < parts; ++k)
    observe_part(stepper, from + h * static_cast<double>(k) / static_cast<double>(parts));
  observe_part(stepper, stepper.state().time);
}

void StatisticsWatch::observe_part(const Stepper& stepper, double to) {
  const double h = to - from_;
  for (std::size_t k = 1; k < places; ++k) {
    const bool end = k + 1 == places;
    if (end && to == stepper.state().time) {
      read_end(stepper.state(), within_.back());
      break;
    }
    between_.time = end ? to : from_ + h * static_cast<double>(k) / (places - 1);
    interpolate_step(stepper, between_.time, between_.y);
    read(between_, within_[k]);
  }
  for (std::size_t k = 0; k < places; ++k) note(from_ + h * static_cast<double>(k) / (places - 1), within_[k]);
  for (std::size_t i = 0; i < results_.size(); ++i) {
    const bool whole =
        std::all_of(within_.begin(), within_.end(), [i](const auto& at) { return std::isfinite(at[i]); });
    if (!whole) continue;
    add_part(i, h);
    refine(stepper, i, h, 1);
    refine(stepper, i, h, -1);
  }
  within_.front() = within_.back();
  from_ = to;
}

void StatisticsWatch::add_part(std::size_t result, double h) {
  constexpr std::array<double, places> boole{7 / 90.0, 32 / 90.0, 12 / 90.0, 32 / 90.0, 7 / 90.0};
  OutputStatistics& r = results_[result];
  for (std::size_t k = 0; k < places; ++k) {
    const double x = within_[k][result];
    r.integral += h * boole[k] * x;
    r.square += h * boole[k] * x * x;
  }
  r.span += h;
}

/// Looks for a greatest (sign 1) or least (−1) value between the places.
void StatisticsWatch::refine(const Stepper& stepper, std::size_t result, double h, double sign) {
  const OutputStatistics& r = results_[result];
  const double apart = h / (places - 1);
  std::size_t top = 0;
  for (std::size_t k = 1; k < places; ++k)
    if (sign * within_[k][result] > sign * within_[top][result]) top = k;
  const std::size_t middle = std::clamp<std::size_t>(top, 1, places - 2);
  std::array<double, 3> t{}, x{};
  for (std::size_t k = 0; k < 3; ++k) {
    t[k] = from_ + apart * static_cast<double>(middle + k - 1);
    x[k] = within_[middle + k - 1][result];
  }
  for (int look = 0; look < 2; ++look) {
    const double at = vertex(t, x), known = sign > 0 ? r.greatest : -r.least;
    if (at == t[0] || at == t[1] || at == t[2] || sign * along(t, x, at) <= known) return;
    between_.time = at;
    interpolate_step(stepper, at, between_.y);
    read(between_, now_);
    if (!std::isfinite(now_[result])) return;
    note(at, now_);
    // The point farthest from the new one goes.
    const std::size_t out = at - t[0] > t[2] - at ? 0 : 2;
    const bool behind = at > t[1];
    const double value = now_[result], t1 = t[1], x1 = x[1];
    if (out == 0) {
      t = {behind ? t1 : at, behind ? at : t1, t[2]};
      x = {behind ? x1 : value, behind ? value : x1, x[2]};
    } else {
      t = {t[0], behind ? t1 : at, behind ? at : t1};
      x = {x[0], behind ? x1 : value, behind ? value : x1};
    }
  }
}

void StatisticsWatch::remember(Memory& memory) {
  for (OutputStatistics& r : results_)
    for (double* number : {&r.least, &r.least_at, &r.greatest, &r.greatest_at, &r.integral, &r.square, &r.span})
      memory(*number);
  memory(within_.front());
  memory(from_);
}

}  // namespace withy
