#include "withy/core/simulation/diagnosis.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "withy/core/simulation/elastic_modes.hpp"
#include "withy/core/simulation/loop_following.hpp"

namespace withy {
namespace {

std::string sign_text(int sign) { return sign > 0 ? "positive" : (sign < 0 ? "negative" : "zero"); }

using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// M, with prescribed speeds of unit mass on their own: they are in no direction that is weak.
DenseMatrix decoupled(const DenseSystem& system) {
  const auto n = static_cast<Eigen::Index>(system.size);
  DenseMatrix M = Eigen::Map<const DenseMatrix>(system.mass.data(), n, n);
  for (const PrescribedRate& p : system.prescribed) {
    const auto i = static_cast<Eigen::Index>(p.speed);
    M.row(i).setZero();
    M.col(i).setZero();
    M(i, i) = 1;
  }
  return M;
}

/// Least |eigenvalue| of first⁻¹ last.
double least_share_of(const Eigen::MatrixXd& first, const Eigen::MatrixXd& last) {
  if (first.size() == 0 || !first.allFinite() || !last.allFinite()) return 1;
  const Eigen::FullPivLU<Eigen::MatrixXd> factors(first);
  if (!factors.isInvertible()) return 1;
  const Eigen::EigenSolver<Eigen::MatrixXd> shares(factors.solve(last), false);
  return shares.info() == Eigen::Success ? shares.eigenvalues().cwiseAbs().minCoeff() : 1;
}

/// Unit vector of the scaled coordinates along which M acts least or, where M is indefinite and not singular, that of
/// the lowest eigenvalue.
Eigen::VectorXd weakest_direction(const MassMatrixHistory& h, bool negative) {
  const auto n = static_cast<Eigen::Index>(h.first.size);
  const DenseMatrix first = decoupled(h.first), last = decoupled(h.last);
  Eigen::VectorXd scale = first.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) scale.setOnes();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * last * scale.asDiagonal();
  if (negative) {
    const Eigen::MatrixXd symmetric = 0.5 * (scaled + scaled.transpose());
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvectors().col(0);
  }
  return Eigen::JacobiSVD<Eigen::MatrixXd>(scaled, Eigen::ComputeFullV).matrixV().col(n - 1);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Loads with states of their own whose rates are not finite: what they measure is not, or is out of all range.
std::string describe_rates(const Model& model, const State& state, double ahead) {
  const NonfiniteRates bad = nonfinite_rates(model, state, ahead);
  std::string text;
  for (const std::size_t i : bad.states)
    text += (text.empty() ? "" : "; ") +
            ("the rate of '" + model.layout().continuous_names[i] + "' is not finite at t = " + brief(bad.time) +
             " s: look at what that load measures");
  return text;
}

/// Loads that give an effort that is not finite, or more than motion can be computed with, with the first such time
/// found.
std::string nonfinite_loads(const Model& model, const EquationsOfMotion& equations, const State& state, double ahead) {
  constexpr double unbearable = 1e100;  // its square, and what masses divide it by, leave the range of numbers
  const Layout& layout = model.layout();
  Work work = equations.make_work();
  std::string text;
  for (std::size_t load = 0; load < model.loads().size(); ++load) {
    std::vector<double> efforts(layout.speeds);
    // From just after the state on, at intervals that double: a load may fail from some time on.
    for (double after = 0; after <= ahead; after = after > 0 ? 2 * after : ahead * 0x1p-30) {
      equations.load_efforts(state.time + after, state.y, static_cast<int>(load), efforts, work);
      const auto bad =
          std::find_if(efforts.begin(), efforts.end(), [](double e) { return !(std::abs(e) < unbearable); });
      if (bad != efforts.end()) {
        text += (text.empty() ? "" : "; ") +
                ("load '" + model.loads()[load].name + "' gives " + (std::isnan(*bad) ? "nan" : brief(*bad)) + " on ") +
                layout.speed_names[static_cast<std::size_t>(bad - efforts.begin())] +
                " at t = " + brief(state.time + after) + " s";
        break;
      }
      if (!(ahead > 0)) break;
    }
  }
  if (const std::string rates = describe_rates(model, state, ahead); !rates.empty())
    text += (text.empty() ? "" : "; ") + rates;
  return text;
}

/// Loads that have renewed what they hold to no number, so that what depends on it is none.
std::string describe_held(const Model& model, const State& state) {
  std::string text;
  for (const LoadSlot& slot : model.layout().discrete_slots) {
    const auto held = std::span(state.y).subspan(slot.first, slot.count);
    if (std::none_of(held.begin(), held.end(), [](double d) { return std::isnan(d); })) continue;
    text += (text.empty() ? "" : "; ") + ("load '" + model.loads()[slot.load].name + "' holds no number") +
            " in its discrete states";
  }
  return text;
}

std::string shown_number(double x) { return std::isnan(x) ? "nan" : brief(x); }

bool all_finite_numbers(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

/// What of a hinge's motion is not finite; null: nothing is, or its coordinates and rates are not.
const char* nonfinite_part(const Hinge& hinge, std::span<const double> x, std::span<const double> rates) {
  if (!all_finite_numbers(x) || !all_finite_numbers(rates)) return nullptr;
  HingeMotion m;
  m.H.setZero(6, static_cast<Eigen::Index>(rates.size()));
  hinge.motion(x, rates, m);
  if (!m.pose.R.allFinite() || !m.pose.p.allFinite()) return "pose";
  if (!m.H.allFinite()) return "H";
  return m.bias.allFinite() ? nullptr : "bias";
}

/// \param part of its motion
std::string nonfinite_at(const std::string& hinge, const char* part, std::span<const double> x) {
  std::string text = std::string("the ") + part + " of hinge '" + hinge + "' is not finite where its coordinate";
  for (std::size_t i = 0; i < x.size(); ++i) text += (i > 0 ? ", " : (x.size() == 1 ? " is " : "s are ")) + brief(x[i]);
  return text;
}

}  // namespace

std::string nonfinite_number(const Layout& layout, const State& state) {
  if (state.y.size() != layout.size()) return {};  // of equations that are another's
  const auto told = [&](const std::string& what, std::size_t at) { return what + " is " + shown_number(state.y[at]); };
  const auto of_slots = [&](const std::vector<Slot>& slots) -> std::string {
    for (const Slot& slot : slots)
      for (std::size_t i = 0; i < slot.positions; ++i)
        if (const std::size_t at = slot.position + i; !std::isfinite(state.y[at]))
          return told(slot.positions == slot.speeds ? "the coordinate '" + layout.speed_names[slot.speed + i] + "'"
                                                    : "a coordinate of '" + slot.name + "'",
                      at);
    return {};
  };
  if (std::string text = of_slots(layout.hinges); !text.empty()) return text;
  if (std::string text = of_slots(layout.bodies); !text.empty()) return text;
  for (std::size_t i = 0; i < layout.speeds; ++i)
    if (const std::size_t at = layout.positions + i; !std::isfinite(state.y[at]))
      return told("the speed '" + layout.speed_names[i] + "'", at);
  for (std::size_t i = 0; i < layout.continuous; ++i)
    if (const std::size_t at = layout.positions + layout.speeds + i; !std::isfinite(state.y[at]))
      return told("the state '" + layout.continuous_names[i] + "'", at);
  return std::isfinite(state.y.back()) ? "" : told("the work", state.y.size() - 1);
}

std::string owners_of(const Layout& layout, std::span<const double> unit_vector) {
  const Eigen::Map<const Eigen::VectorXd> direction(unit_vector.data(), static_cast<Eigen::Index>(unit_vector.size()));
  struct Share {
    double share;
    std::string text;
  };
  std::vector<Share> shares;
  const auto weigh = [&](const std::vector<Slot>& slots, bool modes) {
    for (const Slot& slot : slots) {
      if (slot.speeds == 0) continue;
      Eigen::Index most = 0;
      const auto part =
          direction.segment(static_cast<Eigen::Index>(slot.speed), static_cast<Eigen::Index>(slot.speeds)).array();
      const double share = part.square().sum();
      part.abs().maxCoeff(&most);
      std::string text = modes ? "modes of '" : "hinge '";
      text += slot.name + "'";
      if (slot.speeds > 1)
        text += " (most of all " + layout.speed_names[slot.speed + static_cast<std::size_t>(most)] + ")";
      if (share >= 0.05) shares.push_back({share, std::move(text)});
    }
  };
  weigh(layout.bodies, true);
  weigh(layout.hinges, false);
  std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) { return a.share > b.share; });
  std::string text;
  for (const Share& s : shares) {
    if (!text.empty()) text += ", ";
    text += brief(std::round(100 * s.share)) + " % " + s.text;
  }
  return text;
}

std::string brief(double x) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, 4);
  return {text, end.ptr};
}

namespace {

/// To four digits, down or up; a number of four digits, but for rounding, stays.
double rounded(double x, double (*way)(double)) {
  if (x == 0 || !std::isfinite(x)) return x;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - 3), units = x / unit;
  const double nearest = std::round(units);
  return (std::abs(units - nearest) < 1e-9 * std::abs(nearest) ? nearest : way(units)) * unit;
}

}  // namespace

std::string brief_interval(double from, double to) {
  return "between t = " + brief(rounded(from, &std::floor)) + " and " + brief(rounded(to, &std::ceil)) + " s";
}

// A condition of 1e13 leaves three digits of the accelerations.
bool MassMatrixHistory::became_singular() const { return end.condition > std::max(1e13, 100 * start.condition); }

bool MassMatrixHistory::nearly_singular() const { return least_share < 1e-6; }

bool MassMatrixHistory::has_negative_inertia() const {
  if (!(end.smallest_eigenvalue < 0)) return false;
  if (end.determinant_sign < 0) return true;
  const DenseMatrix M = decoupled(last);
  const double size = M.cwiseAbs().maxCoeff();
  return end.smallest_eigenvalue < -1e-12 * size && (M - M.transpose()).cwiseAbs().maxCoeff() <= 1e-10 * size;
}

bool MassMatrixHistory::lost_definiteness() const {
  return change.has_value() || became_singular() || nearly_singular() ||
         end.determinant_sign != start.determinant_sign ||
         (start.smallest_eigenvalue > 0 && end.smallest_eigenvalue <= 0);
}

MassMatrixHistory examine(const EquationsOfMotion& equations, const State& first, const State& last,
                          const std::optional<SignChange>& change) {
  MassMatrixHistory h;
  h.first = equations.system(first.time, first.y);
  h.last = equations.system(last.time, last.y);
  h.start = conditioning(h.first);
  h.end = conditioning(h.last);
  h.change = change;
  return h;
}

void compare_inertia(MassMatrixHistory& h) { h.least_share = least_share_of(decoupled(h.first), decoupled(h.last)); }

std::string describe(const MassMatrixHistory& h, const Layout& layout) {
  if (h.last.size == 0) return "Nothing moves.";
  if (h.end.weakest.empty()) return "The mass matrix is not finite.";
  const bool near = h.nearly_singular() && !h.change;
  const bool negative = h.end.smallest_eigenvalue < 0 && !h.became_singular() && !near;
  std::string between;
  if (h.change && brief(h.change->before) != brief(h.change->after))
    between = ' ' + brief_interval(h.change->before, h.change->after);
  std::string text;
  if (h.became_singular()) {
    text = "The mass matrix of this formulation became singular: some motion has no inertia, which no structure has; ";
    text += "det M came to zero" + between;
  } else if (near) {
    text =
        "The mass matrix of this formulation is nearly singular: some motion has hardly any inertia, which no "
        "structure ";
    text += "has; it is " + brief(h.least_share) + " of what it was at the start";
  } else if (h.change) {
    text = "The mass matrix of this formulation became singular on the way and then indefinite: some motion has ";
    text += "negative inertia, which no structure has; det M changed sign" + between;
  } else if (h.lost_definiteness()) {
    text = "The mass matrix of this formulation lost its positive definiteness: det M is " +
           sign_text(h.end.determinant_sign) + ", at the start it was " + sign_text(h.start.determinant_sign);
  } else if (h.has_negative_inertia()) {
    text = "The mass matrix of this formulation is indefinite, as it was at the start: some motion has negative ";
    text += "inertia, which no structure has; det M is " + sign_text(h.end.determinant_sign);
  } else {
    text = std::string("The mass matrix is ") + (h.end.smallest_eigenvalue > 0 ? "positive definite" : "indefinite") +
           " as it was at the start: det M is " + sign_text(h.end.determinant_sign);
  }
  const Eigen::VectorXd direction = weakest_direction(h, negative);
  return text + ". Condition of M " + brief(h.end.condition) + " (at the start " + brief(h.start.condition) +
         "), smallest eigenvalue of its symmetric part " + brief(h.end.smallest_eigenvalue) + " (" +
         brief(h.start.smallest_eigenvalue) + "); the direction of " + (negative ? "negative" : "least") + " mass is " +
         owners_of(layout, {direction.data(), static_cast<std::size_t>(direction.size())}) + ".";
}

std::string describe_sound(const MassMatrixHistory& h) {
  if (h.last.size == 0) return "Nothing moves.";
  return "The mass matrix is not the reason: it is positive definite as it was at the start. Condition of M " +
         brief(h.end.condition) + " (at the start " + brief(h.start.condition) + ").";
}

double fastest_mode(const Model& model, const DenseSystem& system, const Eigen::MatrixXd& rows) {
  const auto n = static_cast<Eigen::Index>(system.size);
  Eigen::MatrixXd K = stiffness_of_modes(model);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::none_of(system.prescribed.begin(), system.prescribed.end(),
                     [i](const PrescribedRate& p) { return static_cast<Eigen::Index>(p.speed) == i; }))
      free.push_back(i);
  }
  Eigen::MatrixXd M = Eigen::Map<const DenseMatrix>(system.mass.data(), n, n)(free, free);
  K = K(free, free).eval();
  if (free.empty() || K.isZero(0) || !M.allFinite() || !rows.allFinite()) return 0;
  if (rows.rows() > 0) {
    const Eigen::MatrixXd Z = closed_motions(rows(Eigen::all, free), M.diagonal());
    if (Z.cols() == 0) return 0;
    M = (Z.transpose() * M * Z).eval();
    K = (Z.transpose() * K * Z).eval();
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(0.5 * (M + M.transpose()));
  if (factor.info() != Eigen::Success) return 0;
  const Eigen::MatrixXd half = factor.matrixL().solve(K);
  const Eigen::MatrixXd square = factor.matrixL().solve(half.transpose());
  return std::sqrt(std::max(
      0.0, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(square, Eigen::EigenvaluesOnly).eigenvalues().tail<1>()[0]));
}

NonfiniteRates nonfinite_rates(const Model& model, const State& state, double ahead) {
  const Layout& layout = model.layout();
  const std::size_t first = layout.positions + layout.speeds;
  std::vector<double> rates(layout.size()), scratch(model.load_scratch());
  NonfiniteRates found;
  if (layout.continuous == 0) return found;
  for (double after = 0; after <= ahead; after = after > 0 ? 2 * after : ahead * 0x1p-30) {
    found.time = state.time + after;
    if (!model.continuous_rates(found.time, state.y, rates, scratch))
      for (std::size_t i = 0; i < layout.continuous; ++i)
        if (!std::isfinite(rates[first + i])) found.states.push_back(i);
    if (!found.states.empty() || !(ahead > 0)) break;
  }
  return found;
}

std::optional<NonfiniteHinge> nonfinite_hinge(const Model& model, const State& state, double ahead) {
  const Layout& layout = model.layout();
  if (state.y.size() != layout.size()) return {};  // of equations that are another's
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Hinge& hinge = *model.hinges()[h].hinge;
    if (hinge.kernel()) continue;
    const Slot& slot = layout.hinges[h];
    const auto here = std::span(state.y).subspan(slot.position, slot.positions);
    const auto rates = std::span(state.y).subspan(layout.positions + slot.speed, slot.speeds);
    std::vector<double> x(slot.positions), x_dot(slot.positions);
    hinge.derivatives(here, rates, x_dot);
    // As far as it goes by these rates: the last state may be before the place where it fails.
    for (double after = 0; after <= ahead; after = after > 0 ? 2 * after : ahead * 0x1p-30) {
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = here[i] + after * x_dot[i];
      hinge.normalize(x);
      if (const char* part = nonfinite_part(hinge, x, rates))
        return NonfiniteHinge{h, nonfinite_at(model.hinges()[h].name, part, x)};
      if (!(ahead > 0)) break;
    }
  }
  return {};
}

std::string describe_nonfinite(const Model& model, const EquationsOfMotion& equations, const State& state,
                               double ahead) {
  // Before the loads: what one measures beyond such a hinge is not finite either.
  if (const auto hinge = nonfinite_hinge(model, state, ahead)) return hinge->why;
  if (const std::string loads = nonfinite_loads(model, equations, state, ahead); !loads.empty()) return loads;
  if (const std::string held = describe_held(model, state); !held.empty()) return held;
  const Layout& layout = equations.layout();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < layout.speeds; ++i) {
    if (!std::isfinite(state.y[layout.positions + i])) names.push_back(layout.speed_names[i]);
  }
  if (!names.empty()) return "the speeds " + joined(names) + " are not finite";
  Work work = equations.make_work();
  std::vector<double> y_dot(state.y.size());
  const Evaluation e = equations.derivatives(state.time, state.y, y_dot, work);
  if (e.outcome == Evaluation::Outcome::singular) return {};
  for (std::size_t i = 0; i < layout.speeds; ++i) {
    if (!std::isfinite(y_dot[layout.positions + i])) names.push_back(layout.speed_names[i]);
  }
  if (!names.empty()) return "the accelerations of " + joined(names) + " are not finite";
  return {};
}

}  // namespace withy
