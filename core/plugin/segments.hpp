/// \file
/// Bodies along x that a scene may cut across into segments: what their plugins share.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// The body cut into as many segments of equal length as `segments` in its checked value says: itself where that is 1.
/// Segment k is made from the value with `length` divided and all tables over x cut, between x = k L/n and (k + 1) L/n.
/// It is damped in proportion to its stiffness, D = Σ τ_s K_s with K_s of its strains (TurnedSections), such
/// that the whole is damped as `whole` says. A mode v of the whole has τ = vᵀDv/vᵀKv, 2 ζ/ω where its ratio is ζ; a
/// strain has that of the lowest mode which strains it, so that whole modes of frequency ω have ζ ω/ω₁. Where several
/// strains share in modes, each has the mean over the lowest modes whose shares in it add to one, and is set such that
/// the lowest of all has its τ exactly, and so, as far as lower ones leave their strains to them, have those above it,
/// as the first in the other plane. Modal damping of the segment's own modes would leave next to nothing: they are
/// about n² as fast as those of the whole.
/// \param value  checked, with `length` [m] and `segments`
/// \param specs  of the value's members
/// \param make   makes a body of the value of a segment; null after it has reported
/// \param vibrating  the whole in functions that its lowest modes are found by, for the damping: those of a segment,
///                   which are few, may miss its lowest frequency by far. Null: `whole`
/// \returns null where a segment is not made
std::unique_ptr<Body> in_segments(std::unique_ptr<Body> whole, const Value& value,
                                  const std::vector<ParameterSpec>& specs,
                                  const std::function<std::unique_ptr<Body>(const Value& segment)>& make,
                                  const Body* vibrating = nullptr);

/// A place on one of a body's segments.
struct SegmentPlace {
  std::size_t segment = 0;
  double x = 0;  ///< from the segment's root [m], within its length
};

/// Where a coordinate along a body lies on its segments. A place between two of them belongs to the outer one. Sums of
/// lengths are off by rounding: what is nearer to an end of a segment than 1e-9 of its length is there, and what is
/// beyond an end of the body by 1e-9 of the body's length is at that end.
/// \param lengths  of the segments, from the root of the body on [m]
/// \param x        from the root of the body [m]
/// \returns nothing where that is beyond an end of the body, or no number
std::optional<SegmentPlace> place_in_segments(std::span<const double> lengths, double x);

}  // namespace withy
