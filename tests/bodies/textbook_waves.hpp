/// \file
/// Eigenfunctions of the uniform beam in their textbook forms (Blevins 1979, table 8-1), in multiple precision.
#pragma once

#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace withy::test {

/// cosh and sinh of β = 629 lose 273 digits to cancellation; 330 leave more than fifty.
using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<330>>;

/// f and f′ of a characteristic equation f(β) = 0, divided by cosh β.
struct Equation {
  Exact f, slope;
};
inline Equation clamped_free_equation(const Exact& b) {
  return {cos(b) + 1 / cosh(b), -sin(b) - sinh(b) / (cosh(b) * cosh(b))};
}
inline Equation alike_equation(const Exact& b) {
  return {cos(b) - 1 / cosh(b), -sin(b) + sinh(b) / (cosh(b) * cosh(b))};
}
inline Equation pinned_equation(const Exact& b) {
  const Exact t = tanh(b);
  return {sin(b) - cos(b) * t, cos(b) + sin(b) * t - cos(b) * (1 - t * t)};
}
inline Equation sine_equation(const Exact& b) { return {sin(b), cos(b)}; }

/// Factors of cosh βξ, cos βξ, sinh βξ, sin βξ.
struct Textbook {
  Exact cosh, cos, sinh, sin;
};
inline Textbook clamped_free_form(const Exact& b) {
  const Exact s = (cosh(b) + cos(b)) / (sinh(b) + sin(b));
  return {1, -1, -s, s};
}
inline Textbook held_tip_form(const Exact& b) {
  const Exact s = (cosh(b) - cos(b)) / (sinh(b) - sin(b));
  return {1, -1, -s, s};
}
inline Textbook free_free_form(const Exact& b) {
  const Exact s = (cosh(b) - cos(b)) / (sinh(b) - sin(b));
  return {1, 1, -s, -s};
}
inline Textbook pinned_free_form(const Exact& b) {
  const Exact C = sin(b) / sinh(b);
  const Exact n = sqrt(2 / (1 - C * C));
  return {0, 0, n * C, n};
}
inline Textbook pinned_pinned_form(const Exact&) { return {0, 0, 0, sqrt(Exact(2))}; }

struct Uniform {
  const char* id;
  bool torsion;                        ///< has functions for torsion
  double offset;                       ///< β_k ≈ (k + offset) π
  Equation (*equation)(const Exact&);  ///< Blevins 1979, table 8-1
  Textbook (*form)(const Exact&);      ///< the same table
  std::array<double, 3> blevins;       ///< its first three β
  std::array<bool, 3> root, tip;       ///< whether φ, φ′, φ″ vanish there
};
inline void PrintTo(const Uniform& family, std::ostream* out) { *out << family.id; }

inline const Uniform uniform_families[] = {
    {"clamped-free",
     true,
     -0.5,
     &clamped_free_equation,
     &clamped_free_form,
     {1.87510407, 4.69409113, 7.85475744},
     {true, true, false},
     {false, false, true}},
    {"clamped-clamped",
     true,
     0.5,
     &alike_equation,
     &held_tip_form,
     {4.73004074, 7.85320462, 10.9956078},
     {true, true, false},
     {true, true, false}},
    {"clamped-pinned",
     false,
     0.25,
     &pinned_equation,
     &held_tip_form,
     {3.92660231, 7.06858275, 10.21017612},
     {true, true, false},
     {true, false, true}},
    {"pinned-pinned",
     false,
     0.0,
     &sine_equation,
     &pinned_pinned_form,
     {3.14159265, 6.28318531, 9.42477796},
     {true, false, true},
     {true, false, true}},
    {"pinned-free",
     false,
     0.25,
     &pinned_equation,
     &pinned_free_form,
     {3.92660231, 7.06858275, 10.21017612},
     {true, false, true},
     {false, false, true}},
    {"free-free",
     true,
     0.5,
     &alike_equation,
     &free_free_form,
     {4.73004074, 7.85320462, 10.9956078},
     {false, false, true},
     {false, false, true}},
};

/// The k-th root of a family's equation, from its asymptote by Newton's method.
inline Exact textbook_root(const Uniform& family, int k) {
  Exact beta = (Exact(k) + Exact(family.offset)) * boost::math::constants::pi<Exact>();
  for (int i = 0; i < 12; ++i) {
    const Equation e = family.equation(beta);
    beta -= e.f / e.slope;
  }
  return beta;
}

/// φ, φ′/β and φ″/β² at βξ = p.
inline std::array<double, 3> textbook_values(const Textbook& c, const Exact& p) {
  const Exact ch = cosh(p), co = cos(p), sh = sinh(p), si = sin(p);
  return {static_cast<double>(c.cosh * ch + c.cos * co + c.sinh * sh + c.sin * si),
          static_cast<double>(c.cosh * sh - c.cos * si + c.sinh * ch + c.sin * co),
          static_cast<double>(c.cosh * ch - c.cos * co + c.sinh * sh - c.sin * si)};
}

}  // namespace withy::test
