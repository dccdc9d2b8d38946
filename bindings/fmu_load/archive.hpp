/// \file
/// FMUs as files: what of the archive a program needs, unpacked.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace withy::fmu_load {

/// An FMU cannot be used, or cannot go on: what() says why, in a clause.
class FmuError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The model description, the libraries for this platform and the resources of an FMU, in a temporary folder that is
/// removed with the object.
class Archive {
 public:
  /// \throws FmuError where the file is no FMU; std::system_error where there is no place to unpack it.
  explicit Archive(const std::filesystem::path& file);
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  ~Archive();

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// The text of modelDescription.xml.
  [[nodiscard]] const std::string& description() const { return description_; }
  /// Names of the folders in `binaries`: the platforms that it is for.
  [[nodiscard]] const std::vector<std::string>& platforms() const { return platforms_; }

 private:
  void unpack(const std::filesystem::path& file);

  std::filesystem::path folder_;
  std::string description_;
  std::vector<std::string> platforms_;
};

/// The folder of `binaries` for this machine, by the name that a version of the standard gives it.
const char* platform(int version);

}  // namespace withy::fmu_load
