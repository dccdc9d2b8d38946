/// \file
/// A load that events switch off and on, or to other parameters.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "withy/core/plugin/load.hpp"

namespace withy {

/// The forms of one load, of which one acts or none. Which one stands last in the load's discrete states, so that a
/// State knows it. While the load is off it gives no effort and its own states stand still.
class SwitchedLoad final : public Load {
 public:
  /// \param forms the load as the scene states it, then with other parameters; at least one
  explicit SwitchedLoad(std::vector<std::shared_ptr<const Load>> forms) : forms_(std::move(forms)) {}
  /// \throws std::invalid_argument as those of the forms, and where these differ in more than numbers.
  [[nodiscard]] std::unique_ptr<BoundLoad> bind(const Model& model) const override;

  /// Numbers of forms as they stand in the discrete states: the first form is the one of a state of zeros.
  static constexpr double as_stated = 0, off = -1;
  /// Index in State::y of a load's form. \param slot of a SwitchedLoad
  [[nodiscard]] static std::size_t place_of_form(const LoadSlot& slot) { return slot.first + slot.count - 1; }

 private:
  std::vector<std::shared_ptr<const Load>> forms_;
};

/// What a bound SwitchedLoad is too (dynamic_cast).
class LoadOfForms {
 public:
  virtual ~LoadOfForms() = default;
  [[nodiscard]] virtual const BoundLoad& first() const noexcept = 0;
  /// The form that acts where the load's discrete states are these; null where it is off.
  [[nodiscard]] virtual const BoundLoad* acting(std::span<const double> discrete) const noexcept = 0;
};

}  // namespace withy
