/// \file
/// Runs killed at random moments and resumed, again and again, with every integrator: bit by bit the run that nobody
/// touched. WITHY_KILLS sets the number of kills an integrator; the target `kills` makes 200 in all.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include "withy/tests/cli/json_result.hpp"

namespace withy::test {
namespace {

using Clock = std::chrono::steady_clock;
using Arguments = std::vector<std::string>;

/// With steps short enough, or a tolerance tight enough, for a run that takes a moment.
const std::vector<std::string> integrators = {
    "{name: rk4, step: 0.0005}",   "{name: rk4-adaptive, rtol: 1e-9}", "{name: dopri5, rtol: 1e-9}",
    "{name: dop853, rtol: 1e-11}", "{name: rosenbrock-w, rtol: 1e-6}", "{name: imex, rtol: 1e-6}",
    "{name: radau, rtol: 1e-6}",   "{name: gauss, step: 0.005}",       "{name: generalized-alpha, step: 0.001}",
    "{name: cvode, rtol: 1e-7}"};

int kills() {
  const char* asked = std::getenv("WITHY_KILLS");
  return asked != nullptr ? std::atoi(asked) : 2;
}

class Kills : public testing::TestWithParam<std::string> {};

TEST_P(Kills, AtAnyMomentLeaveTheSameBytes) {
  if (!WITHY_HAS_CVODE && GetParam().find("cvode") != std::string::npos) GTEST_SKIP() << "not in this build";
  const Folder folder;
  const auto command = [&](const std::string& out) {
    return Arguments{
        WITHY_PROGRAM, "run", "scenes/driven-arm.yaml", "--set", "integrator=" + GetParam(), "--set", "time.end=3",
        "--out",       out};
  };
  const auto began = Clock::now();
  const Finished whole = Process(folder, command("whole")).wait();
  const std::chrono::duration<double> length = Clock::now() - began;
  ASSERT_EQ(whole.status, 0) << whole.err;
  std::mt19937 random(static_cast<unsigned>(length.count() * 1e9));
  std::uniform_real_distribution<double> moment(0, length.count());
  // Three kills of a run before it may end, then the next run.
  for (int left = kills(), k = 0; left > 0; ++k) {
    Arguments begin = command("out" + std::to_string(k));
    begin.insert(begin.end(), {"--checkpoint", "0.003"});
    for (int i = 0; i < 3 && left > 0; ++i, --left) {
      Arguments next = begin;
      if (std::filesystem::exists(folder.path() / begin[8] / "checkpoint.cbor")) next.emplace_back("--resume");
      Process process(folder, next);
      std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
      ::kill(process.id(), SIGKILL);
      const Finished ended = process.wait();
      ASSERT_TRUE(ended.status == -SIGKILL || ended.status == 0) << ended.err;
    }
    if (std::filesystem::exists(folder.path() / begin[8] / "checkpoint.cbor")) begin.emplace_back("--resume");
    const Finished resumed = Process(folder, begin).wait();
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    ASSERT_EQ(folder.read(begin[8] + "/results.csv"), folder.read("whole/results.csv")) << "run " << k;
    ASSERT_EQ(outcome(folder, begin[8]).dump(1), outcome(folder, "whole").dump(1)) << "run " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Kills, testing::ValuesIn(integrators), [](const auto& test) {
  std::string name = test.param.substr(7, test.param.find(',') - 7);
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

}  // namespace
}  // namespace withy::test
