// Scenes in modes of other families.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "withy/study/advice.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

/// The scene's own start in the functions of another family: the shape is kept, not the numbers.
TEST(ModeBasis, ABentStartKeepsItsShapeInOtherFunctions) {
  const Prepared scene = prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spacecraft.yaml"), plugins());
  const auto start = [&](const char* family, int modes) {
    const Point point{"quadratic", family, modes, "", 0, {}, {}};
    const Prepared at = prepare(values_at(scene.values, scene.scene, point, plugins()), plugins());
    Outputs outputs(at.model());
    OutputReader reader(outputs, at.model(), *at.equations);
    return std::pair(outputs, reader.read(at.scene.initial));
  };
  const auto own = start("", 6);
  const auto off = [&](const char* family, int modes) {
    const auto [outputs, values] = start(family, modes);
    Distances apart = outputs.none();
    outputs.raise(values, own.second, apart);
    return *std::max_element(apart.begin(), apart.end());
  };
  EXPECT_LT(off("orthogonal-polynomials", 8), 1e-9) << "of 81 mm";
  EXPECT_LT(off("craig-bampton", 8), 1e-5);
  EXPECT_GT(off("orthogonal-polynomials", 1), 1e-3) << "one function cannot have the shape of another";
  EXPECT_LT(off("clamped-free", 4), 1e-12) << "the same functions keep their numbers";
}

/// Bending and twist go together: neither is left in functions that converge more slowly.
TEST(ModeBasis, EveryStrainOfAClampedBeamTakesTheFamily) {
  const Prepared scene = prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spacecraft.yaml"), plugins());
  const Candidates candidates = candidates_for(scene, plugins(), usual_axes());
  EXPECT_EQ(reference_families(candidates, scene).first, "craig-bampton");
  const auto paths = [&](const char* family) {
    std::vector<std::string> named;
    for (const Change& change : changes_at(scene.scene, {"quadratic", family, 2, "", 0, {}, {}}, plugins()))
      if (change.path.ends_with("family")) named.push_back(change.path);
    return named;
  };
  EXPECT_EQ(paths("orthogonal-polynomials").size(), 6U);
  EXPECT_EQ(paths("clamped-pinned"),
            (std::vector<std::string>{"bodies.left_boom.bending_y.family", "bodies.left_boom.bending_z.family",
                                      "bodies.right_boom.bending_y.family", "bodies.right_boom.bending_z.family"}))
      << "it has no twist";
}

}  // namespace
}  // namespace withy::study
