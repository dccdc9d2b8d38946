// How far the tips of flexible bodies are deflected, also between the states that a run accepts.
#include <algorithm>
#include <cmath>

#include "withy/core/simulation/cubic.hpp"
#include "withy/core/simulation/monitor.hpp"

namespace withy {

Monitor::SectionExpansion::SectionExpansion(const PointExpansion& e) {
  for (Eigen::Index i = 0; i < e.phi.cols(); ++i) {
    first.emplace_back(e.phi.col(i));
    for (Eigen::Index j = i; j < e.phi.cols(); ++j)
      second.emplace_back(Vector3(e.gamma[0](i, j), e.gamma[1](i, j), e.gamma[2](i, j)) * (i == j ? 0.5 : 1.0));
  }
}

Vector3 Monitor::SectionExpansion::displacement(const double* q) const {
  Vector3 d = Vector3::Zero();
  const Vector3* gamma = second.data();
  for (std::size_t i = 0; i < first.size(); ++i) {
    d += first[i] * q[i];
    for (std::size_t j = i; j < first.size(); ++j) d += *gamma++ * (q[i] * q[j]);
  }
  return d;
}

Vector3 Monitor::SectionExpansion::velocity(const double* q, const double* u) const {
  Vector3 v = Vector3::Zero();
  const Vector3* gamma = second.data();
  for (std::size_t i = 0; i < first.size(); ++i) {
    v += first[i] * u[i];
    for (std::size_t j = i; j < first.size(); ++j) v += *gamma++ * (u[i] * q[j] + q[i] * u[j]);
  }
  return v;
}

void Monitor::note(const std::string& name, double length, const std::array<double, 3>& d,
                   std::array<double, 3>* peak) {
  for (std::size_t k = 0; peak != nullptr && k < 3; ++k) (*peak)[k] = std::max((*peak)[k], std::abs(d[k]));
  const double size = std::hypot(d[0], d[1], d[2]);
  if (!excess_.empty() || size <= deflection_limit_ * length) return;
  excess_ = "the tip of '" + name + "' is deflected by " + brief(size) + " m, " + brief(size / length) +
            " times its length (limit " + brief(deflection_limit_) + ")";
}

/// Exact kinematics integrates along the body, at the cost of an evaluation: only where the expansion says that the
/// deflection has not been so great before.
void Monitor::observe_end(End& end, const State& state, const Vector3& rough) {
  bool greater = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const double size = std::abs(rough[static_cast<Eigen::Index>(k)]);
    greater = greater || size > end.rough[k];
    end.rough[k] = std::max(end.rough[k], size);
  }
  if (!greater) return;
  std::array<double, 3> d{rough.x(), rough.y(), rough.z()};
  if (end.frame >= 0) {
    see(state);
    d = seen_.deflection(end.body, end.frame);
  }
  *end.ratio = std::max(*end.ratio, std::hypot(d[0], d[1], d[2]) / end.length);
  note(end.slot->name, end.length, d, end.peak);
}

/// Where a component of the deflection grows at the start of the last step and shrinks at its end, its greatest size
/// lies between: along the cubic through the coordinates and rates at the ends. It is sought where the cubic through
/// the component itself says that it has not been so great before.
void Monitor::observe_within(End& end, const State& state, const Vector3& now, const Vector3& velocity) {
  const double h = state.time - last_.time;
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (end.now[k] * end.velocity[k] <= 0 || now[k] * velocity[k] >= 0) continue;
    double greatest = 0, where = 0;
    constexpr int parts = 16;
    for (int i = 1; i < parts; ++i) {
      const double s = static_cast<double>(i) / parts;
      const double size = std::abs(cubic(s, end.now[k], h * end.velocity[k], now[k], h * velocity[k]));
      if (size <= greatest) continue;
      greatest = size;
      where = s;
    }
    if (greatest <= end.rough[static_cast<std::size_t>(k)]) continue;
    const std::size_t q = end.slot->position, u = model_.layout().positions + end.slot->speed;
    between_.y = state.y;
    for (std::size_t i = 0; i < end.slot->positions; ++i)
      between_.y[q + i] = cubic(where, last_.y[q + i], h * last_.y[u + i], state.y[q + i], h * state.y[u + i]);
    observe_end(end, between_, end.section.displacement(between_.y.data() + q));
  }
}

void Monitor::see(const State& state) {
  if (seen_y_ == state.y) return;
  seen_.observe(state.y);
  seen_y_ = state.y;
}

void Monitor::look(const State& state) {
  if (own_ == nullptr) seen_y_.clear();
  for (End& end : ends_) {
    const double* const q = state.y.data() + end.slot->position;
    const double* const u = state.y.data() + model_.layout().positions + end.slot->speed;
    const Vector3 now = end.section.displacement(q), velocity = end.section.velocity(q, u);
    if (state.time > last_.time) observe_within(end, state, now, velocity);
    end.now = now;
    end.velocity = velocity;
    observe_end(end, state, now);
  }
  if (!wholes_.empty()) {
    see(state);
    for (const Tip& tip : wholes_)
      note(tip.body, tip.length, deflection(seen_, tip), &summary_.peak_deflection[tip.body]);
  }
  last_ = state;
}

}  // namespace withy
