/// \file
/// What any sensor must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {

/// Numbers are as many as the columns, whose names a table can hold; at these states all are set, finite, the same
/// whatever stood in their place and whenever they are read, and cost no allocation.
/// \param before the sensors whose numbers it is read with
/// \param states of the equations, with discrete states begun
inline void expect_sensor_conforms(const Sensor& sensor, const Model& model, const EquationsOfMotion& equations,
                                   const std::vector<State>& states, const std::vector<SensorNode>& before = {}) {
  const auto bound = sensor.bind(model, before);
  ASSERT_NE(bound, nullptr);
  const std::vector<SensorColumn> columns = bound->columns();
  EXPECT_EQ(find_fault(columns), "");
  std::vector<SectionPlace> sections;
  std::vector<double> numbers;
  for (const SensorNode& node : before) {
    const std::vector<SectionPlace> own = node.sensor->sections();
    sections.insert(sections.end(), own.begin(), own.end());
  }
  const std::size_t first_section = sections.size();
  for (const SectionPlace& place : bound->sections()) {
    ASSERT_GE(place.body, 0);
    ASSERT_LT(static_cast<std::size_t>(place.body), model.bodies().size());
    EXPECT_TRUE(std::isfinite(place.x));
    sections.push_back(place);
  }
  const auto sensed = equations.make_sensed_state(sections);
  const auto read = [&](const State& state, double memory) {
    EXPECT_TRUE(sensed->observe(state));
    numbers.clear();
    std::size_t section = 0;
    for (const SensorNode& node : before) {
      std::vector<double> own(node.sensor->columns().size());
      node.sensor->read(*sensed, {section, numbers}, own);
      numbers.insert(numbers.end(), own.begin(), own.end());
      section += node.sensor->sections().size();
    }
    std::vector<double> values(columns.size(), memory);
    const std::size_t allocated = allocations();
    bound->read(*sensed, {first_section, numbers}, values);
    EXPECT_EQ(allocations(), allocated);
    return values;
  };
  std::vector<std::vector<double>> seen;
  for (const State& state : states) {
    seen.push_back(read(state, std::numeric_limits<double>::quiet_NaN()));
    for (std::size_t i = 0; i < columns.size(); ++i)
      EXPECT_TRUE(std::isfinite(seen.back()[i])) << columns[i].component << " at " << state.time;
  }
  for (std::size_t i = states.size(); i-- > 0;) EXPECT_EQ(read(states[i], 7), seen[i]) << "in another order";
}

}  // namespace withy::test
