/// \file
/// Energies and momenta of bodies.
#include <stdexcept>

#include "frame_sensor.hpp"

namespace withy {
namespace {

enum class Content { energy, momentum };

/// A body by its pieces; all bodies of the model where a scene names none.
std::vector<int> pieces_of(const Model& model, const std::string& name) {
  if (name != "all") {
    std::vector<int> pieces = model.segments(name);
    if (pieces.empty()) throw std::invalid_argument("there is no body '" + name + "'");
    return pieces;
  }
  std::vector<int> every(model.bodies().size());
  for (std::size_t i = 0; i < every.size(); ++i) every[i] = static_cast<int>(i);
  return every;
}

/// The rotor of a hinge's drive, which is of no body.
struct Rotor {
  std::size_t rate;  ///< index in State::y
  double inertia;    ///< seen from the hinge [kg m², kg]
};

std::vector<Rotor> rotors_of(const Model& model) {
  std::vector<Rotor> rotors;
  const Layout& layout = model.layout();
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (const double inertia = model.hinges()[h].reflected_inertia; inertia > 0)
      rotors.push_back({layout.positions + layout.hinges[h].speed, inertia});
  return rotors;
}

template <Content content>
class BoundContent final : public BoundSensor {
 public:
  BoundContent(std::vector<int> bodies, std::vector<Rotor> rotors)
      : bodies_(std::move(bodies)), rotors_(std::move(rotors)) {}
  std::vector<SensorColumn> columns() const override {
    if (content == Content::energy) return {{"kinetic", "J"}, {"strain", "J"}, {"weight", "J"}};
    std::vector<SensorColumn> c;
    add_columns(c, "", "kg m/s");
    add_columns(c, "angular_", "kg m^2/s");
    return c;
  }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    BodyEnergies sum;
    for (const int body : bodies_) {
      const BodyEnergies own = state.energies(body);
      sum.kinetic += own.kinetic;
      sum.strain += own.strain;
      sum.weight += own.weight;
      sum.linear += own.linear;
      sum.angular += own.angular;
    }
    for (const auto& [rate, inertia] : rotors_) sum.kinetic += 0.5 * inertia * state.y()[rate] * state.y()[rate];
    if constexpr (content == Content::energy) {
      values[0] = sum.kinetic;
      values[1] = sum.strain;
      values[2] = sum.weight;
    } else {
      put(sum.linear, values);
      put(sum.angular, values);
    }
  }

 private:
  std::vector<int> bodies_;
  std::vector<Rotor> rotors_;  ///< of all bodies' energy
};

template <Content content>
class ContentSensor final : public Sensor {
 public:
  explicit ContentSensor(std::string of) : of_(std::move(of)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    return std::make_unique<BoundContent<content>>(
        pieces_of(model, of_), content == Content::energy && of_ == "all" ? rotors_of(model) : std::vector<Rotor>());
  }

 private:
  std::string of_;
};

template <Content content>
std::unique_ptr<Sensor> make_content(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<ContentSensor<content>>(p.text_at("of"));
}

ParameterSpec body_parameter() {
  return text("of", "one body, or all").one_of({"all"}).naming(ParameterSpec::Refers::body).otherwise("all");
}

}  // namespace

void enroll_energy(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "energy",
       .summary = "Kinetic energy, strain energy, and potential energy of the weight, of a body or all",
       .parameters = {body_parameter()},
       .make = &make_content<Content::energy>});
  enrollment.add<Sensor>({.id = "momentum",
                          .summary = "Linear momentum, and angular momentum about the world's origin, of a body or all",
                          .parameters = {body_parameter()},
                          .make = &make_content<Content::momentum>});
}

}  // namespace withy
