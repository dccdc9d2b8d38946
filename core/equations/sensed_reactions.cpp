#include "withy/core/equations/sensed_reactions.hpp"

#include <algorithm>

#include "withy/core/kinematics/sensed_steps.hpp"
#include "withy/core/model/closing.hpp"

namespace withy::equations {

namespace {

/// BodyPlan::frame has indices of frames below their count as they are, those of mass points among them.
FrameIndex at_point(const sensed::CutPlan& cut, std::size_t k) {
  return {static_cast<int>(cut.body), static_cast<int>(cut.first_point + k)};
}

}  // namespace

using sensed::First;
using sensed::Mode;
using sensed::Second;

SensedReactions::SensedReactions(const sensed::Plan& plan, const AppliedLoads& loads)
    : plan_(plan),
      loads_(loads),
      work_(loads.work_size()),
      reactions_(plan.bodies.size()),
      sections_(plan.cuts.size()),
      no_accelerations_(plan.model.layout().speeds) {
  const bool first_order = plan.truncation == Truncation::strict || plan.truncation == Truncation::symmetric;
  if (first_order) {
    second_.emplace(plan);
  } else {
    first_.emplace(plan);
  }
  if (plan.truncation == Truncation::strict) {
    applied_first_.emplace(plan);
  } else if (plan.truncation == Truncation::symmetric) {
    applied_second_.emplace(plan);
  } else {
    plain_.emplace(plan);
  }
  if (!loops_of(plan.model).empty()) untruncated_.emplace(plan);
  for (const sensed::CutPlan& cut : plan.cuts) on_parts_.resize(on_parts_.size() + cut.mass.size());
  if (!on_parts_.empty()) shown_.emplace(plan);
}

void SensedReactions::observe(const State& state, std::span<const double> accelerations) noexcept {
  std::fill(reactions_.begin(), reactions_.end(), Wrench{});
  std::fill(sections_.begin(), sections_.end(), Wrench{});
  if (first_) find_inertia(*first_, state, accelerations);
  if (second_) find_inertia(*second_, state, accelerations);
  if (shown_) find_on_parts(state);
  if (plain_) find_applied(*plain_, state);
  if (applied_first_) find_applied(*applied_first_, state);
  if (applied_second_) find_applied(*applied_second_, state);
}

template <class S>
void SensedReactions::find_inertia(Part<S>& part, const State& state, std::span<const double> accelerations) noexcept {
  const bool strict = plan_.truncation == Truncation::strict;
  const sensed::Kept kept{.ruthless = false, .speeds = plan_.products_of_speeds};
  sensed::set_pass(part.pass, plan_, state.y, accelerations, kept, [&](double q, double q_dot, double q_ddot) {
    if constexpr (std::is_same_v<S, First>) {
      return sensed::moving_mode(q, q_dot, q_ddot);
    } else {
      return strict ? sensed::strict_mode(q, q_dot, q_ddot) : sensed::symmetric_mode(q, q_dot, q_ddot);
    }
  });
  part.pass.outward();
  for (std::size_t b = 0; b < plan_.bodies.size(); ++b)
    part.total[b] = sensed::own_momentum(part.pass, b, plan_.bodies[b], plan_.bodies[b]).h;
  sensed::gather(part.pass, plan_, part.total);
  for (std::size_t b = 0; b < plan_.bodies.size(); ++b) {
    const sensed::BodyMotionOf<S>& body = part.pass.bodies[b];
    const sensed::TwistOf<double> f = sensed::driving(body.BM.from_parent(part.total[b]), body.V_M);
    Matrix3 R;
    for (Eigen::Index i = 0; i < R.size(); ++i) R(i) = sensed::number(part.pass.hinges[b].X.R(i));
    reactions_[b].moment += R * f.w;
    reactions_[b].force += R * f.v;
  }
  for (std::size_t c = 0; c < plan_.cuts.size(); ++c) {
    const sensed::CutPlan& cut = plan_.cuts[c];
    const sensed::StepOf<S>& section = part.pass.section(cut.body, cut.section);
    const sensed::TwistOf<S> h =
        at_cut(part, cut, sensed::own_momentum(part.pass, cut.body, plan_.bodies[cut.body], cut).h);
    const sensed::TwistOf<double> f = sensed::driving(h, section.X.to_child(part.pass.bodies[cut.body].V) + section.V);
    sections_[c].moment += f.w;
    sections_[c].force += f.v;
  }
}

template <class S>
void SensedReactions::find_applied(Part<S>& part, const State& state) noexcept {
  const sensed::Kept kept{.ruthless = false, .speeds = false};
  sensed::set_pass(part.pass, plan_, state.y, no_accelerations_, kept, [](double q, double, double) {
    const S value = frame_pass::elastic<S>(q);
    return Mode<S>{value, S(0.0)};
  });
  part.pass.outward();
  take_off(part, loads_.frames(), loads_.wrenches(state.time, state.y, work_.data()), true);
}

/// Frames are shown to loads without truncation, but that ruthless bodies are undeformed.
void SensedReactions::find_on_parts(const State& state) noexcept {
  const sensed::Kept kept{.ruthless = false, .speeds = true};
  sensed::set_pass(shown_->pass, plan_, state.y, no_accelerations_, kept, [](double q, double q_dot, double) {
    return Mode<double>{q, q_dot};
  });
  shown_->pass.outward();
  auto wrench = on_parts_.begin();
  for (const sensed::CutPlan& cut : plan_.cuts) {
    const sensed::PoseOf<double>& WB = shown_->pass.bodies[cut.body].WB;
    for (std::size_t k = 0; k < cut.mass.size(); ++k, ++wrench) {
      const sensed::StepOf<double> at = shown_->pass.frame(cut.body, cut.first_point + k);
      const Matrix3 R = WB.R * at.X.R;
      const FrameMotion motion{R, WB.p + WB.R * at.X.p, R * at.V.w, R * at.V.v};
      *wrench = plan_.fields.wrench(state.time, state.y, cut.mass[k], motion);
    }
  }
}

void SensedReactions::add(const State& state, std::span<const FrameIndex> frames,
                          std::span<const Wrench> wrenches) noexcept {
  const sensed::Kept kept{.ruthless = true, .speeds = false};
  sensed::set_pass(untruncated_->pass, plan_, state.y, no_accelerations_, kept, [](double q, double, double) {
    return Mode<double>{q, 0};
  });
  untruncated_->pass.outward();
  take_off(*untruncated_, frames, wrenches, false);
}

template <class S>
void SensedReactions::take_off(Part<S>& part, std::span<const FrameIndex> frames, std::span<const Wrench> wrenches,
                               bool weight) noexcept {
  for (std::size_t b = 0; b < plan_.bodies.size(); ++b) {
    part.total[b] = {};
    if (weight) part.total[b] = sensed::weight(part.pass, b, plan_, plan_.bodies[b]);
  }
  for (std::size_t i = 0; i < wrenches.size(); ++i)
    part.total[static_cast<std::size_t>(frames[i].body)] += sensed::on_body(part.pass, plan_, frames[i], wrenches[i]);
  sensed::gather(part.pass, plan_, part.total);
  for (std::size_t b = 0; b < plan_.bodies.size(); ++b) {
    const sensed::TwistOf<S> f = part.pass.bodies[b].BM.from_parent(part.total[b]);
    Matrix3 R;
    for (Eigen::Index i = 0; i < R.size(); ++i) R(i) = sensed::number(part.pass.hinges[b].X.R(i));
    reactions_[b].moment -= R * sensed::on_hinge(f.w);
    reactions_[b].force -= R * sensed::on_hinge(f.v);
  }
  auto on_part = on_parts_.begin();
  for (std::size_t c = 0; c < plan_.cuts.size(); ++c) {
    const sensed::CutPlan& cut = plan_.cuts[c];
    sensed::TwistOf<S> own;
    if (weight) own = sensed::weight(part.pass, cut.body, plan_, cut);
    for (std::size_t k = 0; weight && k < cut.mass.size(); ++k, ++on_part)
      own += sensed::on_body(part.pass, plan_, at_point(cut, k), *on_part);
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      const FrameIndex& at = frames[i];
      if (static_cast<std::size_t>(at.body) != cut.body) continue;
      const double share = cut.frames[plan_.bodies[cut.body].frame(at.frame)];
      if (share == 0) continue;
      const Wrench beyond{share * wrenches[i].moment, share * wrenches[i].force};
      own += sensed::on_body(part.pass, plan_, at, beyond);
    }
    const sensed::TwistOf<S> f = at_cut(part, cut, own);
    sections_[c].moment -= sensed::on_hinge(f.w);
    sections_[c].force -= sensed::on_hinge(f.v);
  }
}

template <class S>
sensed::TwistOf<S> SensedReactions::at_cut(const Part<S>& part, const sensed::CutPlan& cut,
                                           sensed::TwistOf<S> own) const noexcept {
  for (const std::size_t h : cut.hinges) {
    const sensed::BodyMotionOf<S>& child = part.pass.bodies[h];
    own += child.PM.to_parent(child.BM.from_parent(part.total[h]));
  }
  // Where the body's own hinge holds the part beyond, the other part is free: it bears what is inside alone.
  if (cut.inboard) own = own - part.total[cut.body];
  return part.pass.section(cut.body, cut.section).X.from_parent(own);
}

}  // namespace withy::equations
