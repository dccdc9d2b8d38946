#include "mjcf_geoms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "withy/scene/names.hpp"

namespace withy::exchange {
namespace {

/// About its centre, symmetric about its axes x, y, z: of unit density filled, of a unit of mass per area as a shell.
struct Solid {
  double size = 0;                    ///< volume [m^3]; area [m^2] of a shell
  Vector3 moments = Vector3::Zero();  ///< of inertia over density [m^5]; over mass per area [m^4] of a shell
};

/// Of the second moments ∫ x², ∫ y², ∫ z².
Vector3 moments_of(const Vector3& second) { return Vector3::Constant(second.sum()) - second; }

Solid ellipsoid(const Vector3& a) {
  const double v = 4.0 / 3 * std::numbers::pi * a.prod();
  return {v, moments_of(v / 5 * a.cwiseAbs2())};
}

Solid box(const Vector3& a) { return {8 * a.prod(), moments_of(8 * a.prod() / 3 * a.cwiseAbs2())}; }

Solid cylinder(double r, double h) {
  const double v = 2 * std::numbers::pi * r * r * h, across = v * (r * r / 4 + h * h / 3);
  return {v, {across, across, v * r * r / 2}};
}

/// A tube of half length h closed by `ends` at its ends: two halves of what is symmetric about z, whose centres of mass
/// are `beyond` the ends of the tube.
Solid closed(const Solid& tube, const Solid& ends, double h, double beyond) {
  const double across = ends.size * (h * h + 2 * h * beyond);
  return {tube.size + ends.size, tube.moments + ends.moments + Vector3(across, across, 0)};
}

Solid capsule(double r, double h) { return closed(cylinder(r, h), ellipsoid(Vector3::Constant(r)), h, 3 * r / 8); }

/// Its area is Thomsen's approximation, to 1.1 %, and its mass lies between it and a slightly greater ellipsoid whose
/// three axes are longer by the same: both are MuJoCo's. Exact for a sphere.
Solid ellipsoid_shell(const Vector3& a) {
  const double p = 1.6075;
  const Vector3 products(a[1] * a[2], a[2] * a[0], a[0] * a[1]);
  const double area = 4 * std::numbers::pi * std::pow(products.array().pow(p).mean(), 1 / p);
  // d/dε of V a_i²/5 at axes a + ε, over dV/dε.
  const Vector3 squares = a.cwiseAbs2();
  const Vector3 second = (squares + 2 * a.prod() / products.sum() * a) / 5;
  return {area, moments_of(area * second)};
}

Solid box_shell(const Vector3& a) {
  const Vector3 faces = 8 * Vector3(a[1] * a[2], a[2] * a[0], a[0] * a[1]);  // both across x, …
  const Vector3 second = a.cwiseAbs2().cwiseProduct((Vector3::Constant(faces.sum()) + 2 * faces) / 3);
  return {faces.sum(), moments_of(second)};
}

Solid tube_shell(double r, double h) {
  const double area = 4 * std::numbers::pi * r * h, across = area * (r * r / 2 + h * h / 3);
  return {area, {across, across, area * r * r}};
}

Solid cylinder_shell(double r, double h) {
  const double discs = 2 * std::numbers::pi * r * r, across = discs * r * r / 4;
  return closed(tube_shell(r, h), {discs, {across, across, 2 * across}}, h, 0);
}

Solid capsule_shell(double r, double h) {
  return closed(tube_shell(r, h), ellipsoid_shell(Vector3::Constant(r)), h, r / 2);
}

/// \param a radius and half length of what is round about z, else half lengths of the axes
Solid solid_of(std::string_view type, const Vector3& a, bool shell) {
  if (type == "capsule") return shell ? capsule_shell(a[0], a[2]) : capsule(a[0], a[2]);
  if (type == "cylinder") return shell ? cylinder_shell(a[0], a[2]) : cylinder(a[0], a[2]);
  if (type == "box") return shell ? box_shell(a) : box(a);
  return shell ? ellipsoid_shell(a) : ellipsoid(a);
}

/// Whether its mass lies on its surface.
bool is_shell(const Attributes& a, const Element& geom) {
  const std::string* text = geom.find("shellinertia");
  if (text == nullptr || *text == "false") return false;
  if (*text != "true") a.error("shellinertia", fmt::format("got {}; need true or false", in_quotes(*text)));
  return true;
}

/// Reports a mass or density below zero; where both are given `mass` counts.
void check_mass(const Attributes& a, const Element& geom) {
  const char* key = geom.find("mass") != nullptr ? "mass" : "density";
  if (const double value = a.number(key, 0); value < 0) a.error(key, fmt::format("got {}; need at least 0", value));
}

/// The points that `fromto` gives; none, after a report, where they say nothing, as MuJoCo refuses it too.
std::optional<std::pair<Vector3, Vector3>> ends_of(const Attributes& a, const std::string& type, bool has_length) {
  constexpr double shortest_half = 1e-14;  // MuJoCo's mjEPS [m]
  const auto ends = a.numbers("fromto", 6, 6);
  if (!ends) return {};
  const Vector3 from((*ends)[0], (*ends)[1], (*ends)[2]), to((*ends)[3], (*ends)[4], (*ends)[5]);
  if (!has_length) {
    a.error("fromto", fmt::format("a {} has no ends; need a capsule, cylinder, box or ellipsoid", type));
  } else if ((to - from).norm() < 2 * shortest_half) {
    a.error("fromto", fmt::format("got two ends at {} {} {}; need a length", from[0], from[1], from[2]));
  } else if (!a.vector("pos", Vector3::Zero()).isZero(0)) {
    a.error("pos", "the geom has a fromto, which says where it is; need one of them");
  } else {
    return std::pair(from, to);
  }
  return {};
}

/// Looks: by `mass`, else by `density`.
bool is_massless(const Attributes& a, const Element& geom) {
  return a.number(geom.find("mass") != nullptr ? "mass" : "density", 1) == 0;
}

}  // namespace

void MassProperties::add(const MassProperties& other) {
  const double whole = mass + other.mass;
  if (whole == 0) return;
  const Vector3 d = other.center - center;
  const double reduced = mass * other.mass / whole;
  inertia += other.inertia + reduced * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
  center = (mass * center + other.mass * other.center) / whole;
  mass = whole;
}

std::optional<MassProperties> mass_of_geom(const Element& geom, const MjcfAngles& angles, Diagnostics& diagnostics) {
  const Attributes a(geom, diagnostics);
  const std::string* given = geom.find("type");
  const std::string type = given != nullptr ? *given : geom.find("mesh") != nullptr ? "mesh" : "sphere";
  if (type == "plane" || type == "hfield" || is_massless(a, geom)) return {};
  const bool round = type == "capsule" || type == "cylinder";
  const bool has_length = round || type == "box" || type == "ellipsoid";  // which `fromto` may give
  const std::size_t count = type == "sphere" || (has_length && geom.find("fromto") != nullptr) ? 1 : round ? 2 : 3;
  if (type != "sphere" && !has_length) {
    a.error("type",
            fmt::format("got {}, whose mass is not in this file; give the body an <inertial>", in_quotes(type)));
    return {};
  }
  if (geom.find("mesh") != nullptr) {
    a.error("mesh",
            fmt::format("the {} is fitted to a mesh, which is not in this file; give the body an <inertial>", type));
    return {};
  }
  check_mass(a, geom);
  const auto size = a.numbers("size", count, 3);
  if (!size ||
      std::any_of(size->begin(), size->begin() + static_cast<std::ptrdiff_t>(count), [](double x) { return x <= 0; })) {
    a.error("size",
            fmt::format("need {} of a {} above 0", count == 1 ? "a size" : fmt::format("{} sizes", count), type));
    return {};
  }
  MassProperties m{0, a.vector("pos", Vector3::Zero()), Matrix3::Zero()};
  Matrix3 R = angles.rotation(geom, diagnostics);
  const double r = (*size)[0];
  const double across = count == 3 ? (*size)[1] : r;
  double half = count == 3 ? (*size)[2] : count == 2 ? (*size)[1] : 0;
  if (geom.find("fromto") != nullptr) {
    const auto ends = ends_of(a, type, has_length);
    if (!ends) return {};
    const auto& [from, to] = *ends;
    m.center = (from + to) / 2;
    half = (to - from).norm() / 2;
    R = rotation_between(Vector3::UnitZ(), to - from);
  }
  const Solid solid =
      solid_of(type, type == "sphere" ? Vector3::Constant(r) : Vector3(r, across, half), is_shell(a, geom));
  const double density = geom.find("mass") != nullptr ? a.number("mass", 0) / solid.size : a.number("density", 1000);
  m.mass = density * solid.size;
  m.inertia = turned(R, density * solid.moments.asDiagonal().toDenseMatrix());
  return m;
}

}  // namespace withy::exchange
