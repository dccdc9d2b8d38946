#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

struct Include {
  const char* file;
  const char* text;  ///< between `#include ` and the end of the line
};
void PrintTo(const Include& include, std::ostream* out) { *out << include.file << " including " << include.text; }

Finished check(const Include& include) {
  const Folder folder;
  folder.write(include.file, std::string("#pragma once\n#include ") + include.text + "\n");
  return Process(folder, {WITHY_SOURCES "/scripts/check_includes.sh", folder.path().string()}).wait();
}

class Forbidden : public testing::TestWithParam<Include> {};

TEST_P(Forbidden, IsFoundWithFileAndLine) {
  const Finished f = check(GetParam());
  EXPECT_EQ(f.status, 1);
  EXPECT_THAT(f.out, HasSubstr(std::string(GetParam().file) + ":2: "));
}

INSTANTIATE_TEST_SUITE_P(Includes, Forbidden,
                         testing::Values(Include{"core/model/a.hpp", "\"withy/scene/scene.hpp\""},
                                         Include{"core/model/a.hpp", "\"withy/plugins/host/plugin_host.hpp\""},
                                         Include{"core/model/a.hpp", "<nlohmann/json.hpp>"},
                                         Include{"core/model/a.hpp", "<dlfcn.h>"},
                                         Include{"core/model/a.hpp", "\"absent.hpp\""},
                                         Include{"core/model/a.hpp", "\"../scene/scene.hpp\""},
                                         // Upward inside the core, and from one sweep to the other.
                                         Include{"core/spatial/a.hpp", "\"withy/core/plugin/b.hpp\""},
                                         Include{"core/plugin/a.hpp", "\"withy/core/model/model.hpp\""},
                                         Include{"core/sweep/a.hpp", "\"withy/core/sweep/rod/b.hpp\""},
                                         Include{"core/sweep/symmetric/a.hpp", "\"withy/core/sweep/strict/b.hpp\""},
                                         Include{"core/simulation/a.hpp", "\"withy/core/analysis/b.hpp\""},
                                         Include{"scene/a.cpp", "\"withy/bodies/beam.hpp\""},
                                         Include{"bodies/a.cpp", "\"withy/plugins/modes/clamped_free.hpp\""},
                                         Include{"bodies/a.cpp", "<yaml-cpp/yaml.h>"},
                                         Include{"integrators/a.cpp", "\"withy/loads/table.hpp\""},
                                         Include{"loads/a.cpp", "\"withy/scene/scene.hpp\""},
                                         Include{"plugins/formulations/a.cpp", "\"withy/plugins/modes/a.hpp\""},
                                         Include{"plugins/modes/a.cpp", "<boost/dll/shared_library.hpp>"},
                                         Include{"plugins/host/a.cpp", "\"withy/scene/scene.hpp\""},
                                         Include{"apps/a.cpp", "<yaml-cpp/yaml.h>"},
                                         Include{"apps/a.cpp", "<CLI/CLI.hpp>"},
                                         Include{"tests/a.cpp", "  <CLI/CLI.hpp>"}));

TEST(Includes, ARoomWithoutARuleIsFound) {
  const Finished f = check({"attic/a.cpp", "<vector>"});
  EXPECT_EQ(f.status, 1);
  EXPECT_THAT(f.out, HasSubstr("attic"));
}

class Allowed : public testing::TestWithParam<Include> {};

TEST_P(Allowed, Passes) {
  const Finished f = check(GetParam());
  EXPECT_EQ(f.status, 0) << f.out << f.err;
}

INSTANTIATE_TEST_SUITE_P(
    Includes, Allowed,
    testing::Values(Include{"core/model/a.hpp", "\"withy/core/plugin/b.hpp\""}, Include{"core/model/a.hpp", "<vector>"},
                    Include{"core/model/a.hpp", "\"a.hpp\""}, Include{"core/model/a.hpp", "<Eigen/Core>"},
                    Include{"scene/a.cpp", "<yaml-cpp/yaml.h>"}, Include{"program/a.cpp", "<CLI/CLI.hpp>"},
                    Include{"plugins/host/a.cpp", "<boost/dll/shared_library.hpp>"}));

TEST(Includes, TheProjectsOwnGoAllowedDirections) {
  const Folder folder;
  const Finished f = Process(folder, {WITHY_SOURCES "/scripts/check_includes.sh"}).wait();
  EXPECT_EQ(f.status, 0) << f.out;
}

}  // namespace
}  // namespace withy::test
