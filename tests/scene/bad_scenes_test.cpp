// Every kind of bad scene and the message a user gets: the place in the file, the path, what is wrong, what is needed.
#include <gmock/gmock.h>

#include "scene_fixture.hpp"

namespace withy::test {
namespace {

struct BadScene {
  const char* kind;
  std::string from;  ///< in the good scene
  std::string to;
  const char* message;  ///< the beginning of the whole report
};

const BadScene bad_scenes[] = {
#include "cases.inc"
};

class BadScenes : public SceneTest, public testing::WithParamInterface<BadScene> {};

TEST_P(BadScenes, AreReportedWithPlaceAndReason) {
  const std::string report = problems(replaced(good_scene, GetParam().from, GetParam().to), registry);
  EXPECT_THAT(report, testing::StartsWith(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(Kinds, BadScenes, testing::ValuesIn(bad_scenes),
                         [](const auto& info) { return std::string(info.param.kind); });
}
}
