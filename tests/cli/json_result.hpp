/// \file
/// What commands answer as JSON.
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

}  // namespace withy::test
