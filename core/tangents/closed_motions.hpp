/// \file
/// Small motions that keep closed loops closed: some speeds follow the others.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

class ClosedLoops;

/// Of a model whose loops are at rest in themselves, u = 0 on what changes their shape; what carries them may move.
/// With J u = 0 of the closing equations, J = (J_i, J_d) of speeds i that move by themselves and d that follow,
///   u = Z u_i,   Z = (1, −J_d⁺ J_i),
/// and with the residual r of the tree and the multipliers λ of J_dᵀ λ = r_d the equations of motion are Zᵀ r = 0.
/// Their derivative along Z δ is Zᵀ (∂r/∂x − ∂(Jᵀλ)/∂x + M ∂(Z a)/∂x) Z with λ and a constant: what Zᵀ changes by meets
/// (r − Jᵀλ)_d = 0. At rest J̇ u and its derivatives vanish. Of redundant equations any λ will do: JᵀΔλ = 0 wherever
/// loops are closed.
class ClosedMotions {
 public:
  /// Chooses what follows at a state: of the speeds that change the shape of a loop and are not held as many as there
  /// are independent equations. By themselves move, one after the other, modes and then hinges, the first of the model
  /// that moves by a notable share of what moves most in what is left of the motions.
  /// \param model with loops, which outlives the object \param equations of such a model (ClosedLoops)
  /// \param held one a speed
  ClosedMotions(const Model& model, std::shared_ptr<const EquationsOfMotion> equations, const State& state,
                const std::vector<bool>& held);

  /// One a speed.
  [[nodiscard]] const std::vector<bool>& follows() const { return follows_; }

  /// The loops at a state.
  struct At {
    Eigen::MatrixXd J;  ///< equations × speeds [m/rad, 1]
    /// Speeds × speeds, columns of those that follow zero; not finite where those cannot close the loops,
    /// or nearly turn back.
    Eigen::MatrixXd Z;
  };
  [[nodiscard]] At at(std::span<const double> y) const;
  /// λ of least Σ λ² [N]. \param residual of the tree, M a − f − τ
  [[nodiscard]] Eigen::VectorXd multipliers(const At& at, const Eigen::VectorXd& residual) const;
  /// Derivatives along the columns of Z, speeds × speeds, by central differences of eighth order.
  struct Changes {
    Eigen::MatrixXd efforts;        ///< of Jᵀλ, λ constant
    Eigen::MatrixXd accelerations;  ///< of Z a, a constant
  };
  /// \param accelerations Z a
  [[nodiscard]] Changes changes(std::span<const double> y, const At& at, const Eigen::VectorXd& multipliers,
                                const Eigen::VectorXd& accelerations) const;
  /// Moves y by δ and what follows with it, so far at a time that it does not come to another way of closing the loops.
  /// Where the loops cannot be closed on the way, or it is too long, y is not finite. \param delta of all speeds; those
  /// of what follows do not count
  void displace(std::span<double> y, const Eigen::VectorXd& delta) const;
  /// Whether more equations are independent beside a state than at it, or the loops cannot be closed there: the motions
  /// about it are not those of a few speeds.
  [[nodiscard]] bool singular(std::span<const double> y) const;

 private:
  struct Seen {
    Eigen::VectorXd gaps;
    Eigen::MatrixXd J;
  };
  [[nodiscard]] Seen see(std::span<const double> y) const;
  void choose(const Eigen::MatrixXd& J, const std::vector<bool>& held);
  /// Moves what follows until the loops are closed. \returns whether that is near by
  bool close(std::span<double> y) const;
  /// How far displacements move anything of the loops, turns counted in lengths of these [m].
  [[nodiscard]] double reach(const Eigen::VectorXd& delta) const;
  /// Independent closing equations.
  [[nodiscard]] Eigen::Index rank(Eigen::MatrixXd J) const;

  const Model& model_;
  std::shared_ptr<const EquationsOfMotion> equations_;
  const ClosedLoops& loops_;
  double length_;                ///< of the loops, as length_of_loops
  std::vector<double> reaches_;  ///< reaches_of_speeds
  std::vector<bool> in_loops_, follows_;
  std::vector<Eigen::Index> followers_, others_;
  std::vector<Eigen::Index> moving_;  ///< of the others those that are not held and change the shape of a loop
};

}  // namespace withy
