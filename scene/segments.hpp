/// \file
/// Bodies cut across into segments: a body plugin with the parameters `segments`, a whole number, and `length` says
/// that it can be cut at any x between its stations `root` (x = 0) and `tip` (x = length).
#pragma once

#include <cstddef>
#include <memory>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// The number of segments that the checked value of a body asks for; 1 where its plugin knows of none.
std::size_t segments_of(const Value& body, const std::vector<ParameterSpec>& specs);

/// What the plugin makes segment k of n from, k from 0: the length divided, tables over x cut, all else as it is.
Value segment_of(const Value& body, const std::vector<ParameterSpec>& specs, std::size_t k, std::size_t n);

/// The segment with damping in proportion to its stiffness, D = τ K, such that the whole is damped as `whole` says.
/// Every strain, as "bending_y", has its own τ = vᵀDv/vᵀKv with the lowest mode v of the whole: 2 ζ/ω₁ where that has
/// the damping ratio ζ, so that whole modes of frequency ω have ζ ω/ω₁. Modal damping of the segment's own modes would
/// leave next to nothing: they are about n² as fast as those of the whole.
std::unique_ptr<Body> damped_as(const ModalShape& whole, std::unique_ptr<Body> segment);

}  // namespace withy
