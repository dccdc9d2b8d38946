/// \file
/// Bodies along x that a scene may cut across into segments: what their plugins share.
#pragma once

#include <functional>
#include <memory>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// The body cut into as many segments of equal length as `segments` in its checked value says: itself where that is 1.
/// Segment k is made from the value with `length` divided and all tables over x cut, between x = k L/n and (k + 1) L/n.
/// It is damped in proportion to its stiffness, D = τ K, such that the whole is damped as `whole` says: every strain,
/// as "bending_y", has its own τ = vᵀDv/vᵀKv from the lowest mode v of the whole: 2 ζ/ω₁ where that has the ratio ζ, so
/// that whole modes of frequency ω have ζ ω/ω₁. Modal damping of the segment's own modes would leave next to
/// nothing: they are about n² as fast as those of the whole.
/// \param value  checked, with `length` [m] and `segments`
/// \param specs  of the value's members
/// \param make   makes a body of the value of a segment; null after it has reported
/// \returns null where a segment is not made
std::unique_ptr<Body> in_segments(std::unique_ptr<Body> whole, const Value& value,
                                  const std::vector<ParameterSpec>& specs,
                                  const std::function<std::unique_ptr<Body>(const Value& segment)>& make);

}  // namespace withy
