// Finding and loading: only what is named, from where it is safe, each plugin from one place.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <thread>

#include "withy/core/plugin/load.hpp"
#include "zoo_keeper.hpp"

namespace {

using testing::HasSubstr;
using withy::PluginHost;
using withy::PluginRecord;
using withy::Registry;
using zoo_keeper::ask;
using zoo_keeper::place;
using zoo_keeper::Scratch;
namespace fs = std::filesystem;

PluginRecord record_of(const PluginHost& host, const std::string& id) {
  for (const PluginRecord& record : host.plugins()) {
    if (record.id == id) return record;
  }
  ADD_FAILURE() << id << " is not on record";
  return {};
}

TEST(PluginHost, loads_only_the_libraries_whose_plugins_are_asked_for) {
  const Scratch scratch;  // copies, so that no other test has loaded them
  const fs::path house = scratch.house("pair", "pair");
  Registry registry;
  const PluginHost host({house});
  host.attach(registry);
  EXPECT_EQ(registry.ids<withy::Body>(), (std::vector<std::string>{"zoo-left", "zoo-right"}));
  EXPECT_FALSE(zoo_keeper::is_mapped(house / "zoo-left.so")) << "known from its manifest alone";

  EXPECT_EQ(ask(registry, "zoo-left"), "loaded");
  EXPECT_TRUE(zoo_keeper::is_mapped(house / "zoo-left.so"));
  EXPECT_FALSE(zoo_keeper::is_mapped(house / "zoo-right.so"));
  EXPECT_EQ(record_of(host, "zoo-left").state, PluginRecord::State::loaded);
  EXPECT_EQ(record_of(host, "zoo-left").summary, "a point mass of 1 kg");
  EXPECT_EQ(record_of(host, "zoo-right").state, PluginRecord::State::available);
  EXPECT_EQ(record_of(host, "zoo-right").summary, "");
}

TEST(PluginHost, a_loaded_plugin_works_and_knows_its_file) {
  Registry registry;
  PluginHost({place("good")}).attach(registry);  // what the registry needs of the host outlives it
  const auto* plugin = registry.find<withy::Body>("zoo-good");
  ASSERT_NE(plugin, nullptr);
  EXPECT_EQ(plugin->origin, (fs::canonical(place("good")) / "zoo-good.so").string());
  withy::Diagnostics diagnostics;
  const auto body = plugin->make(withy::Value::map({}), {registry, diagnostics});
  ASSERT_NE(body, nullptr);
  EXPECT_EQ(body->shape().particles.front().mass, 1.0);
  EXPECT_NE(dynamic_cast<const withy::Body*>(body.get()), nullptr);
}

TEST(PluginHost, is_never_unloaded_so_objects_outlive_host_and_registry) {
  std::unique_ptr<withy::Body> body;
  {
    Registry registry;
    const PluginHost host({place("good")});
    host.attach(registry);
    withy::Diagnostics diagnostics;
    body = registry.find<withy::Body>("zoo-good")->make(withy::Value::map({}), {registry, diagnostics});
  }
  EXPECT_EQ(ask({place("pair")}, "zoo-left"), "loaded") << "another host, another library";
  EXPECT_TRUE(zoo_keeper::is_mapped(fs::canonical(place("good")) / "zoo-good.so"));
  EXPECT_EQ(body->stations(), "root");
}

TEST(PluginHost, does_not_know_what_no_manifest_provides_nor_another_kind_of_the_same_name) {
  EXPECT_EQ(ask({place("good")}, "zoo-bad"), "unknown");
  EXPECT_EQ(ask({place("good")}, "../good/zoo-good"), "unknown") << "ids, never paths";
  Registry registry;
  const PluginHost host({place("good")});
  host.attach(registry);
  EXPECT_EQ(registry.find<withy::Load>("zoo-good"), nullptr);
}

TEST(PluginHost, an_id_in_two_manifests_is_an_error_that_names_both_files) {
  const Scratch scratch;
  const fs::path a = scratch.house("good", "a");
  const fs::path b = scratch.house("good", "b");
  const std::string expected = "the plugin 'body/zoo-good' is in two places: " + (a / "zoo-good.so").string() +
                               " and " + (b / "zoo-good.so").string();
  EXPECT_EQ(ask({a, b}, "zoo-good"), expected);
  EXPECT_FALSE(zoo_keeper::is_mapped(a / "zoo-good.so"));
  EXPECT_EQ(ask({a, b, place("pair")}, "zoo-left"), "loaded") << "others are not concerned";
  EXPECT_EQ(ask({a, a, scratch.path() / "." / "a"}, "zoo-good"), "loaded") << "one directory given thrice is one";
}

TEST(PluginHost, a_library_with_an_id_the_program_has_already_is_an_error_that_names_both_and_brings_nothing) {
  Registry registry;
  withy::Enrollment own;
  own.add(withy::Plugin<withy::Body>{
      .id = "zoo-two-more", .summary = "", .parameters = {}, .make = [](const auto&, const auto&) {
        return std::unique_ptr<withy::Body>();
      }});
  registry.admit(own, "built in");
  const PluginHost host({place("two")});  // provides zoo-two and zoo-two-more
  host.attach(registry);
  EXPECT_EQ(ask(registry, "zoo-two"), "body 'zoo-two-more' is in two places: built in and " +
                                          (fs::canonical(place("two")) / "zoo-two.so").string());
  EXPECT_EQ(registry.ids<withy::Body>(), std::vector<std::string>{"zoo-two-more"});
  EXPECT_EQ(registry.find<withy::Body>("zoo-two-more")->origin, "built in");
}

TEST(PluginHost, a_directory_anybody_can_write_to_is_refused) {
  const Scratch scratch;
  const fs::path house = scratch.house("good", "open");
  fs::permissions(house, fs::perms::others_write, fs::perm_options::add);
  EXPECT_EQ(ask({house}, "zoo-good"), "the plugin " + (house / "zoo-good.plugin").string() + " is refused: " +
                                          house.string() + " is writable by everybody, so its code cannot be trusted");
  EXPECT_FALSE(zoo_keeper::is_mapped(house / "zoo-good.so"));
  fs::permissions(house, fs::perms::others_write | fs::perms::sticky_bit, fs::perm_options::add);
  EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr("writable by everybody")) << "anybody could still add to it";
  EXPECT_EQ(ask({house, place("good")}, "zoo-good"), "loaded") << "what lies there does not hide a good one";
}

TEST(PluginHost, a_directory_below_one_anybody_can_rename_in_is_refused) {
  const Scratch scratch;
  fs::create_directory(scratch.path() / "outer");
  const fs::path house = scratch.house("good", "outer/inner");
  fs::permissions(scratch.path() / "outer", fs::perms::others_write, fs::perm_options::add);
  EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr((scratch.path() / "outer").string() + " is writable by everybody"));
  fs::permissions(scratch.path() / "outer", fs::perms::sticky_bit, fs::perm_options::add);
  EXPECT_EQ(ask({house}, "zoo-good"), "loaded") << "a sticky directory, as the temporary one, protects its entries";
}

TEST(PluginHost, what_another_user_owns_or_a_group_can_write_to_is_refused) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root gives files away";
  constexpr uid_t other = 4711;
  const Scratch scratch;
  const fs::path house = scratch.house("good", "house");
  for (const fs::path& file : {house, house / "zoo-good.plugin", house / "zoo-good.so"}) {
    ASSERT_EQ(::chown(file.c_str(), other, other), 0);
    EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr(file.string() + " belongs to another user (4711)"));
    ASSERT_EQ(::chown(file.c_str(), 0, other), 0);
    fs::permissions(file, fs::perms::group_write, fs::perm_options::add);
    EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr(file.string() + " is writable by a group (4711)"));
    ASSERT_EQ(::chown(file.c_str(), 0, 0), 0);
  }
  EXPECT_FALSE(zoo_keeper::is_mapped(house / "zoo-good.so"));
  EXPECT_EQ(ask({house}, "zoo-good"), "loaded") << "the group of root is root's own";
}

TEST(PluginHost, a_library_that_is_cut_short_or_no_file_is_not_mapped) {
  const Scratch scratch;
  const fs::path house = scratch.house("good", "house");
  const fs::path library = house / "zoo-good.so";
  const std::uintmax_t whole = fs::file_size(library);
  for (const std::uintmax_t size : {whole / 2, whole / 4, std::uintmax_t{4096}, std::uintmax_t{100}}) {
    fs::resize_file(library, size);
    EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr(library.string() + " cannot be loaded: it is cut short")) << size;
  }
  fs::remove(library);
  ASSERT_EQ(::mkfifo(library.c_str(), 0600), 0);
  EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr("cannot be loaded: it is no file"));
}

TEST(PluginHost, a_manifest_or_library_anybody_can_write_to_is_refused_also_behind_a_link) {
  const Scratch scratch;
  const fs::path house = scratch.house("good", "house");
  const fs::path library = house / "zoo-good.so";
  fs::permissions(house / "zoo-good.plugin", fs::perms::others_write, fs::perm_options::add);
  EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr("zoo-good.plugin is writable by everybody"));
  fs::permissions(house / "zoo-good.plugin", fs::perms::others_write, fs::perm_options::remove);
  fs::permissions(library, fs::perms::others_write, fs::perm_options::add);
  EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr(library.string() + " is writable by everybody"));
  fs::create_directory(scratch.path() / "elsewhere");
  const fs::path target = scratch.path() / "elsewhere" / "real.so";
  fs::rename(library, target);
  fs::create_symlink(target, library);
  EXPECT_THAT(ask({house}, "zoo-good"), HasSubstr(target.string() + " is writable by everybody"));
  EXPECT_FALSE(zoo_keeper::is_mapped(target));
  fs::permissions(target, fs::perms::others_write, fs::perm_options::remove);
  EXPECT_EQ(ask({house}, "zoo-good"), "loaded");
}

TEST(PluginHost, records_directories_that_are_not_there) {
  const Scratch scratch;
  const auto file = scratch.write("file", "");
  const auto records = PluginHost({scratch.path() / "nowhere", file, scratch.path()}).plugins();
  ASSERT_EQ(records.size(), 2U) << "an empty directory is no error";
  EXPECT_EQ(records[0].reason, "the plugin directory " + (scratch.path() / "nowhere").string() +
                                   " cannot be read: No such file or directory");
  EXPECT_EQ(records[1].reason, "the plugin directory " + file.string() + " cannot be read: it is not a directory");
}

TEST(PluginHost, finds_its_own_plugins_from_where_its_library_is) {
  const fs::path program = fs::canonical("/proc/self/exe");
  EXPECT_EQ(PluginHost::default_directory(), program.parent_path().parent_path() / "lib/withy/plugins");
}

// Helgrind and the thread sanitizer find no race here either.
TEST(PluginHost, may_be_one_for_all_threads_or_one_for_each) {
  const std::vector<std::string> cases = {"good", "half", "two", "fast-math", "rounding", "missing-symbol", "left"};
  std::vector<fs::path> places;
  for (const char* name : {"good", "half", "two", "fast-math", "rounding", "missing-symbol", "pair"})
    places.push_back(place(name));
  const auto answers = [&](const PluginHost& host) {
    std::vector<std::string> all;
    for (const std::string& name : cases) {
      Registry registry;  // a registry asks again
      host.attach(registry);
      all.push_back(ask(registry, "zoo-" + name));
    }
    return all;
  };
  const PluginHost shared(places);
  std::vector<std::vector<std::string>> own(4), common(4);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < own.size(); ++i)
      threads.emplace_back([&, i] {
        own[i] = answers(PluginHost(places));
        common[i] = answers(shared);
        static_cast<void>(shared.plugins());
      });
  }
  EXPECT_EQ(own[0][0], "loaded");
  EXPECT_THAT(own[0][3], HasSubstr("flush-to-zero"));
  for (const auto& each : own) EXPECT_EQ(each, own[0]);
  for (const auto& each : common) EXPECT_EQ(each, common[0]);
}

}  // namespace
