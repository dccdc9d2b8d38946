/// \file
/// The interface of bodies.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "withy/core/plugin/rod.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"
#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// A body of the tree, rigid (no modes) or flexible. It is immutable once made and is asked only while a model is built
/// and compiled, never during an evaluation.
class Body {
 public:
  /// A place on the body where frames are fixed: a name such as "root" or "tip", or a coordinate along the body [m].
  using StationName = std::variant<std::string, double>;

  virtual ~Body() = default;
  /// Mass, stiffness and damping in modal coordinates.
  [[nodiscard]] virtual const ModalShape& shape() const = 0;
  /// Motion of the section at a station; nothing where the body has no such station. Every body has "root".
  [[nodiscard]] virtual std::optional<PointExpansion> station(const StationName& name) const = 0;
  /// Names of the stations, for messages.
  [[nodiscard]] virtual std::string stations() const = 0;
  /// Name of the station whose deflection is held against shape().length; empty: of none. A body that has no "tip"
  /// names the one that gives most (ModalShape::compliance).
  [[nodiscard]] virtual std::string measured_station() const { return station("tip") ? "tip" : ""; }
  /// Further stations that are measured with it: they move in motions in which it rests, as the corners of a plate do
  /// while it twists.
  [[nodiscard]] virtual std::vector<std::string> measured_beside() const { return {}; }
  /// The body as a rod of exact kinematics; null where it cannot be one. It lives as long as the body.
  [[nodiscard]] virtual const Rod* rod() const { return nullptr; }
  /// The same body with its second-order maps made by `kinematics` from its linear fields; it has a station at every
  /// coordinate along x where this one has one. Null where the body has not the fields, as it is not slender or reads
  /// its maps from data.
  [[nodiscard]] virtual std::shared_ptr<const Body> expanded(const StrainKinematics& /*kinematics*/) const {
    return nullptr;
  }
  /// The body in pieces that lie one behind the other, from its root on: each has the stations `root` and `tip`, and
  /// the tip of one is joined rigidly to the root of the next. A model is made of them in place of the body; shape() is
  /// then of the whole as if it were one piece. Empty where it is one.
  [[nodiscard]] virtual std::span<const std::shared_ptr<const Body>> segments() const { return {}; }
  /// The body cut at x [m] along itself; nothing where it is not slender or does not reach there. Of a body in segments
  /// the segments are asked.
  [[nodiscard]] virtual std::optional<BodyCut> cut(double /*x*/) const { return {}; }
  /// What a user should know of the body beyond its numbers, such as what its data lack: each a sentence.
  [[nodiscard]] virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace withy
