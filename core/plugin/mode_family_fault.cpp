// Whether the functions that a mode family gives are what they are said to be.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include "withy/core/plugin/false_slope.hpp"
#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/plugin/most_waves.hpp"
#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {
namespace {

/// Parts of the length where no table has a row and no function of an even beam a node.
constexpr std::array<double, 4> compared_places = {0.1371742, 0.4142136, 0.6830127, 0.9318517};
constexpr double compared_step = 1e-2;        ///< the longest of those of differences, of 1/β
constexpr double derivative_rounding = 1e-8;  ///< of the greatest value times β

/// φ, φ′ and φ″ of all functions at a place.
using ShapeValues = std::array<std::vector<double>, 3>;

ShapeValues values_at(const ShapeFunctions& functions, double x) {
  ShapeValues v;
  for (std::vector<double>& of : v) of.resize(functions.count());
  functions.evaluate(x, v[0], v[1], v[2]);
  return v;
}

ShapeValues greatest_of(const std::vector<ShapeValues>& places) {
  ShapeValues greatest = places.front();
  for (std::size_t d = 0; d < greatest.size(); ++d)
    for (std::size_t i = 0; i < greatest[d].size(); ++i)
      for (const ShapeValues& v : places) greatest[d][i] = std::max(std::abs(greatest[d][i]), std::abs(v[d][i]));
  return greatest;
}

/// Whether the derivatives at one place agree with differences of what they are the derivatives of.
class ComparedFunctions {
 public:
  ComparedFunctions(const ShapeFunctions& functions, const BeamData& beam)
      : functions_(functions),
        length_(beam.length),
        unit_(std::max(functions.wave_number(), 1 / beam.length)),
        // Curvatures are the strains of bending alone: nobody asks for those of twist and elongation.
        derivatives_(beam.strain == BeamData::Strain::bending ? 2 : 1) {
    for (const double part : compared_places) places_.push_back(values_at(functions, part * length_));
    greatest_ = greatest_of(places_);
  }

  [[nodiscard]] std::string fault() const {
    if (std::string text = finite_fault(); !text.empty()) return text;
    for (std::size_t place = 0; place < places_.size(); ++place)
      if (std::string text = fault_at(place); !text.empty()) return text;
    return {};
  }

 private:
  [[nodiscard]] std::string finite_fault() const {
    for (std::size_t place = 0; place < places_.size(); ++place)
      for (std::size_t d = 0; d <= derivatives_; ++d)
        for (std::size_t i = 0; i < functions_.count(); ++i)
          if (const double said = places_[place][d][i]; !std::isfinite(said)) return said_text(place, d, i).str();
    return {};
  }

  /// Derivatives from the `first` on, as many as are compared: φ_1, φ_1′, φ_2, ….
  [[nodiscard]] Eigen::RowVectorXd row_of(const ShapeValues& values, std::size_t first) const {
    Eigen::RowVectorXd row(static_cast<Eigen::Index>(functions_.count() * derivatives_));
    for (std::size_t i = 0; i < functions_.count(); ++i)
      for (std::size_t d = 0; d < derivatives_; ++d)
        row[static_cast<Eigen::Index>(i * derivatives_ + d)] = values[first + d][i];
    return row;
  }

  [[nodiscard]] std::string fault_at(std::size_t place) const {
    const double x = compared_places[place] * length_;
    SaidSlopes said{row_of(places_[place], 1), row_of(greatest_, 1),
                    derivative_rounding * unit_ * row_of(greatest_, 0)};
    const auto wrong = false_slope(
        said, [&](double s) -> Eigen::MatrixXd { return row_of(values_at(functions_, x + s), 0); },
        compared_step / unit_, x);
    if (!wrong) return {};
    const auto column = static_cast<std::size_t>(wrong->column);
    return difference_text(place, column % derivatives_, column / derivatives_, wrong->found(0, wrong->column));
  }

  [[nodiscard]] std::ostringstream said_text(std::size_t place, std::size_t d, std::size_t function) const {
    static constexpr std::array<const char*, 3> names = {"value", "slope", "curvature"};
    std::ostringstream text;
    text << "function " << function + 1 << " has the " << names.at(d) << " " << places_[place][d][function]
         << " at x = " << compared_places.at(place) * length_ << " m";
    return text;
  }
  [[nodiscard]] std::string difference_text(std::size_t place, std::size_t d, std::size_t function,
                                            double found) const {
    std::ostringstream text = said_text(place, d + 1, function);
    text << "; differences of its " << (d == 0 ? "values" : "slopes") << " give " << found;
    return text.str();
  }

  const ShapeFunctions& functions_;
  double length_, unit_;
  std::size_t derivatives_;  ///< how many of them are compared
  std::vector<ShapeValues> places_;
  ShapeValues greatest_;
};

/// Ends of the beam may be among them, and one twice: nothing is integrated there.
std::string kinks_fault(const std::vector<double>& kinks, double length) {
  double before = 0;
  for (const double kink : kinks) {
    if (kink >= before && kink <= length) {
      before = kink;
      continue;
    }
    std::ostringstream text;
    text << "they have a kink at x = " << kink << " m behind " << before << " m; need increasing ones from 0 to "
         << length << " m";
    return text.str();
  }
  return {};
}

/// ∫ φ_i φ_j dx and the same of the strains, φ″ or φ′.
struct ProductIntegrals {
  Eigen::MatrixXd values, strains;
};

/// By the quadrature of bodies (BeamQuadrature), each of its panels in so many parts.
ProductIntegrals product_integrals(const ShapeFunctions& functions, const BeamData& beam, std::size_t derivative,
                                   int parts) {
  constexpr Eigen::Index nodes = 20;
  constexpr double phase = 2.5;
  std::vector<double> edges{0}, ends = functions.kinks();
  ends.insert(ends.end(), beam.kinks.begin(), beam.kinks.end());
  ends.push_back(beam.length);
  std::sort(ends.begin(), ends.end());
  for (const double end : ends) {
    const double from = edges.back(), piece = end - from;
    if (!(piece > 0) || end > beam.length) continue;
    const int panels = parts * std::max(1, static_cast<int>(std::ceil(functions.wave_number() * piece / phase)));
    for (int k = 1; k < panels; ++k) edges.push_back(from + piece * k / panels);
    edges.push_back(end);
  }
  const PanelQuadrature rule(std::move(edges), nodes);
  const auto n = static_cast<Eigen::Index>(functions.count());
  Eigen::MatrixXd values(n, static_cast<Eigen::Index>(rule.nodes().size())), strains = values;
  for (std::size_t k = 0; k < rule.nodes().size(); ++k) {
    const ShapeValues v = values_at(functions, rule.nodes()[k]);
    const double root = std::sqrt(rule.weights()[k]);
    values.col(static_cast<Eigen::Index>(k)) = root * Eigen::Map<const Eigen::VectorXd>(v[0].data(), n);
    strains.col(static_cast<Eigen::Index>(k)) = root * Eigen::Map<const Eigen::VectorXd>(v.at(derivative).data(), n);
  }
  return {values * values.transpose(), strains * strains.transpose()};
}

/// Bodies choose their quadrature by the wave number: panels of half the length are to give the same.
std::string wave_number_fault(const ShapeFunctions& functions, const BeamData& beam) {
  constexpr double allowed = 1e-3;  // bodies count on 1e-12; a kink of a curvature leaves up to some 1e-4
  const std::size_t derivative = beam.strain == BeamData::Strain::bending ? 2 : 1;
  const ProductIntegrals coarse = product_integrals(functions, beam, derivative, 1),
                         fine = product_integrals(functions, beam, derivative, 2);
  const auto off = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    const double greatest = b.size() > 0 ? b.cwiseAbs().maxCoeff() : 0;
    return greatest > 0 ? (a - b).cwiseAbs().maxCoeff() / greatest : 0;
  };
  const double mass = off(coarse.values, fine.values), stiffness = off(coarse.strains, fine.strains);
  if (!(mass > allowed || stiffness > allowed)) return {};
  std::ostringstream text;
  text << "their greatest wave number is " << functions.wave_number()
       << " 1/m, and they vary faster or have a kink that they do not tell: the quadrature that bodies choose by it is "
          "off by "
       << 100 * mass << " % in their mass and by " << 100 * stiffness << " % in their stiffness";
  return text.str();
}

}  // namespace

std::string find_fault(const ShapeFunctions& functions, const BeamData& beam, std::size_t count) {
  std::ostringstream text;
  if (functions.count() != count) {
    text << "there are " << functions.count() << ", where " << count << " are asked for";
    return text.str();
  }
  const double beta = functions.wave_number();
  if (!std::isfinite(beta) || beta < 0) {
    text << "their greatest wave number is " << beta;
    return text.str();
  }
  if (beta * beam.length > most_waves) {
    text << "their greatest wave number times the length is " << beta * beam.length << "; need at most " << most_waves;
    return text.str();
  }
  if (std::string fault = kinks_fault(functions.kinks(), beam.length); !fault.empty()) return fault;
  if (std::string fault = ComparedFunctions(functions, beam).fault(); !fault.empty()) return fault;
  return wave_number_fault(functions, beam);
}

}  // namespace withy
