#include "withy/core/equations/configured_equations.hpp"

#include <algorithm>
#include <cstring>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/plugin/chosen_sensing.hpp"
#include "withy/core/plugin/forward_dynamics.hpp"
#include "withy/core/plugin/forwarding_equations.hpp"

namespace withy::equations {
namespace {

/// Holds a hinge at rest where it is.
class Hold final : public Motion {
 public:
  bool locks() const override { return true; }
  MotionPoint at(double /*t*/) const noexcept override { return {}; }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
};

/// Which configuration a state is in.
struct ConfigurationPlace {
  std::size_t element = 0;  ///< of State::y
  std::size_t count = 1;    ///< of configurations
  std::size_t operator()(std::span<const double> y) const noexcept {
    return std::min(static_cast<std::size_t>(std::max(y[element], 0.0)), count - 1);
  }
};

using AllEquations = std::vector<std::unique_ptr<EquationsOfMotion>>;

class ConfiguredEquations final : public ForwardingEquations,
                                  public ForwardDynamics,
                                  private LinearlyImplicit,
                                  private Linearization {
 public:
  ConfiguredEquations(AllEquations all, std::size_t element) : all_(std::move(all)), place_{element, all_.size()} {
    for (const auto& equations : all_) {
      forward_.push_back(dynamic_cast<const ForwardDynamics*>(equations.get()));
      work_size_ = std::max(work_size_, equations->make_work().size());
      if (const LinearlyImplicit* linear = equations->linearly_implicit())
        factors_size_ = std::max(factors_size_, linear->make_factors().size());
    }
  }

  // Behind the work of the equations stands the configuration that it was last used in.
  Work make_work() const override { return Work(work_size_ + sizeof(std::size_t)); }
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override {
    return note(y, work, work_size_).derivatives(t, y, y_dot, work);
  }
  Evaluation motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                            Work& work) const noexcept override {
    return note(y, work, work_size_).motion_efforts(t, y, efforts, work);
  }
  bool found_efforts(Work& work, std::span<double> loads, std::span<double> motions) const noexcept override {
    return noted(work, work_size_).found_efforts(work, loads, motions);
  }
  Evaluation forward_dynamics(std::span<const double> y, std::span<const double> efforts, std::span<double> u_dot,
                              Work& work) const noexcept override {
    return forward_[place_(y)]->forward_dynamics(y, efforts, u_dot, work);
  }
  const LinearlyImplicit* linearly_implicit() const override {
    return own().linearly_implicit() == nullptr ? nullptr : this;
  }
  const Linearization* linearization() const override { return own().linearization() == nullptr ? nullptr : this; }
  std::unique_ptr<SensedState> make_sensed_state(std::span<const SectionPlace> sections) const override {
    std::vector<std::unique_ptr<SensedState>> all;
    for (const auto& equations : all_) all.push_back(equations->make_sensed_state(sections));
    return std::make_unique<ChosenSensing>(std::move(all), [place = place_](const State& s) { return place(s.y); });
  }
  std::vector<std::string> savings() const override {
    std::vector<std::string> lines = own().savings();
    lines.push_back("events lock hinges in " + std::to_string(all_.size()) + " combinations, compiled each");
    return lines;
  }

 private:
  // What is seen of a state does not depend on what is locked.
  const EquationsOfMotion& own() const noexcept override { return *all_.front(); }
  const EquationsOfMotion& at(std::span<const double> y) const noexcept override { return *all_[place_(y)]; }
  /// The equations of a state, noted behind the memory that they are about to use.
  const EquationsOfMotion& note(std::span<const double> y, Work& work, std::size_t offset) const noexcept {
    const std::size_t index = place_(y);
    std::memcpy(work.data() + offset, &index, sizeof index);
    return *all_[index];
  }
  [[nodiscard]] const EquationsOfMotion& noted(Work& work, std::size_t offset) const noexcept {
    std::size_t index = 0;
    std::memcpy(&index, work.data() + offset, sizeof index);
    return *all_[std::min(index, all_.size() - 1)];
  }

  Work make_factors() const override { return Work(factors_size_ + sizeof(std::size_t)); }
  Evaluation factorize(std::span<const double> y, double delta, Work& factors) const noexcept override {
    return note(y, factors, factors_size_).linearly_implicit()->factorize(y, delta, factors);
  }
  void solve(std::span<double> r, Work& factors) const noexcept override {
    noted(factors, factors_size_).linearly_implicit()->solve(r, factors);
  }
  Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                  std::span<double> y_dot, Work& work) const noexcept override {
    return note(y, work, work_size_).linearly_implicit()->implicit_derivatives(t, y, base, delta, y_dot, work);
  }
  Evaluation jacobian(double t, std::span<const double> y, std::span<const double> y_dot,
                      std::span<double> jacobian) const override {
    return at(y).linearization()->jacobian(t, y, y_dot, jacobian);
  }
  std::vector<std::string> differenced(double t, std::span<const double> y) const override {
    return at(y).linearization()->differenced(t, y);
  }

  AllEquations all_;
  ConfigurationPlace place_;
  std::vector<const ForwardDynamics*> forward_;
  std::size_t work_size_ = 0, factors_size_ = 0;
};

}  // namespace

bool has_configurations(const Model& model) {
  const EventBook events(model);
  return events.any() && events.plan().configurations.size() > 1;
}

std::unique_ptr<EquationsOfMotion> make_configured(
    const Model& model,
    const std::function<std::unique_ptr<EquationsOfMotion>(std::shared_ptr<const Model>)>& compile) {
  // Integrators would not see the loops behind this face, and let them open.
  require_tree(model, "a model whose events lock or unlock hinges");
  const EventBook events(model);
  AllEquations all;
  for (const std::vector<std::size_t>& locked : events.plan().configurations) {
    auto configured = std::make_shared<Model>(model);
    for (const std::size_t hinge : locked) {
      if (model.driven(hinge)) continue;  // an analysis holds it already
      const std::string& name = model.hinges()[hinge].name;
      configured->add_motion(name, name, std::make_shared<const Hold>());
    }
    all.push_back(compile(std::move(configured)));
  }
  return std::make_unique<ConfiguredEquations>(std::move(all), events.place());
}

}  // namespace withy::equations
