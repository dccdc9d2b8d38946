/// \file
/// Loads whose laws are not the engine's own.
#pragma once

#include <span>
#include <string>

namespace withy {

/// A BoundLoad whose law runs elsewhere – in an FMU, in another language – and may fail there: the simulation stops
/// with its words. With discrete states it keeps what it had and says so in them. They are no numbers of the law that
/// could be varied one by one: linear analyses refuse the load. One in continuous time gives NaN from its failure on.
class ForeignLaw {
 public:
  virtual ~ForeignLaw() = default;
  /// Why it failed, of the discrete states that it has left, in a clause without a full stop; empty: it has not.
  [[nodiscard]] virtual std::string failure(std::span<const double> discrete) const = 0;
  /// Why a simulation cannot go on from saved states; empty: it can.
  [[nodiscard]] virtual std::string refusal(std::span<const double> discrete) const = 0;
  /// What has failed is told, and its caller goes on from elsewhere. Only for a law that keeps its failure itself.
  virtual void forget() const {}
};

}  // namespace withy
