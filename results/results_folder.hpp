/// \file
/// A folder of results: one process writes it at a time, and it never holds parts of two results.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/results/provenance.hpp"

namespace withy {

/// Another process writes the folder.
class FolderBusy : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How a folder is taken.
enum class FolderUse {
  begin,    ///< what the same result left before is removed; another result is refused
  replace,  ///< whatever result is there is removed
  go_on     ///< what is there stays
};

/// A folder taken for writing. `result.json` in it says what the folder holds, and is locked as long as this lives.
class ResultsFolder {
 public:
  /// Makes the folder where it is not there.
  /// \param content what the result consists of: names in the folder, and of this alone something is removed
  /// \throws FolderBusy; ResultsError where the folder holds another command's, scene's or values' result, or such
  /// names without saying whose they are, or a file `result.json` of another program, and `use` is `begin`;
  /// study::InputError where one of provenance.reads would be removed or replaced; std::system_error
  ResultsFolder(std::filesystem::path path, const std::string& command, const Provenance& provenance,
                const std::vector<std::string>& content, FolderUse use);
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// A name in the folder.
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// What the folder held before differs in from what it holds now, in words; empty where in nothing, or there was
  /// none.
  [[nodiscard]] const std::string& changed() const { return changed_; }

 private:
  void lock();
  void take(const std::string& command, const Provenance& provenance, const std::vector<std::string>& content,
            FolderUse use);
  void write(const std::string& text) const;

  std::filesystem::path path_;
  int file_ = -1;  ///< of result.json
  std::string changed_;
};

/// Who writes the folder now: "process 4711", or "another process" where its record does not say which; empty where
/// nobody does.
std::string writer_of(const std::filesystem::path& folder);

/// \throws FolderBusy where somebody writes the folder now.
void refuse_busy(const std::filesystem::path& folder);

/// What tells a folder's name from those of other settings: "" where there are none, "-loads.slew.time_scale=1.2", or
/// where that is no good name for a folder "-set-1a2b3c4d".
std::string folder_suffix(const std::vector<std::string>& settings);

}  // namespace withy
