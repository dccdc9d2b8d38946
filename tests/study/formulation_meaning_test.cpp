// What results say of a formulation that is chosen by its two choices.
#include "withy/study/formulation_meaning.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;
using testing::Not;

Prepared of_pair(const std::string& kinematics, const std::string& truncation) {
  SceneValues values = short_slew(1.2);
  values.choose_formulation(Value::map({{"name", Value(std::string("general"))},
                                        {"kinematics", Value(kinematics)},
                                        {"truncation", Value(truncation)}}),
                            "the test");
  return prepare(std::move(values), plugins());
}

Prepared of_name(const std::string& formulation) {
  return prepare(short_slew(1.2).choose_formulation(formulation, "the test"), plugins());
}

/// At a state that is bent and moves.
std::vector<double> rates_of(const Prepared& prepared) {
  State state = prepared.scene.initial;
  for (std::size_t i = 0; i < state.y.size(); ++i) state.y[i] += 0.003 * static_cast<double>(i + 1);
  std::vector<double> rates(state.y.size());
  Work work = prepared.equations->make_work();
  EXPECT_TRUE(prepared.equations->derivatives(state.time, state.y, rates, work).ok());
  return rates;
}

TEST(FormulationMeaning, OfAPairIsItsChoicesAndTheFormulationOfOneNameWithTheSameMotion) {
  struct Known {
    std::string kinematics, truncation, name;
  };
  for (const auto& [kinematics, truncation, name] :
       {Known{"linear", "ruthless", "ruthless"}, Known{"linear", "strict", "inconsistent"},
        Known{"linear", "symmetric", "symmetric-linear"}, Known{"linear", "none", "linear"},
        Known{"quadratic", "strict", "consistent"}, Known{"quadratic", "symmetric", "symmetric"},
        Known{"quadratic", "none", "quadratic"}, Known{"exact", "none", "exact"}}) {
    const Prepared pair = of_pair(kinematics, truncation);
    const FormulationWords words = formulation_words_of(pair.scene, plugins());
    EXPECT_EQ(words.name, "general");
    EXPECT_EQ(words.title, "general: " + kinematics + ", " + truncation);
    EXPECT_THAT(words.meaning, HasSubstr("'" + kinematics + "' with truncation '" + truncation + "'"));
    EXPECT_THAT(words.meaning, HasSubstr("the same as formulation '" + name + "': "));
    EXPECT_EQ(rates_of(pair), rates_of(of_name(name))) << name;
  }
  const Prepared own = of_pair("foreshortening", "symmetric");
  EXPECT_THAT(formulation_words_of(own.scene, plugins()).meaning, Not(HasSubstr("the same as")));
  EXPECT_EQ(formulation_title(of_name("linear").scene), "linear");
}

TEST(FormulationMeaning, IsInTheCertificateOfARun) {
  const Prepared pair = of_pair("linear", "none");
  RunSettings settings;
  settings.estimate = Estimate::never;
  EXPECT_EQ(run(pair, plugins(), settings).certificate.meaning,
            "Strain kinematics 'linear' with truncation 'none', the same as formulation 'linear': " +
                plugins().find<Formulation>("linear")->summary);
}

}  // namespace
}  // namespace withy::study
