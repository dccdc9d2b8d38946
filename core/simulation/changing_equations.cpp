#include "withy/core/simulation/changing_equations.hpp"

#include <algorithm>
#include <stdexcept>

#include "withy/core/plugin/chosen_sensing.hpp"
#include "withy/core/plugin/closed_loops.hpp"

namespace withy {

/// Of the rung that is in force when it is brought to a state.
class ChangingEquations::Seen final : public Observation {
 public:
  explicit Seen(const ChangingEquations& equations) : equations_(equations), rung_(equations.rung_) {
    for (const Rung& rung : equations.rungs_) seen_.push_back(rung.equations->make_observation());
  }
  void observe(std::span<const double> y) noexcept override {
    rung_ = equations_.rung_;
    seen_[rung_]->observe(y);
  }
  Energies energies() const noexcept override { return seen_[rung_]->energies(); }
  WorldPose frame_pose(int body, int frame) const noexcept override { return seen_[rung_]->frame_pose(body, frame); }
  WorldVelocity frame_velocity(int body, int frame) const noexcept override {
    return seen_[rung_]->frame_velocity(body, frame);
  }
  double turning(int body) const noexcept override { return seen_[rung_]->turning(body); }
  std::array<double, 3> deflection(int body, int frame) const noexcept override {
    return seen_[rung_]->deflection(body, frame);
  }

 private:
  const ChangingEquations& equations_;
  std::size_t rung_;
  std::vector<std::unique_ptr<Observation>> seen_;
};

void require_trees(const std::vector<Rung>& rungs) {
  for (const Rung& rung : rungs)
    if (dynamic_cast<const ClosedLoops*>(rung.equations) != nullptr)
      throw std::invalid_argument("formulations cannot change along a run whose loops are closed (constraints)");
}

ChangingEquations::ChangingEquations(const std::vector<Rung>& rungs, std::vector<Stretch> stretches)
    : rungs_(rungs), stretches_(std::move(stretches)), evaluations_(rungs.size()) {
  if (rungs_.empty() || stretches_.empty()) throw std::invalid_argument("no formulation to run in");
  require_trees(rungs_);
  go_over(stretches_.front().start);
}

void ChangingEquations::go_over(double time) {
  const auto later = std::upper_bound(stretches_.begin() + 1, stretches_.end(), time,
                                      [](double t, const Stretch& s) { return t < s.start; });
  rung_ = std::prev(later)->rung;
}

std::vector<double> ChangingEquations::hand_overs() const {
  std::vector<double> times;
  for (auto s = stretches_.begin() + 1; s != stretches_.end(); ++s) times.push_back(s->start);
  return times;
}

// What is in a Work between two calls does not matter: the largest serves all.
Work ChangingEquations::make_work() const {
  std::size_t bytes = 0;
  for (const Rung& rung : rungs_) bytes = std::max(bytes, rung.equations->make_work().size());
  return Work(bytes);
}

Work ChangingEquations::make_factors() const {
  std::size_t bytes = 0;
  for (const Rung& rung : rungs_)
    if (const LinearlyImplicit* linear = rung.equations->linearly_implicit(); linear != nullptr)
      bytes = std::max(bytes, linear->make_factors().size());
  return Work(bytes);
}

const LinearlyImplicit* ChangingEquations::linearly_implicit() const {
  const auto able = [&](const Stretch& s) { return rungs_[s.rung].equations->linearly_implicit() != nullptr; };
  return std::all_of(stretches_.begin(), stretches_.end(), able) ? this : nullptr;
}

const Linearization* ChangingEquations::linearization() const {
  const auto able = [&](const Stretch& s) { return rungs_[s.rung].equations->linearization() != nullptr; };
  return std::all_of(stretches_.begin(), stretches_.end(), able) ? this : nullptr;
}

std::unique_ptr<Observation> ChangingEquations::make_observation() const { return std::make_unique<Seen>(*this); }

std::unique_ptr<SensedState> ChangingEquations::make_sensed_state(std::span<const SectionPlace> sections) const {
  std::vector<std::unique_ptr<SensedState>> all;
  for (const Rung& rung : rungs_) all.push_back(rung.equations->make_sensed_state(sections));
  return std::make_unique<ChosenSensing>(std::move(all), [this](const State&) { return rung_; });
}

}  // namespace withy
