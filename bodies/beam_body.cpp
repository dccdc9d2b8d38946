/// \file
/// The beam: slender, along x of the body frame from `root` (x = 0) to `tip` (x = length); inextensible and without
/// shear where a scene does not ask for them.
///
/// Its strains are linear in the modal coordinates (theory, section 1): κ = (t′, −w″, v″) with deflections v, w along
/// y, z and twist t, and γ = (u′, v_s′, w_s′) with the extension u and what shear adds to the deflections. With the
/// first-order rotation vector θ₁ = (t, −w′, v′) = Σ ψ_i q_i, second-order kinematics follow from R′ = R κ̂,
/// r′ = R (e_x + γ):
///   θ₂ = ½ ∫₀ˣ θ₁ × θ₁′ dσ                    →  Θ_ij = ½ ∫₀ˣ (ψ_i × ψ_j′ + ψ_j × ψ_i′) dσ
///   r₂ = ∫₀ˣ θ₂ × e_x + ½ θ₁ × (θ₁ × e_x) + θ₁ × γ dσ
///     →  Γ_ij = ∫₀ˣ Θ_ij × e_x + ½ (ψ_i × (ψ_j × e_x) + ψ_j × (ψ_i × e_x)) + ψ_i × γ_j + ψ_j × γ_i dσ
/// for the complete second order; another strain kinematics gives other slopes (StrainKinematics). Along x this is the
/// foreshortening −½∫(v′² + w′²) of Padilla & von Flotow, across it the coupling of bending and twist. The sections'
/// inertia is ρI_p about x, and in bending ρI where a scene gives it (Rayleigh's beam). Mass, stiffness and inertias
/// may vary along the beam; the assumed modes are then Ritz functions, K and M their integrals.
#include "beam_body.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <span>

#include "beam_quadrature.hpp"
#include "withy/core/shape/modal_mass.hpp"

namespace withy {
namespace {

/// Values of every coordinate's fields at one x.
struct LinearFields {
  Matrix3X phi, psi, psi_slope, gamma;  ///< Φ; ψ; curvature and twist rate κ = ψ′; elongation γ

  [[nodiscard]] SectionField field(Eigen::Index i) const { return {psi.col(i), psi_slope.col(i), gamma.col(i)}; }
};

/// Θ′, Γ′, Θ and Γ at the nodes of quadrature, a row each: the upper triangles of their three components.
struct SecondFields {
  Eigen::MatrixXd theta_slope, gamma_slope, theta, gamma;
};

/// What a beam's nodes of quadrature have whatever its stiffness and mass are.
struct NodeFields {
  std::shared_ptr<const std::vector<LinearFields>> linear;
  std::shared_ptr<const SecondFields> pairs;
};

/// Fields of the beams that were made last, of any thread, by all that they depend on: a beam that varies in stiffness
/// or mass alone, from case to case of a sweep, is not integrated again.
class LastFields {
 public:
  template <class Make>
  NodeFields of(std::vector<double> key, std::size_t pairs, Make&& make) {
    constexpr std::size_t kept = 8, most_numbers = 1 << 15;
    if (key.size() + pairs > most_numbers) return make();
    const std::lock_guard lock(mutex_);
    const auto same = [&](const std::vector<double>& other) {
      return other.size() == key.size() && std::memcmp(other.data(), key.data(), key.size() * sizeof(double)) == 0;
    };
    auto found = std::find_if(last_.begin(), last_.end(), [&](const auto& entry) { return same(entry.first); });
    if (found == last_.end()) {
      if (last_.size() == kept) last_.pop_back();
      last_.emplace_back(std::move(key), make());
      found = last_.end() - 1;
    }
    std::rotate(last_.begin(), found, found + 1);
    return last_.front().second;
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::vector<double>, NodeFields>> last_;  ///< the youngest first
};

class Beam final : public Body, private Rod {
 public:
  Beam(const BeamMaterial& material, std::vector<BeamStrain> strains, const StrainKinematics& kinematics)
      : material_(material),
        length_(material.length),
        strains_(std::move(strains)),
        quadrature_(material.length, wave_number(strains_), kinks(material, strains_)) {
    shape_.length = length_;
    for (const auto& [axis, inertia] : material.inertias) bending_inertia_ |= axis != Vector3::UnitX();
    for (const BeamStrain& s : strains_) {
      for (std::size_t i = 1; i <= s.functions->count(); ++i) {
        shape_.mode_names.push_back(std::string(s.name) + "[" + std::to_string(i) + "]");
      }
    }
    const NodeFields fields = fields_at_nodes(kinematics);
    pairs_ = fields.pairs;
    const Eigen::Index n = shape_.modes();
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
    // Without modes it is a rigid body, to the last bit the one that a scene would write with ρL and ρL³/12.
    const bool rigid = n == 0 && material.mass_per_length.knots().empty();
    if (rigid) {
      const double mass = material.mass_per_length.mean() * length_, central = mass * (length_ * length_) / 12;
      const PointExpansion middle = PointExpansion::rigid(Vector3(length_ / 2, 0, 0), 0);
      shape_.particles.push_back({mass, middle});
      shape_.sections.push_back({Vector3(0, central, central).asDiagonal(), middle});
    }
    const auto& x = quadrature_.nodes();
    if (!rigid) shape_.particles.reserve(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double w = quadrature_.weights()[k];
      const LinearFields& f = (*fields.linear)[k];
      const double mass = w * material.mass_per_length(x[k]);
      if (!rigid)
        shape_.particles.push_back({mass, expansion(x[k], f, pairs_->gamma.row(static_cast<Eigen::Index>(k)),
                                                    pairs_->theta.row(static_cast<Eigen::Index>(k)))});
      add_products(mass, f.phi, gram);
      add_stiffness(w, f, x[k]);
    }
    if (!material.inertias.empty()) add_sections(gram);
    shape_.damping = material.damping.matrix(shape_.stiffness, gram);
  }

  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    double x = 0;
    if (const auto* text = std::get_if<std::string>(&name)) {
      if (*text == "tip") {
        x = length_;
      } else if (*text != "root") {
        return {};
      }
    } else {
      x = std::get<double>(name);
      if (!(x >= 0 && x <= length_)) return {};
    }
    return expansion(x, linear_fields(x), quadrature_.integral_to(x, pairs_->gamma_slope),
                     quadrature_.integral_to(x, pairs_->theta_slope));
  }
  std::string stations() const override {
    return "root, tip, or a coordinate x from 0 to " + std::to_string(length_) + " m";
  }
  std::shared_ptr<const Body> expanded(const StrainKinematics& kinematics) const override {
    return std::make_shared<const Beam>(material_, strains_, kinematics);
  }
  std::vector<std::string> remarks() const override {
    std::vector<std::string> all = material_.damping.remarks(shape_.modes());
    all.insert(all.end(), material_.remarks.begin(), material_.remarks.end());
    return all;
  }
  std::optional<BodyCut> cut(double x) const override {
    const std::optional<PointExpansion> at = station(x);
    if (!at) return {};
    BodyCut cut;
    cut.at = *at;
    cut.curvature = linear_fields(x).psi_slope;
    for (const BeamStrain& s : strains_) {
      if (s.kind != BeamData::Strain::elongation) cut.stiffness += s.stiffness(x) * s.direction.cwiseAbs();
    }
    if (!(x < length_)) return cut;
    std::vector<double> beyond;
    for (const double kink : kinks(material_, strains_)) {
      if (kink > x && kink < length_) beyond.push_back(kink - x);
    }
    const BeamQuadrature mass(length_ - x, wave_number(strains_), beyond);
    for (std::size_t k = 0; k < mass.nodes().size(); ++k) {
      const double s = x + mass.nodes()[k];
      cut.particles.push_back({mass.weights()[k] * material_.mass_per_length(s), *station(s)});
    }
    const SectionQuadrature along(length_ - x, wave_number(strains_), beyond);
    for (std::size_t k = 0; k < along.nodes().size(); ++k) {
      const double s = x + along.nodes()[k];
      Matrix3 inertia = Matrix3::Zero();
      for (const auto& [axis, per_length] : material_.inertias)
        inertia += along.weights()[k] * per_length(s) * axis * axis.transpose();
      if (!inertia.isZero(0)) cut.sections.push_back({inertia, *station(s)});
    }
    return cut;
  }
  const Rod* rod() const override {
    // The exact rod is inextensible, without rotary inertia in bending, and clamped at x = 0. Shape functions that
    // vanish there leave rounding, at most 1e-12 of a mode's size.
    const LinearFields root = linear_fields(0);
    for (const BeamStrain& s : strains_) {
      if (s.kind == BeamData::Strain::elongation) return nullptr;
    }
    const double moved = root.phi.cwiseAbs().sum() + length_ * root.psi.cwiseAbs().sum();
    return !bending_inertia_ && shape_.modes() > 0 && moved < 1e-9 * static_cast<double>(shape_.modes()) ? this
                                                                                                         : nullptr;
  }

 private:
  Eigen::Index modes() const override { return shape_.modes(); }
  double length() const override { return length_; }
  double wave_number() const override { return wave_number(strains_); }
  std::vector<double> kinks() const override {
    std::vector<double> x = kinks(material_, {});
    std::sort(x.begin(), x.end());
    x.erase(std::unique(x.begin(), x.end()), x.end());
    std::erase_if(x, [this](double at) { return at <= 0 || at >= length_; });
    return x;
  }
  RodSection section(double x) const override {
    LinearFields f = linear_fields(x);
    double inertia = 0;
    for (const auto& [axis, per_length] : material_.inertias) inertia += per_length(x);  // all about x
    return {std::move(f.psi_slope), std::move(f.psi), std::move(f.phi), material_.mass_per_length(x), inertia};
  }

  static double wave_number(const std::vector<BeamStrain>& strains) {
    double beta = 0;
    for (const BeamStrain& s : strains) beta = std::max(beta, s.functions->wave_number());
    return beta;
  }

  static std::vector<double> kinks(const BeamMaterial& material, const std::vector<BeamStrain>& strains) {
    std::vector<double> x = material.mass_per_length.knots();
    const auto add = [&](const Profile& p) {
      const std::vector<double> more = p.knots();
      x.insert(x.end(), more.begin(), more.end());
    };
    for (const auto& [axis, inertia] : material.inertias) add(inertia);
    for (const BeamStrain& s : strains) add(s.stiffness);
    return x;
  }

  LinearFields linear_fields(double x) const {
    const Eigen::Index n = shape_.modes();
    LinearFields f{Matrix3X::Zero(3, n), Matrix3X::Zero(3, n), Matrix3X::Zero(3, n), Matrix3X::Zero(3, n)};
    Eigen::Index at = 0;
    for (const BeamStrain& s : strains_) {
      const std::size_t count = s.functions->count();
      std::vector<double> value(count), slope(count), curvature(count);
      s.functions->evaluate(x, value, slope, curvature);
      for (std::size_t i = 0; i < count; ++i, ++at) {
        switch (s.kind) {
          case BeamData::Strain::bending:
            f.phi.col(at) = s.direction.cross(Vector3::UnitX()) * value[i];
            f.psi.col(at) = s.direction * slope[i];
            f.psi_slope.col(at) = s.direction * curvature[i];
            break;
          case BeamData::Strain::torsion:
            f.psi.col(at) = s.direction * value[i];
            f.psi_slope.col(at) = s.direction * slope[i];
            break;
          case BeamData::Strain::elongation:
            f.phi.col(at) = s.direction * value[i];
            f.gamma.col(at) = s.direction * slope[i];
            break;
        }
      }
    }
    return f;
  }

  /// The sections that have rotary inertia, and what they add to the modal mass.
  void add_sections(Eigen::MatrixXd& gram) {
    const SectionQuadrature along(length_, wave_number(strains_), kinks(material_, strains_));
    for (std::size_t k = 0; k < along.nodes().size(); ++k) {
      const double at = along.nodes()[k];
      Matrix3 inertia = Matrix3::Zero();
      for (const auto& [axis, per_length] : material_.inertias) {
        inertia += along.weights()[k] * per_length(at) * axis * axis.transpose();
      }
      if (inertia.isZero(0)) continue;
      const LinearFields f = linear_fields(at);
      shape_.sections.push_back({inertia, expansion(at, f, quadrature_.integral_to(at, pairs_->gamma_slope),
                                                    quadrature_.integral_to(at, pairs_->theta_slope))});
      add_products(inertia, f.psi, gram);
    }
  }

  /// Integrand of ½ qᵀKq: EI κ², GJ t′², EA u′² or kGA γ², coordinates of different strains being independent.
  void add_stiffness(double weight, const LinearFields& f, double x) {
    Eigen::Index at = 0;
    for (const BeamStrain& s : strains_) {
      const auto count = static_cast<Eigen::Index>(s.functions->count());
      const Matrix3X& strain = s.kind == BeamData::Strain::elongation ? f.gamma : f.psi_slope;
      const double stiffness = s.stiffness(x);
      for (Eigen::Index i = at; i < at + count; ++i) {
        const Vector3 stress = stiffness * strain.col(i);
        for (Eigen::Index j = at; j < at + count; ++j) shape_.stiffness(i, j) += weight * stress.dot(strain.col(j));
      }
      at += count;
    }
  }

  /// The fields at the nodes of the quadrature.
  NodeFields fields_at_nodes(const StrainKinematics& kinematics) const {
    const auto make = [&]() -> NodeFields {
      std::vector<LinearFields> linear;
      linear.reserve(quadrature_.nodes().size());
      for (const double x : quadrature_.nodes()) linear.push_back(linear_fields(x));
      auto pairs = std::make_shared<const SecondFields>(integrated(kinematics, linear));
      return {std::make_shared<const std::vector<LinearFields>>(std::move(linear)), std::move(pairs)};
    };
    if (!kinematics.complete()) return make();
    static LastFields last;
    const auto modes = static_cast<std::size_t>(shape_.modes());
    return last.of(key_of_fields(), quadrature_.nodes().size() * 6 * modes * (modes + 1), make);
  }

  /// All that they depend on: the panels, where their nodes are; of each strain its kind and axis, and its functions.
  std::vector<double> key_of_fields() const {
    std::vector<double> key = quadrature_.nodes();
    key.push_back(length_);
    key.push_back(static_cast<double>(quadrature_.panels()));
    for (const BeamStrain& s : strains_) {
      const std::size_t count = s.functions->count(), first = key.size() + 5;
      key.insert(key.end(), {static_cast<double>(s.kind), s.direction.x(), s.direction.y(), s.direction.z(),
                             static_cast<double>(count)});
      key.resize(first + 3 * count * quadrature_.nodes().size());
      std::span<double> rest = std::span(key).subspan(first);
      for (const double x : quadrature_.nodes()) {
        s.functions->evaluate(x, rest.first(count), rest.subspan(count, count), rest.subspan(2 * count, count));
        rest = rest.subspan(3 * count);
      }
    }
    return key;
  }

  /// Θ and Γ at the nodes by running integrals; a row holds the upper triangles of the three components.
  SecondFields integrated(const StrainKinematics& kinematics, const std::vector<LinearFields>& linear) const {
    SecondFields at;
    const Eigen::Index n = shape_.modes();
    const Eigen::Index pairs = n * (n + 1) / 2;
    const auto nodes = static_cast<Eigen::Index>(quadrature_.nodes().size());
    at.theta_slope.resize(nodes, 3 * pairs);
    at.gamma_slope.resize(nodes, 3 * pairs);
    const auto each_pair = [&](auto&& action) {
      Eigen::Index column = 0;
      for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = i; j < n; ++j, column += 3) action(i, j, column);
      }
    };
    for (Eigen::Index k = 0; k < nodes; ++k) {
      const LinearFields& f = linear[static_cast<std::size_t>(k)];
      each_pair([&](Eigen::Index i, Eigen::Index j, Eigen::Index column) {
        at.theta_slope.block<1, 3>(k, column) = kinematics.rotation_slope(f.field(i), f.field(j)).transpose();
      });
    }
    at.theta = quadrature_.running_integral(at.theta_slope);
    for (Eigen::Index k = 0; k < nodes; ++k) {
      const LinearFields& f = linear[static_cast<std::size_t>(k)];
      each_pair([&](Eigen::Index i, Eigen::Index j, Eigen::Index column) {
        const Vector3 theta = at.theta.block<1, 3>(k, column).transpose();
        at.gamma_slope.block<1, 3>(k, column) =
            kinematics.displacement_slope(f.field(i), f.field(j), theta).transpose();
      });
    }
    at.gamma = quadrature_.running_integral(at.gamma_slope);
    return at;
  }

  using PairFields = Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;

  PointExpansion expansion(double x, const LinearFields& f, const PairFields& gamma, const PairFields& theta) const {
    const Eigen::Index n = shape_.modes();
    PointExpansion e = PointExpansion::rigid(Vector3(x, 0, 0), n);
    e.phi = f.phi;
    e.psi = f.psi;
    Eigen::Index column = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = i; j < n; ++j) {
        for (std::size_t c = 0; c < 3; ++c, ++column) {
          e.gamma[c](i, j) = e.gamma[c](j, i) = gamma[column];
          e.theta[c](i, j) = e.theta[c](j, i) = theta[column];
        }
      }
    }
    return e;
  }

  BeamMaterial material_;
  double length_;
  bool bending_inertia_ = false;
  std::vector<BeamStrain> strains_;
  BeamQuadrature quadrature_;
  ModalShape shape_;
  std::shared_ptr<const SecondFields> pairs_;
};

}  // namespace

std::unique_ptr<Body> make_beam_body(const BeamMaterial& material, std::vector<BeamStrain> strains) {
  return std::make_unique<Beam>(material, std::move(strains), CompleteSecondOrder());
}

}  // namespace withy
