/// \file
/// Every input of the corpora, and changed ones: an answer, never a crash or an exception that nobody documents.
/// WITHY_FUZZ_SECONDS: so long for each target, beyond the corpora.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <vector>

#include "withy/tests/fuzz/targets.hpp"

namespace withy::fuzz {
namespace {

/// Its own files, and those of scenes/ that are of its kind.
std::vector<std::string> corpus(const std::string& target) {
  namespace fs = std::filesystem;
  const std::map<std::string, std::string> shipped = {
      {"scene", "scenes"}, {"sid", "scenes"}, {"deck", "scenes/meshes"}, {"csv", "scenes/measured"}};
  const std::map<std::string, std::string> endings = {
      {"scene", ".yaml"}, {"sid", ".SID_FEM"}, {"deck", ".inp"}, {"csv", ".csv"}};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(WITHY_SOURCES) / "tests/fuzz/corpus" / target))
    files.push_back(entry.path());
  if (const auto at = shipped.find(target); at != shipped.end())
    for (const auto& entry : fs::directory_iterator(fs::path(WITHY_SOURCES) / at->second))
      if (entry.path().extension() == endings.at(target)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<std::string> all;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    all.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return all;
}

/// Cuts, copies, flips, and takes parts of other inputs.
class Changes {
 public:
  explicit Changes(const std::vector<std::string>& corpus) : corpus_(corpus) {}
  std::string next() {
    std::string text = corpus_[below(corpus_.size())];
    for (std::size_t left = 1 + below(4); left > 0; --left) change(text);
    return text;
  }

 private:
  void change(std::string& text) {
    static const char* const parts[] = {"[",  "{", ": ", ",",        "\n", "1e999", "-1", "nan", "99999999999999999999",
                                        "\"", "*", "m0", "\x9b\xff", "<",  "\xff",  "0"};
    const std::size_t at = below(text.size() + 1), length = std::min(1 + below(40), text.size() - at);
    const std::string& other = corpus_[below(corpus_.size())];
    switch (below(7)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(text[at] ^ static_cast<char>(1U << below(8)));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(below(text.size() + 1), text.substr(at, length));
        break;
      case 3:
        text.insert(at, parts[below(std::size(parts))]);
        break;
      case 4:
        text.resize(at);
        break;
      case 5:
        text.insert(at, other.substr(below(other.size() + 1), 1 + below(200)));
        break;
      default:
        if (length > 0) text[at] = static_cast<char>(below(256));
    }
  }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

  const std::vector<std::string>& corpus_;
  std::mt19937_64 random_{1};
};

class Fuzz : public testing::TestWithParam<std::string> {};

TEST_P(Fuzz, AnswersWhateverItIsGiven) {
  const Target target = targets().at(GetParam());
  const std::vector<std::string> inputs = corpus(GetParam());
  ASSERT_FALSE(inputs.empty()) << "a target without a corpus";
  for (const std::string& input : inputs) ASSERT_NO_THROW(target(input));
  using Clock = std::chrono::steady_clock;
  const char* asked = std::getenv("WITHY_FUZZ_SECONDS");
  const auto end = Clock::now() + std::chrono::duration<double>(asked != nullptr ? std::atof(asked) : 0);
  Changes changes(inputs);
  std::size_t done = 0;
  for (; asked != nullptr ? Clock::now() < end : done < 300; ++done) {
    const std::string input = changes.next();
    std::ofstream(std::filesystem::temp_directory_path() / ("withy-fuzz-last-" + GetParam()), std::ios::binary)
        << input;
    ASSERT_NO_THROW(target(input)) << input.substr(0, 2000);
  }
  RecordProperty("executions", static_cast<int>(done));
  if (asked != nullptr) std::printf("%s: %zu executions\n", GetParam().c_str(), done);
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const auto& [name, target] : targets()) all.push_back(name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, testing::ValuesIn(names()), [](const auto& test) { return test.param; });

}  // namespace
}  // namespace withy::fuzz
