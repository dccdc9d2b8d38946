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
  BoundHinge(const HingeNode& hinge, Slot slot, bool all) : slot_(std::move(slot)), all_(all) {
    const std::vector<Column> rates = rate_columns(hinge);
    if (all)
      for (const Column& c : coordinate_columns(hinge))
        columns_.push_back({"position" + behind(c, hinge.name), c.unit});
    for (const Column& c : all ? rates : std::vector<Column>{})
      columns_.push_back({behind(c, hinge.name).substr(1), c.unit});
    for (const Column& c : rates) {
      std::string name = behind(c, hinge.name).substr(1);
      // `rate.0` becomes `acceleration.0`; `wx`, `vx` become `alphax`, `ax`, as of a frame.
      if (name.rfind("rate", 0) == 0) {
        name.replace(0, all || name.size() == 4 ? 4 : 5, all ? "acceleration" : "");
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
    for (std::size_t i = 0; all_ && i < slot_.positions; ++i) *next++ = state.y()[slot_.position + i];
    for (std::size_t i = 0; all_ && i < slot_.speeds; ++i) *next++ = state.y()[speeds + slot_.speed + i];
    for (std::size_t i = 0; i < slot_.speeds; ++i) *next++ = state.accelerations()[slot_.speed + i];
  }

 private:
  Slot slot_;
  bool all_;
  std::vector<SensorColumn> columns_;
};

class HingeSensor final : public Sensor {
 public:
  HingeSensor(std::string hinge, bool all) : hinge_(std::move(hinge)), all_(all) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    const int index = model.hinge(hinge_);
    if (index < 0) throw std::invalid_argument("there is no hinge '" + hinge_ + "'");
    const auto h = static_cast<std::size_t>(index);
    if (model.layout().hinges[h].speeds == 0)
      throw std::invalid_argument("hinge '" + hinge_ + "' does not move; a sensor of it needs one that has rates");
    return std::make_unique<BoundHinge>(model.hinges()[h], model.layout().hinges[h], all_);
  }

 private:
  std::string hinge_;
  bool all_;
};

std::unique_ptr<Sensor> make_hinge(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<HingeSensor>(p.text_at("hinge"), p.text_at("show") == "all");
}

}  // namespace

void enroll_hinge(Enrollment& enrollment) {
  enrollment.add<Sensor>({.id = "hinge",
                          .summary = "Coordinates of a hinge, their rates and accelerations",
                          .parameters = {text("hinge", "hinge that is observed").naming(ParameterSpec::Refers::hinge),
                                         text("show", "all, or accelerations alone, without a word before their names")
                                             .one_of({"all", "acceleration"})
                                             .otherwise("all")},
                          .make = &make_hinge});
}

}  // namespace withy
