// Whether a rod is one, and the same as the body that offers it.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include "withy/core/model/matrix_faults.hpp"
#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/false_slope.hpp"
#include "withy/core/plugin/most_waves.hpp"
#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {
namespace {

/// Parts of the length where no table has a row.
constexpr std::array<double, 4> compared_sections = {0.1371742, 0.4142136, 0.6830127, 0.9318517};
constexpr double section_step = 1e-2;  ///< the longest of those of differences, of 1/β
constexpr double beside_root = 1e-6;   ///< of 1/β: what fields change by until there is far below rod_tolerance
/// Of the greatest: far above the error of these differences and of any quadrature of the mass, far below a factor that
/// is forgotten.
constexpr double rod_tolerance = 1e-4;
constexpr double rod_rounding = 1e-8;  ///< of what a mode moves the rod by
constexpr Eigen::Index mass_nodes = 16;
constexpr double mass_panel = 4.75;  ///< of 1/β, as the rod is integrated

/// The least of texts with numbers.
template <class... Parts>
std::string said(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

std::string section_fault_at(double x, const RodSection& s, Eigen::Index modes) {
  const auto fields = [&]() -> std::string {
    const auto field = [&](const char* name, const Matrix3X& m) {
      std::string fault = size_fault(name, m, 3, modes);
      return fault.empty() ? finite_fault(name, m) : fault;
    };
    if (std::string fault = field("strain", s.strain); !fault.empty()) return fault;
    if (std::string fault = field("rotation", s.rotation); !fault.empty()) return fault;
    if (std::string fault = field("deflection", s.deflection); !fault.empty()) return fault;
    if (s.elongation.cols() > 0)
      if (std::string fault = field("elongation", s.elongation); !fault.empty()) return fault;
    if (!std::isfinite(s.mass_per_length) || s.mass_per_length < 0)
      return said("mass_per_length is ", s.mass_per_length);
    if (std::string fault = square_fault("inertia_per_length", s.inertia_per_length, 3); !fault.empty()) return fault;
    return sign_fault("inertia_per_length", s.inertia_per_length);
  };
  const std::string fault = fields();
  return fault.empty() ? fault : said("its section at x = ", x, " m: ", fault);
}

std::string kinks_fault(const char* name, const std::vector<double>& kinks, double length) {
  double before = 0;
  for (const double kink : kinks) {
    if (!(kink > before && kink < length))
      return said("its ", name, " have ", kink, " m behind ", before, " m; need increasing ones between 0 and ", length,
                  " m");
    before = kink;
  }
  return {};
}

/// Its numbers, and its sections at some places with both ends.
std::string rod_numbers_fault(const Rod& rod, Eigen::Index modes) {
  if (rod.modes() != modes) return said("it has ", rod.modes(), " modes, the body ", modes);
  const double length = rod.length(), beta = rod.wave_number();
  if (!std::isfinite(length) || !(length > 0)) return said("its length is ", length);
  if (!std::isfinite(beta) || beta < 0) return said("its greatest wave number is ", beta);
  if (beta * length > most_waves)
    return said("its greatest wave number times its length is ", beta * length, "; need at most ", most_waves);
  if (std::string fault = kinks_fault("kinks", rod.kinks(), length); !fault.empty()) return fault;
  if (std::string fault = kinks_fault("mass kinks", rod.mass_kinks(), length); !fault.empty()) return fault;
  std::vector<double> places = {0, length};
  for (const double part : compared_sections) places.push_back(part * length);
  for (const double x : places)
    if (std::string fault = section_fault_at(x, rod.section(x), modes); !fault.empty()) return fault;
  return {};
}

/// A column of a field and what it has to be.
std::string difference_text(const std::string& name, Eigen::Index mode, const Vector3& is, const Vector3& needed,
                            const std::string& by) {
  const Eigen::IOFormat row(4, Eigen::DontAlignCols, " ", " ");
  return said(name, " of mode ", mode + 1, " is (", is.transpose().format(row), "); ", by, " (",
              needed.transpose().format(row), ")");
}

/// Columns of a field and what they have to be, to `tolerance`, a number a column.
std::string column_fault(const std::string& name, const Matrix3X& is, const Matrix3X& needed,
                         const Eigen::RowVectorXd& tolerance, const std::string& by) {
  for (Eigen::Index i = 0; i < is.cols(); ++i)
    if (!((is.col(i) - needed.col(i)).norm() <= tolerance[i]))
      return difference_text(name, i, is.col(i), needed.col(i), by);
  return {};
}

/// Whether strains are what rotations and deflections grow by.
class ComparedRod {
 public:
  explicit ComparedRod(const Rod& rod) : rod_(rod), unit_(std::max(rod.wave_number(), 1 / rod.length())) {
    for (const double part : compared_sections) sections_.push_back(rod.section(part * rod.length()));
    rotation_ = greatest(&RodSection::rotation), deflection_ = greatest(&RodSection::deflection);
    strain_ = greatest(&RodSection::strain);
    size_ = rotation_.cwiseMax(deflection_ / rod.length()).cwiseMax(strain_ * rod.length());
  }

  [[nodiscard]] std::string fault() const {
    if (std::string fault = root_fault(); !fault.empty()) return fault;
    for (std::size_t k = 0; k < sections_.size(); ++k)
      if (std::string fault = fault_at(k); !fault.empty()) return fault;
    return {};
  }

 private:
  [[nodiscard]] Eigen::RowVectorXd greatest(Matrix3X RodSection::*field) const {
    Eigen::RowVectorXd norms = Eigen::RowVectorXd::Zero(rod_.modes());
    for (const RodSection& s : sections_) norms = norms.cwiseMax((s.*field).colwise().norm());
    return norms;
  }

  /// The root's own rotation and deflection are where the integrals begin: they are those of what is next to it.
  [[nodiscard]] std::string root_fault() const {
    const RodSection root = rod_.section(0), next = rod_.section(beside_root / unit_);
    const std::string by = "next to it";
    std::string fault = column_fault("the rotation at x = 0", root.rotation, next.rotation, rod_tolerance * size_, by);
    return !fault.empty() ? fault
                          : column_fault("the deflection at x = 0", root.deflection, next.deflection,
                                         rod_tolerance * rod_.length() * size_, by);
  }

  /// The slope ψ × e_x + γ of deflections.
  [[nodiscard]] static Matrix3X slope_of(const RodSection& s) {
    Matrix3X slope = Matrix3X::Zero(3, s.rotation.cols());
    slope.row(1) = s.rotation.row(2);
    slope.row(2) = -s.rotation.row(1);
    if (s.elongation.cols() > 0) slope += s.elongation;
    return slope;
  }

  /// Rotations of all modes, then their deflections.
  [[nodiscard]] static Eigen::MatrixXd fields_of(const RodSection& s) {
    Eigen::MatrixXd fields(3, 2 * s.rotation.cols());
    fields << s.rotation, s.deflection;
    return fields;
  }

  [[nodiscard]] std::string fault_at(std::size_t k) const {
    const double x = compared_sections[k] * rod_.length();
    const Matrix3X slope = slope_of(sections_[k]);
    const Eigen::RowVectorXd slopes = slope.colwise().norm(), least = rod_rounding * unit_ * size_;
    SaidSlopes said_slopes{Eigen::MatrixXd(3, 2 * rod_.modes()), Eigen::RowVectorXd(2 * rod_.modes()),
                           Eigen::RowVectorXd(2 * rod_.modes())};
    said_slopes.slopes << sections_[k].strain, slope;
    said_slopes.sizes << strain_, slopes.cwiseMax(rotation_);
    said_slopes.least << least, rod_.length() * least;
    const auto wrong = false_slope(
        said_slopes, [&](double s) { return fields_of(rod_.section(x + s)); }, section_step / unit_, x);
    if (!wrong) return {};
    const bool turns = wrong->column < rod_.modes();
    const Eigen::Index mode = wrong->column % rod_.modes();
    return difference_text(said(turns ? "the strain" : "rotation x e_x with elongation", " at x = ", x, " m"), mode,
                           said_slopes.slopes.col(wrong->column), wrong->found.col(wrong->column),
                           turns ? "differences of its rotation give" : "differences of its deflection give");
  }

  const Rod& rod_;
  double unit_;
  std::vector<RodSection> sections_;
  Eigen::RowVectorXd rotation_, deflection_, strain_;  ///< greatest, a number a mode
  Eigen::RowVectorXd size_;                            ///< of all that, as an angle [rad]
};

/// The edges of panels that end at all kinks.
std::vector<double> mass_edges(const Rod& rod) {
  std::vector<double> ends = rod.kinks(), edges = {0};
  const std::vector<double> more = rod.mass_kinks();
  ends.insert(ends.end(), more.begin(), more.end());
  ends.push_back(rod.length());
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  for (const double end : ends) {
    const double from = edges.back();
    const int panels = std::max(1, static_cast<int>(std::ceil(rod.wave_number() * (end - from) / mass_panel)));
    for (int p = 1; p < panels; ++p) edges.push_back(from + (end - from) * p / panels);
    edges.push_back(end);
  }
  return edges;
}

/// The mass and its first moment along x, of the rod and of the body's particles.
std::string rod_mass_fault(const Rod& rod, const ModalShape& shape) {
  double mass = 0, moment = 0, body_mass = 0, body_moment = 0;
  const PanelQuadrature along(mass_edges(rod), mass_nodes);
  for (std::size_t k = 0; k < along.nodes().size(); ++k) {
    const double part = along.weights()[k] * rod.section(along.nodes()[k]).mass_per_length;
    mass += part, moment += part * along.nodes()[k];
  }
  for (const Particle& p : shape.particles) body_mass += p.mass, body_moment += p.mass * p.at.X.x();
  if (!(std::abs(mass - body_mass) <= rod_tolerance * body_mass))
    return said("its mass is ", mass, " kg, that of the body's particles ", body_mass, " kg");
  if (!(std::abs(moment - body_moment) <= rod_tolerance * body_mass * rod.length()))
    return said("the first moment of its mass is ", moment, " kg m, that of the body's particles ", body_moment,
                " kg m");
  return {};
}

/// Whether some particles of the body move as the sections that they lie in.
std::string rod_place_fault(const Rod& rod, const ModalShape& shape) {
  constexpr std::size_t compared = 5;
  const std::size_t count = shape.particles.size();
  if (count == 0) return {};
  Eigen::RowVectorXd moved = Eigen::RowVectorXd::Zero(shape.modes()), turned = moved;
  for (const Particle& p : shape.particles) {
    moved = moved.cwiseMax(p.at.phi.colwise().norm());
    turned = turned.cwiseMax(p.at.psi.colwise().norm());
  }
  const double length = rod.length();
  const Eigen::RowVectorXd size = rod_tolerance * turned.cwiseMax(moved / length);
  for (std::size_t k = 0; k < compared; ++k) {
    const PointExpansion& at = shape.particles[k * (count - 1) / (compared - 1)].at;
    if (!(at.X.x() >= 0 && at.X.x() <= length))
      return said("a particle of the body is at x = ", at.X.x(), " m, and the rod is ", length, " m long");
    const RodSection s = rod.section(at.X.x());
    const std::string where = said(" at x = ", at.X.x(), " m");
    if (std::string fault = column_fault("the deflection" + where, s.deflection, at.phi, length * size,
                                         "Phi of the body's particle there is");
        !fault.empty())
      return fault;
    if (std::string fault =
            column_fault("the rotation" + where, s.rotation, at.psi, size, "Psi of the body's particle there is");
        !fault.empty())
      return fault;
  }
  return {};
}

}  // namespace

std::string find_fault(const Rod& rod, const ModalShape& shape) {
  if (std::string fault = rod_numbers_fault(rod, shape.modes()); !fault.empty()) return fault;
  if (std::string fault = ComparedRod(rod).fault(); !fault.empty()) return fault;
  if (std::string fault = rod_place_fault(rod, shape); !fault.empty()) return fault;
  return rod_mass_fault(rod, shape);
}

}  // namespace withy
