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
#include "withy/core/simulation/loop_following.hpp"
#include "withy/core/simulation/tree_motion.hpp"

namespace withy {

/// The twelve motions that induce stiffness (Banerjee & Dickens, J. Guidance 13, 1990), body axes: the products
/// ω_x², ω_y², ω_z², ω_x ω_y, ω_y ω_z, ω_z ω_x; ω̇; v̇ − g; for bodies that carry others, what these do relative to the
/// body; and the forces of loads and of closed loops at frames, its own and those of what it carries.
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
/// carried at a station adds (Σ m (a − g))·Γ there. A load's force F at a frame, or that of a closed loop, does the
/// work of −F·Γ. Moments, of carried bodies about their station and of loads, are left out.
///
/// In closed loops Γ is seen from the section at the inboard hinge as if that held it. Where hinges of the loop turn
/// that section by θ = T q as the body bends, a point moves by θ × Φq + ½ θ × (θ × X) more: of a rod with a pin at each
/// end Γ is then seen from the line between its pins, whatever its modes turn, and the load is held against the
/// buckling load of the pinned rod.
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
  ///   each, then those of loops; empty: nothing
  /// \param loop how loops let the body turn and bend, as LoopFollowing says; null: its inboard hinge is held
  LoadRatio evaluate(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads = {},
                     const LoopBound* loop = nullptr);

 private:
  /// Of a section under unit force on it along body axes.
  struct Section {
    PointExpansion at;
    std::array<Eigen::MatrixXd, 3> stiffness;
    Matrix3X phi;  ///< as seen from the root, in the same coordinates
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
    /// What the forces of unit terms do where the body turns by θ: θᵀ D q + ½ θᵀ E θ.
    std::array<Matrix3X, 12> turned;  ///< D
    std::array<Matrix3, 12> twice;    ///< E
    Eigen::MatrixXd total;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    Eigen::VectorXd buckled;  ///< of the eigenvalue of greater magnitude
  };
  [[nodiscard]] std::shared_ptr<const Section> section_of(const Model& model, int frame,
                                                          const MotionStiffness* twin) const;
  [[nodiscard]] std::shared_ptr<const Section> made(const PointExpansion& at) const;

  /// Calls act(force, section) for the forces of stations and of loads, body axes, as in `evaluate`.
  template <class Act>
  void each_force(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads, Act&& act) const;
  /// Adds what θ = T q does. \param T in the coordinates in which K is 1
  void add_turning(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads, const Matrix3X& T);
  /// Extreme eigenvalues of `total`, of motions that `bound` leaves, and `buckled`. \param bound as LoopBound, or null
  void find_extremes(const Eigen::MatrixXd* bound, LoadRatio& ratio);
  /// \param turn of the body in `buckled`, which `find_extremes` has left
  void find_shares(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads, const Vector3& turn,
                   LoadRatio& ratio) const;
  /// As seen from the root.
  [[nodiscard]] PointExpansion seen(const PointExpansion& at) const;

  static std::optional<HeldSection> root_of(const Model& model, std::size_t body);

  std::size_t body_;
  std::optional<HeldSection> root_;  ///< nothing: fields are those of the body's frame
  std::shared_ptr<Own> own_;
  std::vector<Station> stations_;
  std::vector<Loaded> loaded_;
};

}  // namespace withy
