/// \file
/// Coordinates of a hinge with their rates and accelerations.
#include <stdexcept>

#include "withy/core/model/columns.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {
namespace {

/// What stands behind the hinge's name.
std::string behind(const Column& column, const std::string& hinge) { return column.name.substr(hinge.size()); }

class BoundHinge final : public BoundSensor {
 public:
  BoundHinge(const HingeNode& hinge, Slot slot) : slot_(std::move(slot)) {
    for (const Column& c : coordinate_columns(hinge)) columns_.push_back({"position" + behind(c, hinge.name), c.unit});
    const std::vector<Column> rates = rate_columns(hinge);
    for (const Column& c : rates) columns_.push_back({behind(c, hinge.name).substr(1), c.unit});
    for (const Column& c : rates) {
      std::string name = behind(c, hinge.name).substr(1);
      // `rate.0` becomes `acceleration.0`; `wx`, `vx` become `alphax`, `ax`, as of a frame.
      if (name.rfind("rate", 0) == 0) {
        name.replace(0, 4, "acceleration");
      } else {
        name.replace(0, 1, name[0] == 'w' ? "alpha" : "a");
      }
      columns_.push_back({name, c.unit + "^2"});
    }
  }
  std::vector<SensorColumn> columns() const override { return columns_; }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    double* next = values.data();
    const std::size_t speeds = state.layout().positions;
    for (std::size_t i = 0; i < slot_.positions; ++i) *next++ = state.y()[slot_.position + i];
    for (std::size_t i = 0; i < slot_.speeds; ++i) *next++ = state.y()[speeds + slot_.speed + i];
    for (std::size_t i = 0; i < slot_.speeds; ++i) *next++ = state.accelerations()[slot_.speed + i];
  }

 private:
  Slot slot_;
  std::vector<SensorColumn> columns_;
};

class HingeSensor final : public Sensor {
 public:
  explicit HingeSensor(std::string hinge) : hinge_(std::move(hinge)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    const int index = model.hinge(hinge_);
    if (index < 0) throw std::invalid_argument("there is no hinge '" + hinge_ + "'");
    const auto h = static_cast<std::size_t>(index);
    if (model.layout().hinges[h].speeds == 0)
      throw std::invalid_argument("hinge '" + hinge_ + "' does not move; a sensor of it needs one that has rates");
    return std::make_unique<BoundHinge>(model.hinges()[h], model.layout().hinges[h]);
  }

 private:
  std::string hinge_;
};

std::unique_ptr<Sensor> make_hinge(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<HingeSensor>(p.text_at("hinge"));
}

}  // namespace

void enroll_hinge(Enrollment& enrollment) {
  enrollment.add<Sensor>({.id = "hinge",
                          .summary = "Coordinates of a hinge, their rates and accelerations",
                          .parameters = {text("hinge", "hinge that is observed").naming(ParameterSpec::Refers::hinge)},
                          .make = &make_hinge});
}

}  // namespace withy
