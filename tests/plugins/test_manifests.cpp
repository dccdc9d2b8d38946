// Manifests: what is malformed is refused with the reason, and nothing it names is touched.
#include <gmock/gmock.h>

#include "zoo_keeper.hpp"

namespace {

using testing::HasSubstr;
using withy::PluginHost;
using withy::PluginRecord;
using zoo_keeper::Scratch;

/// The reason with which a manifest of this text is refused.
std::string reason(const std::string& text) {
  const Scratch scratch;
  const auto file = scratch.write("bad.plugin", text);
  const auto records = PluginHost({scratch.path()}).plugins();
  if (records.size() != 1 || records.front().state != PluginRecord::State::refused) return "not refused";
  EXPECT_EQ(records.front().file, file);
  EXPECT_THAT(records.front().reason, HasSubstr("the manifest " + file.string() + " "));
  EXPECT_EQ(zoo_keeper::ask({scratch.path()}, "bad"), records.front().reason)
      << "asked for by its file's name, the manifest answers";
  return records.front().reason;
}

std::string manifest(const std::string& library, const std::string& entry, const std::string& provides) {
  return "[withy-plugin]\nlibrary = " + library + "\nentry = " + entry + "\nprovides = " + provides +
         "\nversion = 1.2\n";
}

TEST(Manifest, of_another_form_is_refused_with_the_line_or_the_key) {
  EXPECT_THAT(reason(""), HasSubstr("malformed: it does not consist of one section [withy-plugin]"));
  EXPECT_THAT(reason("\x7f"
                     "ELF\x02\x01"),
              HasSubstr("malformed: line 1: '=' character not found in line"));
  EXPECT_THAT(reason("[withy-plugin\n"), HasSubstr("malformed: line 1: unmatched '['"));
  EXPECT_THAT(reason("library = a.so\n"), HasSubstr("does not consist of one section"));
  EXPECT_THAT(reason(manifest("a.so", "withy_plugin_a", "body/a") + "[more]\na = 1\n"),
              HasSubstr("does not consist of one section"));
  EXPECT_THAT(reason(manifest("a.so", "withy_plugin_a", "body/a") + "autoload = yes\n"),
              HasSubstr("the key 'autoload' is unknown"));
  EXPECT_THAT(reason(manifest("a.so", "withy_plugin_a", "body/a") + "library = b.so\n"),
              HasSubstr("line 6: duplicate key name"));
  EXPECT_THAT(reason("[withy-plugin]\nlibrary = a.so\n"), HasSubstr("the key 'entry' is missing or empty"));
  EXPECT_THAT(reason(manifest("", "withy_plugin_a", "body/a")), HasSubstr("the key 'library' is missing or empty"));
  EXPECT_THAT(reason(std::string(100'000, '#')), HasSubstr("it is too long"));
}

TEST(Manifest, that_leads_out_of_its_directory_or_to_another_symbol_is_refused) {
  for (const char* library : {"../a.so", "/usr/lib/a.so", "sub/a.so", "..", "."}) {
    EXPECT_THAT(reason(manifest(library, "withy_plugin_a", "body/a")), HasSubstr("is not the plain name of a file"))
        << library;
  }
  for (const char* entry : {"main", "withy_plugin_", "withy_plugin_A", "withy_plugin_a b"}) {
    EXPECT_THAT(reason(manifest("a.so", entry, "body/a")), HasSubstr("is not a symbol withy_plugin_<name>")) << entry;
  }
}

TEST(Manifest, that_promises_what_cannot_be_is_refused) {
  const auto provides = [](const std::string& text) { return reason(manifest("a.so", "withy_plugin_a", text)); };
  EXPECT_THAT(provides("a"), HasSubstr("'a' under provides is not kind/id with a kind among body, hinge, mode-family, "
                                       "formulation, integrator, load, motion"));
  EXPECT_THAT(provides("wheel/a"), HasSubstr("'wheel/a' under provides is not kind/id"));
  EXPECT_THAT(provides("body/A"), HasSubstr("the id in 'body/A' under provides is not 1 to 64 of a-z, 0-9 and '-'"));
  EXPECT_THAT(provides("body/"), HasSubstr("the id in 'body/'"));
  EXPECT_THAT(provides("body/" + std::string(65, 'a')), HasSubstr("is not 1 to 64"));
  EXPECT_THAT(provides("body/a hinge/a body/a"), HasSubstr("'body/a' is twice under provides"));
}

TEST(Manifest, that_is_no_file_is_refused) {
  const Scratch scratch;
  std::filesystem::create_directory(scratch.path() / "folder.plugin");
  std::filesystem::create_symlink("nowhere", scratch.path() / "dangling.plugin");
  const auto records = PluginHost({scratch.path()}).plugins();
  ASSERT_EQ(records.size(), 2U);
  for (const auto& record : records) EXPECT_THAT(record.reason, HasSubstr(" cannot be read: "));
}

TEST(Manifest, naming_a_missing_file_a_text_or_a_truncated_library_is_refused_when_it_is_asked_for) {
  const Scratch scratch;
  scratch.write("missing.plugin", manifest("missing.so", "withy_plugin_a", "body/missing"));
  scratch.write("text.plugin", manifest("text.so", "withy_plugin_a", "body/text"));
  scratch.write("text.so", "not a library\n");
  scratch.write("short.plugin", manifest("short.so", "withy_plugin_a", "body/short"));
  scratch.write("short.so",
                "\x7f"
                "ELF");
  scratch.write("folder.plugin", manifest("folder.so", "withy_plugin_a", "body/folder"));
  std::filesystem::create_directory(scratch.path() / "folder.so");
  const auto say = [&](const std::string& id) { return zoo_keeper::ask({scratch.path()}, id); };
  const std::string place = scratch.path().string();
  EXPECT_EQ(say("missing"), "the plugin library " + place + "/missing.so cannot be read: No such file or directory");
  EXPECT_THAT(say("text"), HasSubstr(place + "/text.so cannot be loaded: " + place + "/text.so: file too short"));
  EXPECT_THAT(say("short"), HasSubstr(place + "/short.so cannot be loaded: "));
  EXPECT_THAT(say("folder"), HasSubstr(place + "/folder.so cannot be loaded: "));
}

}  // namespace
