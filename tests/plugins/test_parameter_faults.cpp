// What plugins say of their parameters is looked at as they enrol.
#include <gtest/gtest.h>

#include <cmath>

#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/parameter_faults.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

/// The fault of one parameter beside a good one.
std::string fault_beside(ParameterSpec spec) {
  return parameter_fault({number("good", "m", "a length").above(0).otherwise(1.0), std::move(spec)});
}

TEST(ParameterFaults, OfAllKindsThatCanBeThereAreNone) {
  EXPECT_EQ(parameter_fault({}), "");
  EXPECT_EQ(fault_beside(number("a", "m", "").least(0).most(1).otherwise("3 mm")), "") << "its unit is the reader's";
  EXPECT_EQ(fault_beside(number("a", "m", "").or_table("s").otherwise(2.0)), "");
  EXPECT_EQ(fault_beside(integer("a", "").least(0).otherwise(3.0).as(ParameterSpec::Role::modes)), "");
  EXPECT_EQ(fault_beside(boolean("a", "").otherwise(Value(false))), "");
  EXPECT_EQ(fault_beside(text("a", "").one_of({"x", "y"}).otherwise("y")), "");
  EXPECT_EQ(fault_beside(text("a", "").naming(ParameterSpec::Refers::mode_family).otherwise("clamped-free")), "");
  EXPECT_EQ(fault_beside(vector("a", 2, "m", "").otherwise(Value::list({Value(1.0), Value(2.0)}))), "");
  EXPECT_EQ(fault_beside(table("a", {"s", "m"}, "")), "");
  EXPECT_EQ(fault_beside(map("a", {number("b", "1", "")}, "").otherwise(Value::map({}))), "");
}

TEST(ParameterFaults, AreKeysThatAreMissingOrStandTwice) {
  EXPECT_EQ(fault_beside(number("good", "kg", "")), "parameter 'good' stands twice");
  EXPECT_EQ(fault_beside(number("", "kg", "")), "parameter '' has no key");
  EXPECT_EQ(fault_beside(map("a", {number("b", "1", ""), text("b", "")}, "")), "parameter 'a.b' stands twice");
}

TEST(ParameterFaults, AreTablesAndRangesThatHoldNothing) {
  EXPECT_EQ(fault_beside(table("a", {}, "")), "parameter 'a' is a table without columns");
  EXPECT_EQ(fault_beside(number("a", "m", "").least(2).most(1)), "parameter 'a' has a range that holds no number");
  EXPECT_EQ(fault_beside(number("a", "m", "").above(1).most(1)), "parameter 'a' has a range that holds no number");
  EXPECT_EQ(fault_beside(number("a", "m", "").least(1).most(1)), "") << "one is left";
  EXPECT_EQ(fault_beside(number("a", "m", "").least(std::nan(""))), "parameter 'a' has a range that holds no number");
}

TEST(ParameterFaults, AreDefaultsThatNoSceneMayGive) {
  const std::string fault = "parameter 'a' has a default that ";
  EXPECT_EQ(fault_beside(number("a", "m", "").above(0).otherwise(-1.0)), fault + "is not within its range");
  EXPECT_EQ(fault_beside(number("a", "m", "").otherwise(Value(true))), fault + "is of another kind");
  EXPECT_EQ(fault_beside(integer("a", "").otherwise(0.5)), fault + "is no whole number");
  EXPECT_EQ(fault_beside(boolean("a", "").otherwise(1.0)), fault + "is of another kind");
  EXPECT_EQ(fault_beside(text("a", "").one_of({"x"}).otherwise("y")), fault + "is none of its choices");
  EXPECT_EQ(fault_beside(vector("a", 3, "m", "").otherwise(Value::list({Value(1.0)}))),
            fault + "has another count of numbers");
}

TEST(ParameterFaults, AreRolesOfOtherKinds) {
  EXPECT_EQ(fault_beside(text("a", "").as(ParameterSpec::Role::modes)),
            "parameter 'a' is to be a number of modes and is no integer");
}

TEST(ParameterFaults, KeepAPluginOutOfARegistryInWordsThatNameIt) {
  Plugin<Load> plugin;
  plugin.id = "mine";
  plugin.make = [](const Value&, const MakeContext&) -> std::unique_ptr<Load> { return nullptr; };
  plugin.parameters = {table("course", {}, "")};
  Enrollment e;
  e.add(std::move(plugin));
  Registry registry;
  try {
    registry.admit(std::move(e), "mine.so");
    FAIL() << "it was admitted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "load 'mine' from mine.so: parameter 'course' is a table without columns");
  }
  EXPECT_TRUE(registry.ids<Load>().empty());
}

}  // namespace
}  // namespace withy
