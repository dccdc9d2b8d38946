/// \file
/// The plate: rectangular, thin (Kirchhoff), in the x-y plane of the body frame, clamped along x = 0, 0 ≤ x ≤ length,
/// |y| ≤ width/2. Its deflection w along z is a sum of Ritz modes, eigenvectors of
///   ½ D ∫ w,xx² + w,yy² + 2ν w,xx w,yy + 2 (1−ν) w,xy²   and   ½ ∫ m w²
/// among products of polynomials, of x clamped at the edge and of y any. Functions of beams would do, too, but have no
/// curvature at free edges, where a plate has ν times that of its other direction: their sums converge slowly.
///
/// No bending of a plate but a developable one leaves all lengths in its plane as they are. As in H. H. Yoo and J.
/// Chung (J. Sound Vib. 239, 2001, 123–137), the lines y = const from the clamped edge, and x = const from the middle
/// line, keep theirs: u = −½ ∫₀ˣ w,x² dσ, v = −½ ∫₀ʸ w,y² dη; what shear of the plane that leaves costs no energy. A
/// section's x axis stays along its line y = const:
///   Γ_kl = (−∫₀ˣ W_k,x W_l,x dσ, −∫₀ʸ W_k,y W_l,y dη, 0),   Ψ_k = (W_k,y, −W_k,x, 0),
///   Θ_kl = (0, 0, ∂Γ_y/∂x + ½ (W_k,x W_l,y + W_l,x W_k,y)).
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "damping.hpp"
#include "equal_particles.hpp"
#include "magnitude.hpp"
#include "place_on_body.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

struct Sheet {
  double length, width;  ///< [m]
  double mass_per_area;  ///< [kg/m²]
  double stiffness;      ///< D = E h³ / (12 (1 − ν²)) [N m]
  double poisson_ratio;  ///< ν
  BodyDamping damping;
};

/// How many functions there are beside as many as modes.
constexpr double usual_along = 6, usual_across = 4;

/// Functions of one coordinate and their derivatives, each a row.
struct Line {
  RowVectorXd value, slope, curvature;
};
/// The same at the nodes of a quadrature, a row each, times the roots of its weights: their products are integrals.
struct Lines {
  MatrixXd value, slope, curvature;
};

class Plate final : public Body {
 public:
  Plate(const Sheet& sheet, Eigen::Index modes, std::unique_ptr<ShapeFunctions> along,
        std::unique_ptr<ShapeFunctions> across)
      : sheet_(sheet),
        along_(std::move(along)),
        across_(std::move(across)),
        x_(sheet.length, 1, exact_order(along_->count() + 1)),
        y_(sheet.width, 1, exact_order(across_ == nullptr ? 1 : across_->count() + 1)) {
    choose_modes(modes);
    make_particles();
  }

  /// Products of `along` functions and 1, y and `across` functions.
  static Eigen::Index products(const ShapeFunctions& along, const ShapeFunctions* across) {
    return static_cast<Eigen::Index>(along.count() * (2 + (across == nullptr ? 0 : across->count())));
  }

  const ModalShape& shape() const override { return shape_; }
  std::vector<std::string> remarks() const override { return sheet_.damping.remarks(shape_.modes()); }
  std::optional<PointExpansion> station(const StationName& name) const override {
    const auto* text = std::get_if<std::string>(&name);
    if (text == nullptr) {
      const std::optional<double> x = place_on_body(std::get<double>(name), 0, sheet_.length);
      return x ? std::optional(expansion(*x, 0)) : std::nullopt;
    }
    if (*text == "root") return expansion(0, 0);
    if (*text == "tip") return expansion(sheet_.length, 0);
    if (*text == "left") return expansion(sheet_.length, sheet_.width / 2);
    if (*text == "right") return expansion(sheet_.length, -sheet_.width / 2);
    const auto place = place_of(*text);
    return place ? std::optional(expansion(place->first, place->second)) : std::nullopt;
  }
  /// The middle of the edge rests while the plate twists, and the plate may bend across.
  std::vector<std::string> measured_beside() const override { return {"left", "right"}; }
  std::string stations() const override {
    return fmt::format(
        "root, tip, left and right (the corners at the tip), a coordinate x of the middle line from 0 to {:.9g} m, or "
        "a place '(x, y)' with y from -{:.9g} to {:.9g} m",
        sheet_.length, sheet_.width / 2, sheet_.width / 2);
  }

 private:
  /// Of "(x, y)" or, where a comma would end the name, "(x; y)" [m]; nothing where that is no place on the plate.
  std::optional<std::pair<double, double>> place_of(std::string_view text) const {
    const auto number = [](std::string_view word) {
      word.remove_prefix(std::min(word.find_first_not_of(' '), word.size()));
      word.remove_suffix(word.size() - (word.find_last_not_of(' ') + 1));
      if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);  // as numbers of scenes may
      double value = std::nan("");
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      return error == std::errc() && end == word.data() + word.size() ? value : std::nan("");
    };
    const std::size_t comma = text.find_first_of(",;");
    if (comma == std::string_view::npos || !text.starts_with('(') || !text.ends_with(')')) return {};
    const double x = number(text.substr(1, comma - 1)), y = number(text.substr(comma + 1, text.size() - comma - 2));
    const std::optional<double> along = place_on_body(x, 0, sheet_.length);
    const std::optional<double> across = place_on_body(y, -sheet_.width / 2, sheet_.width / 2);
    return along && across ? std::optional(std::pair(*along, *across)) : std::nullopt;
  }
  Line along(double x) const {
    const auto n = static_cast<Eigen::Index>(along_->count());
    Line f{RowVectorXd(n), RowVectorXd(n), RowVectorXd(n)};
    evaluate(*along_, x, f, 0);
    return f;
  }
  Line across(double y) const {
    const Eigen::Index n = 2 + (across_ == nullptr ? 0 : static_cast<Eigen::Index>(across_->count()));
    Line f{RowVectorXd::Zero(n), RowVectorXd::Zero(n), RowVectorXd::Zero(n)};
    f.value[0] = 1;
    f.value[1] = y / sheet_.width;
    f.slope[1] = 1 / sheet_.width;
    if (across_ != nullptr) evaluate(*across_, y + sheet_.width / 2, f, 2);
    return f;
  }
  static void evaluate(const ShapeFunctions& functions, double x, Line& f, Eigen::Index from) {
    std::vector<double> value(functions.count()), slope(functions.count()), curvature(functions.count());
    functions.evaluate(x, value, slope, curvature);
    for (std::size_t i = 0; i < value.size(); ++i) {
      const Eigen::Index at = from + static_cast<Eigen::Index>(i);
      f.value[at] = value[i];
      f.slope[at] = slope[i];
      f.curvature[at] = curvature[i];
    }
  }
  /// Products f_i(x) g_j(y) in a row, i outermost.
  static RowVectorXd product(const RowVectorXd& f, const RowVectorXd& g) {
    RowVectorXd p(f.size() * g.size());
    for (Eigen::Index i = 0; i < f.size(); ++i) p.segment(i * g.size(), g.size()) = f[i] * g;
    return p;
  }

  /// Quadrature coordinate of y runs from 0.
  double y_at(std::size_t j) const { return y_.nodes()[j] - sheet_.width / 2; }

  /// Gauss nodes that integrate the product of four functions, polynomials of this degree.
  static Eigen::Index exact_order(std::size_t degree) { return static_cast<Eigen::Index>(2 * degree + 1); }

  template <class At>
  static Lines at_nodes(const PanelQuadrature& quadrature, Eigen::Index functions, const At& at) {
    const auto nodes = static_cast<Eigen::Index>(quadrature.nodes().size());
    Lines lines{MatrixXd(nodes, functions), MatrixXd(nodes, functions), MatrixXd(nodes, functions)};
    for (Eigen::Index i = 0; i < nodes; ++i) {
      const auto node = static_cast<std::size_t>(i);
      const double root = std::sqrt(quadrature.weights()[node]);
      const Line line = at(quadrature.nodes()[node]);
      lines.value.row(i) = root * line.value;
      lines.slope.row(i) = root * line.slope;
      lines.curvature.row(i) = root * line.curvature;
    }
    return lines;
  }
  /// Integrals over the plate, of products of functions of x and of y.
  static MatrixXd product(const MatrixXd& a, const MatrixXd& b) {
    MatrixXd p(a.rows() * b.rows(), a.cols() * b.cols());
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < a.cols(); ++j) p.block(i * b.rows(), j * b.cols(), b.rows(), b.cols()) = a(i, j) * b;
    }
    return p;
  }

  void choose_modes(Eigen::Index modes) {
    const auto of_x = static_cast<Eigen::Index>(along_->count());
    const Lines f = at_nodes(x_, of_x, [this](double x) { return along(x); });
    const Lines g = at_nodes(y_, products(*along_, across_.get()) / of_x,
                             [this](double y) { return across(y - sheet_.width / 2); });
    const auto over = [](const MatrixXd& a, const MatrixXd& b) { return MatrixXd(a.transpose() * b); };
    const MatrixXd ff = over(f.value, f.value), gg = over(g.value, g.value);
    const MatrixXd mixed = product(over(f.curvature, f.value), over(g.value, g.curvature));
    const double nu = sheet_.poisson_ratio;
    const MatrixXd M = sheet_.mass_per_area * product(ff, gg);
    const MatrixXd K =
        sheet_.stiffness *
        (product(over(f.curvature, f.curvature), gg) + product(ff, over(g.curvature, g.curvature)) +
         nu * (mixed + mixed.transpose()) + 2 * (1 - nu) * product(over(f.slope, f.slope), over(g.slope, g.slope)));
    // M x = ω⁻² K x: the lowest are the greatest there, and rounding is small beside them.
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(M, K);
    const VectorXd softness = eigen.eigenvalues().tail(modes).reverse();
    const double mass = sheet_.mass_per_area * sheet_.length * sheet_.width;
    const VectorXd size = (mass / softness.array()).sqrt();  // modal masses are the plate's mass
    modes_ = eigen.eigenvectors().rightCols(modes).rowwise().reverse() * size.asDiagonal();
    // Up at the left corner, which no mode leaves at rest.
    const RowVectorXd corner = product(along(sheet_.length).value, across(sheet_.width / 2).value) * modes_;
    for (Eigen::Index k = 0; k < modes; ++k) {
      if (corner[k] < 0) modes_.col(k) *= -1;
      shape_.mode_names.push_back(fmt::format("mode[{}]", k + 1));
    }
    const VectorXd stiffness = mass * softness.cwiseInverse();
    shape_.stiffness = stiffness.asDiagonal();
    shape_.damping = sheet_.damping.matrix(shape_.stiffness, mass * MatrixXd::Identity(modes, modes));
    shape_.length = sheet_.length;
  }

  Eigen::Index count() const { return modes_.cols(); }
  Eigen::Index pairs() const { return count() * (count() + 1) / 2; }
  /// a_k b_l + a_l b_k over 2 for k ≤ l, in a row.
  RowVectorXd symmetric(const RowVectorXd& a, const RowVectorXd& b) const {
    RowVectorXd p(pairs());
    Eigen::Index at = 0;
    for (Eigen::Index k = 0; k < count(); ++k) {
      for (Eigen::Index l = k; l < count(); ++l) p[at++] = 0.5 * (a[k] * b[l] + a[l] * b[k]);
    }
    return p;
  }
  /// Values at the nodes of x of W,x W,x on the line y, and of y of W,y W,y and its derivative on the line x.
  MatrixXd slopes_along(double y) const {
    const RowVectorXd g = across(y).value;
    MatrixXd values(static_cast<Eigen::Index>(x_.nodes().size()), pairs());
    for (std::size_t i = 0; i < x_.nodes().size(); ++i) {
      const RowVectorXd slope = product(along(x_.nodes()[i]).slope, g) * modes_;
      values.row(static_cast<Eigen::Index>(i)) = symmetric(slope, slope);
    }
    return values;
  }
  MatrixXd slopes_across(double x) const {
    const Line f = along(x);
    MatrixXd values(static_cast<Eigen::Index>(y_.nodes().size()), 2 * pairs());
    for (std::size_t j = 0; j < y_.nodes().size(); ++j) {
      const RowVectorXd g = across(y_at(j)).slope;
      const RowVectorXd slope = product(f.value, g) * modes_, twist = product(f.slope, g) * modes_;
      values.row(static_cast<Eigen::Index>(j)) << symmetric(slope, slope), 2 * symmetric(slope, twist);
    }
    return values;
  }

  PointExpansion expansion(double x, double y) const {
    const MatrixXd across_values = slopes_across(x);
    const RowVectorXd shortening = x_.integral_to(x, slopes_along(y));  // −Γ_x
    const RowVectorXd narrowing = y_.integral_to(y + sheet_.width / 2, across_values) -
                                  y_.integral_to(sheet_.width / 2, across_values);  // −Γ_y, −∂Γ_y/∂x
    PointExpansion e = PointExpansion::rigid(Vector3(x, y, 0), count());
    const Line f = along(x), g = across(y);
    const RowVectorXd slope_x = product(f.slope, g.value) * modes_, slope_y = product(f.value, g.slope) * modes_;
    e.phi.row(2) = product(f.value, g.value) * modes_;
    e.psi.row(0) = slope_y;
    e.psi.row(1) = -slope_x;
    const RowVectorXd turn = symmetric(slope_x, slope_y) - narrowing.tail(pairs());
    Eigen::Index at = 0;
    for (Eigen::Index k = 0; k < count(); ++k) {
      for (Eigen::Index l = k; l < count(); ++l, ++at) {
        e.gamma[0](k, l) = e.gamma[0](l, k) = -shortening[at];
        e.gamma[1](k, l) = e.gamma[1](l, k) = -narrowing[at];
        e.theta[2](k, l) = e.theta[2](l, k) = turn[at];
      }
    }
    return e;
  }
  /// The fields 1, x, y, W_k, Γ_x, Γ_y over the quadrature, weighted with the roots of its masses, are replaced by
  /// their triangular factor: coefficients in orthonormal functions, the first constant.
  void make_particles() {
    const auto across_count = static_cast<Eigen::Index>(y_.nodes().size());
    MatrixXd fields(static_cast<Eigen::Index>(x_.nodes().size()) * across_count, 3 + count() + 2 * pairs());
    std::vector<MatrixXd> shortening;
    for (std::size_t j = 0; j < y_.nodes().size(); ++j) {
      shortening.push_back(x_.running_integral(slopes_along(y_at(j))));
    }
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < x_.nodes().size(); ++i) {
      const double x = x_.nodes()[i];
      const MatrixXd values = slopes_across(x).leftCols(pairs());
      const MatrixXd narrowing = y_.running_integral(values).rowwise() - y_.integral_to(sheet_.width / 2, values);
      const RowVectorXd f = along(x).value;
      for (std::size_t j = 0; j < y_.nodes().size(); ++j, ++row) {
        const double y = y_at(j);
        fields.row(row) << 1, x, y, product(f, across(y).value) * modes_,
            -shortening[j].row(static_cast<Eigen::Index>(i)), -narrowing.row(static_cast<Eigen::Index>(j));
        fields.row(row) *= std::sqrt(sheet_.mass_per_area * x_.weights()[i] * y_.weights()[j]);
      }
    }
    const Eigen::HouseholderQR<MatrixXd> qr(fields);
    // Many modes of a strip have more fields than nodes: no more functions are independent there.
    const Eigen::Index independent = std::min(fields.rows(), fields.cols());
    MatrixXd R = MatrixXd::Zero(fields.cols(), fields.cols());
    R.topRows(independent) = qr.matrixQR().topRows(independent).triangularView<Eigen::Upper>();
    if (R(0, 0) < 0) R.row(0) *= -1;
    const double mass = R(0, 0) * R(0, 0);
    const MatrixXd values = at_particle_pairs(R, mass);
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      PointExpansion e = PointExpansion::rigid(Vector3(values(i, 1), values(i, 2), 0), count());
      e.phi.row(2) = values.row(i).segment(3, count());
      Eigen::Index at = 3 + count();
      for (Eigen::Index k = 0; k < count(); ++k) {
        for (Eigen::Index l = k; l < count(); ++l, ++at) {
          e.gamma[0](k, l) = e.gamma[0](l, k) = values(i, at);
          e.gamma[1](k, l) = e.gamma[1](l, k) = values(i, at + pairs());
        }
      }
      shape_.particles.push_back({mass / static_cast<double>(values.rows()), e});
    }
  }

  Sheet sheet_;
  std::unique_ptr<ShapeFunctions> along_, across_;
  PanelQuadrature x_, y_;
  MatrixXd modes_;  ///< columns: coefficients of the products
  ModalShape shape_;
};

std::unique_ptr<Body> make_plate(const Value& p, const MakeContext& context) {
  const std::optional<BodyDamping> damping = BodyDamping::read(p, context.diagnostics);
  if (!damping) return nullptr;
  const Sheet sheet{p.number_at("length"),    p.number_at("width"),         p.number_at("mass_per_area"),
                    p.number_at("stiffness"), p.number_at("poisson_ratio"), *damping};
  const auto number = [&](const char* key, double value, int power = 1) {
    return Factor{key, &p.at(key), value, power};
  };
  const Factor mass = number("mass_per_area", sheet.mass_per_area), stiff = number("stiffness", sheet.stiffness);
  const auto length = [&](int power) { return number("length", sheet.length, power); };
  const auto width = [&](int power) { return number("width", sheet.width, power); };
  Diagnostics& told = context.diagnostics;
  if (!held("the mass", {mass, length(1), width(1)}, told) || !held("the inertia", {mass, length(3), width(1)}, told) ||
      !held("the inertia", {mass, length(1), width(3)}, told) ||
      !held("the stiffness along", {stiff, length(-3), width(1)}, told) ||
      !held("the stiffness across", {stiff, length(1), width(-3)}, told))
    return nullptr;
  const auto modes = static_cast<Eigen::Index>(p.count_at("modes"));
  // More modes are nearer to the truth by each of them, too: what is wrong with few functions shows where modes are
  // added.
  const auto count = [&](const char* key, double beside) {
    const Value* const given = p.find(key);
    return given != nullptr ? *given : Value(static_cast<double>(modes) + beside, p.at("modes").place());
  };
  const auto functions = [&](const Value& count, double length) {
    return make_shape_functions(Value(std::string("orthogonal-polynomials"), count.place()), count,
                                {BeamData::Strain::bending, length, sheet.mass_per_area, sheet.stiffness}, context);
  };
  auto along = functions(count("functions_along", usual_along), sheet.length);
  if (along == nullptr) return nullptr;
  std::unique_ptr<ShapeFunctions> across;
  if (const Value given = count("functions_across", usual_across); given.number() > 0) {
    across = functions(given, sheet.width);
    if (across == nullptr) return nullptr;
  }
  if (const Eigen::Index most = Plate::products(*along, across.get()); modes > most) {
    context.diagnostics.error(
        p.at("modes").place(),
        fmt::format("got {} modes; need at most {}, the number of products of functions_along and "
                    "functions_across + 2 functions",
                    modes, most));
    return nullptr;
  }
  return std::make_unique<Plate>(sheet, modes, std::move(along), std::move(across));
}

}  // namespace

void enroll_plate(Enrollment& enrollment) {
  std::vector<ParameterSpec> specs = {
      number("length", "m", "length along x").above(0),
      number("width", "m", "width along y; the middle line is y = 0").above(0),
      number("mass_per_area", "kg/m^2", "mass per area").above(0),
      number("stiffness", "N m", "bending stiffness D = E h^3 / (12 (1 - nu^2))").above(0),
      number("poisson_ratio", "1", "Poisson's ratio nu").above(-1).most(0.5).otherwise(0.3),
      integer("modes", "number of modes, the lowest").least(0).most(12).otherwise(3.0).as(ParameterSpec::Role::modes),
      integer("functions_along", "number of polynomials of x that modes are made of, modes + 6 if left out")
          .least(1)
          .most(24)
          .optional(),
      integer("functions_across",
              "number of polynomials of y that modes are made of, beside 1 and y, modes + 4 if left out")
          .least(0)
          .most(24)
          .optional()};
  for (ParameterSpec& spec : damping_parameters()) specs.push_back(std::move(spec));
  enrollment.add<Body>({.id = "plate",
                        .summary = "Thin rectangular plate in the x-y plane, clamped along x = 0, bending along z",
                        .parameters = std::move(specs),
                        .make = &make_plate});
}

}  // namespace withy
