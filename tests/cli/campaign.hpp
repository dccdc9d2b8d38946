/// \file
/// Measurements on numbered random scenes that take long: they are made in parts, and what is found is kept.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace withy::test {

/// Which seeds: WITHY_TEST_SEEDS=N is 1 to N, not given: 1 to `usual`; WITHY_TEST_AFTER=K begins after K.
/// WITHY_TEST_FILE=F keeps a line of JSON a seed in F; seeds that are there are not measured again. Remove F when the
/// program has changed.
class Campaign {
 public:
  /// \param name what a line of the file belongs to
  Campaign(std::string name, unsigned usual, unsigned most = 1'000'000) : name_(std::move(name)) {
    const char* const wanted = std::getenv("WITHY_TEST_SEEDS");
    seeds_ = wanted != nullptr ? static_cast<unsigned>(std::atoi(wanted)) : usual;
    seeds_ = std::min(seeds_, most);
    const char* const after = std::getenv("WITHY_TEST_AFTER");
    after_ = after != nullptr ? static_cast<unsigned>(std::atoi(after)) : 0;
    const char* const file = std::getenv("WITHY_TEST_FILE");
    file_ = file != nullptr ? file : "";
    std::ifstream in(file_);
    for (std::string line; !file_.empty() && std::getline(in, line);) {
      const auto j = nlohmann::json::parse(line, nullptr, false);  // the last line may be half
      if (!j.is_discarded() && j.value("campaign", "") == name_) known_[j.at("seed").get<unsigned>()] = j;
    }
    folder_ = std::filesystem::temp_directory_path() / ("withy-campaign-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~Campaign() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Campaign(const Campaign&) = delete;
  Campaign& operator=(const Campaign&) = delete;

  [[nodiscard]] unsigned seeds() const { return seeds_; }
  /// The seed before the first.
  [[nodiscard]] unsigned after() const { return after_; }
  /// What was found for each seed, in their order. `measure` gets the seed and a file for its scene.
  template <class Finding>
  std::vector<Finding> run(const std::function<Finding(unsigned, const std::string& scene)>& measure) const {
    std::vector<Finding> all;
    for (unsigned seed = after_ + 1; seed <= after_ + seeds_; ++seed) {
      const auto known = known_.find(seed);
      if (known != known_.end()) {
        all.push_back(known->second.template get<Finding>());
        continue;
      }
      all.push_back(measure(seed, (folder_ / "scene.yaml").string()));
      nlohmann::json j = all.back();
      j["seed"] = seed;
      j["campaign"] = name_;
      if (!file_.empty()) std::ofstream(file_, std::ios::app) << j.dump() << std::endl;
      std::printf("%s\n", j.dump().c_str());
      std::fflush(stdout);
    }
    return all;
  }

 private:
  std::string name_;
  unsigned seeds_ = 0, after_ = 0;
  std::string file_;
  std::map<unsigned, nlohmann::json> known_;
  std::filesystem::path folder_;
};

}  // namespace withy::test
