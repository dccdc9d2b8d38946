#include "withy/scene/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <string>
#include <system_error>
#include <vector>

#include "withy/scene/one_line.hpp"

namespace withy {
namespace {

struct Read {
  Document document;
  Diagnostics diagnostics;
  bool good;
  explicit Read(std::string_view text) : good(read_document(text, {}, document, diagnostics)) {}
  const Value& operator[](const char* key) const { return document.root.at(key); }
};

TEST(Documents, GiveScalarsTheKindTheyAreWrittenAs) {
  const Read r(
      "number: 1e3\ntext: one\nquoted: '1e3'\nyes_: yes\ntrue_: true\nnull_: null\nnothing:\ntilde: ~\noctal: 010\n"
      "clock: 1:30\nhex: 0x10\nnan: .nan\ninfinity: -.inf\nunit: 25 mm\n");
  ASSERT_TRUE(r.good && r.diagnostics.ok());
  EXPECT_EQ(r["number"].number(), 1000);
  for (const char* key : {"text", "quoted", "yes_", "octal", "clock", "hex", "unit"}) {
    EXPECT_EQ(r[key].kind(), Value::Kind::text) << key;
  }
  EXPECT_EQ(r["true_"].kind(), Value::Kind::boolean);
  for (const char* key : {"null_", "nothing", "tilde"}) EXPECT_EQ(r[key].kind(), Value::Kind::null) << key;
  EXPECT_TRUE(std::isnan(r["nan"].number()));
  EXPECT_EQ(r["infinity"].number(), -INFINITY);
}

/// JSON has them in pairs of escapes, as many programs write all that is not ASCII. Places are those of the file.
TEST(Documents, CharactersBeyondTheFirstPlaneAreReadFromJson) {
  const Read r(
      "{\"name\": \"a\\ud83d\\ude00b\", \"\\uD835\\uDD38\": \"\\\\ud83d\\\\ude00\",\n \"x\": \"\\u00e9\", \"last\": "
      "1}");
  ASSERT_TRUE(r.good && r.diagnostics.ok());
  EXPECT_EQ(r["name"].text(), "a\U0001F600b");
  EXPECT_EQ(r["\U0001D538"].text(), "\\ud83d\\ude00") << "an escaped backslash";
  EXPECT_EQ(r["\U0001D538"].place().column, 44);
  EXPECT_EQ(r["x"].place().column, 7);
  const Read twice("{\"a\": \"\\ud83d\\ude00\", \"a\": 1}");
  ASSERT_FALSE(twice.diagnostics.ok());
  EXPECT_EQ(twice.diagnostics.errors()[0].place.column, 23);
  const Read alone("{\"a\": \"\\ud83d\"}");
  EXPECT_FALSE(alone.good);
}

TEST(Documents, GiveBackWhatIsWrittenInOneLine) {
  const std::vector<std::string> texts = {
      "arm",   "two words", "25 mm",       "-1 rpm", "a, b", "key: x", "{x}",  "[1]",   "#c",
      "a #b",  "true",      "null",        "~",      "1e3",  "-2.5",   "",     " lead", "trail ",
      "it's",  "q\"uote",   "back\\slash", "- item", "--",   "-",      "*x",   "&x",    "!x",
      "%x",    "@x",        "`x",          "? x",    "a:",   "=",      ".nan", "é 1",   "two\nlines",
      "C:\\x", "a|b",       ">",           "yes",    "1:30", "0x10"};
  std::vector<Value> items;
  for (const std::string& text : texts) items.emplace_back(text);
  const Value value = Value::map({{"texts", Value::list(items)},
                                  {"number", Value(0.1)},
                                  {"inner", Value::map({{"on", Value(true)}, {"nothing", Value()}})}});
  const Read r(in_one_line(value));
  ASSERT_TRUE(r.good && r.diagnostics.ok()) << in_one_line(value);
  ASSERT_EQ(r["texts"].items().size(), texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    ASSERT_EQ(r["texts"].items()[i].kind(), Value::Kind::text) << texts[i];
    EXPECT_EQ(r["texts"].items()[i].text(), texts[i]);
  }
  EXPECT_EQ(r["number"].number(), 0.1);
  EXPECT_TRUE(r["inner"].at("on").boolean());
  EXPECT_EQ(r["inner"].at("nothing").kind(), Value::Kind::null);
  EXPECT_EQ(in_one_line(Value(std::string("25 mm"))), "25 mm") << "no quotes without need";
}

TEST(Documents, GiveEveryValueItsPlace) {
  const Read r("a:\n  b: [1,\n      {c: 2}]\n");
  const Value& c = r["a"].at("b").items()[1].at("c");
  EXPECT_EQ(c.place().line, 3);
  EXPECT_EQ(c.place().column, 11);
  EXPECT_EQ(c.place().path, "/a/b/1/c");
  EXPECT_EQ(r.document.key_place("/a/b").line, 2);
  EXPECT_EQ(r.document.key_place("/a/b").column, 3);
  EXPECT_EQ(r.document.key_place("/a/absent").line, 1);
}

TEST(Documents, OfJsonReadAsThoseOfYaml) {
  const Read r("{\n\t\"a\": [1, -2.5e-3, \"text \\u00e9 \\/ \\n\", true, null],\n\t\"b\": {}\n}\n");
  ASSERT_TRUE(r.good && r.diagnostics.ok()) << r.diagnostics.errors()[0].message;
  const std::vector<Value>& a = r["a"].items();
  EXPECT_EQ(a[1].number(), -2.5e-3);
  EXPECT_EQ(a[2].text(), "text \u00e9 / \n");
  EXPECT_TRUE(a[3].boolean());
  EXPECT_EQ(a[4].kind(), Value::Kind::null);
  EXPECT_TRUE(r["b"].members().empty());
}

TEST(Documents, ReadNumbersToTheLastBit) {
  const Read r("a: [0.1, 1.7976931348623157e308, 2.2250738585072011e-308, 0.30000000000000004]\n");
  EXPECT_EQ(r["a"].numbers(), (std::vector<double>{0.1, 1.7976931348623157e308, 2.2250738585072011e-308, 0.1 + 0.2}));
}

TEST(Documents, MayBeginWithAByteOrderMarkAndEndLinesAsOnWindows) {
  const Read r(
      "\xEF\xBB\xBF"
      "a: 1\r\nb: \"x\"\r\n");
  ASSERT_TRUE(r.good && r.diagnostics.ok());
  EXPECT_EQ(r["a"].number(), 1);
  EXPECT_EQ(r["b"].text(), "x");
}

TEST(Documents, KnowAnOpenQuoteFromAClosedOne) {
  EXPECT_TRUE(Read("a: 'it''s'\nb: \"say \\\"so\\\"\"\nc: it's\n").good);
  for (const char* text : {"a: 'open", "a: 'open''", "a: \"open", "a: \"open\\\"", "a: [1, \"open]\n"}) {
    EXPECT_FALSE(Read(text).good) << text;
  }
}

TEST(Documents, ThatAreNotTextAreRefusedWhereTheyAreNot) {
  // Overlong, surrogate, beyond U+10FFFF, truncated, stray continuation: RFC 3629 section 3.
  for (const char* bytes :
       {"\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xE2\x82", "\x80", "\xFF\xFE", "\x7F", "\x1B"}) {
    const Read r("a: 1\nb: x" + std::string(bytes));
    EXPECT_FALSE(r.good);
    ASSERT_EQ(r.diagnostics.errors().size(), 1u);
    EXPECT_EQ(r.diagnostics.errors()[0].place.line, 2);
    EXPECT_EQ(r.diagnostics.errors()[0].place.column, 5);
  }
  EXPECT_FALSE(Read(std::string_view("a: \0", 4)).good);
}

TEST(Documents, BoundTheirKeys) {
  const Read r("a: {" + std::string(300, 'k') + ": 1}");
  EXPECT_FALSE(r.good);
  EXPECT_EQ(r.diagnostics.errors()[0].message, "key of 300 bytes; need at most 256");
}

TEST(Documents, RefuseAliasesBeforeTheyMultiply) {
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 30; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 8; ++k) bomb += ", " + before;
    bomb += "]\n";
  }
  const Read r(bomb);
  EXPECT_FALSE(r.good);
  EXPECT_THAT(r.diagnostics.errors()[1].message, testing::HasSubstr("not allowed"));
}

TEST(Documents, RefuseTheCharacterNul) {
  const Read r("file: \"a.SID_FEM\\0.txt\"\n");
  EXPECT_FALSE(r.good);
  ASSERT_EQ(r.diagnostics.errors().size(), 1U);
  EXPECT_EQ(r.diagnostics.errors()[0].message, "the text holds the character NUL");
  EXPECT_EQ(r.diagnostics.errors()[0].place.path, "/file");
}

TEST(Bytes, AreReadFromFilesAndPipesUpToTheLimit) {
  EXPECT_THROW(read_bytes("/dev/zero"), std::system_error);
  EXPECT_THROW(read_bytes("/nowhere"), std::system_error);
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "name: x", 7), 7);
  ::close(ends[1]);
  EXPECT_EQ(read_bytes("/proc/self/fd/" + std::to_string(ends[0])), "name: x");
  ::close(ends[0]);
}

}  // namespace
}  // namespace withy
