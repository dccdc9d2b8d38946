#include "withy/bindings/fmu_load/archive.hpp"

#include <minizip/unzip.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <system_error>

namespace withy::fmu_load {
namespace {

namespace fs = std::filesystem;

using Zip = std::unique_ptr<void, int (*)(unzFile)>;

/// Of one FMU, unpacked: more is no model.
constexpr std::size_t most_bytes = std::size_t{1} << 30U;

std::string bytes_of_entry(unzFile zip, const std::string& name, std::size_t size) {
  std::string bytes(size, '\0');
  bool good = unzOpenCurrentFile(zip) == UNZ_OK;
  for (std::size_t at = 0; good && at < size;) {
    const auto piece = static_cast<unsigned>(std::min<std::size_t>(size - at, 1U << 24U));
    const int read = unzReadCurrentFile(zip, bytes.data() + at, piece);
    good = read > 0;
    at += good ? static_cast<std::size_t>(read) : 0;
  }
  if (!good || unzCloseCurrentFile(zip) != UNZ_OK) throw FmuError("'" + name + "' in it is damaged");
  return bytes;
}

/// Whether a name stays in the folder that it is unpacked to.
bool stays_inside(const fs::path& name) {
  return !name.empty() && name.is_relative() &&
         std::none_of(name.begin(), name.end(), [](const fs::path& part) { return part == ".."; });
}

bool of_this_platform(const std::string& folder) { return folder == platform(2) || folder == platform(3); }

void write(const fs::path& file, const std::string& bytes) {
  fs::create_directories(file.parent_path());
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  stream << bytes;
  stream.close();
  if (!stream) throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), file.string());
}

}  // namespace

const char* platform(int version) {
#if defined(__aarch64__)
  return version == 2 ? "linux-aarch64" : "aarch64-linux";
#else
  return version == 2 ? "linux64" : "x86_64-linux";
#endif
}

Archive::Archive(const fs::path& file) {
  std::string name = (fs::temp_directory_path() / "withy-fmu-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category(), name);
  folder_ = name;
  try {
    unpack(file);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    throw;
  }
}

Archive::~Archive() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void Archive::unpack(const fs::path& file) {
  const Zip zip(unzOpen64(file.c_str()), &unzClose);
  if (zip == nullptr) throw FmuError("is no archive, as FMUs are");
  std::size_t sum = 0;
  for (int at = unzGoToFirstFile(zip.get()); at == UNZ_OK; at = unzGoToNextFile(zip.get())) {
    char text[4096] = {};
    unz_file_info64 info{};
    if (unzGetCurrentFileInfo64(zip.get(), &info, text, sizeof text - 1, nullptr, 0, nullptr, 0) != UNZ_OK)
      throw FmuError("is a damaged archive");
    const std::string name = text;
    const fs::path path(name);
    if (!stays_inside(path)) throw FmuError("has an entry '" + name + "', which is no place inside it");
    const auto first = path.begin()->string();
    const bool library = first == "binaries" && std::next(path.begin()) != path.end();
    if (library) {
      const std::string folder = std::next(path.begin())->string();
      if (!folder.empty() && std::find(platforms_.begin(), platforms_.end(), folder) == platforms_.end())
        platforms_.push_back(folder);
      if (!of_this_platform(folder)) continue;
    } else if (first != "resources" && name != "modelDescription.xml") {
      continue;
    }
    if (name.ends_with('/')) continue;
    sum += static_cast<std::size_t>(std::min<ZPOS64_T>(info.uncompressed_size, most_bytes));
    if (sum > most_bytes) throw FmuError("unpacks to more than 1 GiB");
    const std::string bytes = bytes_of_entry(zip.get(), name, static_cast<std::size_t>(info.uncompressed_size));
    if (name == "modelDescription.xml")
      description_ = bytes;
    else
      write(folder_ / path, bytes);
  }
  fs::create_directories(folder_ / "resources");
  if (description_.empty()) throw FmuError("has no modelDescription.xml");
}

}  // namespace withy::fmu_load
