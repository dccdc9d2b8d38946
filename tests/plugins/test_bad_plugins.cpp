// Every inhabitant of the zoo: refused with its own words, nothing of it admitted, and the program goes on.
#include <gmock/gmock.h>

#include <algorithm>
#include <cfenv>
#include <limits>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/entry.hpp"
#include "zoo_keeper.hpp"

namespace {

using testing::HasSubstr;
using withy::PluginHost;
using withy::PluginRecord;
using withy::Registry;
using zoo_keeper::ask;
using zoo_keeper::place;

struct Inhabitant {
  const char* name;
  const char* says;  ///< part of the message
};

std::ostream& operator<<(std::ostream& out, const Inhabitant& i) { return out << i.name; }

class BadPlugin : public testing::TestWithParam<Inhabitant> {};

TEST_P(BadPlugin, is_refused_in_its_own_words_and_leaves_the_good_one_working) {
  const std::string id = std::string("zoo-") + GetParam().name;
  Registry registry;
  const PluginHost host({place(GetParam().name), place("good")});
  host.attach(registry);

  const std::string first = ask(registry, id);
  EXPECT_THAT(first, HasSubstr(GetParam().says));
  EXPECT_THAT(first, HasSubstr(id + ".so")) << "the file is named";
  EXPECT_EQ(first.find('\n'), std::string::npos) << "one sentence";
  EXPECT_EQ(ask(registry, id), first) << "asked again, it is still refused";

  // Nothing of it is admitted; it is on record; and the good one works.
  EXPECT_EQ(registry.ids<withy::Body>(), std::vector<std::string>{"zoo-good"});
  EXPECT_EQ(ask(registry, "zoo-good"), "loaded");
  for (const PluginRecord& record : host.plugins()) {
    if (record.id == "zoo-good") {
      EXPECT_EQ(record.state, PluginRecord::State::loaded);
    } else {
      EXPECT_EQ(record.state, PluginRecord::State::refused);
      EXPECT_EQ(record.reason, first);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    zoo, BadPlugin,
    testing::Values(
        Inhabitant{"abi-0", "its SDK version is foreign, this program's is 11"},
        Inhabitant{"abi-1", "its compiler is foreign, this program's is "},
        Inhabitant{"abi-2", "its standard library is foreign, this program's is "},
        Inhabitant{"abi-3", "its debug containers is foreign, this program's is "},
        Inhabitant{"abi-4", "its run-time type information is foreign, this program's is "},
        Inhabitant{"abi-5", "its sanitizer is foreign, this program's is "},
        Inhabitant{"abi-6", "its arithmetic is foreign, this program's is IEEE"},
        Inhabitant{"abi-7", "its Eigen version is foreign, this program's is "},
        Inhabitant{"abi-8", "its alignment of Eigen's fixed sizes is foreign, this program's is 32"},
        Inhabitant{"abi-9", "its alignment of Eigen's memory is foreign, this program's is 32"},
        Inhabitant{"abi-unknown", "it depends on a byte order (middle) this program does not know"},
        Inhabitant{"abi-missing", "it does not state its alignment of Eigen's memory"},
        Inhabitant{"abi-null", "its list of build properties is damaged"},
        Inhabitant{"abi-null-text", "its list of build properties is damaged"},
        Inhabitant{"abi-endless", "its list of build properties is damaged"},
        Inhabitant{"debug-containers", "its debug containers is on, this program's is off"},
        Inhabitant{"finite-math", "its arithmetic is finite-math-only, this program's is IEEE"},
        Inhabitant{"alignment", "its alignment of Eigen's fixed sizes is 16, this program's is 32"},
        Inhabitant{"magic", "has an entry that is no withy plugin descriptor"},
        Inhabitant{"null-table", "has an entry that is no withy plugin descriptor"},
        Inhabitant{"size", "has a plugin descriptor of 48 bytes where 40 are expected"},
        Inhabitant{"null-enroll", "has a plugin descriptor without enroll function"},
        Inhabitant{"missing-symbol", "undefined symbol: withy_plugin_zoo_missing_symbol"},
        Inhabitant{"unresolved", "undefined symbol: _Z24function_that_is_nowherev"},
        Inhabitant{"escapes", "let an exception out of its enroll function"},
        Inhabitant{"unterminated", "failed to enroll its plugins: ?????"},
        Inhabitant{"throws-text", "failed to enroll its plugins: the material data base is missing"},
        Inhabitant{"throws-number", "failed to enroll its plugins: an exception of unknown type"},
        Inhabitant{"throws-long", "failed to enroll its plugins: xxxxx"},
        Inhabitant{"half", "does not enroll 'body/zoo-other-half', which its manifest promises"},
        Inhabitant{"half-and-throws", "failed to enroll its plugins: no licence found"},
        Inhabitant{"nothing", "does not enroll 'body/zoo-nothing', which its manifest promises"},
        Inhabitant{"excess", "enrolls 'body/zoo-unannounced', which its manifest does not promise"},
        Inhabitant{"twice", "body 'zoo-twice' is twice in "},
        Inhabitant{"malformed-id", "enrolls 'body/Zoo Malformed', whose id is not 1 to 64 of a-z, 0-9 and '-'"},
        Inhabitant{"no-factory", " has no factory"},
        Inhabitant{"fast-math", "is refused: it changes flush-to-zero, denormals-are-zero for the whole program"},
        Inhabitant{"rounding", "is refused: it changes the rounding mode"},
        Inhabitant{"rounding-late", "is refused: it changes the rounding mode"}),
    [](const auto& name) {
      std::string text = name.param.name;
      std::replace(text.begin(), text.end(), '-', '_');
      return text;
    });

TEST(BadPlugins, every_property_of_the_identity_is_compared_and_named_with_both_values) {
  // One inhabitant a property: abi-0 … abi-9, in the order of the identity.
  constexpr withy::AbiIdentity identity = withy::abi_identity();
  for (std::size_t i = 0; i < identity.size(); ++i) {
    const std::string name = "abi-" + std::to_string(i);
    EXPECT_THAT(ask({place(name)}, "zoo-" + name),
                HasSubstr(std::string(" does not fit this program: its ") + identity[i].name +
                          " is foreign, this program's is " + identity[i].value));
  }
}

TEST(BadPlugins, all_together_leave_the_program_running_and_every_good_one_usable) {
  std::vector<std::filesystem::path> all;
  for (const auto& entry : std::filesystem::directory_iterator(WITHY_ZOO)) {
    if (entry.is_directory()) all.push_back(entry.path());
  }
  ASSERT_GT(all.size(), 35U);
  Registry registry;
  const PluginHost host(all);
  host.attach(registry);
  std::size_t refused = 0;
  std::size_t loaded = 0;
  for (const PluginRecord& record : host.plugins()) {
    const std::string answer = ask(registry, record.id);
    EXPECT_NE(answer, "unknown");
    ++(answer == "loaded" ? loaded : refused);
  }
  EXPECT_EQ(loaded, 6U) << "good, left, right, two, and the one whose shape, not whose library, is bad";
  EXPECT_EQ(refused, 40U) << "the parameters above, and both halves of one of them";
}

TEST(BadPlugins, a_library_that_changes_the_arithmetic_does_so_to_nobody) {
  // Half the least normal number is a denormal: flushed to zero where FTZ or DAZ is set.
  volatile double least = std::numeric_limits<double>::min();
  // 1 + 2⁻⁶⁰ rounds to 1 unless the mode is upward.
  volatile double tiny = 0x1p-60;
  for (const char* name : {"fast-math", "rounding", "rounding-late"}) {
    EXPECT_NE(ask({place(name)}, std::string("zoo-") + name), "loaded");
    EXPECT_GT(least / 2, 0.0) << name;
    EXPECT_EQ(1.0 + tiny, 1.0) << name;
    EXPECT_EQ(std::fegetround(), FE_TONEAREST) << name;
  }
}

TEST(BadPlugins, a_library_that_changed_the_arithmetic_is_refused_by_a_second_host_although_it_is_loaded_already) {
  const std::string first = ask({place("fast-math")}, "zoo-fast-math");
  EXPECT_THAT(first, HasSubstr("flush-to-zero"));
  EXPECT_EQ(ask({place("fast-math")}, "zoo-fast-math"), first);
}

TEST(BadPlugins, a_body_with_a_nan_loads_but_no_model_is_built_with_it) {
  Registry registry;
  const PluginHost host({place("nan-body")});
  host.attach(registry);
  const auto* plugin = registry.find<withy::Body>("zoo-nan-body");
  ASSERT_NE(plugin, nullptr);
  withy::Diagnostics diagnostics;
  withy::BodyNode node;
  node.name = "payload";
  node.body = plugin->make(withy::Value::map({}), {registry, diagnostics});
  try {
    withy::Model({node}, {withy::HingeNode{}}, withy::Vector3::Zero());
    FAIL() << "a model was built";
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "the shape of body 'payload' cannot be used: particle 1: X has nan in row 2, column 1");
  }
}

}  // namespace
