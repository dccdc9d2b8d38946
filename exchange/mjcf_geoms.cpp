#include "mjcf_geoms.hpp"

#include <fmt/format.h>

#include <numbers>

#include "withy/scene/names.hpp"

namespace withy::exchange {
namespace {

/// Of unit density, about its centre, symmetric about its axes x, y, z.
struct Solid {
  double volume = 0;
  Vector3 moments = Vector3::Zero();  ///< for unit density [m^5]
};

Solid ellipsoid(double a, double b, double c) {
  const double v = 4.0 / 3 * std::numbers::pi * a * b * c;
  return {v, v / 5 * Vector3(b * b + c * c, a * a + c * c, a * a + b * b)};
}

Solid box(double a, double b, double c) {
  const double v = 8 * a * b * c;
  return {v, v / 3 * Vector3(b * b + c * c, a * a + c * c, a * a + b * b)};
}

Solid cylinder(double r, double h) {
  const double v = 2 * std::numbers::pi * r * r * h, across = v * (r * r / 4 + h * h / 3);
  return {v, {across, across, v * r * r / 2}};
}

/// A cylinder of half length h between two hemispheres, whose centres of mass are 3r/8 beyond its ends.
Solid capsule(double r, double h) {
  const Solid middle = cylinder(r, h), ends = ellipsoid(r, r, r);
  const double across = ends.volume * (h * h + 0.75 * h * r);
  return {middle.volume + ends.volume, middle.moments + ends.moments + Vector3(across, across, 0)};
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
  if (type == "plane" || type == "hfield" || a.number("mass", 1) == 0) return {};
  const bool round = type == "capsule" || type == "cylinder";
  const bool has_length = round || type == "box" || type == "ellipsoid";  // which `fromto` may give
  const std::size_t count = type == "sphere" || (has_length && geom.find("fromto") != nullptr) ? 1 : round ? 2 : 3;
  if (type != "sphere" && !has_length) {
    a.error("type",
            fmt::format("got {}, whose mass is not in this file; give the body an <inertial>", in_quotes(type)));
    return {};
  }
  const auto size = a.numbers("size", count, 3);
  if (!size || (*size)[0] <= 0) {
    a.error("size", fmt::format("need {} of a {}, the first above 0",
                                count == 1 ? "a size" : fmt::format("{} sizes", count), type));
    return {};
  }
  MassProperties m{0, a.vector("pos", Vector3::Zero()), Matrix3::Zero()};
  Matrix3 R = angles.rotation(geom, diagnostics);
  const double r = (*size)[0];
  const double across = count == 3 ? (*size)[1] : r;
  double half = count == 3 ? (*size)[2] : count == 2 ? (*size)[1] : 0;
  if (const auto ends = a.numbers("fromto", 6, 6); ends && has_length) {
    const Vector3 from((*ends)[0], (*ends)[1], (*ends)[2]), to((*ends)[3], (*ends)[4], (*ends)[5]);
    m.center = (from + to) / 2;
    half = (to - from).norm() / 2;
    R = rotation_between(Vector3::UnitZ(), to - from);
  }
  const Solid solid = type == "sphere"     ? ellipsoid(r, r, r)
                      : type == "capsule"  ? capsule(r, half)
                      : type == "cylinder" ? cylinder(r, half)
                      : type == "box"      ? box(r, across, half)
                                           : ellipsoid(r, across, half);
  const double density = geom.find("mass") != nullptr ? a.number("mass", 0) / solid.volume : a.number("density", 1000);
  m.mass = density * solid.volume;
  m.inertia = turned(R, density * solid.moments.asDiagonal().toDenseMatrix());
  return m;
}

}  // namespace withy::exchange
