#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/property_tree/xml_parser.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Nothing but the slew's torques acts on the arm, so in `ruthless`, which keeps no more, the hinges have M0 a − f1 =
// loads, and sizes obey the triangle inequality.
TEST(Terms, KeepsTableSeriesAndPicture) {
  const Folder folder;
  const Finished f = withy(folder, {"terms", "scenes/two-link-slew.yaml", "--formulation", "ruthless", "--set",
                                    "time.end=1", "--out", "out", "--json"});
  ASSERT_EQ(f.status, 0) << f.err;
  const json j = json::parse(f.out);
  EXPECT_EQ(j, json::parse(folder.read("out/terms.json")));
  EXPECT_EQ(j.at("outputs"), 21);
  const json& hinges = j.at("groups").at("hinges");
  const auto peak = [&](const char* term) { return hinges.at(term).at("peak").get<double>(); };
  EXPECT_LE(peak("loads"), peak("M0 a") + peak("f1"));
  EXPECT_GT(peak("f1"), 0);
  EXPECT_EQ(peak("K q"), 0);
  EXPECT_EQ(peak("weight"), 0);
  const auto rows = lines(folder.read("out/terms.csv"));
  ASSERT_EQ(rows.size(), 22U);
  EXPECT_THAT(rows[0], HasSubstr("t[s],hinges.M0 a[N/sqrt(kg)]"));
  boost::property_tree::ptree svg;
  std::istringstream text(folder.read("out/terms.svg"));
  EXPECT_NO_THROW(boost::property_tree::read_xml(text, svg));
}

TEST(Terms, OfARunThatStopsAreThoseUpToThere) {
  const Folder folder;
  const Finished f = withy(folder, {"terms", "scenes/two-link-slew.yaml", "--formulation", "inconsistent"});
  EXPECT_EQ(f.status, 1);
  EXPECT_THAT(f.out, HasSubstr("M*3 a"));
  EXPECT_THAT(f.err, HasSubstr("singular"));
}

}  // namespace
}  // namespace withy::test
