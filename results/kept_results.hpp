/// \file
/// Parts of a study kept on disk, so that the same command continues where it was ended.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace withy {

/// Files `KEY.json` in a folder, each with the fingerprint of what it comes from and a checksum.
class KeptResults {
 public:
  /// \param folder made with the first result that is kept
  KeptResults(std::filesystem::path folder, std::string fingerprint);
  /// Whole or not at all. \throws std::system_error
  void keep(const std::string& key, const nlohmann::ordered_json& result) const;
  /// Nothing where none is kept, it comes from something else, or it is damaged.
  [[nodiscard]] std::optional<nlohmann::ordered_json> find(const std::string& key) const;

 private:
  std::filesystem::path folder_;
  std::string fingerprint_;
};

}  // namespace withy
