/// \file
/// The beam's parameters in a scene.
#include <fmt/format.h>

#include <Eigen/QR>

#include "beam_body.hpp"
#include "magnitude.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/segments.hpp"

namespace withy {
namespace {

/// Reads a beam's parameters; what is wrong is reported, and nothing made then.
class Reader {
 public:
  Reader(const Value& parameters, const MakeContext& context, std::vector<std::string> remarks = {})
      : p_(parameters), context_(context), remarks_(std::move(remarks)) {}

  std::unique_ptr<Body> make() {
    const std::optional<BodyDamping> damping = BodyDamping::read(p_, context_.diagnostics);
    good_ = damping.has_value();
    BeamMaterial material{
        p_.number_at("length"), profile(p_.at("mass_per_length")), {}, damping.value_or(BodyDamping())};
    material.remarks = remarks_;
    good_ = good_ && masses_are_held(material.mass_per_length.mean(), material.length);
    using enum BeamData::Strain;
    add("bending_y", Vector3::UnitZ(), bending, "rotary_inertia", material);
    add("bending_z", -Vector3::UnitY(), bending, "rotary_inertia", material);
    add("torsion", Vector3::UnitX(), torsion, "inertia", material);
    add("extension", Vector3::UnitX(), elongation, "", material);
    add("shear_y", Vector3::UnitY(), elongation, "", material);
    add("shear_z", Vector3::UnitZ(), elongation, "", material);
    if (p_.has("twist")) material.twist = twist();
    remark_on_sections_without_inertia(material);
    if (!good_) return nullptr;
    return make_beam_body(material, std::move(strains_));
  }

 private:
  void remark_on_sections_without_inertia(BeamMaterial& material) const {
    for (const auto& [shear, bending] : {std::pair("shear_y", "bending_y"), std::pair("shear_z", "bending_z")}) {
      if (!p_.has(shear) || p_.at(shear).count_at("modes") == 0) continue;
      if (p_.has(bending) && p_.at(bending).has("rotary_inertia")) continue;
      material.remarks.push_back(
          fmt::format("{} without a rotary_inertia in {}: sections turn without inertia, so that a turn of the root "
                      "that shear undoes "
                      "moves no mass, and a hinge that turns there may move next to none",
                      shear, bending));
    }
  }
  /// Of no use after a reported error.
  Profile profile(const Value& value) {
    const auto read = Profile::read(value, p_.number_at("length"), context_.diagnostics);
    good_ = good_ && read.has_value();
    return read.value_or(Profile(1));
  }

  /// Turned sections: what is softer in one plane bends in the other as well, so both are to be known.
  BeamTwist twist() {
    for (const auto& [one, other] : {std::pair("bending_y", "bending_z"), std::pair("shear_y", "shear_z")}) {
      if (p_.has(one) == p_.has(other)) continue;
      const char *there = p_.has(one) ? one : other, *missing = p_.has(one) ? other : one;
      context_.diagnostics.error(
          p_.at("twist").place(),
          fmt::format("turns what {} is of out of its plane; need {} too (with `modes: 0` where it is not to move)",
                      there, missing));
      good_ = false;
    }
    const auto stiffness = [&](const char* key) {
      return good_ && p_.has(key) ? profile(p_.at(key).at("stiffness")) : Profile(0);
    };
    const Profile angle = profile(p_.at("twist"));
    return {angle, stiffness("bending_y"), stiffness("bending_z"), stiffness("shear_y"), stiffness("shear_z")};
  }

  /// The strain a scene asks for under `key`. A section's inertia stays where the strain has no modes.
  void add(const char* key, const Vector3& direction, BeamData::Strain kind, const char* inertia_key,
           BeamMaterial& material) {
    if (!p_.has(key)) return;
    const Value& given = p_.at(key);
    const Profile stiffness = profile(given.at("stiffness"));
    const Profile inertia = given.has(inertia_key) ? profile(given.at(inertia_key)) : Profile(0);
    if (given.has(inertia_key)) material.inertias.emplace_back(direction, inertia);
    good_ = good_ && strain_is_held(given, kind, stiffness.mean(), inertia_key, inertia.mean(), material);
    if (given.count_at("modes") == 0)
      material.remarks.push_back(fmt::format("{} has no modes: the body is rigid to it, whatever its stiffness", key));
    if (given.count_at("modes") == 0 || !good_) return;
    const BeamData beam = beam_data(kind, material.length,
                                    kind == BeamData::Strain::torsion ? inertia : material.mass_per_length, stiffness);
    auto functions = make_shape_functions(given.at("family"), given.at("modes"), beam, context_);
    if (functions == nullptr || !can_join(*functions, given.at("family"), kind, material.length)) {
      good_ = false;
    } else {
      strains_.push_back({key, direction, kind, stiffness, std::move(functions)});
    }
  }

  /// What families know of the beam, with its sections where they vary.
  static BeamData beam_data(BeamData::Strain kind, double length, const Profile& inertia, const Profile& stiffness) {
    BeamData beam{kind, length, inertia.mean(), stiffness.mean()};
    beam.kinks = inertia.knots();
    const std::vector<double> more = stiffness.knots();
    beam.kinks.insert(beam.kinks.end(), more.begin(), more.end());
    if (beam.kinks.empty()) return beam;
    beam.section = [inertia, stiffness](double x) { return BeamData::Section{inertia(x), stiffness(x)}; };
    return beam;
  }

  bool masses_are_held(double mass_per_length, double length) {
    const Factor mass{"mass_per_length", &p_.at("mass_per_length"), mass_per_length};
    const auto to = [&](int power) { return Factor{"length", &p_.at("length"), length, power}; };
    return held("the inertia", {mass, to(3)}, context_.diagnostics) &&
           held("the mass", {mass, to(1)}, context_.diagnostics);
  }

  /// Its stiffness, its section's inertia where there is one, and the square of its frequencies.
  bool strain_is_held(const Value& given, BeamData::Strain kind, double stiffness, const char* inertia_key,
                      double inertia, const BeamMaterial& material) {
    const bool bends = kind == BeamData::Strain::bending;
    const Factor stiff{"stiffness", &given.at("stiffness"), stiffness};
    const auto to = [&](int power) { return Factor{"length", &p_.at("length"), material.length, power}; };
    Factor moved{"mass_per_length", &p_.at("mass_per_length"), material.mass_per_length.mean(), -1};
    if (inertia > 0) {
      Factor turned{inertia_key, &given.at(inertia_key), inertia};
      if (!held("the inertia of its sections", {turned, to(1)}, context_.diagnostics)) return false;
      turned.power = -1;
      if (kind == BeamData::Strain::torsion) moved = turned;
    }
    return held("the square of a frequency", {stiff, moved, to(bends ? -4 : -2)}, context_.diagnostics) &&
           held("the stiffness", {stiff, to(bends ? -3 : -1)}, context_.diagnostics);
  }

  /// Segments pass moments on to each other, so functions that have no strain at an end leave each of them too stiff,
  /// and all of them together as well, however many there are: one that is strained evenly must be among their sums.
  bool can_join(const ShapeFunctions& functions, const Value& family, BeamData::Strain kind, double length) {
    if (const Value* segments = p_.find("segments"); segments == nullptr || segments->number() == 1) return true;
    constexpr Eigen::Index points = 64;
    const std::size_t n = functions.count();
    Eigen::MatrixXd strain(points, static_cast<Eigen::Index>(n));
    for (Eigen::Index k = 0; k < points; ++k) {
      std::vector<double> value(n), slope(n), curvature(n);
      functions.evaluate(length * (static_cast<double>(k) + 0.5) / points, value, slope, curvature);
      const std::vector<double>& of = kind == BeamData::Strain::bending ? curvature : slope;
      for (std::size_t i = 0; i < n; ++i) strain(k, static_cast<Eigen::Index>(i)) = of[i];
    }
    const Eigen::VectorXd even = Eigen::VectorXd::Ones(points);
    const Eigen::VectorXd sum = strain.completeOrthogonalDecomposition().solve(even);
    const double miss = (strain * sum - even).norm() / even.norm();
    if (miss < 1e-6) return true;
    context_.diagnostics.error(
        family.place(), fmt::format("these {} modes of a segment cannot be strained evenly, so that the segments would "
                                    "be too stiff however many; need family orthogonal-polynomials, or craig-bampton "
                                    "with 2 modes at least in bending",
                                    n));
    return false;
  }

  const Value& p_;
  const MakeContext& context_;
  std::vector<std::string> remarks_;
  std::vector<BeamStrain> strains_;
  bool good_ = true;
};

std::vector<ParameterSpec> strain_parameters(const char* stiffness, const char* unit = "N m^2") {
  return {number("stiffness", unit, stiffness).above(0).or_table("m"),
          integer("modes", "number of assumed modes").least(0).most(1000).otherwise(2).as(ParameterSpec::Role::modes),
          text("family", "assumed-mode family").naming(ParameterSpec::Refers::mode_family).otherwise("clamped-free")};
}

/// Quadrature follows the sections as they turn: what nobody means would take all memory.
constexpr double most_twist = 1e4;  // [rad]

std::vector<ParameterSpec> make_parameters() {
  std::vector<ParameterSpec> torsion = strain_parameters("torsional stiffness GJ");
  torsion.push_back(number("inertia", "kg m", "polar inertia per length, rho I_p").above(0).or_table("m"));
  const auto bending = [](const char* stiffness, const char* inertia) {
    std::vector<ParameterSpec> specs = strain_parameters(stiffness);
    specs.back().role = ParameterSpec::Role::bending_family;
    specs.push_back(number("rotary_inertia", "kg m", inertia).least(0).or_table("m").optional());
    return specs;
  };
  std::vector<ParameterSpec> specs = {
      number("length", "m", "length, undeformed").above(0),
      number("mass_per_length", "kg/m", "mass per length").above(0).or_table("m"),
      number("twist", "rad",
             "angle about x from the body's y to that of the section's own axes, which stiffness and inertia are of")
          .least(-most_twist)
          .most(most_twist)
          .or_table("m")
          .optional(),
      map("bending_y", bending("EI_z, for deflection along y", "rotary inertia of the sections per length, rho I_z"),
          "bending with deflection along y")
          .optional(),
      map("bending_z", bending("EI_y, for deflection along z", "rotary inertia of the sections per length, rho I_y"),
          "bending with deflection along z")
          .optional(),
      map("torsion", torsion, "twist about x").optional(),
      map("extension", strain_parameters("axial stiffness EA", "N"), "extension along x").optional(),
      map("shear_y", strain_parameters("shear stiffness k G A along y", "N"),
          "shear, deflection along y beside that of bending_y")
          .optional(),
      map("shear_z", strain_parameters("shear stiffness k G A along z", "N"),
          "shear, deflection along z beside that of bending_z")
          .optional(),
      integer("segments", "number of beams, welded one behind the other, it is cut into; modes are of each")
          .least(1)
          .most(1000)
          .otherwise(1)};
  for (ParameterSpec& spec : damping_parameters()) specs.push_back(std::move(spec));
  return specs;
}

const std::vector<ParameterSpec>& parameters() {
  static const std::vector<ParameterSpec> all = make_parameters();
  return all;
}

/// The whole beam in vibration modes of its own sections: of one strain the lowest is exact, where strains share in
/// modes as twist and shear make them do, six of each find it to a small part of what damping is known to. Null where
/// they cannot be made.
std::unique_ptr<Body> in_vibration_modes(const Value& p, const MakeContext& context) {
  constexpr double functions = 6;
  Value whole = p;
  whole.set("segments", Value(1.0, p.place()));
  for (const char* strain : {"bending_y", "bending_z", "torsion", "extension", "shear_y", "shear_z"}) {
    const Value* given = p.find(strain);
    if (given == nullptr || given->count_at("modes") == 0) continue;
    Value vibrating = *given;
    vibrating.set("modes", Value(functions, given->place()));
    vibrating.set("family", Value::map({{"name", Value(std::string("vibration-modes"), given->place())},
                                        {"tip_mass", Value(0.0)},
                                        {"tip_inertia", Value(0.0)},
                                        {"tip_offset", Value(0.0)},
                                        {"static", Value(0.0)}},
                                       given->place()));
    whole.set(strain, std::move(vibrating));
  }
  Diagnostics told;  // what is wrong with the beam itself is told of the one that the scene asks for
  return Reader(whole, {context.registry, told, context.directory}).make();
}

std::unique_ptr<Body> make_beam(const Value& p, const MakeContext& context) {
  const Value* segments = p.find("segments");
  const bool damped =
      (p.number_at("damping_ratio") != 0 || p.has("damping")) && segments != nullptr && segments->number() > 1;
  const std::unique_ptr<Body> vibrating = damped ? in_vibration_modes(p, context) : nullptr;
  std::vector<std::string> remarks;
  if (damped && vibrating == nullptr)
    remarks.emplace_back(
        "segments are damped by the lowest frequency of the whole in its own functions, which may be off: its "
        "vibration "
        "modes cannot be made");
  auto whole = Reader(p, context, std::move(remarks)).make();
  if (whole == nullptr) return nullptr;
  return in_segments(
      std::move(whole), p, parameters(), [&](const Value& segment) { return Reader(segment, context).make(); },
      vibrating.get());
}

}  // namespace

void enroll_beam(Enrollment& enrollment) {
  enrollment.add<Body>(
      {.id = "beam",
       .summary = "Slender beam along x, bending in two planes and twisting, if wanted with extension and shear",
       .parameters = parameters(),
       .make = &make_beam});
}

}  // namespace withy
