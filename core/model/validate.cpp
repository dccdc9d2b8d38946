#include "withy/core/model/validate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace withy {
namespace {

constexpr double tolerance = 1e-10;

using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;

std::string size_fault(const std::string& name, const ConstMatrix& m, Eigen::Index rows, Eigen::Index columns) {
  if (m.rows() == rows && m.cols() == columns) return {};
  std::ostringstream text;
  text << name << " is " << m.rows() << " by " << m.cols() << ", not " << rows << " by " << columns;
  return text.str();
}

std::string finite_fault(const std::string& name, const ConstMatrix& m) {
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      if (std::isfinite(m(i, j))) continue;
      std::ostringstream text;
      text << name << " has " << m(i, j) << " in row " << i + 1 << ", column " << j + 1;
      return text.str();
    }
  }
  return {};
}

std::string symmetry_fault(const std::string& name, const ConstMatrix& m) {
  if (m.size() == 0) return {};
  if ((m - m.transpose()).cwiseAbs().maxCoeff() <= tolerance * m.cwiseAbs().maxCoeff()) return {};
  return name + " is not symmetric";
}

std::string square_fault(const std::string& name, const ConstMatrix& m, Eigen::Index size) {
  if (std::string fault = size_fault(name, m, size, size); !fault.empty()) return fault;
  if (std::string fault = finite_fault(name, m); !fault.empty()) return fault;
  return symmetry_fault(name, m);
}

/// Of a symmetric matrix: it is semidefinite where the smallest shift makes it definite.
std::string sign_fault(const std::string& name, const ConstMatrix& m) {
  const double greatest = m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff();
  if (greatest == 0) return {};
  const auto shift = tolerance * greatest * Eigen::MatrixXd::Identity(m.rows(), m.cols());
  if (Eigen::LLT<Eigen::MatrixXd>(m + shift).info() == Eigen::Success) return {};
  return name + " is not positive semidefinite";
}

std::string field_fault(const std::string& name, const ConstMatrix& m, Eigen::Index modes) {
  if (std::string fault = size_fault(name, m, 3, modes); !fault.empty()) return fault;
  return finite_fault(name, m);
}

/// Whether the head of a table cannot hold a text: it is one line of columns as "name[unit]" with commas between them.
bool breaks_heads(const std::string& text, const char* signs) {
  return text.find_first_of(signs) != std::string::npos || std::any_of(text.begin(), text.end(), [](char c) {
           return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
         });
}

/// Of a name, which is that of an object in HDF5 too.
bool is_no_column(const std::string& name) { return breaks_heads(name, ",\"/"); }

constexpr const char* column_rule = " has a name with a comma, a quotation mark, a slash or a control character";

/// As tables spell a name: "mode[1]" is "mode.1".
std::string spelled(const std::string& name) {
  std::string text = name;
  std::erase(text, ']');
  std::replace(text.begin(), text.end(), '[', '.');
  return text;
}

std::string names_fault(const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) return "a mode has no name";
    if (is_no_column(names[i])) return "mode " + std::to_string(i + 1) + column_rule;
    if (!seen.insert(spelled(names[i])).second) return "two modes are named '" + names[i] + "'";
  }
  for (const std::string& name : seen)
    if (seen.contains(name + ".rate")) return "a mode is named '" + name + ".rate', as the rate of another";
  return {};
}

/// Of a matrix that is one piece of memory.
template <class Matrix>
bool all_finite(const Matrix& m) {
  double nothing = 0;  // or NaN
  for (const double *at = m.data(), *const end = at + m.size(); at != end; ++at) nothing += 0.0 * *at;
  return nothing == 0;
}

/// Symmetric to the last bit, as matrices mostly are.
bool plainly_symmetric(const Eigen::MatrixXd& m) {
  for (Eigen::Index j = 1; j < m.cols(); ++j)
    for (Eigen::Index i = 0; i < j; ++i)
      if (m(i, j) != m(j, i)) return false;
  return true;
}

/// Whether nothing is to be found: scenes have thousands of points, and cases of a sweep are checked one by one.
bool plainly_sound(const PointExpansion& point, Eigen::Index modes) {
  const auto field = [&](const Matrix3X& m) { return m.cols() == modes && all_finite(m); };
  const auto square = [&](const Eigen::MatrixXd& m) {
    return m.rows() == modes && m.cols() == modes && all_finite(m) && plainly_symmetric(m);
  };
  return all_finite(point.X) && field(point.phi) && field(point.psi) &&
         std::all_of(point.gamma.begin(), point.gamma.end(), square) &&
         std::all_of(point.theta.begin(), point.theta.end(), square);
}

std::string particle_fault(const Particle& particle, Eigen::Index modes) {
  if (!std::isfinite(particle.mass) || particle.mass < 0) {
    std::ostringstream text;
    text << "its mass is " << particle.mass;
    return text.str();
  }
  return find_fault(particle.at, modes);
}

std::string section_fault(const Section& section, Eigen::Index modes) {
  if (std::string fault = square_fault("its inertia", section.inertia, 3); !fault.empty()) return fault;
  if (std::string fault = sign_fault("its inertia", section.inertia); !fault.empty()) return fault;
  return find_fault(section.at, modes);
}

}  // namespace

std::string find_fault(const PointExpansion& point, Eigen::Index modes) {
  if (plainly_sound(point, modes)) return {};
  if (std::string fault = finite_fault("X", point.X); !fault.empty()) return fault;
  if (std::string fault = field_fault("Phi", point.phi, modes); !fault.empty()) return fault;
  if (std::string fault = field_fault("Psi", point.psi, modes); !fault.empty()) return fault;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string axis(1, "xyz"[c]);
    if (std::string fault = square_fault("Gamma_" + axis, point.gamma[c], modes); !fault.empty()) return fault;
    if (std::string fault = square_fault("Theta_" + axis, point.theta[c], modes); !fault.empty()) return fault;
  }
  return {};
}

std::string find_fault(const ModalShape& shape) {
  const Eigen::Index n = shape.modes();
  if (std::string fault = names_fault(shape.mode_names); !fault.empty()) return fault;
  if (!std::isfinite(shape.length) || shape.length < 0) {
    std::ostringstream text;
    text << "its length is " << shape.length;
    return text.str();
  }
  if (std::string fault = square_fault("the stiffness matrix", shape.stiffness, n); !fault.empty()) return fault;
  if (std::string fault = square_fault("the damping matrix", shape.damping, n); !fault.empty()) return fault;
  if (std::string fault = sign_fault("the damping matrix", shape.damping); !fault.empty()) return fault;
  for (std::size_t i = 0; i < shape.particles.size(); ++i) {
    if (const std::string fault = particle_fault(shape.particles[i], n); !fault.empty()) {
      return "particle " + std::to_string(i + 1) + ": " + fault;
    }
  }
  for (std::size_t i = 0; i < shape.sections.size(); ++i) {
    if (const std::string fault = section_fault(shape.sections[i], n); !fault.empty()) {
      return "section " + std::to_string(i + 1) + ": " + fault;
    }
  }
  return {};
}

std::string find_fault(const std::vector<SensorColumn>& columns) {
  if (columns.empty()) return "there is none";
  std::set<std::string> seen;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const SensorColumn& c = columns[i];
    const std::string which = "number " + std::to_string(i + 1);
    if (is_no_column(c.component)) return which + column_rule;
    if (breaks_heads(c.unit, ",\"[]"))
      return which + " has a unit with a comma, a quotation mark, a bracket or a control character";
    if (!seen.insert(spelled(c.component)).second)
      return c.component.empty() ? "two have no name" : "two are named '" + c.component + "'";
  }
  return {};
}

}  // namespace withy
