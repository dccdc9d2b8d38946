#include "withy/core/model/switched_load.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/digital_part.hpp"
#include "withy/core/plugin/effortless_load.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/plugin/kinks.hpp"
#include "withy/core/plugin/load_numbers.hpp"
#include "withy/core/plugin/sampled_part.hpp"

namespace withy {
namespace {

using Forms = std::vector<std::shared_ptr<const BoundLoad>>;

std::size_t discrete_states(const BoundLoad& load) {
  return load.discrete() == nullptr ? 0 : load.discrete()->states();
}
std::size_t continuous_states(const BoundLoad& load) {
  return load.continuous() == nullptr ? 0 : load.continuous()->states();
}

const SampledPart* sampled_part(const BoundLoad& load) { return dynamic_cast<const SampledPart*>(load.discrete()); }

const DigitalPart* digital_part(const BoundLoad& load) { return dynamic_cast<const DigitalPart*>(load.discrete()); }

/// What of the forms changes at instants, and which of them acts.
class SwitchedDiscrete final : public DiscretePart, public SampledPart, public DigitalPart {
 public:
  explicit SwitchedDiscrete(const Forms& forms) : forms_(forms), own_(discrete_states(*forms.front())) {
    for (const auto& form : forms)
      if (const SampledPart* part = sampled_part(*form)) measured_.push_back(part->measures().size());
  }
  /// The form that acts; null where the load is off.
  [[nodiscard]] const BoundLoad* acting(std::span<const double> discrete) const noexcept {
    const double form = discrete[own_];
    return form < 0 ? nullptr : forms_[std::min(static_cast<std::size_t>(form), forms_.size() - 1)].get();
  }
  template <class T>
  [[nodiscard]] std::span<T> own(std::span<T> discrete) const noexcept {
    return discrete.first(own_);
  }
  [[nodiscard]] LoadView inner(const LoadView& v) const noexcept {
    return {v.t, v.layout, v.y, own(v.discrete), v.continuous, v.scratch, v.accelerations};
  }

  std::size_t states() const override { return own_ + 1; }
  double period() const override {
    const DiscretePart* part = forms_.front()->discrete();
    return part == nullptr ? 0 : part->period();
  }
  std::size_t switches() const override {
    const DiscretePart* part = forms_.front()->discrete();
    return part == nullptr ? 0 : part->switches();
  }
  void switching(double t, std::span<const double> positions, std::span<const double> speeds,
                 std::span<const double> discrete, std::span<double> values) const noexcept override {
    if (const BoundLoad* load = acting(discrete)) {
      load->discrete()->switching(t, positions, speeds, own(discrete), values);
    } else {
      std::fill(values.begin(), values.end(), 1.0);
    }
  }
  void renew(double t, std::span<const double> positions, std::span<const double> speeds, const Crossing& crossing,
             std::span<double> discrete, std::span<double> scratch) const noexcept override {
    const BoundLoad* load = acting(discrete);
    if (load != nullptr && own_ > 0) load->discrete()->renew(t, positions, speeds, crossing, own(discrete), scratch);
  }
  std::vector<std::string> measures() const override {
    std::vector<std::string> all;
    for (const auto& form : forms_)
      if (const SampledPart* part = sampled_part(*form))
        for (const std::string& name : part->measures()) all.push_back(name);
    return all;
  }
  void pass_idle(std::span<double> discrete) const noexcept override {
    if (const DigitalPart* part = digital_part(*forms_.front())) part->pass_idle(own(discrete));
  }
  bool waits(std::span<const double> discrete) const override {
    const BoundLoad* load = acting(discrete);
    const DigitalPart* part = load == nullptr ? nullptr : digital_part(*load);
    return part != nullptr && part->waits(own(discrete));
  }
  bool gives_steps() const override {
    const DigitalPart* part = digital_part(*forms_.front());
    return part != nullptr && part->gives_steps();
  }
  bool draws() const override {
    const DigitalPart* part = digital_part(*forms_.front());
    return part != nullptr && part->draws();
  }
  std::size_t told() const override {
    const DigitalPart* part = digital_part(*forms_.front());
    return part == nullptr ? 0 : part->told();
  }
  void renew_measured(double t, const Crossing& crossing, std::span<const double> measured,
                      std::span<double> discrete) const noexcept override {
    const BoundLoad* load = acting(discrete);
    if (load == nullptr) pass_idle(discrete);
    std::size_t first = 0;
    for (std::size_t f = 0; f < measured_.size(); ++f) {
      if (forms_[f].get() == load)
        sampled_part(*load)->renew_measured(t, crossing, measured.subspan(first, measured_[f]), own(discrete));
      first += measured_[f];
    }
  }
  void add(double t, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    const BoundLoad* load = acting(discrete);
    if (load != nullptr && own_ > 0) load->discrete()->add(t, own(discrete), efforts);
  }

 private:
  const Forms& forms_;
  std::size_t own_;                    ///< count of the forms' discrete states
  std::vector<std::size_t> measured_;  ///< one a form, where they are sampled: how many numbers it measures
};

/// All that the acting form gives from the whole state.
class SwitchedContinuous final : public ContinuousPart {
 public:
  SwitchedContinuous(const Forms& forms, const SwitchedDiscrete& discrete)
      : discrete_(discrete), first_(*forms.front()), states_(continuous_states(first_)) {}
  std::size_t states() const override { return states_; }
  std::string name(std::size_t state) const override { return first_.continuous()->name(state); }
  void begin(const LoadView& view, std::span<double> continuous) const noexcept override {
    const BoundLoad* load = discrete_.acting(view.discrete);
    if (states_ > 0) (load != nullptr ? *load : first_).continuous()->begin(discrete_.inner(view), continuous);
  }
  void rates(const LoadView& view, std::span<double> rates) const noexcept override {
    const BoundLoad* load = discrete_.acting(view.discrete);
    if (load != nullptr && states_ > 0) {
      load->continuous()->rates(discrete_.inner(view), rates);
    } else {
      std::fill(rates.begin(), rates.end(), 0.0);
    }
  }
  void add(const LoadView& view, std::span<double> efforts) const noexcept override {
    const BoundLoad* load = discrete_.acting(view.discrete);
    if (load == nullptr) return;
    load->add(view.t, view.positions(), view.speeds(), efforts, view.scratch.first(load->scratch()));
    if (load->continuous() != nullptr) load->continuous()->add(discrete_.inner(view), efforts);
  }
  void add_wrenches(const LoadView& view, std::span<const FrameMotion> motions,
                    std::span<Wrench> wrenches) const noexcept override {
    const BoundLoad* load = discrete_.acting(view.discrete);
    if (load == nullptr) return;
    load->wrenches(view.t, motions, wrenches);
    const LoadView inner = discrete_.inner(view);
    if (!inner.discrete.empty()) load->discrete()->add_wrenches(view.t, inner.discrete, motions, wrenches);
    if (load->continuous() != nullptr) load->continuous()->add_wrenches(inner, motions, wrenches);
  }
  bool add_derivatives(const LoadView& view, ContinuousDerivatives& to) const override {
    const BoundLoad* load = discrete_.acting(view.discrete);
    if (load == nullptr) return true;
    // Of two parts one may have derivatives and the other none: then neither may be added.
    if (load->continuous() != nullptr) return false;
    return load->add_derivatives(view.t, view.positions(), view.speeds(), to.effort_by_position, to.effort_by_speed);
  }

 private:
  const SwitchedDiscrete& discrete_;
  const BoundLoad& first_;
  std::size_t states_;
};

class SwitchedOutput final : public LoadOutput {
 public:
  SwitchedOutput(const Forms& forms, const SwitchedDiscrete& discrete)
      : discrete_(discrete),
        first_(*forms.front()),
        needs_accelerations_(std::any_of(forms.begin(), forms.end(),
                                         [](const auto& form) { return form->output()->needs_accelerations(); })) {}
  std::size_t outputs() const override { return first_.output()->outputs(); }
  bool needs_accelerations() const override { return needs_accelerations_; }
  void read(const LoadView& view, std::span<double> values) const noexcept override {
    if (const BoundLoad* load = discrete_.acting(view.discrete)) {
      load->output()->read(discrete_.inner(view), values);
    } else {
      std::fill(values.begin(), values.end(), 0.0);
    }
  }

 private:
  const SwitchedDiscrete& discrete_;
  const BoundLoad& first_;
  bool needs_accelerations_;  ///< in any of its forms
};

/// The value that a host sets is the same in all forms.
class SwitchedInput final : public InputPort {
 public:
  SwitchedInput(const Forms& forms, const SwitchedDiscrete& discrete)
      : discrete_(discrete), port_(*forms.front()->input()) {}
  std::string unit() const override { return port_.unit(); }
  InputPlace place() const override { return port_.place(); }
  bool interpolates() const override { return port_.interpolates(); }
  double value(double t, std::span<const double> discrete) const noexcept override {
    return port_.value(t, discrete_.own(discrete));
  }
  bool is_set(std::span<const double> discrete) const noexcept override {
    return port_.is_set(discrete_.own(discrete));
  }
  void set(double t, double reached, double value, std::span<double> discrete) const noexcept override {
    port_.set(t, reached, value, discrete_.own(discrete));
  }

 private:
  const SwitchedDiscrete& discrete_;
  const InputPort& port_;
};

/// What acts depends on the discrete states: all of it is in the parts that see them.
class BoundSwitchedLoad final : public EffortlessLoad,
                                public LoadNumbers,
                                public LoadOfForms,
                                public Kinks,
                                public CourseOfTime {
 public:
  explicit BoundSwitchedLoad(Forms forms)
      : forms_(std::move(forms)), discrete_(forms_), continuous_(forms_, discrete_) {
    const BoundLoad& first = *forms_.front();
    if (first.output() != nullptr) output_ = std::make_unique<SwitchedOutput>(forms_, discrete_);
    if (first.input() != nullptr) input_ = std::make_unique<SwitchedInput>(forms_, discrete_);
  }
  std::size_t scratch() const override {
    std::size_t most = 0;
    for (const auto& form : forms_) most = std::max(most, form->scratch());
    return most;
  }
  std::span<const FrameIndex> frames() const override { return forms_.front()->frames(); }
  void wrenches(double, std::span<const FrameMotion>, std::span<Wrench> wrenches) const noexcept override {
    std::fill(wrenches.begin(), wrenches.end(), Wrench{});
  }
  std::vector<double> discontinuities() const override {
    std::vector<double> all;
    for (const auto& form : forms_)
      for (const double t : form->discontinuities()) all.push_back(t);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
  const DiscretePart* discrete() const override { return &discrete_; }
  const ContinuousPart* continuous() const override { return &continuous_; }
  const LoadOutput* output() const override { return output_.get(); }
  const InputPort* input() const override { return input_.get(); }
  std::vector<SensorColumn> numbers() const override {
    const auto* told = dynamic_cast<const LoadNumbers*>(forms_.front().get());
    return told == nullptr ? std::vector<SensorColumn>{} : told->numbers();
  }
  void show(const LoadView& view, std::span<double> values) const noexcept override {
    const auto* told = dynamic_cast<const LoadNumbers*>(discrete_.acting(view.discrete));
    if (told != nullptr) {
      told->show(discrete_.inner(view), values);
    } else {
      std::fill(values.begin(), values.end(), 0.0);
    }
  }
  const BoundLoad& first() const noexcept override { return *forms_.front(); }
  const BoundLoad* acting(std::span<const double> discrete) const noexcept override {
    return discrete_.acting(discrete);
  }
  /// Of all forms: an event may set what goes on for longer.
  double end() const override {
    double last = 0;
    for (const auto& form : forms_) last = std::max(last, form->end());
    return last;
  }
  std::size_t kinks() const override {
    std::size_t count = 0;
    for (const Kinks* form : parts<Kinks>()) count += form->kinks();
    return count;
  }
  void kinks(std::span<const double> positions, std::span<const double> speeds,
             std::span<double> values) const noexcept override {
    for (const auto& form : forms_) {
      const auto* part = dynamic_cast<const Kinks*>(form.get());
      if (part == nullptr) continue;
      part->kinks(positions, speeds, values.first(part->kinks()));
      values = values.subspan(part->kinks());
    }
  }
  std::size_t courses() const override {
    std::size_t count = 0;
    for (const CourseOfTime* form : parts<CourseOfTime>()) count += form->courses();
    return count;
  }
  void course(double t, std::span<double> values) const noexcept override {
    for (const auto& form : forms_) {
      const auto* part = dynamic_cast<const CourseOfTime*>(form.get());
      if (part == nullptr) continue;
      part->course(t, values.first(part->courses()));
      values = values.subspan(part->courses());
    }
  }
  void begin(State& state) const override { forms_.front()->begin(state); }
  std::unique_ptr<BoundLoad> rebound(const Model& model, const Terms& terms) const override {
    Forms forms = forms_;
    bool changed = false;
    for (auto& form : forms) {
      std::unique_ptr<BoundLoad> other = form->rebound(model, terms);
      changed = changed || other != nullptr;
      if (other != nullptr) form = std::move(other);
    }
    if (!changed) return nullptr;
    return std::make_unique<BoundSwitchedLoad>(std::move(forms));
  }

 private:
  template <class Part>
  [[nodiscard]] std::vector<const Part*> parts() const {
    std::vector<const Part*> all;
    for (const auto& form : forms_)
      if (const auto* part = dynamic_cast<const Part*>(form.get())) all.push_back(part);
    return all;
  }

  Forms forms_;
  SwitchedDiscrete discrete_;
  SwitchedContinuous continuous_;
  std::unique_ptr<SwitchedOutput> output_;
  std::unique_ptr<SwitchedInput> input_;
};

/// What another form of a load has otherwise that no event can change; empty where it is all the same.
std::string unlike(const BoundLoad& a, const BoundLoad& b) {
  const auto same = [](const FrameIndex& x, const FrameIndex& y) { return x.body == y.body && x.frame == y.frame; };
  const auto period = [](const BoundLoad& load) { return load.discrete() == nullptr ? 0 : load.discrete()->period(); };
  const auto switches = [](const BoundLoad& load) {
    return load.discrete() == nullptr ? 0 : load.discrete()->switches();
  };
  const auto counts = [](std::size_t one, std::size_t other) {
    return " (" + std::to_string(one) + " before, " + std::to_string(other) + " after)";
  };
  if (!std::equal(a.frames().begin(), a.frames().end(), b.frames().begin(), b.frames().end(), same))
    return "where the load acts";
  if (period(a) != period(b)) return "the load's sample";
  if (discrete_states(a) != discrete_states(b))
    return "what the load keeps between instants" + counts(discrete_states(a), discrete_states(b));
  if (continuous_states(a) != continuous_states(b))
    return "the load's continuous states" + counts(continuous_states(a), continuous_states(b));
  if (switches(a) != switches(b))
    return "the functions at whose zeros the load switches" + counts(switches(a), switches(b));
  return {};
}

}  // namespace

std::unique_ptr<BoundLoad> SwitchedLoad::bind(const Model& model) const {
  Forms forms;
  for (const auto& form : forms_) {
    forms.push_back(form->bind(model));
    if (const std::string what = unlike(*forms.front(), *forms.back()); !what.empty())
      throw std::invalid_argument("an event changes " + what +
                                  "; need a change of numbers that the load has from the start, as of a limit that it "
                                  "does not reach until then");
    if (dynamic_cast<const ForeignLaw*>(forms.back().get()) != nullptr)
      throw std::invalid_argument("an event cannot switch or change a load whose law is not withy's own");
  }
  return std::make_unique<BoundSwitchedLoad>(std::move(forms));
}

}  // namespace withy
