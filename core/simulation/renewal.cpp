#include "withy/core/simulation/renewal.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "withy/core/simulation/run_times.hpp"

namespace withy {
namespace {

using Kind = SignalSource::Kind;

/// The sensors that can be measured, up to that with a number.
std::vector<SensorNode> up_to(const Model& model, std::size_t number) {
  std::vector<SensorNode> all;
  std::size_t count = 0;
  for (const SensorNode& node : *model.measured()) {
    if (count > number) break;
    if (node.sensor == nullptr) continue;
    all.push_back(node);
    count += node.sensor->columns().size();
  }
  return all;
}

}  // namespace

Renewal::Renewal(const Model& model, const EquationsOfMotion& equations)
    : model_(model), jumps_(discontinuities(model)) {
  std::size_t scratch = 0, most = 0, last = 0;
  bool outputs = false, loads = false;
  for (const LoadSlot& slot : model.layout().discrete_slots) {
    const BoundLoad& load = *model.loads()[slot.load].load;
    scratch = std::max(scratch, load.scratch());
    Measured m{.part = dynamic_cast<const SampledPart*>(load.discrete()), .sources = {}};
    for (const std::string& name : m.part == nullptr ? std::vector<std::string>{} : m.part->measures()) {
      const SignalSource source = find_signal(model, name);
      if (source.kind == Kind::unbound)
        throw std::invalid_argument("no number '" + name + "' of an output, which a load measures");
      if (source.kind == Kind::output) last = std::max(last, source.index);
      m.outputs = m.outputs || source.kind == Kind::output;
      loads = loads || source.kind == Kind::load;
      m.sources.push_back(source);
    }
    outputs = outputs || m.outputs;
    most = std::max(most, m.sources.size());
    measured_.push_back(std::move(m));
  }
  for (std::size_t i = 0; i < model.loads().size(); ++i)
    if (const auto* law = dynamic_cast<const ForeignLaw*>(model.loads()[i].load.get()))
      foreign_.push_back({{i, model.loads()[i].slot.first, model.loads()[i].slot.count}, law});
  scratch_.resize(scratch);
  values_.resize(most);
  if (outputs) {
    reader_ = std::make_unique<SensorReader>(up_to(model, last), equations);
    readings_.resize(reader_->columns().size());
  }
  if (loads) sensed_ = equations.make_sensed_state({});
  if (outputs || loads) before_.y.resize(equations.size());
}

void Renewal::at(const State& before) {
  looked_ = false;
  if (reader_ == nullptr && sensed_ == nullptr) return;
  before_.time = from_jump_on(jumps_, before.time);
  std::copy(before.y.begin(), before.y.end(), before_.y.begin());
}

void Renewal::measure(const Measured& measured, const State& state) {
  if (!looked_) {
    readable_ = reader_ == nullptr || reader_->read(before_, readings_);
    if (sensed_ != nullptr) static_cast<void>(sensed_->observe(before_));
    looked_ = true;
  }
  const std::size_t positions = model_.layout().positions;
  for (std::size_t i = 0; i < measured.sources.size(); ++i) {
    const SignalSource& source = measured.sources[i];
    switch (source.kind) {
      case Kind::position:
        values_[i] = state.y[source.index];
        break;
      case Kind::rate:
        values_[i] = state.y[positions + source.index];
        break;
      case Kind::load:
        values_[i] = dynamic_cast<SensedLoads&>(*sensed_).given(source.index, source.number, state.y);
        break;
      case Kind::output:
      case Kind::unbound:
        values_[i] = readings_[source.index];
        break;
    }
  }
}

std::string Renewal::said(const State& state, std::string (ForeignLaw::*what)(std::span<const double>) const) const {
  for (const Foreign& f : foreign_) {
    if (f.slot.first + f.slot.count > state.y.size()) continue;
    const std::string words = (f.law->*what)(std::span(state.y).subspan(f.slot.first, f.slot.count));
    if (!words.empty()) return "load '" + model_.loads()[f.slot.load].name + "': " + words;
  }
  return {};
}

std::string Renewal::failure(const State& state) const { return said(state, &ForeignLaw::failure); }

std::string Renewal::refusal(const State& state) const { return said(state, &ForeignLaw::refusal); }

void Renewal::forget() const {
  for (const Foreign& f : foreign_) f.law->forget();
}

void Renewal::operator()(State& state, const LoadSlot& slot, const Crossing& crossing) {
  const Layout& layout = model_.layout();
  const auto of_slot = [&](const LoadSlot& other) { return other.load == slot.load; };
  const auto at = std::find_if(layout.discrete_slots.begin(), layout.discrete_slots.end(), of_slot);
  const Measured& measured = measured_[static_cast<std::size_t>(at - layout.discrete_slots.begin())];
  const std::span<double> y(state.y), own = y.subspan(at->first, at->count);
  model_.loads()[slot.load].load->discrete()->renew(
      state.time, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), crossing, own, scratch_);
  if (measured.part == nullptr) return;
  measure(measured, state);
  const bool known =
      std::all_of(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(measured.sources.size()),
                  [](double x) { return std::isfinite(x); });
  if ((measured.outputs && !readable_) || !known) return;
  measured.part->renew_measured(state.time, crossing, std::span(values_).first(measured.sources.size()), own);
}

}  // namespace withy
