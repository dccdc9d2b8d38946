#include "withy/bindings/fmu_load/fmu_block.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "withy/core/simulation/diagnosis.hpp"

namespace withy::fmu_load {
namespace {

constexpr double failed = -1;
/// Instances kept between samples: one for each motion under way, with some that have ended.
constexpr std::size_t most_kept = 16;
/// A double holds six bytes as a whole number.
constexpr std::size_t bytes_a_number = 6;

/// Mixes (Steele, Lea & Flood, "Fast splittable pseudorandom number generators", 2014: the finalizer of SplitMix64).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// A whole number above zero of what an FMU has been told up to now.
double next_ticket(double before, double t, std::span<const double> w) {
  std::uint64_t h = mixed(std::bit_cast<std::uint64_t>(before)) ^ mixed(std::bit_cast<std::uint64_t>(t));
  for (const double x : w) h = mixed(h ^ std::bit_cast<std::uint64_t>(x));
  return static_cast<double>(mixed(h) >> 12U) + 1;
}

/// From an instant of the clock the period; from a start between two of them the time to the next.
double length_of_step(double t, double period) {
  const double periods = t / period;
  if (std::abs(periods - std::round(periods)) < 1e-9 * std::max(1.0, std::abs(periods))) return period;
  return (std::floor(periods) + 1) * period - t;
}

void pack(std::span<const unsigned char> bytes, std::span<double> numbers) {
  for (std::size_t i = 0; i * bytes_a_number < bytes.size(); ++i) {
    std::uint64_t sum = 0;
    for (std::size_t k = std::min(bytes.size(), (i + 1) * bytes_a_number); k-- > i * bytes_a_number;)
      sum = sum << 8U | bytes[k];
    numbers[i] = static_cast<double>(sum);
  }
}

std::vector<unsigned char> unpacked(std::span<const double> numbers, std::size_t count) {
  std::vector<unsigned char> bytes(count);
  for (std::size_t k = 0; k < count; ++k)
    bytes[k] = static_cast<unsigned char>(static_cast<std::uint64_t>(numbers[k / bytes_a_number]) >>
                                          (8 * (k % bytes_a_number)));
  return bytes;
}

}  // namespace

FmuBlock::FmuBlock(const std::string& file, int line, std::shared_ptr<const Program> program, Wiring wiring, double t)
    : name_("FMU '" + file + "'" + (line > 0 ? " (line " + std::to_string(line) + " of the scene)" : "")),
      program_(std::move(program)),
      wiring_(std::move(wiring)) {
  const std::unique_ptr<Instance> first = make();
  if (!program_->description().keeps_states) return;
  const std::vector<double> zero(inputs());
  first->begin(t, parameters(), {wiring_.inputs, zero});
  // Histories of solvers grow over the first steps.
  memory_ = 2 + (2 * first->save().size() + 600) / bytes_a_number;
}

std::unique_ptr<Instance> FmuBlock::make() const { return program_->instantiate(); }

std::unique_ptr<Instance> FmuBlock::take(double ticket) const {
  const std::lock_guard lock(mutex_);
  const auto at = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.ticket == ticket; });
  if (at == kept_.end()) return nullptr;
  std::unique_ptr<Instance> instance = std::move(at->instance);
  kept_.erase(at);
  return instance;
}

bool FmuBlock::has(double ticket) const {
  const std::lock_guard lock(mutex_);
  return std::any_of(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.ticket == ticket; });
}

void FmuBlock::keep(double ticket, std::unique_ptr<Instance> instance) const {
  std::unique_ptr<Instance> dropped;
  const std::lock_guard lock(mutex_);
  kept_.push_back({ticket, std::move(instance)});
  if (kept_.size() <= (program_->description().once_only ? 1 : most_kept)) return;
  dropped = std::move(kept_.front().instance);
  kept_.pop_front();
}

void FmuBlock::write(std::span<double> z, double ticket, Instance& instance) const {
  z[0] = ticket;
  if (z.size() < 2) return;
  const std::vector<unsigned char> bytes = instance.save();
  const std::span<double> room = z.subspan(2);
  std::fill(room.begin(), room.end(), 0.0);
  const bool fits = bytes.size() <= room.size() * bytes_a_number;
  z[1] = fits ? static_cast<double>(bytes.size()) : -1;
  if (fits) pack(bytes, room);
}

void FmuBlock::fail(std::span<double> z, double t, const char* why) const noexcept {
  z[0] = failed;
  try {
    std::string text = name_ + " at t = " + brief(t) + " s: " + why;
    const std::lock_guard lock(mutex_);
    failure_ = std::move(text);
  } catch (...) {
    return;  // no memory for words
  }
}

void FmuBlock::begin(double t, std::span<const double> w, std::span<double> z) const noexcept {
  try {
    std::unique_ptr<Instance> instance = make();
    instance->begin(t, parameters(), {wiring_.inputs, w});
    write(z, next_ticket(0, t, w), *instance);
    keep(z[0], std::move(instance));
  } catch (const std::exception& e) {
    fail(z, t, e.what());
  }
}

/// Never asked: `sample` takes its place.
void FmuBlock::output(double /*t*/, std::span<const double> /*w*/, std::span<const double> /*z*/,
                      std::span<double> v) const noexcept {
  std::fill(v.begin(), v.end(), 0.0);
}

void FmuBlock::sample(double t, std::span<const double> w, std::span<double> z, std::span<double> v) const noexcept {
  if (z[0] == failed) return;
  try {
    std::unique_ptr<Instance> instance = take(z[0]);
    if (instance == nullptr) {
      if (const std::string why = refusal(z); !why.empty()) throw FmuError(why);
      instance = make();
      instance->restore(unpacked(z.subspan(2), static_cast<std::size_t>(z[1])));
    }
    std::vector<double> commands(v.size());
    instance->step(t, length_of_step(t, period_), {wiring_.inputs, w}, wiring_.outputs, commands);
    for (const double command : commands)
      if (!std::isfinite(command)) throw FmuError("gives " + brief(command) + " as a command");
    std::copy(commands.begin(), commands.end(), v.begin());
    write(z, next_ticket(z[0], t, w), *instance);
    keep(z[0], std::move(instance));
  } catch (const std::exception& e) {
    fail(z, t, e.what());
  }
}

std::string FmuBlock::failure(std::span<const double> z) const {
  if (z[0] != failed) return {};
  const std::lock_guard lock(mutex_);
  return failure_.empty() ? name_ + " has failed" : failure_;
}

std::string FmuBlock::refusal(std::span<const double> z) const {
  if (z[0] == failed) return failure(z);
  if (z[0] == 0 || has(z[0]) || has_bytes(z)) return {};
  return name_ + " cannot go on from a saved state: " +
         (z.size() > 1 ? "the bytes of its state have become more than twice as many as at its start"
                       : "it does not give its state away (canGetAndSetFMUstate and canSerializeFMUstate)");
}

}  // namespace withy::fmu_load
