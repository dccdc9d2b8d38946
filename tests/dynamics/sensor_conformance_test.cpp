// Sensors do what every sensor must, and the suite sees one that does not.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "withy/core/simulation/instants.hpp"
#include "withy/tests/conformance/sensor_suite.hpp"
#include "withy/tests/simulation/made_scene.hpp"

namespace withy::test {
namespace {

constexpr const char* boom_on_a_hub = R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 1}
bodies:
  hub: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 10, modes: 2}}
hinges:
  shoulder: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
)";

/// At the start, and bent and in motion later.
std::vector<State> states_of(const Made& made) {
  State begun = withy::begun(*made.scene.model, *made.equations, made.scene.initial), moving = begun;
  moving.time = 0.3;
  const Layout& layout = made.scene.model->layout();
  for (std::size_t i = 0; i < layout.moving(); ++i) moving.y[i] += 0.01 * std::sin(1.0 + static_cast<double>(i));
  return {begun, moving};
}

TEST(SensorConformance, OfWhatComesWithTheProject) {
  Made made(boom_on_a_hub);
  const Value shoulder(std::string("shoulder")), boom(std::string("boom"));
  const auto check = [&](const std::string& id, std::vector<Value::Member> given) {
    SCOPED_TRACE(id);
    const auto sensor = make_plugin<Sensor>(made.registry, id, std::move(given));
    ASSERT_NE(sensor, nullptr);
    expect_sensor_conforms(*sensor, *made.scene.model, *made.equations, states_of(made));
  };
  check("hinge", {{"hinge", shoulder}});
  check("reaction", {{"hinge", shoulder}});
  check("energy", {});
  check("section", {{"of", boom}, {"at", Value(0.5)}});
}

/// Leaves its second number, or what stood there.
class Half final : public Sensor {
 public:
  std::unique_ptr<BoundSensor> bind(const Model&, std::span<const SensorNode>) const override {
    return std::make_unique<Bound>();
  }

 private:
  class Bound final : public BoundSensor {
   public:
    std::vector<SensorColumn> columns() const override { return {{"a", "1"}, {"b", "1"}}; }
    void read(SensedState&, const SensorInputs&, std::span<double> values) const noexcept override { values[0] = 1; }
  };
};

TEST(SensorConformance, IsNotOfASensorThatLeavesANumber) {
  const Made made(boom_on_a_hub);
  using Reporter = testing::ScopedFakeTestPartResultReporter;
  testing::TestPartResultArray faults;
  {
    const Reporter reporter(Reporter::INTERCEPT_ONLY_CURRENT_THREAD, &faults);
    expect_sensor_conforms(Half(), *made.scene.model, *made.equations, {made.scene.initial});
  }
  EXPECT_GT(faults.size(), 0);
}

}  // namespace
}  // namespace withy::test
