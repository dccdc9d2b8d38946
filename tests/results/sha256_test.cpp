/// \file
/// SHA-256 against the examples of its standard and against itself.
#include "withy/scene/sha256.hpp"

#include <gtest/gtest.h>

namespace withy {
namespace {

TEST(Sha256, GivesTheDigestsOfTheStandardsExamples) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(
      sha256("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrs"
             "tnopqrstu"),
      "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Lengths on both sides of where padding takes another block, in pieces of every size.
TEST(Sha256, DoesNotDependOnThePieces) {
  std::string text;
  for (int i = 0; i < 200; ++i) text += static_cast<char>(i);
  for (const std::size_t length : {1U, 55U, 56U, 63U, 64U, 65U, 119U, 120U, 128U, 200U}) {
    const std::string_view whole = std::string_view(text).substr(0, length);
    for (std::size_t piece = 1; piece <= length; ++piece) {
      Sha256 hash;
      for (std::size_t i = 0; i < length; i += piece) hash.add(whole.substr(i, piece));
      ASSERT_EQ(hash.digest(), sha256(whole)) << length << " in pieces of " << piece;
      ASSERT_EQ(hash.digest(), sha256(whole)) << "a digest changes nothing";
    }
  }
}

}  // namespace
}  // namespace withy
