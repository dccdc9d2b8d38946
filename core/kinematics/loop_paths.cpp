#include "withy/core/kinematics/loop_paths.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "withy/core/sweep/node.hpp"

namespace withy {
namespace {

std::vector<FrameIndex> frames_of(const Model& model) {
  std::vector<FrameIndex> frames;
  for (const LoopClosure* c : loops_of(model))
    for (const FrameIndex& f : {c->a(), c->b()})
      if (f.body >= 0) frames.push_back(f);
  return frames;
}

/// Of a hinge that holds the direction b, across a, where M has turned it to p = R b: with the shortest turn back, by α
/// from the tangent t at b, the component of α t along a, which is a · p nearby and zero at −b nowhere, and its slope
/// by p.
struct Tilt {
  double gap;
  Vector3 slope;
  Tilt(const ClosingEquation& e, const Matrix3& R) {
    const Vector3 p = R * e.b, across = p - e.b.dot(p) * e.b;
    const double sine = across.norm(), alpha = std::atan2(sine, e.b.dot(p));
    const Vector3 t = sine > 0 ? Vector3(across / sine) : e.a;
    const Vector3 ahead = std::cos(alpha) * t - sine * e.b;
    // Opposite b all ways lead back.
    constexpr double far_enough = 1e-6;
    const double stretch = sine > far_enough ? alpha / sine : 1;
    gap = alpha * e.a.dot(t);
    slope = e.a.dot(t) * ahead + stretch * (e.a - e.a.dot(ahead) * ahead);
  }
};

}  // namespace

LoopPaths::LoopPaths(const Model& model, Terms terms)
    : model_(model), frames_(frames_of(model)), paths_(model, terms, frames_, true), length_(length_of_loops(model)) {
  int next = 0;
  const auto end = [&](const FrameIndex& frame, const Pose& pose) { return End{frame.body < 0 ? -1 : next++, pose}; };
  for (const LoopClosure* c : loops_of(model)) {
    const End a = end(c->a(), c->offset()), b = end(c->b(), Pose{});
    const auto directions = std::count_if(c->equations().begin(), c->equations().end(),
                                          [](const ClosingEquation& e) { return e.of_directions; });
    loops_.push_back({a, b, c, static_cast<std::size_t>(directions)});
    size_ += c->equations().size();
  }
  sweep::WorkLayout memory;
  motions_offset_ = memory.take<FrameMotion>(frames_.size());
  accelerations_offset_ = memory.take<FrameAcceleration>(frames_.size());
  wrenches_offset_ = memory.take<Wrench>(frames_.size());
  paths_offset_ = memory.size();
  work_size_ = memory.size() + paths_.work_size();
}

FrameMotion LoopPaths::motion(const End& end, const FrameMotion* motions) noexcept {
  FrameMotion m = end.frame < 0 ? FrameMotion{} : motions[end.frame];
  const Vector3 arm = m.R * end.pose.p;
  m.position += arm;
  m.velocity += m.angular_velocity.cross(arm);
  m.R = m.R * end.pose.R;
  return m;
}

LoopPaths::Moving LoopPaths::moving(const Loop& loop, std::byte* work) const noexcept {
  const auto* motions = sweep::at<FrameMotion>(work, motions_offset_);
  return {motion(loop.a, motions), motion(loop.b, motions)};
}

FrameAcceleration LoopPaths::accelerated(const End& end, const FrameMotion& at, std::byte* work) const noexcept {
  if (end.frame < 0) return {};
  const FrameMotion& frame = sweep::at<FrameMotion>(work, motions_offset_)[end.frame];
  FrameAcceleration A = sweep::at<FrameAcceleration>(work, accelerations_offset_)[end.frame];
  const Vector3 arm = at.position - frame.position, w = frame.angular_velocity;
  A.linear += A.angular.cross(arm) + w.cross(w.cross(arm));
  return A;
}

void LoopPaths::gaps(std::span<const double> y, std::span<double> gaps, std::byte* work, Held held) const noexcept {
  const Layout& layout = model_.layout();
  paths_.motions(y.first(layout.positions), y.subspan(layout.positions, layout.speeds),
                 {sweep::at<FrameMotion>(work, motions_offset_), frames_.size()}, work + paths_offset_);
  double* g = gaps.data();
  for (const Loop& loop : loops_) {
    const auto [F, M] = moving(loop, work);
    const Vector3 r = F.R.transpose() * (M.position - F.position);
    const Matrix3 R = F.R.transpose() * M.R;
    const bool turn = held == Held::turn && loop.directions == 3, tilt = held == Held::turn && loop.directions == 2;
    Vector3 theta = Vector3::Zero();
    if (turn) {
      const Eigen::AngleAxisd turned(R);
      theta = turned.angle() * turned.axis();
    }
    for (const ClosingEquation& e : loop.node->equations()) {
      if (e.of_directions && turn)
        *g++ = length_ * e.b.cross(e.a).dot(theta);
      else if (e.of_directions && tilt)
        *g++ = length_ * Tilt(e, R).gap;
      else
        *g++ = e.of_directions ? length_ * (e.a.dot(R * e.b) - e.value) : e.a.dot(r) - e.value;
    }
  }
}

double LoopPaths::rounding(std::byte* work) const noexcept {
  constexpr double of_lengths = 1e-13, of_places = 1e-15;
  double farthest = 0;
  for (const Loop& loop : loops_) farthest = std::max(farthest, moving(loop, work).M.position.norm());
  return of_lengths + of_places * farthest / length_;
}

void LoopPaths::rates(std::span<double> rates, std::byte* work) const noexcept {
  double* g = rates.data();
  for (const Loop& loop : loops_) {
    const auto [F, M] = moving(loop, work);
    const Vector3 v = M.velocity - F.velocity - F.angular_velocity.cross(M.position - F.position);
    const Vector3 w = M.angular_velocity - F.angular_velocity;
    for (const ClosingEquation& e : loop.node->equations()) {
      const Vector3 d = F.R * e.a;
      *g++ = e.of_directions ? length_ * w.dot((M.R * e.b).cross(d)) : d.dot(v);
    }
  }
}

void LoopPaths::biases(std::span<double> biases, std::byte* work) const noexcept {
  paths_.velocity_accelerations({sweep::at<FrameAcceleration>(work, accelerations_offset_), frames_.size()},
                                work + paths_offset_);
  double* g = biases.data();
  for (const Loop& loop : loops_) {
    const auto [F, M] = moving(loop, work);
    const FrameAcceleration A = accelerated(loop.a, F, work), B = accelerated(loop.b, M, work);
    const Vector3 r = M.position - F.position, v = M.velocity - F.velocity;
    const Vector3 w_F = F.angular_velocity, w_M = M.angular_velocity;
    for (const ClosingEquation& e : loop.node->equations()) {
      const Vector3 d = F.R * e.a, d_rate = w_F.cross(d);
      if (e.of_directions) {
        const Vector3 f = M.R * e.b;
        *g++ = length_ *
               ((B.angular - A.angular).dot(f.cross(d)) + (w_M - w_F).dot(w_M.cross(f).cross(d) + f.cross(d_rate)));
      } else {
        *g++ = d.dot(B.linear - A.linear) + 2 * d_rate.dot(v) + (A.angular.cross(d) + w_F.cross(d_rate)).dot(r);
      }
    }
  }
}

Wrench LoopPaths::on_b(std::size_t index, std::span<const double> multipliers, std::byte* work,
                       Held held) const noexcept {
  std::size_t first = 0;
  for (std::size_t l = 0; l < index; ++l) first += loops_[l].node->equations().size();
  const auto [F, M] = moving(loops_[index], work);
  const bool turn = held == Held::turn && loops_[index].directions == 3;
  const bool tilt = held == Held::turn && loops_[index].directions == 2;
  const Matrix3& R_b = turn ? F.R : M.R;
  Wrench on_b;
  for (const ClosingEquation& e : loops_[index].node->equations()) {
    const Vector3 a = e.of_directions && tilt ? Tilt(e, F.R.transpose() * M.R).slope : e.a;
    const Vector3 d = F.R * a * multipliers[first++];
    if (e.of_directions) {
      on_b.moment += length_ * (R_b * e.b).cross(d);
    } else {
      on_b.force += d;
    }
  }
  return on_b;
}

Matrix3 LoopPaths::axes(std::size_t index, std::byte* work) const noexcept { return moving(loops_[index], work).F.R; }

bool LoopPaths::right_way_round(std::size_t index, std::byte* work) const noexcept {
  const auto [F, M] = moving(loops_[index], work);
  const Matrix3 R = F.R.transpose() * M.R;
  const std::size_t directions = loops_[index].directions;
  // Two directions hold the axis b, three the whole frame; one has no opposite. What solves the equations of three
  // takes each axis a to ± a, as half turns do, or to another one, as turns by a third of a circle about x + y + z.
  for (const ClosingEquation& e : loops_[index].node->equations()) {
    if (e.of_directions && directions == 2 && e.b.dot(R * e.b) < 0) return false;
    if (e.of_directions && directions == 3 && e.a.dot(R * e.a) < 0.5) return false;
  }
  return true;
}

void LoopPaths::wrenches(std::span<const double> multipliers, std::span<Wrench> wrenches, std::byte* work,
                         Held held) const noexcept {
  const auto* motions = sweep::at<FrameMotion>(work, motions_offset_);
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    const Wrench on = on_b(l, multipliers, work, held);
    const Vector3 at = moving(loops_[l], work).M.position;
    const auto apply = [&](const End& end, double sign) {
      if (end.frame < 0) return;
      const Vector3 arm = at - motions[end.frame].position;
      wrenches[static_cast<std::size_t>(end.frame)] = {sign * (on.moment + arm.cross(on.force)), sign * on.force};
    };
    apply(loops_[l].a, -1);
    apply(loops_[l].b, 1);
  }
}

void LoopPaths::add_efforts(std::span<const double> multipliers, std::span<double> efforts, std::byte* work,
                            Held held) const noexcept {
  const std::span<Wrench> all(sweep::at<Wrench>(work, wrenches_offset_), frames_.size());
  wrenches(multipliers, all, work, held);
  paths_.add_efforts(all, efforts, work + paths_offset_);
}

}  // namespace withy
