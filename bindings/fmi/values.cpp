/// \file
/// What hosts read from an instance and set in it.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "withy/bindings/fmi/instance.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy::fmi {

const Variable& Instance::variable(std::uint32_t reference) const {
  if (reference >= variables_.all.size())
    throw std::out_of_range("there is no variable of value reference " + std::to_string(reference) + "; the last is " +
                            std::to_string(variables_.all.size() - 1));
  return variables_.all[reference];
}

void Instance::get(std::span<const std::uint32_t> references, double* values) {
  if (is_in(static_cast<unsigned>(Mode::initialization)))
    if (const std::string fault = settle_start(); !fault.empty()) throw Discarded(fault);
  for (const std::uint32_t reference : references) {
    const Variable& v = variable(reference);
    switch (v.kind) {
      case Variable::Kind::time:
        *values++ = dynamics().time();
        break;
      case Variable::Kind::state:
        *values++ = dynamics().state().y[v.index];
        break;
      case Variable::Kind::derivative:
        *values++ = dynamics().derivatives()[v.index];
        break;
      case Variable::Kind::output:
        *values++ = dynamics().output(v.index);
        break;
      case Variable::Kind::indicator:
        *values++ = dynamics().indicator(v.index);
        break;
      case Variable::Kind::parameter:
        *values++ = parameters_[v.index];
        break;
      case Variable::Kind::input: {
        const std::size_t i = reference - variables_.input(0);
        *values++ = is_input_set_[i] != 0 ? inputs_[i] : dynamics().input(v.index);
        break;
      }
    }
  }
}

void Instance::check_set(const Variable& v, double value) {
  const auto refuse = [&](const std::string& why) { throw std::invalid_argument(v.quoted() + ": " + why); };
  const bool starting = is_in(Mode::instantiated | Mode::initialization);
  if (!std::isfinite(value)) refuse("got " + brief(value) + "; need a finite number");
  if (v.kind == Variable::Kind::parameter && v.tunable && !starting && !is_in(Mode::event | Mode::step))
    refuse("is a tunable parameter, set before initialization ends, between steps and at events; the mode is " +
           std::string(mode_name()));
  if (v.kind == Variable::Kind::parameter && !v.tunable && !starting)
    refuse("is a fixed parameter, set before initialization ends; the mode is " + std::string(mode_name()));
  if (v.kind == Variable::Kind::state && !starting)
    refuse("is a state, which is set by its start value; the mode is " + std::string(mode_name()));
  if (v.kind == Variable::Kind::state && dynamics_->driven(v.index) && value != dynamics_->state().y[v.index])
    refuse("is prescribed by a motion of the scene");
  if (v.kind == Variable::Kind::input && is_in(Mode::intermediate | Mode::terminated))
    refuse("is an input, which is not set in the mode " + std::string(mode_name()));
  if (v.kind != Variable::Kind::parameter && v.kind != Variable::Kind::state && v.kind != Variable::Kind::input)
    refuse("is calculated");
}

void Instance::set_one(const Variable& v, double value) {
  if (v.kind == Variable::Kind::parameter) {
    if (is_in(Mode::instantiated | Mode::initialization)) stale_ = stale_ || parameters_[v.index] != value;
    parameters_[v.index] = value;
  } else if (v.kind == Variable::Kind::state) {
    if (dynamics_->driven(v.index)) return;  // it is what the motion says, at another start too
    starts_[v.index] = value;
    is_started_[v.index] = 1;
    if (!stale_) dynamics_->set_state(v.index, value);
  } else {
    const auto i = static_cast<std::size_t>(&v - &variables_.all[variables_.input(0)]);
    inputs_[i] = value;
    is_input_set_[i] = 1;
    if (session_ != nullptr) session_->set_input(v.index, value);
    // One that is reached in a straight line still has its old value.
    const bool later = session_ != nullptr && dynamics_->model().loads()[v.index].load->input()->interpolates();
    if (!stale_ && !later) dynamics_->set_input(v.index, value);
  }
}

void Instance::set(std::span<const std::uint32_t> references, const double* values) {
  for (std::size_t i = 0; i < references.size(); ++i) check_set(variable(references[i]), values[i]);
  const std::vector<double> before = parameters_;
  const auto set_those = [&](bool parameters) {
    for (std::size_t i = 0; i < references.size(); ++i)
      if (const Variable& v = variable(references[i]); (v.kind == Variable::Kind::parameter) == parameters)
        set_one(v, values[i]);
  };
  set_those(true);
  if (parameters_ != before && is_in(Mode::event | Mode::step)) retune(before);
  set_those(false);
  open_ = true;
  if (!stale_ && is_in(Mode::instantiated | Mode::initialization)) begin_loads(*dynamics_);
}

void Instance::give(std::span<const double> numbers, double* array, std::size_t count) const {
  if (count != numbers.size() || (count > 0 && array == nullptr))
    throw std::invalid_argument("got an array of " + std::to_string(count) + " numbers; need " +
                                std::to_string(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), array);
}

void Instance::give_indicators(double* array, std::size_t count) { give(dynamics().event_indicators(), array, count); }

void Instance::set_continuous(std::span<const double> x) {
  if (x.size() != variables_.states || (x.data() == nullptr && !x.empty()))
    throw std::invalid_argument("got an array of " + std::to_string(x.size()) + " numbers; need " +
                                std::to_string(variables_.states));
  if (!std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); }))
    throw Discarded("a state is not finite");
  dynamics().set_moving(x);
}

}  // namespace withy::fmi
