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
/// may vary along the beam; the assumed modes are then Ritz functions, K and M their integrals. Of a twisted beam the
/// sections' axes are turned by β(x) about x, stiffness and inertia are T C_s Tᵀ with T the turn, and bending in the
/// two planes is coupled; the axis is straight, and strains are resolved in axes that do not turn.
#include "beam_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "beam_fields.hpp"
#include "place_on_body.hpp"
#include "withy/core/plugin/turned_sections.hpp"
#include "withy/core/shape/modal_mass.hpp"

namespace withy {
namespace {

class Beam final : public Body, public TurnedSections, private Rod {
 public:
  Beam(const BeamMaterial& material, std::vector<BeamStrain> strains, const StrainKinematics& kinematics)
      : material_(material),
        length_(material.length),
        strains_(std::move(strains)),
        quadrature_(material.length, phase(material, strains_), kinks(material, strains_)) {
    shape_.length = length_;
    for (const BeamStrain& s : strains_) {
      for (std::size_t i = 1; i <= s.functions->count(); ++i) {
        shape_.mode_names.push_back(std::string(s.name) + "[" + std::to_string(i) + "]");
      }
    }
    const NodeFields fields = fields_at_nodes(strains_, length_, quadrature_, kinematics);
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
    if (!rigid) begin_points(fields);
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double w = quadrature_.weights()[k];
      const LinearFields& f = (*fields.linear)[k];
      const double mass = w * material.mass_per_length(x[k]);
      if (!rigid) shape_.particles[k].mass = mass;
      add_products(mass, f.phi, gram);
      if (material.twist) {
        add_products(w * turned(own_bending(x[k]), x[k]), f.psi_slope, shape_.stiffness);
        add_products(w * turned(own_elongation(x[k]), x[k]), f.gamma, shape_.stiffness);
      } else {
        add_stiffness(w, f, x[k]);
      }
    }
    if (!material.inertias.empty()) add_sections(gram);
    shape_.damping = material.damping.matrix(shape_.stiffness, gram);
  }

  ~Beam() override {
    if (points_ != nullptr) points_->give_back(std::move(shape_.particles));
  }
  Beam(const Beam&) = delete;
  Beam& operator=(const Beam&) = delete;

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
      const std::optional<double> at = place_on_body(std::get<double>(name), 0, length_);
      if (!at) return {};
      x = *at;
    }
    return expansion_at(x, linear_fields(strains_, x));
  }
  std::string stations() const override { return fmt::format("root, tip, or a coordinate x from 0 to {} m", length_); }
  std::shared_ptr<const Body> expanded(const StrainKinematics& kinematics) const override {
    return std::make_shared<const Beam>(material_, strains_, kinematics);
  }
  std::vector<std::string> remarks() const override {
    std::vector<std::string> all = material_.damping.remarks(shape_.modes());
    all.insert(all.end(), material_.remarks.begin(), material_.remarks.end());
    return all;
  }
  std::optional<BodyCut> cut(double place) const override {
    const std::optional<double> on = place_on_body(place, 0, length_);
    if (!on) return {};
    const double x = *on;
    BodyCut cut;
    cut.at = *station(x);
    cut.curvature = linear_fields(strains_, x).psi_slope;
    cut.stiffness = turned(own_bending(x), x);
    if (!(x < length_)) return cut;
    std::vector<double> beyond;
    for (const double kink : kinks(material_, strains_)) {
      if (kink > x && kink < length_) beyond.push_back(kink - x);
    }
    const BeamQuadrature mass(length_ - x, phase(material_, strains_, x), beyond);
    for (std::size_t k = 0; k < mass.nodes().size(); ++k) {
      const double s = x + mass.nodes()[k];
      cut.particles.push_back({mass.weights()[k] * material_.mass_per_length(s), *station(s)});
    }
    const SectionQuadrature along(length_ - x, phase(material_, strains_, x), beyond);
    for (std::size_t k = 0; k < along.nodes().size(); ++k) {
      const double s = x + along.nodes()[k];
      const Matrix3 inertia = section_inertia(along.weights()[k], s);
      if (!inertia.isZero(0)) cut.sections.push_back({inertia, *station(s)});
    }
    return cut;
  }
  Matrix3 section_axes(double x) const override {
    if (!material_.twist) return Matrix3::Identity();
    const double beta = material_.twist->angle(x), c = std::cos(beta), s = std::sin(beta);
    Matrix3 axes;
    axes << 1, 0, 0, 0, c, -s, 0, s, c;
    return axes;
  }
  /// About the sections' axes x, y_s, z_s, then along them.
  std::vector<Eigen::MatrixXd> stiffness_by_strain() const override {
    const Eigen::Index n = shape_.modes();
    std::vector<Eigen::MatrixXd> parts(6, Eigen::MatrixXd::Zero(n, n));
    const auto& x = quadrature_.nodes();
    for (std::size_t k = 0; k < x.size(); ++k) {
      const LinearFields f = linear_fields(strains_, x[k]);
      const Vector3 bending = own_bending(x[k]), elongation = own_elongation(x[k]);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const auto part = static_cast<std::size_t>(axis);
        const Matrix3 along = turned(quadrature_.weights()[k] * Vector3::Unit(axis), x[k]);
        if (bending[axis] > 0) add_products(bending[axis] * along, f.psi_slope, parts[part]);
        if (elongation[axis] > 0) add_products(elongation[axis] * along, f.gamma, parts[3 + part]);
      }
    }
    return parts;
  }
  const Rod* rod() const override { return shape_.modes() > 0 ? this : nullptr; }

 private:
  [[nodiscard]] PointExpansion expansion_at(double x, const LinearFields& f) const {
    const auto weights = quadrature_.weights_to(x);
    return expansion(x, f, weights * pairs_->gamma_slope, weights * pairs_->theta_slope);
  }
  Eigen::Index modes() const override { return shape_.modes(); }
  double length() const override { return length_; }
  double wave_number() const override { return of_strains(strains_); }
  std::vector<double> kinks() const override { return inside(of_functions(strains_)); }
  std::vector<double> mass_kinks() const override { return inside(kinks(material_, {})); }
  RodSection section(double x) const override {
    LinearFields f = linear_fields(strains_, x);
    const bool stretches = std::any_of(strains_.begin(), strains_.end(),
                                       [](const BeamStrain& s) { return s.kind == BeamData::Strain::elongation; });
    return {std::move(f.psi_slope),       std::move(f.psi),      std::move(f.phi),
            material_.mass_per_length(x), section_inertia(1, x), stretches ? std::move(f.gamma) : Matrix3X()};
  }

  static double of_strains(const std::vector<BeamStrain>& strains) {
    double beta = 0;
    for (const BeamStrain& s : strains) beta = std::max(beta, s.functions->wave_number());
    return beta;
  }
  /// Of functions whose products are integrated: stiffness and inertia of a twisted beam go like cos 2β, and β is
  /// linear between kinks. What turns in one piece is of that piece alone: a jump has a short one.
  /// \param root  where their x begins on the beam [m]
  static PhaseBetween phase(const BeamMaterial& material, const std::vector<BeamStrain>& strains, double root = 0) {
    const double waves = of_strains(strains);
    if (!material.twist) return [waves](double from, double to) { return waves * (to - from); };
    return [waves, root, &angle = material.twist->angle](double from, double to) {
      return waves * (to - from) + std::abs(angle(root + to) - angle(root + from));
    };
  }

  /// Points inside the beam, increasing.
  [[nodiscard]] std::vector<double> inside(std::vector<double> x) const {
    std::sort(x.begin(), x.end());
    x.erase(std::unique(x.begin(), x.end()), x.end());
    std::erase_if(x, [this](double at) { return at <= 0 || at >= length_; });
    return x;
  }
  static std::vector<double> of_functions(const std::vector<BeamStrain>& strains) {
    std::vector<double> x;
    for (const BeamStrain& s : strains) {
      const std::vector<double> more = s.functions->kinks();
      x.insert(x.end(), more.begin(), more.end());
    }
    return x;
  }
  static std::vector<double> kinks(const BeamMaterial& material, const std::vector<BeamStrain>& strains) {
    std::vector<double> x = of_functions(strains);
    const std::vector<double> masses = material.mass_per_length.knots();
    x.insert(x.end(), masses.begin(), masses.end());
    const auto add = [&](const Profile& p) {
      const std::vector<double> more = p.knots();
      x.insert(x.end(), more.begin(), more.end());
    };
    for (const auto& [axis, inertia] : material.inertias) add(inertia);
    for (const BeamStrain& s : strains) add(s.stiffness);
    if (!material.twist) return x;
    const BeamTwist& t = *material.twist;
    if (!strains.empty() || !material.inertias.empty()) add(t.angle);
    if (strains.empty()) return x;
    for (const Profile* p : {&t.EI_y, &t.EI_z, &t.shear_y, &t.shear_z}) add(*p);
    return x;
  }

  /// C of the section at x, given about its own axes, in those of the body.
  [[nodiscard]] Matrix3 turned(const Vector3& own, double x) const {
    if (!material_.twist) return own.asDiagonal();
    const Matrix3 T = section_axes(x);
    return T * own.asDiagonal() * T.transpose();
  }
  /// GJ, EI_y, EI_z at x [N m²] about the section's own axes, zero where the body has no such strain.
  [[nodiscard]] Vector3 own_bending(double x) const {
    Vector3 own = Vector3::Zero();
    for (const BeamStrain& s : strains_)
      if (s.kind != BeamData::Strain::elongation) own += s.stiffness(x) * s.direction.cwiseAbs();
    if (const std::optional<BeamTwist>& t = material_.twist) own.tail<2>() << t->EI_y(x), t->EI_z(x);
    return own;
  }
  /// EA, kGA_y, kGA_z at x [N] likewise.
  [[nodiscard]] Vector3 own_elongation(double x) const {
    Vector3 own = Vector3::Zero();
    for (const BeamStrain& s : strains_)
      if (s.kind == BeamData::Strain::elongation) own += s.stiffness(x) * s.direction;
    if (const std::optional<BeamTwist>& t = material_.twist) own.tail<2>() << t->shear_y(x), t->shear_z(x);
    return own;
  }
  /// Rotary inertia of a length at x [kg m²].
  [[nodiscard]] Matrix3 section_inertia(double piece, double x) const {
    Matrix3 own = Matrix3::Zero();
    for (const auto& [axis, per_length] : material_.inertias) own += piece * per_length(x) * axis * axis.transpose();
    if (!material_.twist) return own;
    const Matrix3 T = section_axes(x);
    return T * own * T.transpose();
  }

  /// The sections that have rotary inertia, and what they add to the modal mass.
  void add_sections(Eigen::MatrixXd& gram) {
    const SectionQuadrature along(length_, phase(material_, strains_), kinks(material_, strains_));
    for (std::size_t k = 0; k < along.nodes().size(); ++k) {
      const double at = along.nodes()[k];
      const Matrix3 inertia = section_inertia(along.weights()[k], at);
      if (inertia.isZero(0)) continue;
      const LinearFields f = linear_fields(strains_, at);
      shape_.sections.push_back({inertia, expansion_at(at, f)});
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

  /// A point at each node, whose masses are to be set.
  void begin_points(const NodeFields& fields) {
    points_ = fields.points;
    if (points_ != nullptr) shape_.particles = points_->take();
    if (!shape_.particles.empty()) return;
    const auto& x = quadrature_.nodes();
    shape_.particles.reserve(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      shape_.particles.push_back(
          {0, expansion(x[k], (*fields.linear)[k], pairs_->gamma.row(row), pairs_->theta.row(row))});
    }
  }

  BeamMaterial material_;
  double length_;
  std::vector<BeamStrain> strains_;
  BeamQuadrature quadrature_;
  ModalShape shape_;
  std::shared_ptr<const SecondFields> pairs_;
  std::shared_ptr<SparePoints> points_;  ///< takes the points at the end; null: nobody does
};

}  // namespace

std::unique_ptr<Body> make_beam_body(const BeamMaterial& material, std::vector<BeamStrain> strains) {
  return std::make_unique<Beam>(material, std::move(strains), CompleteSecondOrder());
}

}  // namespace withy
