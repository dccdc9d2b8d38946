#include "reduce.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "interior.hpp"
#include "rounding.hpp"
#include "sections.hpp"

namespace withy::fem {
namespace {

using Triplet = Eigen::Triplet<double>;

constexpr double two_pi = 2 * std::numbers::pi;
/// Greatest relative error of a frequency by rounding of the stiffness.
constexpr double tolerated_error = 0.01;

/// The scalar mass matrix of M = m ⊗ 1₃, as elements without rotations have.
SparseMatrix node_mass_of(const SparseMatrix& M) {
  std::vector<Triplet> triplets;
  for (Eigen::Index column = 0; column < M.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(M, column); it; ++it) {
      if (it.row() % 3 == 0 && it.col() % 3 == 0) triplets.emplace_back(it.row() / 3, it.col() / 3, it.value());
    }
  }
  SparseMatrix m(M.rows() / 3, M.rows() / 3);
  m.setFromTriplets(triplets.begin(), triplets.end());
  std::vector<Triplet> thrice;
  for (const Triplet& t : triplets) {
    for (int c = 0; c < 3; ++c) thrice.emplace_back(3 * t.row() + c, 3 * t.col() + c, t.value());
  }
  SparseMatrix whole(M.rows(), M.rows());
  whole.setFromTriplets(thrice.begin(), thrice.end());
  if ((M - whole).norm() > 1e-8 * M.norm())
    throw InputError("the mass matrix differs between the axes or couples them; need a mesh of solid elements");
  return m;
}

class Reducer {
 public:
  Reducer(const Matrices& matrices, const ReductionOptions& options) : m_(matrices), options_(options) {}

  Reduction run() {
    body_.node_mass = node_mass_of(m_.M);
    place_origin();
    classify();
    check_free();
    coordinates_of_interfaces();
    solve();
    add_nodes();
    return std::move(body_);
  }

 private:
  void place_origin() {
    const Section root = section_of(options_.root, m_);
    if (!root.rigid()) throw InputError("the root needs three nodes or more that are not in a line: they are clamped");
    body_.origin = root.centre;
    body_.X = m_.X.colwise() - body_.origin;
  }

  /// Every row is clamped (−1), interior (0), or of an interface (1).
  void classify() {
    kind_.assign(static_cast<std::size_t>(m_.K.rows()), 0);
    const auto mark = [&](const std::vector<long>& nodes, int kind, const std::string& name) {
      for (const Eigen::Index a : section_of(nodes, m_).rows) {
        for (Eigen::Index c = 0; c < 3; ++c) {
          int& k = kind_[static_cast<std::size_t>(3 * a + c)];
          if (k != 0)
            throw InputError(fmt::format("node {} of {} is in the root or another interface too",
                                         m_.nodes[static_cast<std::size_t>(a)], name));
          k = kind;
        }
      }
    };
    mark(options_.root, -1, "the root");
    for (const Interface& interface : options_.interfaces) {
      mark(interface.nodes, 1, interface.name);
      if (interface.nodes.size() > 1 && !section_of(interface.nodes, m_).rigid())
        throw InputError(
            fmt::format("interface {} needs one node, or three or more that are not in a line", interface.name));
    }
    for (std::size_t i = 0; i < kind_.size(); ++i) {
      if (kind_[i] >= 0) body_.free.push_back(static_cast<Eigen::Index>(i));
      if (kind_[i] != 0) continue;
      interior_.push_back(static_cast<Eigen::Index>(i));
    }
  }

  /// A free mesh has no stiffness against rigid motions.
  void check_free() const {
    Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(m_.K.rows(), 6);
    const double size = body_.X.colwise().norm().maxCoeff();
    for (Eigen::Index a = 0; a < body_.X.cols(); ++a) {
      rigid.block<3, 3>(3 * a, 0).setIdentity();
      rigid.block<3, 3>(3 * a, 3) = -skew<double>(Vector3(body_.X.col(a) / size));
    }
    const double scale = m_.K.diagonal().cwiseAbs().maxCoeff();
    const double stiff = (m_.K * rigid).cwiseAbs().maxCoeff() / scale;
    if (!(stiff < 1e-5))
      throw InputError(
          fmt::format("rigid motions of the mesh meet {:.1g} of its greatest stiffness; need the stiffness "
                      "of the free mesh, in the axes and units of the node positions",
                      stiff));
  }

  /// The rows of the interfaces as functions of their own coordinates b: three of a node, or translation and rotation
  /// of a rigid section.
  void coordinates_of_interfaces() {
    Eigen::Index count = 0;
    for (const Interface& i : options_.interfaces) count += i.nodes.size() == 1 ? 3 : 6;
    std::vector<Triplet> triplets;
    Eigen::Index first = 0;
    for (const Interface& interface : options_.interfaces) {
      const Section section = section_of(interface.nodes, m_);
      for (std::size_t s = 0; s < section.rows.size(); ++s) {
        const Eigen::Index a = section.rows[s];
        const Matrix3 turn = -skew<double>(Vector3(section.arms.col(static_cast<Eigen::Index>(s))));
        for (int c = 0; c < 3; ++c) {
          triplets.emplace_back(3 * a + c, first + c, 1.0);
          for (int k = 0; section.rigid() && k < 3; ++k) triplets.emplace_back(3 * a + c, first + 3 + k, turn(c, k));
        }
      }
      first += section.rigid() ? 6 : 3;
    }
    rigid_.resize(m_.K.rows(), count);
    rigid_.setFromTriplets(triplets.begin(), triplets.end());
  }

  /// Constraint modes, what the mesh does under motions of the interfaces, and its modes with the interfaces held.
  void solve() {
    const auto shared = std::make_shared<const Interior>(m_.K, m_.M, interior_);
    const Interior& interior = *shared;
    Interior::Modes held = interior.modes(options_.modes);
    body_.fixed_frequencies = std::move(held.frequencies);
    if (rigid_.cols() + held.shapes.cols() == 0)
      throw InputError("got no modes and no interface: that is a rigid body");
    const Eigen::MatrixXd moved = rigid_;
    const Eigen::MatrixXd constraint = moved - interior.response(m_.K * moved);
    Eigen::MatrixXd V(m_.K.rows(), constraint.cols() + held.shapes.cols());
    V << constraint, held.shapes;
    take_modes(V);
    respond(interior, constraint);
    body_.statics = [shared, constraint, K = Eigen::MatrixXd(constraint.transpose() * (m_.K * constraint))](
                        const Eigen::MatrixXd& forces) -> Eigen::MatrixXd {
      Eigen::MatrixXd u = shared->response(forces);
      if (constraint.cols() > 0) u += constraint * K.ldlt().solve(constraint.transpose() * forces);
      return u;
    };
  }

  /// Statics of the mesh under the unit loads. Motions of the interior alone and constraint modes are orthogonal in K.
  void respond(const Interior& interior, const Eigen::MatrixXd& constraint) {
    const Eigen::Index held = constraint.cols();
    const Eigen::Index stations = 3 * static_cast<Eigen::Index>(options_.stations.size());
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(m_.K.rows(), inertial_loads + held + stations);
    const Eigen::VectorXd mass = body_.node_mass * Eigen::VectorXd::Ones(body_.X.cols());
    const Eigen::MatrixXd weighted = body_.node_mass * body_.X.transpose();
    for (Eigen::Index a = 0; a < body_.X.cols(); ++a) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        forces(3 * a + c, c) = mass[a];
        for (Eigen::Index i = 0; i < 3; ++i) forces(3 * a + c, 3 + 3 * i + c) = weighted(a, i);
      }
    }
    Eigen::Index column = inertial_loads + held;
    for (const Interface& station : options_.stations) {
      const Eigen::Index a = section_of(station.nodes, m_).rows[0];
      for (Eigen::Index c = 0; c < 3; ++c) forces(3 * a + c, column++) = 1;
    }
    body_.loaded = interior.response(forces);
    if (held > 0) {
      Eigen::MatrixXd on_interfaces = constraint.transpose() * forces;
      on_interfaces.middleCols(inertial_loads, held).setIdentity();
      const Eigen::MatrixXd K = constraint.transpose() * (m_.K * constraint);
      body_.loaded += constraint * K.ldlt().solve(on_interfaces);
    }
    // Motions of clamped rows are none.
    body_.held = m_.K * body_.loaded - forces;
  }

  /// Eigenvectors of the reduced body, of unit modal mass, their largest element positive.
  void take_modes(const Eigen::MatrixXd& V) {
    const auto reduced = [&V](const SparseMatrix& whole) -> Eigen::MatrixXd {
      const Eigen::MatrixXd A = V.transpose() * (whole * V);
      return 0.5 * (A + A.transpose());
    };
    const Eigen::MatrixXd K = reduced(m_.K), M = reduced(m_.M);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(K, M);
    if (eigen.info() != Eigen::Success) throw InputError("the reduced body has no positive definite mass");
    if (!(eigen.eigenvalues()[0] > 0))
      throw InputError(fmt::format(
          "the reduced body has no positive definite stiffness: need the stiffness with more digits than its about {}, "
          "or a beam where the part is so slender",
          digits_of(rounding_unit(m_.K))));
    const Eigen::VectorXd omega = eigen.eigenvalues().cwiseSqrt();
    Eigen::Index kept = omega.size();
    while (options_.highest > 0 && kept > 0 && omega[kept - 1] > two_pi * options_.highest) --kept;
    for (Eigen::Index k = kept; k < omega.size(); ++k) body_.dropped_frequencies.push_back(omega[k] / two_pi);
    if (kept == 0)
      throw InputError(
          fmt::format("every mode is above {} Hz; the lowest has {:.4g} Hz", options_.highest, omega[0] / two_pi));
    Eigen::MatrixXd turn = eigen.eigenvectors().leftCols(kept);
    body_.modes = V * turn;
    for (Eigen::Index k = 0; k < kept; ++k) {
      Eigen::Index most = 0;
      body_.modes.col(k).cwiseAbs().maxCoeff(&most);
      if (body_.modes(most, k) > 0) continue;
      body_.modes.col(k) *= -1;
      turn.col(k) *= -1;
    }
    body_.omega = omega.head(kept);
    check_rounding();
    turn_ = turn.topRows(rigid_.cols());
  }

  /// A frequency is told only where it is known.
  void check_rounding() {
    const Rounding rounding = rounding_of(m_, body_.modes, body_.omega);
    body_.frequency_errors = rounding.frequency_error;
    for (Eigen::Index k = 0; k < body_.omega.size(); ++k) {
      const double error = rounding.frequency_error[k];
      if (error < tolerated_error) continue;
      throw InputError(fmt::format(
          "the frequency of mode {}, {:.4g} Hz, is {}: rigid motions of the mesh's parts, which a free mesh does not "
          "resist, or motions that its elements do not resist, have stiffness, as of numbers with about {} digits; "
          "need the stiffness with more digits and without supports, or a beam where the part is so slender",
          k + 1, body_.frequency(k), error < 1 ? fmt::format("known to {:.2g} % alone", 100 * error) : "not known",
          digits_of(rounding.unit)));
    }
  }

  void add_nodes() {
    const Eigen::Index n = body_.modes.cols();
    const auto node = [&](const std::string& id, const Vector3& X) -> sid::Node& {
      for (const sid::Node& other : body_.nodes) {
        if (other.id == id) throw InputError(fmt::format("two nodes are named '{}'", id));
      }
      sid::Node& fresh = body_.nodes.emplace_back();
      fresh.id = id;
      fresh.origin.m0 = X - body_.origin;
      fresh.phi.m0 = fresh.psi.m0 = Eigen::MatrixXd::Zero(3, n);
      fresh.axes.m0 = Matrix3::Identity();
      return fresh;
    };
    node("base", body_.origin);
    Eigen::Index first = 0;
    for (const Interface& interface : options_.interfaces) {
      sid::Node& at = node(interface.name, section_of(interface.nodes, m_).centre);
      at.phi.m0 = turn_.middleRows(first, 3);
      if (interface.nodes.size() > 1) at.psi.m0 = turn_.middleRows(first + 3, 3);
      first += interface.nodes.size() > 1 ? 6 : 3;
    }
    for (const Interface& station : options_.stations) {
      if (station.nodes.size() != 1) throw InputError(fmt::format("station {} needs one node", station.name));
      const Section at = section_of(station.nodes, m_);
      node(station.name, at.centre).phi.m0 = body_.modes.middleRows(3 * at.rows[0], 3);
    }
  }

  const Matrices& m_;
  const ReductionOptions& options_;
  Reduction body_;
  std::vector<int> kind_;
  std::vector<Eigen::Index> interior_;  ///< rows of K
  SparseMatrix rigid_;                  ///< 3N × coordinates of the interfaces
  Eigen::MatrixXd turn_;                ///< coordinates of the interfaces × modes
};

}  // namespace

Reduction reduce(const Matrices& matrices, const ReductionOptions& options) { return Reducer(matrices, options).run(); }

}  // namespace withy::fem
