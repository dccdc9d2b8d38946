// Published frequencies of a blade and a tower.
#include "withy/exchange/elastodyn.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/core/model/model.hpp"
#include "withy/study/prepared.hpp"
#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

using testing::Contains, testing::ElementsAre, testing::HasSubstr, testing::StartsWith;

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

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Of the blade clamped at its root, carrying nothing, the modes have what the file says of them, and those above the
/// ratio of the last in their direction: the first three are flapwise, edgewise and flapwise, the fourth is edgewise.
TEST(ElastoDyn, EachModeHasTheDampingThatTheFileGivesIt) {
  const std::string file = text_of_file(model_file("blade.dat")), line = "   0.477465   ";
  const Scratch blade("blade.dat", replaced(replaced(file, line + "BldFlDmp(2)", "3.0 BldFlDmp(2)"),
                                            line + "BldEdDmp(1)", "2.0 BldEdDmp(1)"));
  const ImportedScene scene = imported({blade.file(), {}, false, 61.5, 0});
  const auto modes = nlohmann::json::parse(host::Scene::parse(plugins(), scene.text).modes());
  const std::array<double, 4> ratios = {0.00477465, 0.02, 0.03, 0.02};
  for (std::size_t k = 0; k < ratios.size(); ++k)
    EXPECT_NEAR(modes.at("points").at(0).at("modes").at(k).at("damping_ratio").get<double>(), ratios[k], 1e-9) << k;
  EXPECT_THAT(scene.remarks, Contains(HasSubstr("1 (flapwise, 0.00477465), 2 (edgewise, 0.02), 3 (flapwise, 0.03)")));
  // One ratio for all needs no more than itself.
  const ImportedScene even = imported({model_file("blade.dat"), {}, false, 61.5, 0});
  EXPECT_THAT(even.text, HasSubstr("    damping_ratio: 0.00477465\n    bending_y"));
}

/// Directions of equal stiffness have pairs of modes of one frequency, which do not mix.
TEST(ElastoDyn, ATowerHasDampingOfItsOwnInEachDirection) {
  const std::string file = text_of_file(model_file("tower.dat"));
  const Scratch tower("tower.dat", replaced(file, "1   TwrSSDmp(1)", "4   TwrSSDmp(1)"));
  // Weight bends the tower further, and the ratios are those without.
  const std::string text = replaced(imported({tower.file(), {}, false, 87.6, 0}).text, "-9.80665", "0");
  const auto modes = nlohmann::json::parse(host::Scene::parse(plugins(), text).modes());
  std::vector<double> ratios;
  for (std::size_t k = 0; k < 2; ++k)
    ratios.push_back(modes.at("points").at(0).at("modes").at(k).at("damping_ratio").get<double>());
  EXPECT_NEAR(std::min(ratios[0], ratios[1]), 0.01, 1e-9);
  EXPECT_NEAR(std::max(ratios[0], ratios[1]), 0.04, 1e-9);
}

// Factors of the file are of one column each; ElastoDyn's twist is towards feather, about −x, in degrees; exponents may
// be Fortran's.
TEST(ElastoDyn, ColumnsHaveTheFactorAndTheSenseOfTheirOwn) {
  const ElastoDynBeam blade = read_elastodyn(R"(------- ELASTODYN V1.00.* INDIVIDUAL BLADE INPUT FILE -------
Blade of two rows
---------------------- BLADE PARAMETERS --------
   2   NBlInpSt    - stations
   1.0   BldFlDmp(1) - %
   2.0   BldFlDmp(2) - %
   3.0   BldEdDmp(1) - %
   1.5   AdjBlMs - factor
   2.0   AdjFlSt - factor
   5.0   AdjEdSt - factor
---------------------- DISTRIBUTED BLADE PROPERTIES ----
BlFract StrcTwst BMassDen FlpStff EdgStff
(-) (deg) (kg/m) (Nm^2) (Nm^2)
0.0 18.0 1.0D+2 1d8 2.0D+08
1.0 -9.0 50 1E7 2e7
)",
                                             "blade.dat");
  EXPECT_THAT(blade.mass_per_length, ElementsAre(150, 75));
  EXPECT_THAT(blade.along_y, ElementsAre(2e8, 2e7));
  EXPECT_THAT(blade.along_z, ElementsAre(1e9, 1e8));
  EXPECT_THAT(blade.twist,
              ElementsAre(testing::DoubleEq(-std::numbers::pi / 10), testing::DoubleEq(std::numbers::pi / 20)));
  EXPECT_THAT(blade.damping_y, ElementsAre(0.01, 0.02));
  EXPECT_THAT(blade.damping_z, ElementsAre(0.03));
}

/// A comma ends a number: of 0,7 % the rest would be a parameter called 7, and the blade undamped.
TEST(ElastoDyn, DecimalCommasAreRefusedWhereTheyStand) {
  const std::string file = text_of_file(model_file("blade.dat"));
  const auto problems_of_blade = [](const std::string& text) {
    const Scratch blade("comma.dat", text);
    return problems_of({blade.file(), {}, false, 61.5, 0});
  };
  EXPECT_EQ(problems_of_blade(file), "");
  const std::string with_comma = replaced(file, "0.477465   BldEdDmp(1)", "0,477465   BldEdDmp(1)");
  const std::string before = with_comma.substr(0, with_comma.find("0,47"));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  EXPECT_THAT(problems_of_blade(with_comma),
              HasSubstr("comma.dat:" + std::to_string(line) + ":1: /: got \"0,477465\"; need a finite number"));
  EXPECT_THAT(problems_of_blade(replaced(file, "0.477465   BldEdDmp(1)", "0.4.7   BldEdDmp(1)")),
              HasSubstr("got \"0.4.7\"; need a finite number"));
  // Numbers of a table that commas part are numbers; one too many is of a decimal comma.
  const std::size_t heading = file.find("BlFract"), units = file.find('\n', heading) + 1,
                    row = file.find('\n', units) + 1;
  std::string parted = file;
  for (std::size_t i = row; parted[i] != '\n'; ++i)
    if (parted[i] == ' ' && i > row && parted[i - 1] != ' ' && parted[i - 1] != '\n') parted[i] = ',';
  EXPECT_EQ(problems_of_blade(parted), "");
  std::string decimal = file;
  decimal[decimal.find('.', decimal.find('\n', row))] = ',';
  EXPECT_THAT(problems_of_blade(decimal), HasSubstr("need 6, one for each column; decimals follow a point"));
}

TEST(ElastoDyn, WhatTheFileDoesNotSayIsToldAndWhatItSaysTwiceIsRefused) {
  const std::string file = text_of_file(model_file("blade.dat")), mass = "    1.04536   AdjBlMs ";
  const auto without = [](const std::string& text, const std::string& key) {
    const std::size_t at = text.find(key), begin = text.rfind('\n', at) + 1;
    return text.substr(0, begin) + text.substr(text.find('\n', at) + 1);
  };
  const auto remarks = [](const std::string& text) {
    const Scratch blade("missing.dat", text);
    return imported({blade.file(), {}, false, 61.5, 0}).remarks;
  };
  EXPECT_THAT(remarks(file), testing::Not(Contains(HasSubstr("Not in the file"))));
  EXPECT_THAT(remarks(without(without(file, "AdjBlMs"), "BldEdDmp(1)")),
              Contains("Not in the file: AdjBlMs, taken as 1; BldEdDmp(1), taken as 0."));
  EXPECT_THAT(remarks(without(file, "BldFlDmp(2)")), Contains("Not in the file: BldFlDmp(2), taken as BldFlDmp(1)."));
  const Scratch blade("twice.dat", replaced(file, mass, "        2.0   AdjBlMs - again\n" + mass));
  EXPECT_THAT(problems_of({blade.file(), {}, false, 61.5, 0}),
              HasSubstr("twice.dat:12:1: /: AdjBlMs stands on line 11 already; need it once"));
}

/// Columns that FAST 7 gave to ADAMS, and where air acts; one that is zero all along leaves nothing out.
TEST(ElastoDyn, ColumnsThatNoBeamHasAreListed) {
  const std::string file = R"(------- FAST 7 -------
--------- FAST INDIVIDUAL BLADE FILE ---------
Blade of 3 rows
---------------------- BLADE PARAMETERS --------
   3   NBlInpSt    - stations
   False   CalcBMode   - flag
   1.0   BldFlDmp(1) - %
   1.0   BldFlDmp(2) - %
   1.0   BldEdDmp(1) - %
   7.5   Sweep - an angle that no beam has
   1.0   AdjBlMs - factor
   1.0   AdjFlSt - factor
   1.0   AdjEdSt - factor
---------------------- DISTRIBUTED BLADE PROPERTIES ----
BlFract AeroCent StrcTwst BMassDen FlpStff EdgStff GJStff EAStff Alpha FlpcgOf
(-) (-) (deg) (kg/m) (Nm^2) (Nm^2) (Nm^2) (N) (-) (m)
0.0 0.25 0 100 1e8 2e8 1e7 1e9 0 0.0
0.5 0.25 0 80 8e7 1e8 1e7 1e9 0 0.1
1.0 0.25 0 50 1e7 2e7 1e7 1e9 0 0.0
)";
  const Scratch blade("fast7.dat", file);
  const ImportedScene scene = imported({blade.file(), {}, false, 30, 0});
  EXPECT_THAT(scene.remarks, ElementsAre(HasSubstr("mode shapes"), StartsWith("Sweep = 7.5 on line 10 is left out"),
                                         StartsWith("Column AeroCent of the table is left out"),
                                         StartsWith("Columns GJStff, EAStff, FlpcgOf of the table are left out")));
  for (const std::string& remark : scene.remarks) EXPECT_THAT(scene.text, HasSubstr("# " + remark)) << "in the scene";
}

}  // namespace
}  // namespace withy::exchange
