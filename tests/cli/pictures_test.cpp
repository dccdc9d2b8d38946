/// \file
/// Pictures, pages and files for viewers that runs leave and that are made of their results anew.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Plots with programs of a folder alone.
Finished plotted_with(const Folder& folder, const std::string& programs) {
  return Process(folder, {"/usr/bin/env", "PATH=" + programs, WITHY_PROGRAM, "plot", "out", "pivot", "--out", "p.png"})
      .wait();
}

TEST(Plot, DrawsPngByLibrsvgAndSaysWhereThatIsMissing) {
  const Folder folder;
  ASSERT_EQ(withy(folder, {"run", "scenes/pendulum.yaml", "--set", "time.end=0.2", "--out", "out"}).status, 0);
  const auto left = [&] {
    std::size_t files = 0;
    for (const auto& file : std::filesystem::directory_iterator(folder.path()))
      files += file.path().filename().string().starts_with("p.png");
    return files;
  };
  const Finished missing = plotted_with(folder, "/nowhere");
  EXPECT_EQ(missing.status, 3);
  EXPECT_THAT(missing.err, HasSubstr("rsvg-convert, which is not installed (Debian: apt install librsvg2-bin)"));
  EXPECT_EQ(left(), 0U);
  folder.write("broken/rsvg-convert", "#!/bin/sh\necho 'no fonts' >&2\nexit 7\n");
  std::filesystem::permissions(folder.path() / "broken/rsvg-convert", std::filesystem::perms::owner_all);
  const Finished broken = plotted_with(folder, (folder.path() / "broken").string());
  EXPECT_EQ(broken.status, 3);
  EXPECT_THAT(broken.err, AllOf(HasSubstr("no fonts"), HasSubstr("p.png could not be drawn: rsvg-convert ended with "
                                                                 "status 7")));
  EXPECT_EQ(left(), 0U);
  if (!std::filesystem::exists("/usr/bin/rsvg-convert")) GTEST_SKIP() << "rsvg-convert is not installed";
  const Finished drawn = plotted_with(folder, "/usr/bin");
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(drawn.out, HasSubstr(" in p.png"));
  EXPECT_EQ(left(), 1U);
  const std::string png = folder.read("p.png");
  ASSERT_TRUE(png.starts_with("\x89PNG\r\n\x1a\n"));
  // The head has width and height, most significant byte first: two pixels for each of the picture's units.
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = 256 * value + static_cast<unsigned char>(png.at(at + i));
    return value;
  };
  ASSERT_EQ(withy(folder, {"plot", "out", "pivot", "--out", "p.svg"}).status, 0);
  const std::string svg = folder.read("p.svg");
  EXPECT_THAT(svg, HasSubstr("width=\"" + std::to_string(number(16) / 2) + "\" height=\"" +
                             std::to_string(number(20) / 2) + "\""));
}

TEST(Run, LeavesAPictureThatPlotAndReportMakeAnew) {
  const Folder folder;
  const auto run = [&](const std::string& formulation) {
    return withy(folder, {"run", "scenes/two-link-slew.yaml", "--formulation", formulation, "--set", "time.end=0.2",
                          "--out", formulation});
  };
  ASSERT_EQ(run("ruthless").status, 0);
  ASSERT_EQ(run("quadratic").status, 0);
  Finished f =
      withy(folder, {"plot", "ruthless", "quadratic", "shoulder", "link2.tip.deflection_y", "--out", "two.svg"});
  ASSERT_EQ(f.status, 0) << f.err;
  const std::string picture = folder.read("two.svg");
  for (const char* text : {"shoulder [deg]", "link2.tip.deflection_y [m]", "t [s]", ">ruthless<", ">quadratic<"})
    EXPECT_THAT(picture, HasSubstr(text));
  f = withy(folder, {"plot", "ruthless", "link2.tip.deflection", "--out", "bent.svg"});
  ASSERT_EQ(f.status, 0) << f.err;
  for (const char* text : {"link2.tip.deflection_x [m]", "link2.tip.deflection_y [m]", "link2.tip.deflection_z [m]"})
    EXPECT_THAT(folder.read("bent.svg"), HasSubstr(text));
  f = withy(folder, {"plot", "ruthless", "elbow", "--terminal"});
  EXPECT_THAT(f.out, HasSubstr("elbow [deg]"));
  f = withy(folder, {"plot", "ruthless", "elbow", "--out", "elbow.gif"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("got the file 'elbow.gif' for a picture; need a name that ends in .svg or .png"));
  f = withy(folder, {"plot", "ruthless", "nonsense"});
  EXPECT_THAT(f.err, HasSubstr("there is no column \"nonsense\"; there are: shoulder, elbow, "));
  f = withy(folder, {"plot", "ruthless", "elbw"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("there is no column \"elbw\"; did you mean \"elbow\"?"));
  const std::string page = folder.read("quadratic/report.html");
  f = withy(folder, {"report", "ruthless", "quadratic", "--out", "both.html"});
  ASSERT_EQ(page.empty(), !WITHY_HAS_REPORT);
  if (!WITHY_HAS_REPORT) {
    EXPECT_THAT(folder.read("quadratic/results.svg"), HasSubstr("shoulder [deg]"));
    EXPECT_EQ(f.status, 3);
    return;
  }
  ASSERT_EQ(f.status, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("2 runs in both.html"));
  EXPECT_GT(folder.read("both.html").size(), page.size());
  f = withy(folder, {"report", "scenes"});
  EXPECT_EQ(f.status, 2);
  EXPECT_THAT(f.err, HasSubstr("it is no folder of a run or a comparison"));
}

TEST(Run, OfNoLengthIsAStateThatViewersDraw) {
  const Folder folder;
  ASSERT_EQ(withy(folder, {"run", "scenes/pendulum.yaml", "--set", "time.end=0", "--out", "still"}).status, 0);
  if (!WITHY_HAS_REPORT) GTEST_SKIP() << "a build without the page";
  const Finished f = withy(folder, {"report", "still", "--out", "still.glb"});
  ASSERT_EQ(f.status, 0) << f.err;
  const std::string file = folder.read("still.glb");  // heads of 20 bytes, JSON, its successor's length and name
  const json rod = json::parse(file.substr(20, file.find(std::string("BIN\0", 4)) - 24))["nodes"][0];
  EXPECT_EQ(rod["name"], "rod");
  EXPECT_NEAR(rod["rotation"][2].get<double>(), 0.5, 1e-6) << "60 degrees about z: the sine of their half";
}

}  // namespace
}  // namespace withy::test
