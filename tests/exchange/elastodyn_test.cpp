// Published frequencies of a blade and a tower.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "withy/core/model/model.hpp"
#include "withy/study/prepared.hpp"
#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

double frequency_of(const nlohmann::json& modes, std::size_t mode) {
  return modes.at("points").at(0).at("modes").at(mode).at("hertz").get<double>();
}

/// The blade by itself: 0.68 Hz flapwise, to two digits, and 1.08 Hz edgewise are published, of its twisted sections.
/// The tower with 350 t of rotor and nacelle: 0.32 to 0.34 Hz.
TEST(ElastoDyn, BladeAndTowerOfTheReferenceTurbineHaveTheirPublishedFrequencies) {
  const auto blade = nlohmann::json::parse(scene_of({model_file("blade.dat"), {}, false, 61.5, 0}).modes());
  EXPECT_NEAR(frequency_of(blade, 0), 0.68, 0.005);
  EXPECT_NEAR(frequency_of(blade, 1), 1.08, 0.02 * 1.08);
  const auto tower = nlohmann::json::parse(scene_of({model_file("tower.dat"), {}, false, 87.6, 350e3}).modes());
  EXPECT_GT(frequency_of(tower, 0), 0.32);
  EXPECT_LT(frequency_of(tower, 1), 0.34);
  // Published: 17740 kg, to which the adjustment brings the table by another quadrature.
  const auto prepared = scene_of({model_file("blade.dat"), {}, false, 61.5, 0}).prepare();
  double mass = 0;
  for (const Particle& p : prepared->model().bodies()[0].body->shape().particles) mass += p.mass;
  EXPECT_NEAR(mass, 17740, 0.01 * 17740);
}

/// Two modes of vibration and a static shape each way, which know nothing of twist, against twelve of these and
/// twenty polynomials: 4e-4 of the first two frequencies.
TEST(ElastoDyn, ABladeIsKnownByThreeFunctionsEachWay) {
  const auto frequencies = [](const std::string& family, double count) {
    host::Scene scene = scene_of({model_file("blade.dat"), {}, false, 61.5, 0});
    for (const char* strain : {"bending_y", "bending_z"}) {
      scene.set(std::string("bodies.blade.") + strain + ".modes", count);
      scene.set(std::string("bodies.blade.") + strain + ".family", family);
    }
    const auto modes = nlohmann::json::parse(scene.modes());
    return std::pair(frequency_of(modes, 0), frequency_of(modes, 1));
  };
  const auto few = frequencies("vibration-modes", 3), many = frequencies("vibration-modes", 12),
             polynomials = frequencies("orthogonal-polynomials", 20);
  for (const auto& [one, other] : {std::pair(few, many), std::pair(many, polynomials)}) {
    EXPECT_NEAR(one.first, other.first, 5e-4 * other.first);
    EXPECT_NEAR(one.second, other.second, 5e-4 * other.second);
  }
}

}  // namespace
}  // namespace withy::exchange
