/// \file
/// Energies and momenta of several cases at once, a lane of a vector register each.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "withy/core/kinematics/observation.hpp"

namespace withy {

struct Lanes;

/// A state whose energies a case asks for: Observation::energies with the state and the result.
struct LaneEnergy {
  std::span<const double> y;
  Energies energies;
};

/// Cases whose observations differ in numbers only, cases_at_once of them. What a case gets depends on itself alone, to
/// the last bit. Of one thread.
class LaneEnergies {
 public:
  virtual ~LaneEnergies() = default;
  /// Whether these constants may be put into a lane.
  [[nodiscard]] virtual bool fits(const ObservedModel& model) const = 0;
  /// Puts constants that fit into a lane; they must outlive its calls. May allocate.
  virtual void put(std::size_t lane, const ObservedModel& model) = 0;
  /// Of the lanes that have a call; null: none. Allocates nothing.
  virtual void find(std::span<LaneEnergy* const> calls) noexcept = 0;
  /// Of states that are in lanes already. \param energies takes those of the lanes that have a place; null: none
  virtual void find(const Lanes* y, std::span<Energies* const> energies) noexcept = 0;
};

/// Lanes that all begin with these constants; null where bodies move by exact kinematics, sections in space have rotary
/// inertia, or hinges have several rates.
std::unique_ptr<LaneEnergies> lane_energies(const ObservedModel& model);

}  // namespace withy
