/// \file
/// How fine what a plugin gives along a body may be.
#pragma once

namespace withy {

/// Greatest wave number times the length: what is finer takes all the memory there is for its quadrature, and no number
/// of modes that a model can have is as fine.
constexpr double most_waves = 1e4;

}  // namespace withy
