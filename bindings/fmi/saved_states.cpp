/// \file
/// States of an instance that a host keeps, and their form in bytes.
#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "withy/bindings/fmi/instance.hpp"
#include "withy/scene/sha256.hpp"

namespace withy::fmi {
namespace {

constexpr std::string_view magic = "withyfmu";
constexpr std::size_t digest_size = 64;

std::string_view text_of(std::span<const unsigned char> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

/// Writes or reads everything that the calls to come depend on.
void Instance::remember(Memory& memory) {
  Kind kind = kind_;
  memory(kind);
  if (kind != kind_)
    throw std::invalid_argument(
        "the state is of an instance of the other kind: of model exchange or of co-simulation, not as this one");
  memory(mode_);
  bool tolerated = tolerance_.has_value();
  double tolerance = tolerance_.value_or(0), start = start_;
  std::vector<double> parameters = parameters_;
  memory(tolerated);
  memory(tolerance);
  memory(start);
  bool ends = stop_.has_value();
  double stop = stop_.value_or(0);
  memory(ends);
  memory(stop);
  if (memory.reading()) stop_ = ends ? std::optional(stop) : std::nullopt;
  memory(parameters);
  memory(starts_);
  memory(is_started_);
  memory(inputs_);
  memory(is_input_set_);
  bool stale = stale_, simulating = session_ != nullptr;
  memory(stale);
  memory(simulating);
  if (memory.reading()) {
    const std::optional<double> asked = tolerated ? std::optional(tolerance) : std::nullopt;
    const bool other = stale_ || asked != tolerance_ || start != start_ || parameters != parameters_;
    tolerance_ = asked;
    start_ = start;
    parameters_ = parameters;
    if (other) session_.reset();
    stale_ = other;
  }
  if (stale) {
    stale_ = true;
    session_.reset();
    return;
  }
  dynamics().remember(memory);
  open_ = open_ || memory.reading();
  if (!simulating) return session_.reset();
  Checkpoint checkpoint;
  if (!memory.reading()) checkpoint = session_->snapshot();
  memory(checkpoint.state.time);
  memory(checkpoint.state.y);
  memory(checkpoint.stepper);
  memory(checkpoint.watches);
  if (!memory.reading()) return;
  if (session_ == nullptr) make_session();
  session_->restore(checkpoint);
}

SavedState* Instance::save() {
  Memory memory;
  remember(memory);
  auto state = std::make_unique<SavedState>(SavedState{memory.numbers()});
  saved_.insert(state.get());
  return state.release();
}

const SavedState& Instance::own(const SavedState* state) const {
  if (!saved_.contains(state))
    throw std::invalid_argument("the state is none that this instance has saved, or is freed");
  return *state;
}

void Instance::restore(const SavedState* state) {
  const SavedState& wanted = own(state);
  Memory memory(wanted.numbers);
  remember(memory);
  memory.finish();
}

void Instance::forget(const SavedState* state) {
  const SavedState* kept = &own(state);
  saved_.erase(kept);
  delete kept;
}

std::vector<unsigned char> Instance::serialize(const SavedState* state) const {
  const std::vector<double>& numbers = own(state).numbers;
  std::string bytes(magic);
  bytes += token_;
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
  bytes += sha256(bytes);
  return {bytes.begin(), bytes.end()};
}

SavedState* Instance::deserialize(std::span<const unsigned char> bytes) {
  const std::string head = std::string(magic) + token_;
  const std::string_view all = text_of(bytes);
  const std::size_t around = head.size() + digest_size;
  if (all.size() < around || !all.starts_with(head) || (all.size() - around) % sizeof(double) != 0 ||
      sha256(all.substr(0, all.size() - digest_size)) != all.substr(all.size() - digest_size))
    throw std::invalid_argument("these bytes are no state of this FMU, or are damaged");
  auto state = std::make_unique<SavedState>();
  state->numbers.resize((all.size() - around) / sizeof(double));
  std::memcpy(state->numbers.data(), all.data() + head.size(), state->numbers.size() * sizeof(double));
  saved_.insert(state.get());
  return state.release();
}

}  // namespace withy::fmi
