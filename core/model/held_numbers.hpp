/// \file
/// What the discrete states of a run under way are: a state that has them goes on with them, another begins anew.
#pragma once

#include <optional>
#include <span>

#include "withy/core/model/model.hpp"

namespace withy {

/// Index in State::y of the number that says whether a run has set the discrete states: 1, or 0 in a state that a run
/// is to begin at. Nothing where no load holds numbers.
std::optional<std::size_t> place_of_begun(const Model& model);

/// The numbers in y that a load holds of its own between instants – what a sampled controller commands and remembers,
/// whether a relay is on – and that nothing else in a written state says; empty where there are none.
std::span<double> held_numbers(const LoadNode& load, std::span<double> y);
std::span<const double> held_numbers(const LoadNode& load, std::span<const double> y);

}  // namespace withy
