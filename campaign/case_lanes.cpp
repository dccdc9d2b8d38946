#include "withy/campaign/case_lanes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <memory>
#include <utility>
#include <vector>

#include "withy/campaign/asking_equations.hpp"
#include "withy/campaign/stacks.hpp"
#include "withy/core/equations/lane_equations.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/simulation/run_times.hpp"

namespace withy::campaign {
namespace {

/// What a lane asks of those who evaluate.
class Asked {
 public:
  virtual ~Asked() = default;
  /// Comes back when the lane's call has been answered.
  virtual void answer(std::size_t lane) noexcept = 0;
};

/// A case in a lane, with equations that leave its stack for each evaluation.
class Lane final : public AskingEquations, public StagedSteps {
 public:
  /// \param energies whether those of observations can be asked for
  Lane(std::unique_ptr<CaseRun> run, const study::Control& control, std::size_t lane, bool energies, Asked& asked)
      : AskingEquations(*run->equations()),
        run_(std::move(run)),
        control_(control),
        lane_(lane),
        energies_(energies),
        asked_(asked) {}

  /// To the end.
  void run() noexcept {
    try {
      run_->run(*this, control_);
    } catch (...) {
      error_ = std::current_exception();
    }
  }
  /// From now on it is told that it cannot go on.
  void abandon() { abandoned_ = true; }
  /// What it has asked for, one of the three: an evaluation, energies, or a whole step.
  [[nodiscard]] LaneCall* call() { return asks_ == Asks::evaluation ? &call_ : nullptr; }
  [[nodiscard]] LaneEnergy* energy() { return asks_ == Asks::energies ? &energy_ : nullptr; }
  [[nodiscard]] LaneStep* step() { return asks_ == Asks::step ? &step_ : nullptr; }
  /// Of a run that has ended. \throws what the run has thrown.
  CaseResult& result() {
    if (error_) std::rethrow_exception(error_);
    run_->result().seconds = seconds;
    return run_->result();
  }
  double seconds = 0;    ///< its share of the thread's CPU time
  bool waiting = false;  ///< for an answer

  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override {
    if (!abandoned_) {
      call_ = {t, y, y_dot, &work, {}};
      asks_ = Asks::evaluation;
      asked_.answer(lane_);
    }
    return abandoned_ ? Evaluation{Evaluation::Outcome::nonfinite} : call_.evaluation;
  }
  Outcome stages(const Step& step) const noexcept override {
    if (!abandoned_) {
      step_.step = &step;
      asks_ = Asks::step;
      asked_.answer(lane_);
    }
    return abandoned_ ? Outcome{{Evaluation::Outcome::nonfinite}, 0} : step_.outcome;
  }
  /// Of a run that is abandoned they do not matter.
  [[nodiscard]] Energies ask_energies(std::span<const double> y) const noexcept {
    if (!abandoned_) {
      energy_.y = y;
      asks_ = Asks::energies;
      asked_.answer(lane_);
    }
    return energy_.energies;
  }
  [[nodiscard]] std::unique_ptr<Observation> make_observation() const override {
    std::unique_ptr<Observation> own = AskingEquations::make_observation();
    if (!energies_) return own;
    return std::make_unique<SeenInLanes>(*this, std::move(own), size());
  }

 private:
  /// The case's own observation, but that energies are asked for.
  class SeenInLanes final : public Observation {
   public:
    SeenInLanes(const Lane& lane, std::unique_ptr<Observation> own, std::size_t size)
        : lane_(lane), own_(std::move(own)), y_(size) {}
    void observe(std::span<const double> y) noexcept override {
      std::copy(y.begin(), y.end(), y_.begin());
      behind_ = true;
    }
    [[nodiscard]] Energies energies() const noexcept override { return lane_.ask_energies(y_); }
    [[nodiscard]] WorldPose frame_pose(int body, int frame) const noexcept override {
      return own().frame_pose(body, frame);
    }
    [[nodiscard]] WorldVelocity frame_velocity(int body, int frame) const noexcept override {
      return own().frame_velocity(body, frame);
    }
    [[nodiscard]] double turning(int body) const noexcept override { return own().turning(body); }
    [[nodiscard]] std::array<double, 3> deflection(int body, int frame) const noexcept override {
      return own().deflection(body, frame);
    }
    [[nodiscard]] bool expands(int body) const noexcept override { return own_->expands(body); }

   private:
    [[nodiscard]] const Observation& own() const noexcept {
      if (std::exchange(behind_, false)) own_->observe(y_);
      return *own_;
    }
    const Lane& lane_;
    std::unique_ptr<Observation> own_;
    std::vector<double> y_;
    mutable bool behind_ = true;  ///< its own is to go to the state
  };
  enum class Asks { evaluation, energies, step };

  std::unique_ptr<CaseRun> run_;
  const study::Control& control_;
  std::size_t lane_;
  bool energies_;
  Asked& asked_;
  std::exception_ptr error_;
  bool abandoned_ = false;
  mutable LaneCall call_;
  mutable LaneEnergy energy_;
  mutable LaneStep step_;
  mutable Asks asks_ = Asks::evaluation;
};

class CaseLanes final : public Asked {
 public:
  CaseLanes(const Plan& plan, const Cases& cases, Registry& registry, const study::Control& control,
            const CaseFlow& flow)
      : plan_(plan), cases_(cases), registry_(registry), control_(control), flow_(flow), parts_(plan) {}
  CaseLanes(const CaseLanes&) = delete;
  CaseLanes& operator=(const CaseLanes&) = delete;
  /// Runs that have not ended are told to end: a stack must be left in the way it was entered.
  ~CaseLanes() override {
    filling_ = true;
    for (std::size_t i = 0; i < count_; ++i) {
      if (lanes_[i] == nullptr) continue;
      lanes_[i]->abandon();
      if (!stacks_.ended(i)) stacks_.go_to(Stacks::thread, i);
    }
  }

  void run() {
    while (true) {
      while (more_ && waiting_ == nullptr && free_lane() < count_) take();
      if (none_at_work()) {
        if (waiting_ == nullptr) return;
        together_ = lane_equations(*waiting_->equations());
        begin(0, std::move(waiting_));
        continue;
      }
      go_on();
    }
  }

  /// The lane that asks last evaluates for all; the others leave the thread to one that has its answer, or to the
  /// thread's own stack while lanes are filled.
  void answer(std::size_t lane) noexcept override {
    Lane& asking = *lanes_[lane];
    if (LaneStep* const step = asking.step(); step != nullptr && together_->made_ahead(lane, *step)) return;
    if (LaneEnergy* const energy = asking.energy(); energy != nullptr && together_->made_ahead(lane, *energy)) return;
    asking.waiting = true;
    if (filling_) return stacks_.go_to(lane, Stacks::thread);
    while (asking.waiting) {
      if (const std::size_t next = not_waiting(); next < count_) return stacks_.go_to(lane, next);
      evaluate();
    }
  }

 private:
  [[nodiscard]] std::size_t free_lane() const {
    std::size_t i = 0;
    while (i < count_ && lanes_[i] != nullptr) ++i;
    return i;
  }
  [[nodiscard]] bool none_at_work() const {
    return std::all_of(lanes_.begin(), lanes_.end(), [](const auto& lane) { return lane == nullptr; });
  }

  /// One more case, into a lane, or run by itself; one that does not fit waits until all lanes are free.
  void take() {
    const std::optional<std::uint64_t> index = flow_.next();
    if (!index || control_.stop()) {
      more_ = false;
      return;
    }
    share_time();
    const double began = shared_;
    auto run = std::make_unique<CaseRun>(plan_, cases_, *index, registry_, parts_);
    if (run->equations() != nullptr) {
      const std::string why = run->alone_because();
      if (why.empty()) {
        if (together_ != nullptr && together_->fits(*run->equations())) {
          begin(free_lane(), std::move(run));
        } else {
          waiting_ = std::move(run);
        }
        return;
      }
      if (flow_.alone) flow_.alone(why);
      run->run(*run->equations(), control_);
    }
    run->result().seconds = thread_cpu_seconds() - began;
    finish(run->result());
    shared_ = thread_cpu_seconds();
  }

  void begin(std::size_t lane, std::unique_ptr<CaseRun> run) {
    together_->put(lane, *run->equations());
    lanes_[lane] = std::make_unique<Lane>(std::move(run), control_, lane, together_->has_energies(), *this);
    stacks_.begin(lane, [this, lane] { lanes_[lane]->run(); });
    stacks_.go_to(Stacks::thread, lane);
    if (stacks_.ended(lane)) end(lane);
  }

  /// Until a case has ended.
  void go_on() {
    std::size_t lane = not_waiting();
    if (lane == count_) {
      evaluate();
      lane = not_waiting();
    }
    filling_ = false;
    stacks_.go_to(Stacks::thread, lane);
    filling_ = true;
    for (std::size_t i = 0; i < count_; ++i)
      if (lanes_[i] != nullptr && stacks_.ended(i)) end(i);
  }

  /// A lane whose call has been answered.
  [[nodiscard]] std::size_t not_waiting() const {
    std::size_t i = 0;
    while (i < count_ && (lanes_[i] == nullptr || lanes_[i]->waiting)) ++i;
    return i;
  }

  /// What the lanes ask of one kind; null: a lane does not.
  template <class Call>
  using Calls = std::array<Call*, most_lanes>;
  /// Answers those, and says whether there were any.
  template <class Call>
  bool answer_all(const Calls<Call>& calls, void (LaneEquations::*by)(std::span<Call* const>) noexcept) noexcept {
    bool any = false;
    for (std::size_t i = 0; i < count_; ++i) {
      if (calls[i] == nullptr) continue;
      any = true;
      lanes_[i]->waiting = false;
    }
    if (any) (*together_.*by)(std::span(calls).first(count_));
    return any;
  }

  /// Answers the lanes that have asked for an evaluation, or else for energies; where all ask for steps, those of one
  /// method.
  void evaluate() noexcept {
    Calls<LaneCall> calls{};
    Calls<LaneEnergy> energies{};
    Calls<LaneStep> steps{};
    const StageTable* table = nullptr;
    for (std::size_t i = 0; i < count_; ++i) {
      if (lanes_[i] == nullptr) continue;
      calls[i] = lanes_[i]->call();
      energies[i] = lanes_[i]->energy();
      LaneStep* const step = lanes_[i]->step();
      if (step == nullptr) continue;
      if (table == nullptr) table = step->step->table;
      if (step->step->table == table) steps[i] = step;
    }
    if (answer_all(calls, &LaneEquations::derivatives)) return;
    if (answer_all(energies, &LaneEquations::energies)) return;
    answer_all(steps, &LaneEquations::steps);
  }

  void end(std::size_t lane) {
    share_time();
    const std::unique_ptr<Lane> ended = std::move(lanes_[lane]);
    finish(ended->result());
  }

  void finish(const CaseResult& result) {
    if (result.status == name(RunStatus::interrupted)) {
      more_ = false;
    } else {
      flow_.done(result);
    }
  }

  /// CPU time since the last call belongs to those at work, in equal parts.
  void share_time() {
    const double now = thread_cpu_seconds();
    const auto at_work = lanes_.size() - static_cast<std::size_t>(std::count(lanes_.begin(), lanes_.end(), nullptr));
    for (const auto& lane : lanes_)
      if (lane != nullptr) lane->seconds += (now - shared_) / static_cast<double>(at_work);
    shared_ = now;
  }

  const Plan& plan_;
  const Cases& cases_;
  Registry& registry_;
  const study::Control& control_;
  const CaseFlow& flow_;
  CaseParts parts_;
  std::unique_ptr<LaneEquations> together_;
  std::unique_ptr<CaseRun> waiting_;  ///< for all lanes to be free
  std::size_t count_ = lane_count();  ///< of the lanes, which are the first of these
  std::array<std::unique_ptr<Lane>, most_lanes> lanes_;
  Stacks stacks_;
  bool filling_ = true;  ///< the thread's own stack puts cases into lanes
  bool more_ = true;
  double shared_ = thread_cpu_seconds();
};

}  // namespace

void run_cases(const Plan& plan, const Cases& cases, Registry& registry, const study::Control& control,
               const CaseFlow& flow) {
  CaseLanes(plan, cases, registry, control, flow).run();
}

CaseResult run_case(const Plan& plan, const Cases& cases, std::uint64_t index, Registry& registry,
                    const study::Control& control) {
  std::optional<std::uint64_t> one = index;
  CaseResult result;
  result.status = name(RunStatus::interrupted);
  result.index = index;
  result.values = cases.values(index);
  run_cases(plan, cases, registry, control,
            {[&] { return std::exchange(one, std::nullopt); }, [&](const CaseResult& r) { result = r; }, {}});
  return result;
}

}  // namespace withy::campaign
