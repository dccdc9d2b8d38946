/// Between the matrices of Standard Input Data and integrals over the mass. With B = ∫ X Φ_kᵀ, D = ∫ Φ_k Φ_lᵀ,
/// P = ∫ X Γ_klᵀ, Q = D + P, axial(M) = (M_yz − M_zy, M_zx − M_xz, M_xy − M_yx), so that ∫ u × v = axial(∫ u vᵀ):
///   J = tr(∫XXᵀ) 1 − ∫XXᵀ,  ∂J/∂q_k = 2 tr(B) 1 − B − Bᵀ,  Cr_k = axial(B),  Gr_k = −2 (Bᵀ − tr(B) 1),
///   ∂Cr_k/∂q_l = axial(D_lk + P_kl),  Ge_kl = 2 axial(D_lk),  ∂Gr_k/∂q_l = −2 (D_kl − tr(D) 1),
///   Oe_k = six(sym(B) − tr(B) 1),  ∂Oe_k/∂q_l = six(sym(Q_kl) − tr(Q) 1).
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "feasible_moments.hpp"
#include "mass_integrals.hpp"

namespace withy {
namespace {

using Six = Eigen::Matrix<double, 6, 1>;

Vector3 axial(const Matrix3& m) { return {m(1, 2) - m(2, 1), m(2, 0) - m(0, 2), m(0, 1) - m(1, 0)}; }

/// The skew matrix with this axial vector: skew part of ∫ u vᵀ from ∫ u × v.
Matrix3 skew_part(const Vector3& a) {
  Matrix3 m;
  m << 0, a[2], -a[1], -a[2], 0, a[0], a[1], -a[0], 0;
  return 0.5 * m;
}
Matrix3 sym(const Matrix3& m) { return 0.5 * (m + m.transpose()); }
Matrix3 less_trace(const Matrix3& m) { return m - m.trace() * Matrix3::Identity(); }
/// M of M − tr(M) 1.
Matrix3 with_trace(const Matrix3& m) { return m - 0.5 * m.trace() * Matrix3::Identity(); }

/// Six-vector of J, and back.
Six six_of_inertia(const Matrix3& m) {
  Six s;
  s << m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2);
  return s;
}
Matrix3 inertia_of_six(const Eigen::MatrixXd& s) {
  Matrix3 m;
  m << s(0), s(3), s(4), s(3), s(1), s(5), s(4), s(5), s(2);
  return m;
}
/// Six-vector of Oe: coefficients of ωx², ωy², ωz², ωxωy, ωyωz, ωxωz in ωᵀ m ω, and back.
Six six_of_form(const Matrix3& m) {
  Six s;
  s << m(0, 0), m(1, 1), m(2, 2), 2 * m(0, 1), 2 * m(1, 2), 2 * m(0, 2);
  return s;
}
Matrix3 form_of_six(const Eigen::MatrixXd& s) {
  Matrix3 m;
  m << s(0), 0.5 * s(3), 0.5 * s(5), 0.5 * s(3), s(1), 0.5 * s(4), 0.5 * s(5), 0.5 * s(4), s(2);
  return m;
}

/// Largest relative difference of two versions of the same numbers.
class Comparison {
 public:
  void add(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    if (a.size() == 0) return;
    difference_ = std::max(difference_, (a - b).cwiseAbs().maxCoeff());
    size_ = std::max({size_, a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()});
  }
  [[nodiscard]] double relative() const { return size_ > 0 ? difference_ / size_ : 0; }

 private:
  double difference_ = 0, size_ = 0;
};

/// Reads Standard Input Data of n modes.
class SidIntegrals {
 public:
  SidIntegrals(const sid::Data& data, SidReport& report) : d_(data), report_(report), n_(data.modes()), out_(n_) {}

  MassIntegrals read() {
    order_zero();
    has_gr1_ = d_.Gr.varies();
    has_oe1_ = d_.Oe.varies();
    report_missing();
    report_inconsistency();
    products();
    second_order();
    return std::move(out_);
  }

 private:
  void order_zero() {
    out_.mass = d_.mass;
    out_.x = d_.mdCM.m0;
    const Matrix3 J = inertia_of_six(d_.J.m0);
    out_.xx = 0.5 * J.trace() * Matrix3::Identity() - J;
    out_.phi = d_.Ct.m0.transpose();
    by_mode_ = columns_by_mode();
    for (Eigen::Index k = 0; k < n_; ++k) {
      const auto mode = static_cast<std::size_t>(k);
      // The symmetric part is in J's first order; in Gr or Oe where there is none.
      Matrix3 B = Matrix3::Zero();
      if (!d_.J.m1.empty()) {
        const Matrix3 J1 = inertia_of_six(d_.J.m1[mode]);
        B = 0.25 * J1.trace() * Matrix3::Identity() - 0.5 * J1;
      } else if (!d_.Oe.absent()) {
        B = with_trace(form_of_six(d_.Oe.m0.row(k)));
      } else if (!d_.Gr.absent()) {
        B = sym(with_trace(-0.5 * columns(d_.Gr.m0, k)));
      }
      out_.x_phi[mode] = B + skew_part(d_.Cr.m0.row(k).transpose());
    }
  }

  /// The three columns of mode k in Gr or Ge.
  [[nodiscard]] Eigen::MatrixXd columns(const Eigen::MatrixXd& m, Eigen::Index k, bool by_mode) const {
    if (by_mode) return m.middleCols(3 * k, 3);
    Eigen::MatrixXd c(m.rows(), 3);
    for (Eigen::Index a = 0; a < 3; ++a) c.col(a) = m.col(a * n_ + k);
    return c;
  }
  [[nodiscard]] Eigen::MatrixXd columns(const Eigen::MatrixXd& m, Eigen::Index k) const {
    return columns(m, k, by_mode_);
  }
  /// Whether the columns of Gr and Ge are ordered by mode, then axis, or the other way round, as some programs have
  /// them: what agrees with Oe. Gr_k = −2 (Bᵀ − tr(B) 1) has the symmetric part −2 Oe_k.
  [[nodiscard]] bool columns_by_mode() const {
    if (d_.Gr.absent() || d_.Oe.absent()) return true;
    double modes_first = 0, axes_first = 0;
    for (Eigen::Index k = 0; k < n_; ++k) {
      const Matrix3 known = -2 * form_of_six(d_.Oe.m0.row(k));
      modes_first += (sym(columns(d_.Gr.m0, k, true)) - known).squaredNorm();
      axes_first += (sym(columns(d_.Gr.m0, k, false)) - known).squaredNorm();
    }
    return modes_first <= axes_first;
  }

  [[nodiscard]] Vector3 cr1(Eigen::Index k, Eigen::Index l) const {
    return d_.Cr.m1.empty() ? Vector3::Zero() : Vector3(d_.Cr.m1[static_cast<std::size_t>(l)].row(k).transpose());
  }
  [[nodiscard]] Vector3 ct1(Eigen::Index k, Eigen::Index l) const {
    return d_.Ct.m1.empty() ? Vector3::Zero() : Vector3(d_.Ct.m1[static_cast<std::size_t>(l)].row(k).transpose());
  }
  /// ∫ Φ_k × Φ_l: from the part of Cr's first order that is skew in k and l, or from Ge.
  [[nodiscard]] Vector3 cross(Eigen::Index k, Eigen::Index l) const {
    if (!d_.Cr.m1.empty()) return 0.5 * (cr1(l, k) - cr1(k, l));
    if (d_.Ge.absent()) return Vector3::Zero();
    return 0.25 * (columns(d_.Ge.m0, k).row(l) - columns(d_.Ge.m0, l).row(k)).transpose();
  }
  [[nodiscard]] Matrix3 oe1(Eigen::Index k, Eigen::Index l) const {
    const auto form = [&](Eigen::Index i, Eigen::Index j) {
      return form_of_six(d_.Oe.m1[static_cast<std::size_t>(j)].row(i));
    };
    return with_trace(0.5 * (form(k, l) + form(l, k)));
  }

  void report_missing() const {
    if (n_ == 0) return;
    auto& missing = report_.missing;
    if (d_.J.m1.empty())
      missing.emplace_back("J has no first order: change of the inertia with the modes is taken from Oe or Gr");
    if (d_.Ct.m1.empty())
      missing.emplace_back("Ct has no first order: no geometric stiffness of translational acceleration and weight");
    if (d_.Cr.m1.empty()) missing.emplace_back("Cr has no first order: no geometric stiffness of angular acceleration");
    if (d_.Cr.m1.empty() && d_.Ge.absent())
      missing.emplace_back("neither Cr's first order nor Ge: no gyroscopic coupling of modes");
    if (!has_oe1_) missing.emplace_back("Oe has no first order: no geometric stiffness of rotation");
    if (!has_gr1_) {
      missing.emplace_back(
          "Gr has no first order: the directions of the modes' kinetic energy are not determined; "
          "the formulation 'inconsistent' depends on them");
    }
  }

  void report_inconsistency() const {
    Comparison both;
    if (!d_.mdCM.m1.empty()) {
      for (Eigen::Index k = 0; k < n_; ++k) {
        both.add(d_.mdCM.m1[static_cast<std::size_t>(k)], d_.Ct.m0.row(k).transpose());
      }
    }
    double worst = both.relative();
    both = {};
    for (Eigen::Index k = 0; k < n_; ++k) {
      const Matrix3& B = out_.x_phi[static_cast<std::size_t>(k)];
      if (!d_.Gr.absent()) both.add(columns(d_.Gr.m0, k), -2 * less_trace(B.transpose()));
      if (!d_.Oe.absent()) both.add(d_.Oe.m0.row(k), six_of_form(less_trace(sym(B))).transpose());
    }
    worst = std::max(worst, both.relative());
    both = {};
    for (Eigen::Index k = 0; k < n_ && !d_.Ge.absent(); ++k) {
      for (Eigen::Index l = 0; l < n_; ++l) both.add(columns(d_.Ge.m0, l).row(k), 2 * cross(l, k).transpose());
    }
    // Relative to the size of the modal mass: Ge may be nothing but rounding.
    if (n_ > 0) both.add(d_.Me.m0.diagonal(), d_.Me.m0.diagonal());
    report_.inconsistency = std::max(worst, both.relative());
  }

  /// D: its trace is Me, its skew part ∫ Φ_k × Φ_l; the rest as near as possible to Gr's first order, or to Oe's with
  /// Γ along the body's extent; without either, to the motion of the nodes.
  void products() {
    const Matrix3 along = extent();
    const std::vector<Matrix3> directions = node_directions();
    for (Eigen::Index k = 0; k < n_; ++k) {
      for (Eigen::Index l = 0; l < n_; ++l) {
        const double me = 0.5 * (d_.Me.m0(k, l) + d_.Me.m0(l, k));
        Matrix3 S = Matrix3::Zero();
        if (has_gr1_) {
          const auto block = [&](Eigen::Index i, Eigen::Index j) {
            return Matrix3(columns(d_.Gr.m1[static_cast<std::size_t>(j)], i));
          };
          const Matrix3 D = with_trace(-0.5 * block(k, l));
          const Matrix3 Dt = with_trace(-0.5 * block(l, k)).transpose();
          S = sym(0.5 * (D + Dt));
          S += (me - S.trace()) / 3 * Matrix3::Identity();
        } else if (has_oe1_) {
          S = oe1(k, l);
          S += (me - S.trace()) / along.trace() * along;
        } else {
          S = sym(directions[out_.pair(k, l)]) * std::sqrt(d_.Me.m0(k, k) * d_.Me.m0(l, l));
          S += (me - S.trace()) / 2 * (directions[out_.pair(k, k)] + directions[out_.pair(l, l)]);
        }
        out_.phi_phi[out_.pair(k, l)] = S + skew_part(cross(k, l));
      }
    }
    report_.defect = std::max(report_.defect, make_feasible(out_));
  }

  /// Σ Φ_k Φ_lᵀ over the nodes, scaled to traces of 1 for k = l; isotropic for modes that no node takes part in.
  [[nodiscard]] std::vector<Matrix3> node_directions() const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(n_);
    for (const sid::Node& node : d_.nodes) squares += node.phi.m0.colwise().squaredNorm().transpose();
    std::vector<Matrix3> all(static_cast<std::size_t>(n_ * n_), Matrix3::Zero());
    for (Eigen::Index k = 0; k < n_; ++k) {
      if (squares[k] == 0) all[out_.pair(k, k)] = Matrix3::Identity() / 3;
      for (Eigen::Index l = 0; l < n_; ++l) {
        if (squares[k] == 0 || squares[l] == 0) continue;
        for (const sid::Node& node : d_.nodes) {
          all[out_.pair(k, l)] +=
              node.phi.m0.col(k) * node.phi.m0.col(l).transpose() / std::sqrt(squares[k] * squares[l]);
        }
      }
    }
    return all;
  }

  /// Projector on the directions in which the body extends.
  [[nodiscard]] Matrix3 extent() const {
    const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(out_.xx - out_.x * out_.x.transpose() / out_.mass);
    Matrix3 P = Matrix3::Zero();
    for (Eigen::Index a = 0; a < 3; ++a) {
      if (eigen.eigenvalues()[a] > 1e-9 * eigen.eigenvalues()[2]) {
        P += eigen.eigenvectors().col(a) * eigen.eigenvectors().col(a).transpose();
      }
    }
    return P.trace() > 0 ? P : Matrix3::Identity();
  }

  void second_order() {
    for (Eigen::Index k = 0; k < n_; ++k) {
      for (Eigen::Index l = 0; l < n_; ++l) {
        const std::size_t at = out_.pair(k, l);
        out_.gamma[at] = 0.5 * (ct1(k, l) + ct1(l, k));
        const Matrix3 Q = has_oe1_ ? oe1(k, l) : sym(out_.phi_phi[at]);
        out_.x_gamma[at] = Q - sym(out_.phi_phi[at]) + skew_part(0.5 * (cr1(k, l) + cr1(l, k)));
      }
    }
  }

  const sid::Data& d_;
  SidReport& report_;
  Eigen::Index n_;
  MassIntegrals out_;
  bool has_gr1_ = false, has_oe1_ = false, by_mode_ = true;
};

}  // namespace

MassIntegrals integrals_of(const sid::Data& data, SidReport& report) { return SidIntegrals(data, report).read(); }

void put_integrals(const MassIntegrals& m, sid::Data& data) {
  const Eigen::Index n = m.modes();
  const auto count = static_cast<std::size_t>(n);
  data.mass = m.mass;
  data.mdCM = {m.x, {}};
  data.J = {six_of_inertia(-less_trace(m.xx)), {}};
  data.Ct = {m.phi.transpose(), std::vector<Eigen::MatrixXd>(count, Eigen::MatrixXd::Zero(n, 3))};
  data.Cr = {Eigen::MatrixXd::Zero(n, 3), data.Ct.m1};
  data.Me = {Eigen::MatrixXd::Zero(n, n), {}};
  data.Gr = {Eigen::MatrixXd::Zero(3, 3 * n), std::vector<Eigen::MatrixXd>(count, Eigen::MatrixXd::Zero(3, 3 * n))};
  data.Ge = {Eigen::MatrixXd::Zero(n, 3 * n), {}};
  data.Oe = {Eigen::MatrixXd::Zero(n, 6), std::vector<Eigen::MatrixXd>(count, Eigen::MatrixXd::Zero(n, 6))};
  for (Eigen::Index k = 0; k < n; ++k) {
    const Matrix3& B = m.x_phi[static_cast<std::size_t>(k)];
    data.mdCM.m1.emplace_back(m.phi.col(k));
    data.J.m1.emplace_back(six_of_inertia(-2 * less_trace(sym(B))));
    data.Cr.m0.row(k) = axial(B).transpose();
    data.Gr.m0.middleCols(3 * k, 3) = -2 * less_trace(B.transpose());
    data.Oe.m0.row(k) = six_of_form(less_trace(sym(B))).transpose();
    for (Eigen::Index l = 0; l < n; ++l) {
      const auto mode = static_cast<std::size_t>(l);
      const Matrix3& D = m.phi_phi[m.pair(k, l)];
      const Matrix3& P = m.x_gamma[m.pair(k, l)];
      data.Me.m0(k, l) = D.trace();
      data.Ge.m0.block<1, 3>(k, 3 * l) = -2 * axial(D).transpose();
      data.Ct.m1[mode].row(k) = m.gamma[m.pair(k, l)].transpose();
      data.Cr.m1[mode].row(k) = (axial(P) - axial(D)).transpose();
      data.Gr.m1[mode].middleCols(3 * k, 3) = -2 * less_trace(D);
      data.Oe.m1[mode].row(k) = six_of_form(less_trace(sym(D + P))).transpose();
    }
  }
}

}  // namespace withy
