// How far the tips of flexible bodies, or what stands for them, are deflected, also between the states that a run
// accepts.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "withy/core/simulation/cubic.hpp"
#include "withy/core/simulation/monitor.hpp"

namespace withy {

Monitor::SectionExpansion::SectionExpansion(const PointExpansion& e) {
  const auto modes = static_cast<int>(e.phi.cols());
  const auto add = [this](double factor, int i, int j) {
    if (factor != 0) terms.push_back({factor, i, j});
  };
  for (std::size_t k = 0; k < 3; ++k) {
    for (int i = 0; i < modes; ++i) {
      add(e.phi(static_cast<Eigen::Index>(k), i), i, -1);
      for (int j = i; j < modes; ++j) add(e.gamma[k](i, j) * (i == j ? 0.5 : 1.0), i, j);
    }
    ends[k] = terms.size();
    for (int i = 0; i < modes; ++i) {
      const double psi = e.psi(static_cast<Eigen::Index>(k), i);
      if (psi != 0) turns.push_back({psi, i, -1});
    }
    turn_ends[k] = turns.size();
  }
}

double Monitor::SectionExpansion::squared_angle(const double* q) const {
  double square = 0;
  const Term* t = turns.data();
  for (const std::size_t last : turn_ends) {
    double angle = 0;
    for (const Term* const end = turns.data() + last; t != end; ++t) angle += t->factor * q[t->i];
    square += angle * angle;
  }
  return square;
}

void Monitor::SectionExpansion::at(const double* q, const double* u, Motion& motion) const {
  const Term* t = terms.data();
  for (std::size_t k = 0; k < 3; ++k) {
    double d = 0, v = 0;
    for (const Term* const end = terms.data() + ends[k]; t != end; ++t) {
      if (t->j < 0) {
        d += t->factor * q[t->i];
        v += t->factor * u[t->i];
      } else {
        d += t->factor * (q[t->i] * q[t->j]);
        v += t->factor * (u[t->i] * q[t->j] + q[t->i] * u[t->j]);
      }
    }
    motion.displacement[static_cast<Eigen::Index>(k)] = d;
    motion.velocity[static_cast<Eigen::Index>(k)] = v;
  }
}

void Monitor::note(std::size_t order, const std::string& place, const std::string& body, double length,
                   const std::array<double, 3>& d, std::array<double, 3>* peak) {
  for (std::size_t k = 0; peak != nullptr && k < 3; ++k) (*peak)[k] = std::max((*peak)[k], std::abs(d[k]));
  const double size = std::hypot(d[0], d[1], d[2]);
  if (order >= excess_order_ || size <= deflection_limit_ * length) return;
  excess_order_ = order;
  if (!std::isfinite(size)) {
    excess_ = place + " of '" + body + "' has no finite deflection any more";
    return;
  }
  past_deflection_ = true;
  excess_ = place + " of '" + body + "' is deflected by " + brief(size) + " m, " + brief(size / length) +
            " times its length (limits.deflection: " + brief(deflection_limit_) + ")";
}

/// Looks at a deflection that has not been so great before, as the expansion says, and where that does not have the
/// last word: exact kinematics integrates along the body, at the cost of an evaluation. \param seen whether the
/// observation is at the state
void Monitor::observe_end(std::size_t index, const State& state, const Vector3& rough, bool& seen) {
  End& end = ends_[index];
  for (std::size_t k = 0; k < 3; ++k)
    end.rough[k] = std::max(end.rough[k], std::abs(rough[static_cast<Eigen::Index>(k)]));
  end.rough_square = std::max(end.rough_square, rough.squaredNorm());
  std::array<double, 3> d{rough.x(), rough.y(), rough.z()};
  if (end.frame >= 0 && !end.expanded) {
    if (!std::exchange(seen, true)) see(state);
    d = seen_.deflection(end.body, end.frame);
  }
  *end.ratio = std::max(*end.ratio, std::hypot(d[0], d[1], d[2]) / end.length);
  note(index, end.name, end.slot->name, end.length, d, end.peak);
}

/// At a state to which `next` has been brought.
void Monitor::look_at_angle(End& end, const double* q) {
  const double square = end.section.squared_angle(q);
  if (!(square > *end.angle * *end.angle)) return;
  const Bend bend{end.next.displacement.norm() / end.length, std::sqrt(square)};
  if (bend.bent()) *end.angle = bend.angle;
}

bool Monitor::End::may_exceed(double h) const {
  double square = 0;
  for (Eigen::Index k = 0; k < whole; ++k) {
    const double a = now.displacement[k], b = next.displacement[k];
    // Two by two: a list of four would go through memory, at every step of every body.
    const double bound = std::max(std::max(std::abs(a), std::abs(a + h / 3 * now.velocity[k])),
                                  std::max(std::abs(b), std::abs(b - h / 3 * next.velocity[k])));
    if (!(bound <= rough[static_cast<std::size_t>(k)])) return true;
    square += bound * bound;
  }
  return !(square <= rough_square);
}

/// Where a component of the deflection, or its size, grows at the start of the last step and shrinks at its end, it is
/// greatest between, by the cubics through the components. 0 where it does not, or has been as great before.
double Monitor::greatest_within(const End& end, Eigen::Index k, double h) const {
  if (!end.turns(k)) return 0;
  const auto component = [&](double s, Eigen::Index i) {
    return cubic(s, end.now.displacement[i], h * end.now.velocity[i], end.next.displacement[i],
                 h * end.next.velocity[i]);
  };
  const auto square = [&](double s) {
    if (k < whole) return std::pow(component(s, k), 2);
    return Vector3(component(s, 0), component(s, 1), component(s, 2)).squaredNorm();
  };
  double greatest = 0, where = 0;
  constexpr int parts = 16;
  for (int i = 1; i < parts; ++i) {
    const double s = static_cast<double>(i) / parts;
    const double size = square(s);
    if (size <= greatest) continue;
    greatest = size;
    where = s;
  }
  const double before = k < whole ? std::pow(end.rough[static_cast<std::size_t>(k)], 2) : end.rough_square;
  return greatest > before ? where : 0;
}

/// Greatest deflections between the last state and this, along the cubic through the coordinates and rates at both. A
/// body's deflection is its own coordinates' alone: one state has each body where it is deflected most.
void Monitor::look_within(const State& state) {
  const double h = state.time - last_.time;
  bool begun = false;
  for (Eigen::Index component = 0; component <= whole; ++component) {
    for (End& end : ends_) {
      end.within = greatest_within(end, component, h);
      if (end.within == 0) continue;
      if (!std::exchange(begun, true)) between_.y = state.y;
      const std::size_t q = end.slot->position, u = model_.layout().positions + end.slot->speed;
      for (std::size_t i = 0; i < end.slot->positions; ++i)
        between_.y[q + i] = cubic(end.within, last_.y[q + i], h * last_.y[u + i], state.y[q + i], h * state.y[u + i]);
    }
    bool seen = false;
    for (std::size_t e = 0; begun && e < ends_.size(); ++e) {
      const End& end = ends_[e];
      if (!(end.within > 0)) continue;
      const double *const q = between_.y.data() + end.slot->position, *const u = between_.y.data() +
                                                                                 model_.layout().positions +
                                                                                 end.slot->speed;
      SectionExpansion::Motion rough;
      end.section.at(q, u, rough);
      if (end.exceeded_by(rough.displacement)) observe_end(e, between_, rough.displacement, seen);
    }
  }
}

void Monitor::see(const State& state) {
  if (seen_y_ == state.y) return;
  seen_.observe(state.y);
  seen_y_ = state.y;
}

void Monitor::look(const State& state) {
  if (own_ == nullptr) seen_y_.clear();
  excess_order_ = excess_.empty() ? std::numeric_limits<std::size_t>::max() : 0;
  const double h = state.time - last_.time;
  bool more = false, turns = false;
  for (End& end : ends_) {
    const double* const q = state.y.data() + end.slot->position;
    const double* const u = state.y.data() + model_.layout().positions + end.slot->speed;
    end.section.at(q, u, end.next);
    look_at_angle(end, q);
    if (!end.may_exceed(h)) continue;
    more = true;
    turns = turns || end.turns(0) || end.turns(1) || end.turns(2) || end.turns(whole);
  }
  if (turns && h > 0) look_within(state);
  bool seen = false;
  for (std::size_t e = 0; more && e < ends_.size(); ++e) {
    const End& end = ends_[e];
    if (end.exceeded_by(end.next.displacement)) observe_end(e, state, end.next.displacement, seen);
  }
  for (End& end : ends_) end.now = end.next;
  if (!wholes_.empty()) {
    see(state);
    for (std::size_t w = 0; w < wholes_.size(); ++w) {
      const Tip& tip = wholes_[w];
      note(ends_.size() + w, "the tip", tip.body, tip.length, deflection(seen_, tip),
           &summary_.peak_deflection[tip.body]);
    }
  }
  last_ = state;
}

}  // namespace withy
