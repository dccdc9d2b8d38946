#include <cmath>
#include <numbers>

#include "withy/tests/conformance/allocations.hpp"
#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"

namespace withy {
namespace {

std::unique_ptr<BoundLoad> bound(const Model& model, std::vector<Value::Member> given) {
  Registry registry = load_registry();
  if (std::none_of(given.begin(), given.end(), [](const auto& m) { return m.first == "hinge"; }))
    given.emplace_back("hinge", Value(std::string("elbow")));
  const auto load = make_plugin<Load>(registry, "hinge-effort", std::move(given));
  return load == nullptr ? nullptr : load->bind(model);
}

Value law(const char* name) { return Value(std::string(name)); }

Value table_of(std::initializer_list<std::pair<double, double>> rows) {
  std::vector<Value> items;
  for (const auto& [t, v] : rows) items.push_back(list_of({t, v}));
  return Value::list(std::move(items));
}

/// Effort on the elbow, and nothing on any other speed.
double effort(const BoundLoad& load, double t) {
  const std::vector<double> y(12);
  std::vector<double> tau(6), scratch(load.scratch());
  load.add(t, std::span(y).first(6), std::span(y).subspan(6), tau, scratch);
  const double elbow = std::exchange(tau[3], 0.0);
  EXPECT_EQ(tau, std::vector<double>(6));
  return elbow;
}

TEST(HingeEffort, constant_acts_from_start_until_stop) {
  const Model model = two_link_arm(2);
  const auto load =
      bound(model, {{"law", law("constant")}, {"value", Value(2.5)}, {"start", Value(0.5)}, {"stop", Value(1.5)}});
  EXPECT_EQ(effort(*load, std::nextafter(0.5, 0)), 0);
  EXPECT_EQ(effort(*load, 0.5), 2.5);
  EXPECT_EQ(effort(*load, std::nextafter(1.5, 0)), 2.5);
  EXPECT_EQ(effort(*load, 1.5), 0);
  EXPECT_EQ(load->discontinuities(), (std::vector<double>{0.5, 1.5}));
  EXPECT_EQ(load->end(), 1.5);
  const auto endless = bound(model, {{"law", law("constant")}, {"value", Value(1.0)}});
  EXPECT_EQ(effort(*endless, -3), 1);
  EXPECT_TRUE(endless->discontinuities().empty());
  EXPECT_EQ(endless->end(), 0);
}

TEST(HingeEffort, sine_has_the_amplitude_period_and_phase_given) {
  const Model model = two_link_arm(2);
  const auto by_period =
      bound(model, {{"law", law("sine")}, {"amplitude", Value(-4.0)}, {"period", Value(2.5)}, {"phase", Value(0.3)}});
  const auto by_frequency = bound(
      model, {{"law", law("sine")}, {"amplitude", Value(-4.0)}, {"frequency", Value(0.4)}, {"phase", Value(0.3)}});
  for (const double t : {0.0, 0.6, 3.1}) {
    const double expected = -4 * std::sin(2 * std::numbers::pi * t / 2.5 + 0.3);
    EXPECT_NEAR(effort(*by_period, t), expected, 1e-14);
    EXPECT_NEAR(effort(*by_frequency, t), expected, 1e-14);
  }
}

TEST(HingeEffort, table_is_linear_between_rows_and_zero_outside) {
  const Model model = two_link_arm(2);
  const auto load = bound(model, {{"law", law("table")}, {"table", table_of({{1, 2}, {2, 6}, {4, -2}})}});
  EXPECT_EQ(effort(*load, 0.999), 0);
  EXPECT_EQ(effort(*load, 1), 2);
  EXPECT_EQ(effort(*load, 1.25), 3);
  EXPECT_EQ(effort(*load, 2), 6);
  EXPECT_EQ(effort(*load, 3.5), 0);
  EXPECT_NEAR(effort(*load, std::nextafter(4, 0)), -2, 1e-14);
  EXPECT_EQ(effort(*load, 4), 0);
  EXPECT_EQ(load->discontinuities(), (std::vector<double>{1, 2, 4}));
  EXPECT_EQ(load->end(), 4);
}

TEST(HingeEffort, a_window_cuts_a_table_and_its_knots) {
  const Model model = two_link_arm(2);
  const auto load = bound(model, {{"law", law("table")},
                                  {"table", table_of({{1, 2}, {2, 6}, {4, -2}})},
                                  {"start", Value(1.5)},
                                  {"stop", Value(3.0)}});
  EXPECT_EQ(effort(*load, 1.25), 0);
  EXPECT_EQ(effort(*load, 1.5), 4);
  EXPECT_EQ(effort(*load, 3), 0);
  EXPECT_EQ(load->discontinuities(), (std::vector<double>{1.5, 2, 3}));
  EXPECT_EQ(load->end(), 3);
}

TEST(HingeEffort, steps_hold_each_row_until_the_next_and_the_last_for_ever) {
  const Model model = two_link_arm(2);
  const auto thruster = bound(model, {{"law", law("steps")}, {"table", table_of({{1, 2}, {2, -6}, {4, 0}})}});
  EXPECT_EQ(effort(*thruster, std::nextafter(1, 0)), 0);
  EXPECT_EQ(effort(*thruster, 1), 2);
  EXPECT_EQ(effort(*thruster, std::nextafter(2, 0)), 2);
  EXPECT_EQ(effort(*thruster, 2), -6);
  EXPECT_EQ(effort(*thruster, std::nextafter(4, 0)), -6);
  EXPECT_EQ(effort(*thruster, 4), 0);
  EXPECT_EQ(thruster->discontinuities(), (std::vector<double>{1, 2, 4}));
  EXPECT_EQ(thruster->end(), 4);
  const auto left_on = bound(model, {{"law", law("steps")}, {"table", table_of({{1, 2}})}});
  EXPECT_EQ(effort(*left_on, 1e9), 2);
  EXPECT_EQ(left_on->end(), 0);
}

TEST(HingeEffort, conforms_under_every_law) {
  Registry registry = load_registry();
  const Value rows = table_of({{1, 2}, {2, 6}, {4, 0}});
  const std::vector<std::vector<Value::Member>> cases = {
      {{"law", law("constant")}, {"value", Value(2.5)}, {"start", Value(0.5)}, {"stop", Value(1.5)}},
      {{"law", law("sine")}, {"amplitude", Value(2.5)}, {"period", Value(3.0)}},
      {{"law", law("table")}, {"table", rows}},
      {{"law", law("table")}, {"table", rows}, {"stop", Value(9.0)}},
      {{"law", law("steps")}, {"table", rows}},
      {{"law", law("steps")}, {"table", rows}, {"start", Value(1.5)}, {"stop", Value(3.0)}}};
  for (std::vector<Value::Member> given : cases) {
    given.emplace_back("hinge", Value(std::string("elbow")));
    test::expect_load_conforms(*make_plugin<Load>(registry, "hinge-effort", given), two_link_arm(2));
  }
}

TEST(HingeEffort, evaluation_allocates_nothing) {
  const Model model = two_link_arm(2);
  const auto load = bound(model, {{"law", law("table")}, {"table", table_of({{0, 2}, {2, 6}, {4, -2}})}});
  const std::vector<double> y(12);
  std::vector<double> tau(6);
  const std::size_t before = allocations();
  for (int i = 0; i < 100; ++i) load->add(0.05 * i, std::span(y).first(6), std::span(y).subspan(6), tau, {});
  EXPECT_EQ(allocations(), before);
}

TEST(HingeEffort, what_does_not_fit_the_model_is_said) {
  const Model model = two_link_arm(0);
  const auto text = [&](std::vector<Value::Member> given) -> std::string {
    given.emplace_back("law", law("constant"));
    given.emplace_back("value", Value(1.0));
    try {
      (void)bound(model, std::move(given));
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(text({{"hinge", Value(std::string("wrist"))}}), "there is no hinge 'wrist'");
  EXPECT_EQ(text({{"component", Value(1.0)}}),
            "hinge 'elbow' has 1 rates; there is no component 1 (they count from 0)");
}

TEST(HingeEffort, keys_that_a_law_lacks_or_does_not_take_are_errors) {
  Registry registry = load_registry();
  const auto problems = [&](std::vector<Value::Member> given) {
    given.emplace_back("hinge", Value(std::string("elbow")));
    Diagnostics diagnostics;
    EXPECT_EQ(make_plugin<Load>(registry, "hinge-effort", std::move(given), diagnostics), nullptr);
    return diagnostics.errors().size() == 1 ? diagnostics.errors()[0].message : "not one error";
  };
  EXPECT_EQ(problems({{"law", law("constant")}}), "the law 'constant' needs 'value'");
  EXPECT_EQ(problems({{"law", law("constant")}, {"value", Value(1.0)}, {"period", Value(1.0)}}),
            "the law 'constant' takes no 'period'; law: sine does");
  EXPECT_EQ(problems({{"law", law("sine")}, {"period", Value(1.0)}}), "the law 'sine' needs 'amplitude'");
  EXPECT_EQ(problems({{"law", law("sine")}, {"amplitude", Value(1.0)}}),
            "the law 'sine' needs one of 'period' and 'frequency'");
  EXPECT_EQ(
      problems({{"law", law("sine")}, {"amplitude", Value(1.0)}, {"period", Value(1.0)}, {"frequency", Value(1.0)}}),
      "the law 'sine' needs one of 'period' and 'frequency'");
  EXPECT_EQ(problems({{"law", law("table")}, {"table", table_of({{0, 1}})}}),
            "the law 'table' needs a 'table' of two rows or more");
  EXPECT_EQ(problems({{"law", law("steps")}}), "the law 'steps' needs a 'table'");
  EXPECT_EQ(problems({{"law", law("constant")}, {"value", Value(1.0)}, {"start", Value(2.0)}, {"stop", Value(2.0)}}),
            "'stop' is not after 'start'");
}

}  // namespace
}  // namespace withy
