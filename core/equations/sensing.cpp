#include "withy/core/equations/sensing.hpp"

#include <algorithm>
#include <limits>

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/equations/sensed_reactions.hpp"
#include "withy/core/kinematics/sensed_steps.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/load_numbers.hpp"
#include "withy/core/plugin/sampled_part.hpp"
#include "withy/core/plugin/sensed_fields.hpp"

namespace withy::equations {
namespace {

using sensed::First;

/// What of a state has been found.
struct Found {
  bool motion = false, motion_efforts = false, energies = false, reactions = false;
};

/// Count of numbers that a load gives, of the load that gives most.
std::size_t most_given(const Model& model) {
  std::size_t most = 0;
  for (const LoadNode& node : model.loads())
    if (node.load->output() != nullptr) most = std::max(most, node.load->output()->outputs());
  return most;
}

/// Sensors come from plugins: what they ask for and no model has is no number.
Vector3 no_vector() { return Vector3::Constant(std::numeric_limits<double>::quiet_NaN()); }

bool is_index(int index, std::size_t count) { return index >= 0 && static_cast<std::size_t>(index) < count; }

const LoadNumbers* numbers_of(const LoadNode& node) { return dynamic_cast<const LoadNumbers*>(node.load.get()); }

/// How many numbers each load tells of itself.
std::vector<std::size_t> counts_of_numbers(const Model& model) {
  std::vector<std::size_t> counts;
  for (const LoadNode& node : model.loads())
    counts.push_back(numbers_of(node) == nullptr ? 0 : numbers_of(node)->numbers().size());
  return counts;
}

class Sensing final : public SensedState, public SensedLoops, public SensedLoads, public SensedFields {
 public:
  Sensing(std::unique_ptr<const sensed::Plan> plan, const EquationsOfMotion& equations, const AppliedLoads& loads)
      : plan_(std::move(plan)),
        equations_(equations),
        loops_(dynamic_cast<const ClosedLoops*>(&equations)),
        work_(equations.make_work()),
        seen_(equations.make_observation()),
        rates_(equations.size()),
        load_efforts_(layout().speeds),
        motion_efforts_(layout().speeds),
        load_scratch_(plan_->model.load_scratch() + most_given(plan_->model)),
        counts_(counts_of_numbers(plan_->model)),
        load_numbers_(counts_.empty() ? 0 : *std::max_element(counts_.begin(), counts_.end())),
        pass_(*plan_),
        multipliers_(loops_ != nullptr ? loops_->closing_equations() : 0),
        wrenches_(loops_ != nullptr ? loops_->frames().size() : 0),
        reactions_(*plan_, loads) {}

  bool observe(const State& state) noexcept override {
    state_ = &state;
    found_ = {};
    return equations_.derivatives(state.time, state.y, rates_, work_).ok();
  }
  const Layout& layout() const noexcept override { return equations_.layout(); }
  double time() const noexcept override { return state_->time; }
  std::span<const double> y() const noexcept override { return state_->y; }
  std::span<const double> accelerations() noexcept override {
    return std::span<const double>(rates_).subspan(layout().positions, layout().speeds);
  }
  Vector3 gravity() const noexcept override { return plan_->model.gravity(); }

  Vector3 field(FrameIndex frame) noexcept override {
    return plan_->fields.acceleration(state_->time, state_->y, motion(frame));
  }

  FrameMotion motion(FrameIndex frame) noexcept override {
    FrameMotion motion;
    if (frame.body == -1) return motion;
    if (!plan_->has(frame)) return {no_vector().replicate<1, 3>(), no_vector(), no_vector(), no_vector()};
    const sensed::StepOf<First> at = moving(frame);
    motion.R = at.X.R.unaryExpr(&value);
    motion.position = sensed::now(at.X.p);
    motion.angular_velocity = motion.R * sensed::now(at.V.w);
    motion.velocity = motion.R * sensed::now(at.V.v);
    return motion;
  }
  FrameAcceleration acceleration(FrameIndex frame) noexcept override {
    if (frame.body == -1) return {};
    if (!plan_->has(frame)) return {no_vector(), no_vector()};
    const sensed::StepOf<First> at = moving(frame);
    const Matrix3 R = at.X.R.unaryExpr(&value);
    const Vector3 w = sensed::now(at.V.w), v = sensed::now(at.V.v);
    return {R * sensed::rate(at.V.w), R * (sensed::rate(at.V.v) + w.cross(v))};
  }

  std::span<const double> load_efforts(int load) noexcept override {
    if (load != EquationsOfMotion::all_loads && !is_index(load, plan_->model.loads().size()))
      std::fill(load_efforts_.begin(), load_efforts_.end(), no_vector().x());
    else
      equations_.load_efforts(state_->time, state_->y, load, load_efforts_, work_);
    return load_efforts_;
  }
  std::span<const double> motion_efforts() noexcept override {
    if (!found_.motion_efforts) equations_.motion_efforts(state_->time, state_->y, motion_efforts_, work_);
    found_.motion_efforts = true;
    return motion_efforts_;
  }
  Wrench reaction(int hinge) noexcept override {
    if (!is_index(hinge, plan_->bodies.size())) return {no_vector(), no_vector()};
    find_reactions();
    return reactions_.of_hinge(static_cast<std::size_t>(hinge));
  }
  Wrench closing_reaction(std::size_t loop) noexcept override {
    if (loops_ == nullptr) return {};
    find_multipliers();
    return loops_->reaction(loop, multipliers_, work_);
  }
  SectionLoad section(std::size_t index) noexcept override {
    if (index >= plan_->cuts.size()) return {{no_vector(), no_vector()}, no_vector(), no_vector()};
    find_reactions();
    const sensed::CutPlan& cut = plan_->cuts[index];
    const sensed::BodyPlan& body = plan_->bodies[cut.body];
    SectionLoad load{.inner = reactions_.of_section(index)};
    for (Eigen::Index i = 0; i < body.modes; ++i)
      load.curvature += cut.curvature.col(i) * state_->y[body.modal.position + static_cast<std::size_t>(i)];
    load.elastic = Vector3::Zero() - cut.stiffness * load.curvature;  // no −0
    return load;
  }
  double given(std::size_t load, std::size_t number, std::span<const double> y) noexcept override {
    const LoadNode& node = plan_->model.loads()[load];
    const std::span<double> scratch(load_scratch_);
    const std::size_t count = node.load->output()->outputs();
    LoadView view = node.view(state_->time, y, layout(), scratch.subspan(count));
    view.accelerations = accelerations();
    node.load->output()->read(view, scratch.first(count));
    return scratch[number];
  }
  std::span<const double> numbers(std::size_t load) noexcept override {
    const LoadNode& node = plan_->model.loads()[load];
    const std::span<double> own = std::span(load_numbers_).first(counts_[load]);
    LoadView view = node.view(state_->time, y(), layout(), load_scratch_);
    view.accelerations = accelerations();
    if (const LoadNumbers* told = numbers_of(node)) told->show(view, own);
    return own;
  }
  BodyEnergies energies(int index) noexcept override {
    if (!is_index(index, plan_->bodies.size())) {
      const double none = no_vector().x();
      return {none, none, none, no_vector(), no_vector()};
    }
    find_motion();
    const auto b = static_cast<std::size_t>(index);
    const sensed::BodyPlan& body = plan_->bodies[b];
    const sensed::BodyMotionOf<First>& B = pass_.bodies[b];
    const sensed::MomentumOf<First> own = sensed::own_momentum(pass_, b, body, body);
    const sensed::MassMoment<First> mass = sensed::mass_moment(pass_, body, body);
    const Matrix3 R = B.WB.R.unaryExpr(&value);
    const Vector3 p = sensed::now(B.WB.p), h = sensed::now(own.h.v);
    BodyEnergies e;
    e.kinetic = 0.5 * (value(B.V.w.dot(own.h.w)) + value(B.V.v.dot(own.h.v)) + value(own.along));
    if (const Slot* slot = layout().modes(b)) {
      const Eigen::Map<const Eigen::VectorXd> q(state_->y.data() + slot->position, body.modes);
      const Eigen::MatrixXd& K = plan_->model.bodies()[b].body->shape().stiffness;
      for (Eigen::Index i = 0; i < body.modes; ++i) e.strain += 0.5 * q[i] * K.col(i).dot(q);
    }
    e.weight = -gravity().dot(mass.mass * p + R * sensed::now(mass.moment));
    e.linear = R * h;
    e.angular = R * sensed::now(own.h.w) + p.cross(e.linear);
    return e;
  }
  const Energies& energies() noexcept override {
    if (!found_.energies) {
      seen_->observe(state_->y);
      energies_ = seen_->energies();
    }
    found_.energies = true;
    return energies_;
  }

 private:
  static double value(const First& x) { return x.value(); }

  void find_reactions() noexcept {
    if (found_.reactions) return;
    reactions_.observe(*state_, accelerations());
    if (loops_ != nullptr) {
      find_multipliers();
      loops_->wrenches(multipliers_, wrenches_, work_);
      reactions_.add(*state_, loops_->frames(), wrenches_);
    }
    found_.reactions = true;
  }
  void find_multipliers() noexcept { loops_->multipliers(state_->time, state_->y, multipliers_, work_); }

  void find_motion() noexcept {
    if (found_.motion) return;
    sensed::set_pass(pass_, *plan_, state_->y, accelerations(), {}, &sensed::moving_mode);
    pass_.outward();
    found_.motion = true;
  }
  /// Pose in the world and twist of a frame.
  sensed::StepOf<First> moving(FrameIndex frame) noexcept {
    find_motion();
    const auto body = static_cast<std::size_t>(frame.body);
    sensed::StepOf<First> step = pass_.frame(body, plan_->bodies[body].frame(frame.frame));
    step.X = pass_.bodies[body].WB * step.X;
    return step;
  }

  std::unique_ptr<const sensed::Plan> plan_;
  const EquationsOfMotion& equations_;
  const ClosedLoops* loops_;  ///< null: the equations are a tree's
  Work work_;
  std::unique_ptr<Observation> seen_;
  const State* state_ = nullptr;
  Found found_;
  std::vector<double> rates_, load_efforts_, motion_efforts_, load_scratch_;
  std::vector<std::size_t> counts_;  ///< of the numbers that each load tells of itself
  std::vector<double> load_numbers_;
  Energies energies_;
  sensed::Pass<First> pass_;
  std::vector<double> multipliers_;
  std::vector<Wrench> wrenches_;  ///< of loops
  SensedReactions reactions_;
};

}  // namespace

std::unique_ptr<SensedState> make_sensing(std::unique_ptr<const sensed::Plan> plan, const EquationsOfMotion& equations,
                                          const AppliedLoads& loads) {
  return std::make_unique<Sensing>(std::move(plan), equations, loads);
}

}  // namespace withy::equations
