/// \file
/// Writes a zip archive.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "withy/results/output_file.hpp"

namespace withy::fmi {

/// An archive that appears under its name once it is complete. Same content, same bytes: entries have no times.
class ZipFile {
 public:
  /// \throws std::system_error where it cannot be written; so do the others. study::InputError where the name is that
  /// of a folder, a pipe or a device: an archive is not written from its beginning to its end.
  explicit ZipFile(std::filesystem::path file);
  ZipFile(const ZipFile&) = delete;
  ZipFile& operator=(const ZipFile&) = delete;
  ~ZipFile();
  void add(const std::string& name, std::string_view bytes);
  void finish();

 private:
  void expect(bool good) const;

  std::filesystem::path file_;
  Part part_;
  void* zip_ = nullptr;
};

}  // namespace withy::fmi
