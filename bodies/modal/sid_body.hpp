/// \file
/// Between Standard Input Data and bodies.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mass_integrals.hpp"
#include "withy/bodies/damping.hpp"
#include "withy/core/plugin/body.hpp"

namespace withy {

struct SidBodyOptions {
  std::string root;                         ///< id of the node that is the root; empty: the frame the data refer to
  std::optional<BodyDamping> damping = {};  ///< in the place of De; none: De
};

/// The body that Standard Input Data describe. Its stations are the nodes, with the axes of the body.
/// \throws std::domain_error where there is no such body: what() says why.
std::unique_ptr<Body> body_of(const sid::Data& data, const SidBodyOptions& options, SidReport& report);

/// Standard Input Data of a body, with these of its stations as nodes: every integral to first order, and with Gr's
/// first order.
/// \throws std::domain_error where the body has no such station.
sid::Data sid_of(const Body& body, const std::vector<Body::StationName>& stations);

}  // namespace withy
