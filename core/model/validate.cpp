#include "withy/core/model/validate.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <string_view>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/matrix_faults.hpp"

namespace withy {
namespace {

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

/// The byte that a sequence of UTF-8 begins with: how many bytes follow it, from which number on such a sequence is not
/// longer than it needs to be, and what of the number it holds. Nothing follows what begins none.
struct LeadByte {
  std::size_t following = 0;
  char32_t least = 0, number = 0;
};

LeadByte lead_byte(unsigned char c) {
  if (c >= 0xF0 && c < 0xF5) return {3, 0x10000, char32_t(c & 0x07)};
  if (c >= 0xE0 && c < 0xF0) return {2, 0x800, char32_t(c & 0x0F)};
  if (c >= 0xC2 && c < 0xE0) return {1, 0x80, char32_t(c & 0x1F)};
  return {};
}

/// As the files of results are.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
    if (byte(i) < 0x80) {
      ++i;
      continue;
    }
    const LeadByte lead = lead_byte(byte(i));
    if (lead.following == 0 || i + lead.following >= text.size()) return false;
    char32_t number = lead.number;
    for (std::size_t k = 1; k <= lead.following; ++k) {
      if ((byte(i + k) & 0xC0) != 0x80) return false;
      number = number << 6 | char32_t(byte(i + k) & 0x3F);
    }
    const bool surrogate = number >= 0xD800 && number < 0xE000;
    if (number < lead.least || number > 0x10FFFF || surrogate) return false;
    i += lead.following + 1;
  }
  return true;
}

/// What is wrong with the name of a column, which is that of an object in HDF5 too; empty: nothing.
std::string name_fault(const std::string& name) {
  if (!is_utf8(name)) return " has a name that is not UTF-8";
  return breaks_heads(name, ",\"/") ? " has a name with a comma, a quotation mark, a slash or a control character" : "";
}

std::string names_fault(const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) return "a mode has no name";
    if (std::string fault = name_fault(names[i]); !fault.empty()) return "mode " + std::to_string(i + 1) + fault;
    if (!seen.insert(spelled_in_tables(names[i])).second) return "two modes are named '" + names[i] + "'";
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

std::string mass_fault(const std::vector<Particle>& particles, const std::vector<Section>& sections,
                       Eigen::Index modes) {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (const std::string fault = particle_fault(particles[i], modes); !fault.empty())
      return "particle " + std::to_string(i + 1) + ": " + fault;
  }
  for (std::size_t i = 0; i < sections.size(); ++i) {
    if (const std::string fault = section_fault(sections[i], modes); !fault.empty())
      return "section " + std::to_string(i + 1) + ": " + fault;
  }
  return {};
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
  return mass_fault(shape.particles, shape.sections, n);
}

std::string find_fault(const BodyCut& cut, Eigen::Index modes) {
  if (std::string fault = find_fault(cut.at, modes); !fault.empty()) return fault;
  if (std::string fault = field_fault("its curvature", cut.curvature, modes); !fault.empty()) return fault;
  if (std::string fault = square_fault("its stiffness", cut.stiffness, 3); !fault.empty()) return fault;
  return mass_fault(cut.particles, cut.sections, modes);
}

std::string find_fault(const std::vector<SensorColumn>& columns) {
  if (columns.empty()) return "there is none";
  std::set<std::string> seen;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const SensorColumn& c = columns[i];
    const std::string which = "number " + std::to_string(i + 1);
    if (std::string fault = name_fault(c.component); !fault.empty()) return which + fault;
    if (!is_utf8(c.unit)) return which + " has a unit that is not UTF-8";
    if (breaks_heads(c.unit, ",\"[]"))
      return which + " has a unit with a comma, a quotation mark, a bracket or a control character";
    if (!seen.insert(spelled_in_tables(c.component)).second)
      return c.component.empty() ? "two have no name" : "two are named '" + c.component + "'";
  }
  return {};
}

std::string state_names_fault(const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string which = "number " + std::to_string(i + 1);
    if (names[i].empty()) return which + " has no name";
    if (std::string fault = name_fault(names[i]); !fault.empty()) return which + fault;
    if (!seen.insert(spelled_in_tables(names[i])).second) return "two are named '" + names[i] + "'";
  }
  return {};
}

}  // namespace withy
