#include "withy/results/hdf5_recorder.hpp"

#include <dlfcn.h>

#include <stdexcept>

#include "withy/results/hdf5/hdf5_library.hpp"

namespace withy {
namespace {

struct Library {
  decltype(&withy_hdf5_make_recorder) make = nullptr;
  decltype(&withy_hdf5_read) read = nullptr;
  std::string missing;  ///< why there is none
};

Library load() {
  Dl_info own{};
  if (::dladdr(reinterpret_cast<const void*>(&hdf5_missing), &own) == 0)
    return {nullptr, nullptr, "the place of the program's libraries is not known"};
  const auto file = std::filesystem::canonical(own.dli_fname).parent_path() / "libwithy-hdf5.so";
  if (!std::filesystem::exists(file))
    return {nullptr, nullptr, "this build is without HDF5; on Debian: apt install libhdf5-dev, then build again"};
  void* handle = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (handle == nullptr) return {nullptr, nullptr, std::string("HDF5 cannot be loaded: ") + ::dlerror()};
  Library library;
  library.make = reinterpret_cast<decltype(library.make)>(::dlsym(handle, "withy_hdf5_make_recorder"));
  library.read = reinterpret_cast<decltype(library.read)>(::dlsym(handle, "withy_hdf5_read"));
  if (library.make == nullptr || library.read == nullptr) library.missing = file.string() + " is of another version";
  return library;
}

const Library& library() {
  static const Library loaded = load();
  return loaded;
}

void need_library(const std::filesystem::path& path) {
  if (!library().missing.empty()) throw std::runtime_error(path.string() + ": " + library().missing);
}

}  // namespace

std::string hdf5_missing() { return library().missing; }

std::unique_ptr<Hdf5Recorder> make_hdf5_recorder(const std::filesystem::path& path) {
  need_library(path);
  return std::unique_ptr<Hdf5Recorder>(library().make(path));
}

void read_hdf5(const std::filesystem::path& path, Recorder& recorder) {
  need_library(path);
  library().read(path, recorder);
}

}  // namespace withy
