/// \file
/// The constants of sensing: each body of a model by itself, none merged, with the sections that frames are fixed to.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/sweep/rod/rod_terms.hpp"
#include "withy/core/tree/tree.hpp"

namespace withy::sensed {

/// A generalized particle of a flexible body (mass_table.hpp): coefficients of the fields in a function over the mass.
struct PointFields {
  double constant = 0;          ///< of the field 1 [√kg]
  std::vector<Vector3> first;   ///< X, then Φ_i [m √kg]
  std::vector<Vector3> second;  ///< Γ_ij of i ≤ j; empty where all are zero
};

/// A section of a body where frames are fixed.
struct SectionFields {
  PointExpansion at;
  bool moves = false;  ///< false: the modes leave it where it is
};

/// Rotary inertia of a section about its own axes.
struct RotarySection {
  Matrix3 inertia;  ///< [kg m²]
  SectionFields section;
};

/// A frame at `pose` in a section.
struct SectionFrame {
  std::size_t section = 0;  ///< index in BodyPlan::sections
  Pose pose;
};

/// A rod of exact kinematics; its stations are the body's sections.
struct RodPlan {
  sweep::RodKinematics<Spatial> kinematics;
  std::vector<Matrix3> inertias;  ///< of its nodes, as RodTable has them
  std::size_t work = 0;           ///< first of its packs among those of all rods
};

struct BodyPlan {
  const HingeNode* hinge = nullptr;
  Slot slot;  ///< of the hinge
  Eigen::Index modes = 0;
  Slot modal;                  ///< of the modes
  std::size_t first_mode = 0;  ///< among those of all bodies
  StrainOrder order = StrainOrder::quadratic;
  Truncation truncation = Truncation::none;
  std::vector<SectionFields> sections;
  std::vector<SectionFrame> frames;  ///< of the body, in its order, then its mass points and cuts' under loads on mass
  std::size_t named = 0;             ///< those that are not mass points
  SectionFrame F;      ///< of the inboard hinge, on the parent; at `F.pose` in the world where there is none
  std::size_t M = 0;   ///< of the inboard hinge, on this body: index in `frames`
  RigidInertia rigid;  ///< of a rigid body
  std::vector<PointFields> points;  ///< mass of a flexible one
  std::vector<RotarySection> rotary;
  std::shared_ptr<const RodPlan> rod;

  /// Index in `frames` of a frame of the body.
  [[nodiscard]] std::size_t frame(int index) const {
    return index >= 0 ? static_cast<std::size_t>(index) : named + static_cast<std::size_t>(-1 - index);
  }
};

/// A body cut across: what belongs to the part beyond.
struct CutPlan {
  std::size_t body = 0;
  std::size_t section = 0;          ///< index in BodyPlan::sections
  RigidInertia rigid;               ///< of a rigid body
  std::vector<PointFields> points;  ///< mass of a flexible one
  std::vector<RotarySection> rotary;
  RodTable::Part of_rod;            ///< of a rod: what of its nodes
  std::vector<std::size_t> hinges;  ///< that hang on the part
  std::vector<double> frames;       ///< of the body: the share that the part has of what acts there
  /// Where loads on distributed mass act on the part, of a body that is no rod: their frames are the body's from
  /// `first_point` on.
  std::vector<MassPoint> mass;
  std::size_t first_point = 0;
  bool inboard = false;  ///< the body's own hinge holds the part beyond
  Matrix3X curvature;    ///< as BodyCut
  Matrix3 stiffness;     ///< as BodyCut
};

/// One a body of the model, in its order.
struct Plan {
  /// `terms` hold for every body that has none of its own. The model must outlive the plan.
  /// \throws std::invalid_argument where a body cannot be cut at one of the sections.
  Plan(const Model& model, Terms terms, std::span<const SectionPlace> sections);

  const Model& model;
  ActingFields fields;  ///< that the model has
  bool products_of_speeds;
  Truncation truncation = Truncation::none;  ///< of the flexible bodies that are not ruthless
  std::vector<BodyPlan> bodies;
  std::vector<CutPlan> cuts;  ///< in the order of the sections
  std::size_t modes = 0;      ///< of all bodies
  std::size_t sections = 0;   ///< of all bodies
  std::size_t rod_packs = 0;  ///< work memory of all rods
  std::size_t most_modes = 0;

  /// Whether there is a frame or mass point of this index.
  [[nodiscard]] bool has(FrameIndex at) const noexcept {
    if (at.body < 0 || static_cast<std::size_t>(at.body) >= bodies.size()) return false;
    const BodyPlan& body = bodies[static_cast<std::size_t>(at.body)];
    return body.frame(at.frame) < (at.frame < 0 ? body.frames.size() : body.named);
  }

 private:
  void add_body(std::size_t index, Terms terms);
  void add_cut(const SectionPlace& place);
  void add_rods();
};

}  // namespace withy::sensed
