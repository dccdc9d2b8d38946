/// \file
/// Runs saved and resumed: whatever ended them, they leave what an uninterrupted run leaves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "withy/tests/cli/json_result.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

using Arguments = std::vector<std::string>;

// Sampled and switching parts, and booms that swing: what a checkpoint has to keep beside the motion.
const Arguments command = {"run", "scenes/attitude-jets.yaml", "--set", "time.end=400", "--set", "time.output=0.05"};

Arguments with(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// Starts the command with results in `folder`/out, sends a signal once some outputs are there, and waits.
Finished ended_by(int signal, const Folder& folder, const Arguments& arguments) {
  Process process(folder, with({WITHY_PROGRAM}, arguments));
  const auto under_way = [&] {
    // Both generations: the older one comes first, and where files are slow the newest is long in coming.
    if (signal == SIGKILL)
      return std::filesystem::exists(folder.path() / "out/checkpoint.previous.cbor") &&
             std::filesystem::exists(folder.path() / "out/checkpoint.cbor");
    std::error_code none;
    const auto size = std::filesystem::file_size(folder.path() / "out/results.csv", none);
    return !none && size > 20'000;
  };
  comes_true(under_way);
  ::kill(process.id(), signal);
  return process.wait();
}

void expect_same(const Folder& folder) {
  EXPECT_EQ(folder.read("out/results.csv"), folder.read("whole/results.csv"));
  EXPECT_EQ(outcome(folder, "out").dump(1), outcome(folder, "whole").dump(1));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/checkpoint.cbor"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/checkpoint.previous.cbor"));
}

TEST(Checkpoints, AnInterruptedRunResumedLeavesTheSameBytes) {
  const Folder folder;
  ASSERT_EQ(withy(folder, with(command, {"--out", "whole"})).status, 0);
  const Arguments interrupted = with(command, {"--out", "out"});
  ASSERT_EQ(ended_by(SIGINT, folder, interrupted).status, 130);
  ASSERT_LT(folder.read("out/results.csv").size(), folder.read("whole/results.csv").size());
  const Finished resumed = withy(folder, with(interrupted, {"--resume"}));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  expect_same(folder);
}

TEST(Checkpoints, AKilledRunGoesOnFromTheCheckpointBeforeWhereTheNewestIsDamaged) {
  const Folder folder;
  ASSERT_EQ(withy(folder, with(command, {"--out", "whole"})).status, 0);
  const Arguments killed = with(command, {"--out", "out", "--checkpoint", "0.005"});
  const auto newest = folder.path() / "out/checkpoint.cbor";
  // A kill may fall between the moving of one generation and the writing of the next, when there is no newest.
  for (int kill = 0; kill < 50 && !std::filesystem::exists(newest); ++kill) {
    std::filesystem::remove_all(folder.path() / "out");
    ASSERT_EQ(ended_by(SIGKILL, folder, killed).status, -SIGKILL);
  }
  std::string bytes = folder.read("out/checkpoint.cbor");
  ASSERT_GT(bytes.size(), 200U);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  folder.write("out/checkpoint.cbor", bytes);
  const Finished resumed = withy(folder, with(command, {"--out", "out", "--resume"}));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("is damaged"));
  expect_same(folder);
}

TEST(Checkpoints, AnotherScenesCheckpointOrNoneIsAnInputError) {
  const Folder folder;
  const Arguments interrupted = with(command, {"--out", "out"});
  const Finished nothing = withy(folder, with(interrupted, {"--resume"}));
  EXPECT_EQ(nothing.status, 2);
  EXPECT_THAT(nothing.err, HasSubstr("nothing to resume"));
  ASSERT_EQ(ended_by(SIGINT, folder, interrupted).status, 130);
  const std::string kept = folder.read("out/results.csv");
  const Finished other = withy(folder, with(interrupted, {"--resume", "--formulation", "ruthless"}));
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("belongs to another"));
  EXPECT_EQ(folder.read("out/results.csv"), kept);
  std::filesystem::resize_file(folder.path() / "out/results.csv", 10);
  const Finished cut = withy(folder, with(interrupted, {"--resume"}));
  EXPECT_EQ(cut.status, 2);
  EXPECT_THAT(cut.err, HasSubstr("shorter than at its checkpoint"));
}

}  // namespace
}  // namespace withy::test
