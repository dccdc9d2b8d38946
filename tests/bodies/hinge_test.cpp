#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/conformance/hinge_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

class Hinges : public testing::TestWithParam<std::string> {};

TEST_P(Hinges, conform) {
  Registry registry;
  enroll_static_plugins(registry);
  std::vector<Value::Member> parameters;
  const Plugin<Hinge>* plugin = registry.find<Hinge>(GetParam());
  ASSERT_NE(plugin, nullptr);
  for (const ParameterSpec& spec : plugin->parameters) {
    if (spec.key == "axis") parameters.emplace_back("axis", Value::list({Value(0.3), Value(-2.0), Value(1.1)}));
  }
  const auto hinge = make_plugin<Hinge>(registry, GetParam(), parameters);
  ASSERT_NE(hinge, nullptr);
  expect_hinge_conforms(*hinge);
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, Hinges, testing::Values("weld", "revolute", "prismatic", "spherical", "free"));

TEST(Hinge, zero_axis_is_an_error) {
  Registry registry;
  enroll_static_plugins(registry);
  Diagnostics diagnostics;
  const auto hinge = make_plugin<Hinge>(registry, "revolute",
                                        {{"axis", Value::list({Value(0.0), Value(0.0), Value(0.0)})}}, diagnostics);
  EXPECT_EQ(hinge, nullptr);
  EXPECT_EQ(diagnostics.errors().size(), 1U);
}

}  // namespace
}  // namespace withy::test
