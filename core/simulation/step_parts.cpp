#include "withy/core/simulation/step_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

constexpr double parts_of_a_run = 256, radians = 0.5;
/// Of one step: what turns faster is watched by steps of its own.
constexpr double most_parts = 4096;

}  // namespace

StepParts::StepParts(const Model& model, double start, double end) : longest_((end - start) / parts_of_a_run) {
  for (const ModelRate& rate : hinge_rates(model))
    if (rate.angular)
      turning_.push_back(
          {model.layout().positions + rate.speed, rate.position ? static_cast<std::ptrdiff_t>(*rate.position) : -1});
}

void StepParts::leave_out(const std::function<bool(std::size_t)>& matters) {
  std::erase_if(turning_, [&](const Turning& t) {
    return t.coordinate >= 0 && !matters(static_cast<std::size_t>(t.coordinate));
  });
}

std::size_t StepParts::operator()(double length, std::span<const double> before, std::span<const double> after) const {
  double fastest = 0;
  for (const Turning& t : turning_) fastest = std::max({fastest, std::abs(before[t.rate]), std::abs(after[t.rate])});
  const double parts = std::max(length * fastest / radians, longest_ > 0 ? length / longest_ : 0.0);
  return static_cast<std::size_t>(std::clamp(std::ceil(parts), 1.0, most_parts));
}

}  // namespace withy
