/// \file
/// Scenes written in a test, run to their end, with what their outputs show.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy::test {

/// A run's table of outputs.
struct Shown {
  explicit Shown(const std::string& text, const std::vector<std::string>& overrides = {}) : scene(text, overrides) {
    SensorReader reader(scene.scene.outputs, *scene.equations);
    columns = reader.columns();
    for (const State& state : scene.run()) {
      times.push_back(state.time);
      rows.emplace_back(columns.size());
      EXPECT_TRUE(reader.read(state, rows.back()));
    }
  }
  [[nodiscard]] std::vector<double> operator[](const std::string& name) const {
    std::vector<double> all;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (columns[c].name != name) continue;
      for (const std::vector<double>& row : rows) all.push_back(row[c]);
    }
    EXPECT_FALSE(all.empty()) << name;
    return all;
  }
  LoadedScene scene;
  std::vector<Column> columns;
  std::vector<double> times;
  std::vector<std::vector<double>> rows;
};

}  // namespace withy::test
