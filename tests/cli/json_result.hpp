/// \file
/// What commands answer and leave as JSON.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "withy/tests/cli/process.hpp"

namespace withy::test {

/// The one object that `withy` prints; it must end well and say nothing else.
inline nlohmann::json result(const Folder& folder, const std::vector<std::string>& arguments) {
  const Finished f = withy(folder, arguments);
  EXPECT_EQ(f.status, 0) << f.err;
  EXPECT_EQ(f.err, "");
  return nlohmann::json::parse(f.out);
}

/// The run.json that a run has left in `out`, without what differs between two runs of the same thing.
inline nlohmann::json outcome(const Folder& folder, const std::string& out) {
  nlohmann::json run = nlohmann::json::parse(folder.read(out + "/run.json"));
  run.erase("cpu_seconds");
  run["certificate"].erase("estimated_error");  // with the time that the estimate took
  return run;
}

}  // namespace withy::test
