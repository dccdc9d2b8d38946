/// \file
/// Another family of modes in the place of those that a scene gives a body, and the start that keeps its meaning.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "withy/core/plugin/body.hpp"
#include "withy/scene/scene.hpp"

namespace withy::study {

/// The family of functions that bend freely at either end: they carry a moment at the tip, and are complete for any
/// clamped beam, whatever hangs there.
inline constexpr const char* polynomials = "orthogonal-polynomials";
inline constexpr std::size_t most_polynomials = 100;  ///< that there are of a strain

/// Whether enough functions of a family describe any strain of a beam that is clamped at its root and free at its tip.
/// \param family a name, or a map with `name`
bool spans_cantilevers(const Value& family, Registry& registry);

/// Where a body's value names the family of some of its modes, as "torsion.family": of bending by the parameter's role,
/// of any other strain the family beside the number. Empty where there is none.
std::string family_path(const Scene& scene, const std::string& body, const ModeCount& count, Registry& registry);

/// The family that stands there, defaults filled in; null where there is none.
const Value* family_at(const Scene& scene, const std::string& body, const std::string& path);

/// Whether a property of a body is a table, as those of beams that vary along themselves are.
bool varies(const Scene& scene, const std::string& body);

/// A body of the scene with other values at paths below it. Null where it cannot be made.
std::shared_ptr<const Body> body_with(const Scene& scene, const std::string& body,
                                      const std::vector<std::pair<std::string, Value>>& values, Registry& registry);

/// Modal coordinates (or rates) of `to` with the linear displacements and rotations that `q` has of `from`: least
/// squares along the length, rotations weighed by the length, at more sections than either has functions. Exact where
/// the functions of one are sums of the other's. Nothing where a body has no stations along itself from root to tip.
std::optional<std::vector<double>> same_shape(const Body& from, std::span<const double> q, const Body& to);

/// What vibrations of a body's modes are compared by.
struct OtherFamily {
  std::string family;  ///< whose functions may do better
  std::function<bool(const ModeCount&)>
      compared;  ///< whether modes of a strain are looked at; those of the family are not
  /// First frequency of `count` of a body's modes, all others at rest [Hz]; no number where it is not known.
  std::function<double(const Body&, Eigen::Index first, Eigen::Index count)> first_hertz;
};
/// "2 bending_y modes of clamped-free vibrate first at 9.342 Hz, as many of orthogonal-polynomials at 5.623 Hz", strain
/// by strain, where that is notably faster; empty where the body's functions do about as well.
std::string notably_faster_strains(const Scene& scene, const BodyModes& modes, const Body& body,
                                   const OtherFamily& other, Registry& registry);

}  // namespace withy::study
