#include "withy/core/simulation/sensor_probe.hpp"

#include "withy/core/deformation/mass_points.hpp"

namespace withy {

/// Notes the first thing that it is asked for and has not. All that it has is zero, but for coordinates.
class SensorProbe::Asked final : public SensedState {
 public:
  explicit Asked(const Model& model)
      : model_(model), state_(model.reference_state()), zeros_(model.layout().speeds, 0.0) {}

  void begin(std::size_t sections) {
    sections_ = sections;
    missing_ = Missing::nothing;
  }
  [[nodiscard]] std::string fault() const {
    const auto of_many = [&](const char* what, std::size_t count) {
      return "it asks for " + std::string(what) + " " + std::to_string(index_) + ", and there are " +
             std::to_string(count);
    };
    switch (missing_) {
      case Missing::frame:
        return "it asks for " + frame_in_words(model_, frame_) + ", which the scene has not";
      case Missing::load:
        return of_many("load", model_.loads().size());
      case Missing::hinge:
        return of_many("hinge", model_.hinges().size());
      case Missing::body:
        return of_many("body", model_.bodies().size());
      case Missing::section:
        return of_many("section", sections_);
      case Missing::nothing:
        break;
    }
    return {};
  }

  bool observe(const State& /*state*/) noexcept override { return true; }
  const Layout& layout() const noexcept override { return model_.layout(); }
  double time() const noexcept override { return state_.time; }
  std::span<const double> y() const noexcept override { return state_.y; }
  std::span<const double> accelerations() noexcept override { return zeros_; }
  Vector3 gravity() const noexcept override { return model_.gravity(); }
  FrameMotion motion(FrameIndex frame) noexcept override {
    look(frame);
    return {};
  }
  FrameAcceleration acceleration(FrameIndex frame) noexcept override {
    look(frame);
    return {};
  }
  std::span<const double> load_efforts(int load) noexcept override {
    if (load != EquationsOfMotion::all_loads) look(Missing::load, load, model_.loads().size());
    return zeros_;
  }
  std::span<const double> motion_efforts() noexcept override { return zeros_; }
  Wrench reaction(int hinge) noexcept override {
    look(Missing::hinge, hinge, model_.hinges().size());
    return {};
  }
  SectionLoad section(std::size_t index) noexcept override {
    look(Missing::section, static_cast<std::ptrdiff_t>(index), sections_);
    return {};
  }
  BodyEnergies energies(int body) noexcept override {
    look(Missing::body, body, model_.bodies().size());
    return {};
  }
  const Energies& energies() noexcept override { return energies_; }

 private:
  enum class Missing { nothing, frame, load, hinge, body, section };

  void look(Missing what, std::ptrdiff_t index, std::size_t count) noexcept {
    if (missing_ != Missing::nothing || (index >= 0 && static_cast<std::size_t>(index) < count)) return;
    missing_ = what, index_ = index;
  }
  void look(FrameIndex frame) noexcept {
    if (missing_ != Missing::nothing || frame.body == -1 || has_place(model_, frame)) return;
    missing_ = Missing::frame, frame_ = frame;
  }

  const Model& model_;
  State state_;
  std::vector<double> zeros_;
  Energies energies_;
  std::size_t sections_ = 0;  ///< of the sensor that asks
  Missing missing_ = Missing::nothing;
  FrameIndex frame_;
  std::ptrdiff_t index_ = 0;
};

SensorProbe::SensorProbe(const Model& model) : asked_(std::make_unique<Asked>(model)) {}
SensorProbe::~SensorProbe() = default;
SensorProbe::SensorProbe(SensorProbe&&) noexcept = default;

std::string SensorProbe::fault_of(const BoundSensor& sensor) {
  const std::size_t before = values_.size();
  values_.resize(before + sensor.columns().size());
  const std::span<double> values(values_);
  asked_->begin(sensor.sections().size());
  sensor.read(*asked_, {0, values.first(before)}, values.subspan(before));
  return asked_->fault();
}

}  // namespace withy
