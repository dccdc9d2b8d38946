/// \file
/// Stiffness that the motion of a body's frame induces in its elastic coordinates, against the body's own.
#pragma once

#include <Eigen/Eigenvalues>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "withy/core/shape/held_section.hpp"
#include "withy/core/simulation/tree_motion.hpp"

namespace withy {

/// The twelve motions that induce stiffness (Banerjee & Dickens, J. Guidance 13, 1990), body axes: the products
/// ω_x², ω_y², ω_z², ω_x ω_y, ω_y ω_z, ω_z ω_x; ω̇; v̇ − g; for bodies that carry others, what these do relative to the
/// body; and the forces of loads at frames, its own and those of what it carries.
inline constexpr std::size_t motion_terms = 14;
/// "wx wx", "wx wy", …, "dwx/dt", "ax-gx", "motion of outboard bodies", "loads at frames".
std::string motion_term_name(std::size_t term);

/// The load of a body at one instant.
struct LoadRatio {
  /// Extreme ratios of work: the eigenvalues of the induced stiffness relative to K. Negative: towards buckling, which
  /// is reached at −1. Positive: stiffening.
  double least = 0;
  double greatest = 0;
  /// Whether it stiffens more than it softens. Where both are as much, as under a force across a body that bends and
  /// twists, it does not: of the two that is what matters.
  bool stiffens = false;
  /// Shares of the terms in the eigenvalue of greater magnitude; their sum is that eigenvalue.
  std::array<double, motion_terms> shares{};
  [[nodiscard]] double size() const { return greatest > -least ? greatest : -least; }
};

/// The section at the inboard hinge of a body, where modes turn it and the hinge holds it.
std::optional<HeldSection> held_root(const Model& model, std::size_t body);

/// A second-order displacement ½ qᵀΓq does work against the inertia force −m (a − g) of the undeformed body, to which
/// belongs the stiffness Σ m (a − g)·Γ, with Γ as it is seen from the section at the inboard hinge where modes turn
/// that and the hinge holds it: the body then turns as a whole, and the forces keep their directions; a body or section
/// carried at a station adds (Σ m (a − g))·Γ there. A load's force F at a frame does the work of −F·Γ. Moments, of
/// carried bodies about their station and of loads, are left out.
class MotionStiffness {
 public:
  /// For a flexible body of the model, which must outlive the object.
  /// \param twin of an equal body of the model, to share what they have in common; of one thread together with it.
  ///   Null: there is none
  MotionStiffness(const Model& model, std::size_t body, const MotionStiffness* twin = nullptr);
  /// For a body in segments as one piece, by its own few functions: what truncation leaves between segments does not
  /// act, and loads are then to be held against the buckling load of the whole. \param segments of it, from its root
  MotionStiffness(const Model& model, const Body& whole, const std::vector<int>& segments);
  /// At the motions of the tree. Allocates nothing.
  /// \param loads what loads exert at their frames, world axes, in the order of the model's loads and of the frames of
  ///   each; empty: nothing
  LoadRatio evaluate(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads = {});

 private:
  /// Of a section under unit force on it along body axes.
  struct Section {
    PointExpansion at;
    std::array<Eigen::MatrixXd, 3> stiffness;
  };
  /// A hinge that loads the body: an outboard body's (sign +1), or the inboard one where it holds a moving section.
  struct Station {
    std::size_t carried;  ///< body whose subtree's force passes here
    double sign;
    std::shared_ptr<const Section> section;
  };
  /// A frame of the body at which a load acts.
  struct Loaded {
    std::size_t load;  ///< index among the frames of all loads
    std::shared_ptr<const Section> section;
  };
  /// What equal bodies share, in coordinates in which K is 1.
  struct Own {
    /// \param root null: the body's frame
    Own(const ModalShape& shape, const HeldSection* root);
    Eigen::MatrixXd S;                       ///< of these coordinates
    std::array<Eigen::MatrixXd, 12> motion;  ///< of unit terms
    Eigen::MatrixXd total;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  };
  [[nodiscard]] std::shared_ptr<const Section> section_of(const Model& model, int frame,
                                                          const MotionStiffness* twin) const;
  [[nodiscard]] std::shared_ptr<const Section> made(const PointExpansion& at) const;

  /// As seen from the root.
  [[nodiscard]] PointExpansion seen(const PointExpansion& at) const;

  std::size_t body_;
  std::optional<HeldSection> root_;  ///< nothing: fields are those of the body's frame
  std::shared_ptr<Own> own_;
  std::vector<Station> stations_;
  std::vector<Loaded> loaded_;
};

}  // namespace withy
