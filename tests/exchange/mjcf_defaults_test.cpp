// Default classes of MJCF, by the accelerations that they make.
#include <gtest/gtest.h>

#include "withy/tests/exchange/models.hpp"

namespace withy::exchange {
namespace {

/// A cube of 4 kg whose centre is 0.3 m from its pivot, I = 0.36 + 4 · 0.2²/6: (−7 · 0.2 − 3 · 0.5) / I = −7.5 rad/s².
TEST(MjcfDefaults, ADefaultOfTheTopLevelIsThatOfAllElementsWhateverClassItNames) {
  for (const std::string named : {"", " class='main'", " class='robot'"}) {
    const std::string inside =
        "<option gravity='0 0 0'/><default" + named +
        "><geom density='500'/><joint damping='3' stiffness='7'/><default class='stiff'><joint stiffness='14'/>"
        "</default></default><worldbody><body><joint name='j' axis='0 1 0'/><geom type='box' size='0.1 0.1 0.1' "
        "pos='0.3 0 0'/></body><body><joint name='k' class='stiff' axis='0 1 0'/><geom class='" +
        (named == " class='robot'" ? "robot" : "main") +
        "' type='box' size='0.1 0.1 0.1' pos='0.3 0 0'/></body></worldbody>";
    const Scratch file(".xml", "<mujoco>" + inside + "</mujoco>");
    const ImportedScene scene = imported({file.file(), {}, false, 0, 0});
    host::Equations f(host::Scene::parse(plugins(), scene.text));
    std::vector<double> y = f.y0();
    for (const char* joint : {"j", "k"}) {
      put(f, y, joint, 0.2);
      put(f, y, std::string(joint) + ".rate", 0.5);
    }
    const auto got = accelerations(f, y);
    EXPECT_NEAR(got.at("j.rate"), -7.5, 1e-12) << named;
    EXPECT_NEAR(got.at("k.rate"), -(14 * 0.2 + 3 * 0.5) / (0.36 + 4 * 0.04 / 6), 1e-12) << named;
    EXPECT_EQ(scene.text.find("stands at the top level") != std::string::npos, named == " class='robot'");
  }
}

}  // namespace
}  // namespace withy::exchange
