/// \file
/// Results in HDF5: the same as in the table, and readable where a run was killed.
#include <gmock/gmock.h>
#include <signal.h>

#include <filesystem>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

/// What a build without HDF5 says where it is asked for; empty where this build has it.
std::string without_hdf5(const Folder& folder) {
  if (WITHY_HAS_HDF5) return {};
  const Finished asked = withy(folder, {"run", "scenes/pendulum.yaml", "--hdf5"});
  EXPECT_EQ(asked.status, 3);
  EXPECT_THAT(asked.err, HasSubstr("this build is without HDF5"));
  return asked.err;
}

/// A picture of all that is recorded, from results.csv or, where there is none, from results.h5.
std::string picture(const Folder& folder) {
  const Finished f = withy(folder, {"plot", "out"});
  EXPECT_EQ(f.status, 0) << f.err;
  return folder.read("out/plot.svg");
}

TEST(Run, Hdf5HoldsTheTableThatTheCsvHolds) {
  const Folder folder;
  if (const std::string why = without_hdf5(folder); !why.empty()) GTEST_SKIP() << why;
  const std::vector<std::string> command = {"run", "scenes/attitude-jets.yaml", "--set", "time.end=40", "--out", "out"};
  const Finished f = withy(folder, command);
  ASSERT_EQ(f.status, 0) << f.err;
  ASSERT_TRUE(std::filesystem::exists(folder.path() / "out/results.h5"));
  const std::string of_csv = picture(folder);
  std::filesystem::remove(folder.path() / "out/results.csv");
  EXPECT_EQ(picture(folder), of_csv);
}

TEST(Run, KilledItLeavesAnHdf5FileThatIsReadAndSaysThatItIsNotWhole) {
  const Folder folder;
  if (const std::string why = without_hdf5(folder); !why.empty()) GTEST_SKIP() << why;
  const std::vector<std::string> command = {WITHY_PROGRAM,  "run",    "scenes/pendulum.yaml", "--set",
                                            "time.end=1e6", "--hdf5", "--checkpoint",         "0.05",
                                            "--out",        "out"};
  Process process(folder, command);
  comes_true([&] { return std::filesystem::exists(folder.path() / "out/checkpoint.cbor"); });
  ::kill(process.id(), SIGKILL);
  const Finished ended = process.wait();
  ASSERT_EQ(ended.status, -SIGKILL) << ended.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/run.json"));
  std::filesystem::remove(folder.path() / "out/results.csv");
  EXPECT_THAT(picture(folder), HasSubstr("pivot"));
  EXPECT_NE(folder.read("out/results.h5").find("running"), std::string::npos);
}

}  // namespace
}  // namespace withy::test
