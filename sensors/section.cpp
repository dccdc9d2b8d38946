/// \file
/// What is inside a slender body at a section.
#include <fmt/format.h>

#include <numeric>
#include <optional>
#include <stdexcept>

#include "frame_sensor.hpp"
#include "withy/core/plugin/segments.hpp"
#include "withy/core/plugin/turned_sections.hpp"

namespace withy {
namespace {

/// Section moduli about the section's own axes [m³], for stresses of bending.
struct Moduli {
  double y, z;
};

/// How far the outermost fibres are from the section's own axes [m], for their strains.
struct Fibres {
  double y, z;
};

class BoundSection final : public BoundSensor {
 public:
  BoundSection(SectionPlace place, const Matrix3& axes, std::optional<Moduli> moduli, std::optional<Fibres> fibres)
      : place_(place), axes_(axes), moduli_(moduli), fibres_(fibres) {}
  std::vector<SensorColumn> columns() const override {
    std::vector<SensorColumn> c;
    add_columns(c, "f", "N");
    add_columns(c, "m", "N m");
    add_columns(c, "k", "1/m");
    add_columns(c, "elastic_m", "N m");
    if (moduli_) c.push_back({"stress_y", "Pa"});
    if (moduli_) c.push_back({"stress_z", "Pa"});
    if (fibres_) c.push_back({"strain_y", "1"});
    if (fibres_) c.push_back({"strain_z", "1"});
    return c;
  }
  std::vector<SectionPlace> sections() const override { return {place_}; }
  void read(SensedState& state, const SensorInputs& inputs, std::span<double> values) const noexcept override {
    const SectionLoad load = state.section(inputs.first_section);
    put(load.inner.force, values);
    put(load.inner.moment, values);
    put(load.curvature, values);
    put(load.elastic, values);
    if (moduli_) {
      const Vector3 moment = axes_.transpose() * load.inner.moment;
      values[0] = moment.y() / moduli_->y;
      values[1] = moment.z() / moduli_->z;
      values = values.subspan(2);
    }
    if (!fibres_) return;
    const Vector3 curvature = axes_.transpose() * load.curvature;
    values[0] = -curvature.y() * fibres_->y;
    values[1] = -curvature.z() * fibres_->z;
  }

 private:
  SectionPlace place_;
  Matrix3 axes_;  ///< the section's own, which moduli and fibres are of
  std::optional<Moduli> moduli_;
  std::optional<Fibres> fibres_;
};

class SectionSensor final : public Sensor {
 public:
  SectionSensor(std::string of, double at, std::optional<Moduli> moduli, std::optional<Fibres> fibres)
      : of_(std::move(of)), at_(at), moduli_(moduli), fibres_(fibres) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    const std::vector<int> pieces = model.segments(of_);
    if (pieces.empty()) throw std::invalid_argument("there is no body '" + of_ + "'");
    const auto body_of = [&](int piece) -> const Body& {
      return *model.bodies()[static_cast<std::size_t>(piece)].body;
    };
    std::vector<double> lengths;
    for (const int piece : pieces) {
      if (!body_of(piece).cut(0))
        throw std::invalid_argument("body '" + of_ +
                                    "' is no beam, and has no sections; `type: reaction` gives what a hinge carries");
      lengths.push_back(body_of(piece).shape().length);
    }
    const auto at = place_in_segments(lengths, at_);
    if (!at)
      throw std::invalid_argument(fmt::format("body '{}' ends at x = {} m; there is no section at {} m", of_,
                                              std::accumulate(lengths.begin(), lengths.end(), 0.0), at_));
    const SectionPlace place{pieces[at->segment], at->x};
    const auto* turned = dynamic_cast<const TurnedSections*>(&body_of(place.body));
    const Matrix3 axes = turned != nullptr ? turned->section_axes(place.x) : Matrix3::Identity();
    return std::make_unique<BoundSection>(place, axes, moduli_, fibres_);
  }

 private:
  std::string of_;
  double at_;
  std::optional<Moduli> moduli_;
  std::optional<Fibres> fibres_;
};

std::unique_ptr<Sensor> make_section(const Value& p, const MakeContext& /*context*/) {
  std::optional<Moduli> moduli;
  if (const Value* given = p.find("moduli")) moduli = {given->number_at("y"), given->number_at("z")};
  std::optional<Fibres> fibres;
  if (const Value* given = p.find("fibres")) fibres = {given->number_at("y"), given->number_at("z")};
  return std::make_unique<SectionSensor>(p.text_at("of"), p.number_at("at"), moduli, fibres);
}

}  // namespace

void enroll_section(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "section",
       .summary = "Inner force and moment of a beam on the part beyond x, in the section's axes, with its curvature",
       .parameters = {text("of", "beam that is cut").naming(ParameterSpec::Refers::body),
                      number("at", "m", "coordinate along the beam").least(0),
                      map("moduli",
                          {number("y", "m^3", "section modulus about y, or where it is twisted y_s").above(0),
                           number("z", "m^3", "section modulus about z or z_s").above(0)},
                          "for the bending stresses m/W at the outermost fibres")
                          .optional(),
                      map("fibres",
                          {number("y", "m", "distance of the outermost fibre from the y or y_s axis").least(0),
                           number("z", "m", "distance of the outermost fibre from the z or z_s axis").least(0)},
                          "for the bending strains -k c there")
                          .optional()},
       .make = &make_section});
}

}  // namespace withy
