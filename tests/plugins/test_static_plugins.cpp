// The same plugins, linked in and loaded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "withy/core/plugin/entry.hpp"
#include "withy/plugins/host/plugin_host.hpp"
#include "withy/plugins/host/static_plugins.hpp"

namespace {

using withy::PluginHost;
using withy::PluginRecord;
using withy::Registry;

/// "kind/id" of everything in a registry, once everything its host knows is loaded.
template <class... Interface>
std::vector<std::string> load_all(Registry& registry) {
  std::vector<std::string> names;
  const auto load = [&]<class Kind>(const Kind*) {
    for (const std::string& id : registry.ids<Kind>()) {
      EXPECT_NE(registry.find<Kind>(id), nullptr) << id;
      names.push_back(std::string(withy::kind_name<Kind>()) + "/" + id);
    }
  };
  (load(static_cast<const Interface*>(nullptr)), ...);
  return names;
}

std::vector<std::string> everything(Registry& registry) {
  return load_all<withy::Body, withy::Hinge, withy::ModeFamily, withy::Formulation, withy::Integrator, withy::Load,
                  withy::Motion, withy::StrainKinematics, withy::Sensor>(registry);
}

TEST(StaticPlugins, are_the_plugins_of_the_libraries) {
  Registry linked;
  withy::enroll_static_plugins(linked);
  Registry loaded;
  const PluginHost host({PluginHost::default_directory()});
  host.attach(loaded);
  auto names = everything(linked);
  names.emplace_back("load/fmu");  // what needs a library to be loaded is not linked in
  EXPECT_THAT(everything(loaded), testing::UnorderedElementsAreArray(names));
  EXPECT_GE(names.size(), withy::static_plugins().size()) << "each library brings at least one";
  EXPECT_GT(names.size(), 0U);
  for (const PluginRecord& record : host.plugins()) {
    EXPECT_EQ(record.state, PluginRecord::State::loaded) << record.reason;
    EXPECT_FALSE(record.summary.empty()) << record.kind << "/" << record.id << " says what it is for";
  }
}

TEST(StaticPlugins, enrolled_twice_are_duplicates) {
  Registry registry;
  withy::enroll_static_plugins(registry);
  EXPECT_THROW(withy::enroll_static_plugins(registry), std::invalid_argument);
}

}  // namespace
