#include "withy/core/analysis/multiblade.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "withy/core/analysis/coupled_modes.hpp"
#include "withy/core/analysis/linear_system.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;
constexpr std::size_t fewest_blades = 3, most_blades = 8;

std::vector<int> children(const Model& model, int parent) {
  std::vector<int> found;
  for (const HingeNode& hinge : model.hinges()) {
    if (hinge.parent == parent) found.push_back(hinge.child);
  }
  return found;
}

/// Kinds of hinges and names of modes of a sub-tree, with the stiffness of each body: equal for equal blades.
std::string likeness(const Model& model, int body) {
  const HingeNode& hinge = model.hinges()[static_cast<std::size_t>(body)];
  const ModalShape& shape = model.bodies()[static_cast<std::size_t>(body)].body->shape();
  std::string text = "(" + std::to_string(hinge.hinge->coordinates()) + ':' + std::to_string(hinge.hinge->speeds());
  for (const std::string& name : shape.mode_names) text += ' ' + name;
  char stiffness[32];  // whatever its size: lengths may be micrometres
  const auto end =
      std::to_chars(stiffness, stiffness + sizeof stiffness, shape.stiffness.norm(), std::chars_format::general, 10);
  text += ' ';
  text.append(stiffness, end.ptr);
  for (const int child : children(model, body)) text += likeness(model, child);
  return text + ')';
}

void gather_speeds(const Model& model, int body, std::vector<Eigen::Index>& speeds) {
  const auto add = [&](const Slot& slot) {
    for (std::size_t i = 0; i < slot.speeds; ++i) speeds.push_back(static_cast<Eigen::Index>(slot.speed + i));
  };
  add(model.layout().hinges[static_cast<std::size_t>(body)]);
  if (const Slot* slot = model.layout().body(model.bodies()[static_cast<std::size_t>(body)].name)) add(*slot);
  for (const int child : children(model, body)) gather_speeds(model, child, speeds);
}

Blades blades_of(const Model& model, const std::vector<int>& bodies) {
  Blades blades;
  for (const int body : bodies) {
    blades.names.push_back(model.bodies()[static_cast<std::size_t>(body)].name);
    blades.speeds.emplace_back();
    gather_speeds(model, body, blades.speeds.back());
  }
  return blades;
}

Blades named_blades(const Model& model, const std::vector<std::string>& names) {
  std::vector<int> bodies;
  for (const std::string& name : names) {
    int body = model.hinge(name);  // hinge i carries body i
    if (body < 0) {
      const std::vector<int> pieces = model.segments(name);
      if (pieces.empty()) throw std::invalid_argument("no body or hinge '" + name + "'");
      body = pieces.front();
    }
    bodies.push_back(body);
  }
  if (bodies.size() < fewest_blades || bodies.size() > most_blades)
    throw std::invalid_argument("the multi-blade transform is for three to eight blades; " +
                                std::to_string(bodies.size()) + " are named");
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    if (likeness(model, bodies[i]) != likeness(model, bodies[0]))
      throw std::invalid_argument("'" + names[i] + "' is not like '" + names[0] +
                                  "': hinges, modes or stiffness differ");
  }
  return blades_of(model, bodies);
}

/// `blades` with places among the free displacements in the place of speeds.
std::vector<std::vector<Eigen::Index>> places(const Blades& blades, const Held& held) {
  std::vector<Eigen::Index> place(held.size(), -1);
  Eigen::Index next = 0;
  for (std::size_t s = 0; s < held.size(); ++s) {
    if (!held[s]) place[s] = next++;
  }
  std::vector<std::vector<Eigen::Index>> found;
  for (const std::vector<Eigen::Index>& speeds : blades.speeds) {
    found.emplace_back();
    for (const Eigen::Index s : speeds) {
      if (place[static_cast<std::size_t>(s)] >= 0) found.back().push_back(place[static_cast<std::size_t>(s)]);
    }
  }
  return found;
}

/// Whether the rotor after 1/B of a turn is the rotor with each blade in the place of the next one.
bool follows(const PeriodicMatrix& A, Eigen::Index m, const std::vector<std::vector<Eigen::Index>>& blades,
             double tolerance) {
  const Eigen::Index count = static_cast<Eigen::Index>(blades.size());
  Eigen::VectorX<Eigen::Index> next(A.rows());
  std::iota(next.begin(), next.end(), Eigen::Index{0});
  for (std::size_t k = 0; k < blades.size(); ++k) {
    const std::vector<Eigen::Index>& after = blades[(k + 1) % blades.size()];
    for (std::size_t i = 0; i < after.size(); ++i) {
      next[blades[k][i]] = after[i];
      next[m + blades[k][i]] = m + after[i];
    }
  }
  for (const double t : {0.0, 0.137 * A.period()}) {
    const Eigen::MatrixXd now = A.at(t), later = A.at(t + A.period() / static_cast<double>(count));
    if ((later - now(next, next)).cwiseAbs().maxCoeff() > tolerance) return false;
  }
  return true;
}

/// The blades in an order that `follows`; throws where there is none.
Blades ordered(const PeriodicMatrix& A, Eigen::Index m, Blades blades, const Held& held) {
  if (blades.speeds[0].empty()) throw std::domain_error("the blades do not move");
  for (const auto& speeds : places(blades, held)) {
    if (speeds.size() != places(blades, held)[0].size())
      throw std::domain_error("some of the blades' hinges are held and some are not");
  }
  std::vector<std::size_t> order(blades.speeds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double tolerance = 1e-7 * A.at(0).cwiseAbs().maxCoeff();
  do {
    Blades trial;
    for (const std::size_t k : order) {
      trial.speeds.push_back(blades.speeds[k]);
      trial.names.push_back(blades.names[k]);
    }
    if (follows(A, m, places(trial, held), tolerance)) return trial;
  } while (std::next_permutation(order.begin() + 1, order.end()));
  std::string names;
  for (const std::string& name : blades.names) names += (names.empty() ? "" : ", ") + name;
  throw std::domain_error("after 1/" + std::to_string(blades.count()) + " of a turn the rotor is not the same with " +
                          names + " exchanged: they are not equal, not equally spaced, or not all of the blades" +
                          (A.rows() > 2 * m ? ", or each has a controller of its own" : "") +
                          ", or another hinge turns too, and the turn is that after which both come back");
}

/// Columns of the transform of one coordinate of B blades at angle ψ, and their derivatives with respect to ψ.
struct Columns {
  Eigen::MatrixXd values, derivatives;
};

Columns columns_at(Eigen::Index count, double angle) {
  Columns c{Eigen::MatrixXd::Ones(count, count), Eigen::MatrixXd::Zero(count, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const double psi = angle + full_turn * static_cast<double>(k) / static_cast<double>(count);
    Eigen::Index at = 1;
    for (int n = 1; 2 * n < count; ++n, at += 2) {
      c.values(k, at) = std::cos(n * psi), c.derivatives(k, at) = -n * std::sin(n * psi);
      c.values(k, at + 1) = std::sin(n * psi), c.derivatives(k, at + 1) = n * std::cos(n * psi);
    }
    if (count % 2 == 0) c.values(k, count - 1) = k % 2 == 0 ? 1 : -1;
  }
  return c;
}

Eigen::MatrixXd transformed(const PeriodicMatrix& A, Eigen::Index m, double t,
                            const std::vector<std::vector<Eigen::Index>>& blades) {
  const Eigen::Index count = static_cast<Eigen::Index>(blades.size());
  const double rate = full_turn / A.period();
  const Columns c = columns_at(count, rate * t);
  Eigen::MatrixXd T = Eigen::MatrixXd::Identity(A.rows(), A.rows()), T_dot = Eigen::MatrixXd::Zero(A.rows(), A.rows());
  for (std::size_t i = 0; i < blades[0].size(); ++i) {
    for (const Eigen::Index half : {Eigen::Index{0}, m}) {
      for (Eigen::Index k = 0; k < count; ++k) {
        for (Eigen::Index l = 0; l < count; ++l) {
          const Eigen::Index row = half + blades[static_cast<std::size_t>(k)][i],
                             column = half + blades[static_cast<std::size_t>(l)][i];
          T(row, column) = c.values(k, l);
          T_dot(row, column) = rate * c.derivatives(k, l);
        }
      }
    }
  }
  return T.partialPivLu().solve(A.at(t) * T - T_dot);
}

/// The new coordinates: blade l's place has the transform's column l.
std::vector<MultibladeCoordinate> coordinates_of(const Held& held, const std::vector<std::string>& speed_names,
                                                 const std::vector<std::vector<Eigen::Index>>& blades) {
  using Kind = MultibladeCoordinate::Kind;
  std::vector<MultibladeCoordinate> all;
  for (std::size_t s = 0; s < held.size(); ++s) {
    if (!held[s]) all.push_back({Kind::fixed, 0, speed_names[s], -1});
  }
  const std::size_t count = blades.size();
  for (std::size_t i = 0; i < blades[0].size(); ++i) {
    const std::string name = all[static_cast<std::size_t>(blades[0][i])].name;
    const auto at = [&](std::size_t l) -> MultibladeCoordinate& { return all[static_cast<std::size_t>(blades[l][i])]; };
    at(0) = {Kind::collective, 0, name, -1};
    int n = 1;
    for (; 2 * n < static_cast<int>(count); ++n) {
      const auto l = static_cast<std::size_t>(2 * n - 1);
      at(l) = {Kind::cosine, n, name, blades[l + 1][i]};
      at(l + 1) = {Kind::sine, n, name, blades[l][i]};
    }
    if (count % 2 == 0) at(count - 1) = {Kind::differential, n, name, -1};
  }
  return all;
}

/// States of A that nothing but rounding couples with others, each part in order. What a rotor does collectively and
/// what its blades do against each other may have one frequency, and the eigenvectors of all of A would mix them.
std::vector<std::vector<Eigen::Index>> uncoupled(const Eigen::MatrixXd& A) {
  // What the eigenvalues of A as a whole would be wrong by.
  const double rounding = std::numeric_limits<double>::epsilon() * static_cast<double>(A.rows()) * A.norm();
  std::vector<std::vector<Eigen::Index>> parts;
  std::vector<bool> taken(static_cast<std::size_t>(A.rows()), false);
  for (Eigen::Index first = 0; first < A.rows(); ++first) {
    if (taken[static_cast<std::size_t>(first)]) continue;
    std::vector<Eigen::Index> part = {first};
    taken[static_cast<std::size_t>(first)] = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (Eigen::Index j = 0; j < A.rows(); ++j) {
        if (taken[static_cast<std::size_t>(j)] ||
            std::max(std::abs(A(part[i], j)), std::abs(A(j, part[i]))) <= rounding)
          continue;
        taken[static_cast<std::size_t>(j)] = true;
        part.push_back(j);
      }
    }
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

/// The modes of one part of the balanced A, which nothing else takes part in.
void add_modes(const Eigen::MatrixXd& balanced, const std::vector<Eigen::Index>& part, const Eigen::VectorXd& units,
               const Eigen::VectorXd& masses, std::vector<CharacteristicMode>& modes) {
  const Eigen::Index m = masses.size(), states = balanced.rows() - 2 * m;
  const Eigen::MatrixXd own = balanced(part, part);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(own);
  if (solver.info() != Eigen::Success) throw std::domain_error("the eigenvalues were not found");
  Eigen::MatrixXcd own_left;
  if (states > 0) own_left = left_vectors(own, solver.eigenvalues());
  for (Eigen::Index i = 0; i < own.rows(); ++i) {
    CharacteristicMode mode;
    mode.exponent = solver.eigenvalues()[i];
    if (mode.exponent.imag() < 0) continue;
    Eigen::VectorXcd right = Eigen::VectorXcd::Zero(balanced.rows()), left = right;
    right(part) = solver.eigenvectors().col(i);
    const Eigen::VectorXcd z = units.cwiseInverse().cast<Complex>().cwiseProduct(right);
    mode.shape.resize(m + states);
    mode.shape << z.head(m), z.tail(states);
    if (states > 0) {
      left(part) = own_left.col(i);
      mode.dominant = most_taking_part(left, right, m);
    } else {
      mode.shape.cwiseAbs2().cwiseProduct(masses).maxCoeff(&mode.dominant);
    }
    if (mode.shape[mode.dominant] != 0.0) mode.shape /= Complex(mode.shape[mode.dominant]);
    modes.push_back(std::move(mode));
  }
}

}  // namespace

std::vector<Blades> equal_branches(const Model& model, const std::vector<std::string>& names) {
  if (!names.empty()) return {named_blades(model, names)};
  std::vector<Blades> found;
  for (int parent = -1; parent < static_cast<int>(model.bodies().size()); ++parent) {
    std::map<std::string, std::vector<int>> alike;
    for (const int child : children(model, parent)) alike[likeness(model, child)].push_back(child);
    for (const auto& [kind, bodies] : alike) {
      if (bodies.size() < fewest_blades || bodies.size() > most_blades) continue;
      Blades blades = blades_of(model, bodies);
      if (!blades.speeds[0].empty()) found.push_back(std::move(blades));
    }
  }
  return found;
}

MultibladeForm multiblade_form(const TurningForm& form, const Held& held, const std::vector<std::string>& speed_names,
                               const std::vector<std::string>& state_names, const Blades& branches) {
  const Eigen::Index m = form.masses.size();
  Blades blades = ordered(form.A, m, branches, held);
  const auto at = places(blades, held);
  // The transform adds harmonics.
  const auto samples = 2 * static_cast<int>(form.turn.points.size()) + 1;
  std::vector<Eigen::MatrixXd> A;
  for (int k = 0; k < samples; ++k) A.push_back(transformed(form.A, m, form.A.period() * k / samples, at));
  std::vector<MultibladeCoordinate> coordinates = coordinates_of(held, speed_names, at);
  for (const std::string& name : state_names) coordinates.push_back({MultibladeCoordinate::Kind::fixed, 0, name, -1});
  Eigen::VectorXd masses = form.masses;
  for (Eigen::Index i = 0; i < masses.size(); ++i) {
    using Kind = MultibladeCoordinate::Kind;
    const Kind kind = coordinates[static_cast<std::size_t>(i)].kind;
    // Σ_k cos² nψ_k = B/2.
    const auto count = static_cast<double>(blades.count());
    masses[i] *= kind == Kind::fixed ? 1.0 : (kind == Kind::cosine || kind == Kind::sine ? count / 2 : count);
  }
  return {PeriodicMatrix(A, form.A.period()), std::move(masses), std::move(coordinates), std::move(blades)};
}

std::vector<CharacteristicMode> constant_modes(const Eigen::MatrixXd& A, const Eigen::VectorXd& masses) {
  const Eigen::Index m = masses.size();
  if (m == 0) return {};
  const Eigen::VectorXd units = balancing_units(A, masses);
  const Eigen::MatrixXd balanced = units.asDiagonal() * A * units.cwiseInverse().asDiagonal();
  std::vector<CharacteristicMode> modes;
  std::size_t zeros = 0;
  for (const std::vector<Eigen::Index>& part : uncoupled(balanced)) {
    add_modes(balanced, part, units, masses, modes);
    zeros += zeros_of(balanced(part, part));
  }
  std::stable_sort(modes.begin(), modes.end(), [](const CharacteristicMode& a, const CharacteristicMode& b) {
    return std::abs(a.exponent) < std::abs(b.exponent);
  });
  for (CharacteristicMode& mode : modes) {
    const std::size_t values = mode.exponent.imag() == 0 ? 1 : 2;
    if (values > zeros) break;
    zeros -= values;
    mode.exponent = 0;
  }
  return modes;
}

std::string pattern(const MultibladeForm& form, const CharacteristicMode& mode) {
  using Kind = MultibladeCoordinate::Kind;
  const MultibladeCoordinate& c = form.coordinates[static_cast<std::size_t>(mode.dominant)];
  if (c.kind == Kind::fixed) return c.name;
  if (c.kind == Kind::collective) return c.name + " collective";
  if (c.kind == Kind::differential) return c.name + " differential";
  const bool is_cosine = c.kind == Kind::cosine;
  const Complex cosine = mode.shape[is_cosine ? mode.dominant : c.partner],
                sine = mode.shape[is_cosine ? c.partner : mode.dominant];
  // cos(ωt − nψ), which runs with the rotor, has a cosine of 1 and a sine of −i.
  const double forward = std::abs(cosine + Complex(0, 1) * sine), backward = std::abs(cosine - Complex(0, 1) * sine);
  const std::string order = c.order > 1 ? " " + std::to_string(c.order) + " waves" : "";
  if (forward > 1.5 * backward) return c.name + order + " forward";
  if (backward > 1.5 * forward) return c.name + order + " backward";
  return c.name + order + " standing";
}

}  // namespace withy
