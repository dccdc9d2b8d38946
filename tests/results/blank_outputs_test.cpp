/// \file
/// Outputs that are no numbers are counted, and told with the run.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/results/recorded_run.hpp"

namespace withy {
namespace {

class Sparse final : public BoundSensor {
 public:
  std::vector<SensorColumn> columns() const override { return {{"whole", "1"}, {"half", "1"}}; }
  void read(SensedState& state, const SensorInputs&, std::span<double> values) const noexcept override {
    values[0] = 1;
    values[1] = state.time() > 0.5 ? std::nan("") : 2;
  }
};

TEST(BlankOutputs, AreToldWithTheirNamesAndTheRowsThatLackThem) {
  Registry registry;
  enroll_static_plugins(registry);
  study::Prepared prepared = study::prepare(
      SceneValues::parse("format: withy/1\ntime: {end: 1}\nbodies: {b: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, "
                         "0]}}\nhinges: {h: {type: prismatic, axis: [1, 0, 0], parent: world, child: b}}\n",
                         "s.yaml"),
      registry);
  prepared.scene.outputs.push_back({"o", std::make_shared<Sparse>()});
  MemoryRecorder rows;
  RunTable table(prepared, rows);
  State state = prepared.scene.initial;
  RunSummary summary;
  table.add(state, 0);
  table.note_blanks(summary);
  EXPECT_EQ(summary.message, "") << "all have numbers so far";
  for (const double t : {0.25, 0.75, 1.0}) {
    state.time = t;
    table.add(state, 0);
  }
  table.note_blanks(summary);
  EXPECT_EQ(summary.message, "Outputs gave no finite number in rows of the table: 'o.half' in 2 of them.");
}

}  // namespace
}  // namespace withy
