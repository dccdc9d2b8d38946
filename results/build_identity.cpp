#include "withy/results/build_identity.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "withy/results/git_description.hpp"
#include "withy/scene/sha256.hpp"

namespace withy {
namespace {

/// The build id among the notes of a loaded object, in hexadecimal digits; empty where it has none.
std::string build_id(const dl_phdr_info& object) {
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object.dlpi_phdr[i];
    if (segment.p_type != PT_NOTE) continue;
    const auto* at = reinterpret_cast<const unsigned char*>(object.dlpi_addr + segment.p_vaddr);
    const unsigned char* end = at + segment.p_memsz;
    while (end - at >= static_cast<std::ptrdiff_t>(sizeof(ElfW(Nhdr)))) {
      ElfW(Nhdr) note;
      std::memcpy(&note, at, sizeof note);
      const auto padded = [](std::size_t size) { return (size + 3) & ~std::size_t{3}; };
      const unsigned char* name = at + sizeof note;
      const unsigned char* id = name + padded(note.n_namesz);
      at = id + padded(note.n_descsz);
      if (at > end) break;
      if (note.n_type != NT_GNU_BUILD_ID || note.n_namesz != 4 || std::memcmp(name, "GNU", 4) != 0) continue;
      std::string digits;
      for (const unsigned char* byte = id; byte != id + note.n_descsz; ++byte) {
        digits += "0123456789abcdef"[*byte >> 4];
        digits += "0123456789abcdef"[*byte & 15];
      }
      return digits;
    }
  }
  return {};
}

/// Those of the moment: their names and headers stay as long as they are loaded.
std::vector<dl_phdr_info> loaded_objects() {
  std::vector<dl_phdr_info> all;
  ::dl_iterate_phdr(
      [](dl_phdr_info* object, std::size_t, void* to) {
        static_cast<std::vector<dl_phdr_info>*>(to)->push_back(*object);
        return 0;
      },
      &all);
  return all;
}

std::string hash_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return {};
  return sha256(std::string((std::istreambuf_iterator<char>(stream)), {}));
}

/// The libraries named libwithy-…, and what this function is in: all code of the project but plugins, and but the
/// writer of HDF5, which is loaded where it is asked for and where there is memory for it.
BuildIdentity identify() {
  std::string self;
  Dl_info here = {};
  if (::dladdr(reinterpret_cast<const void*>(&build_identity), &here) != 0 && here.dli_fname != nullptr)
    self = here.dli_fname;
  std::vector<std::string> ids;
  for (const dl_phdr_info& object : loaded_objects()) {
    const std::string file = object.dlpi_name;
    const std::string name = file.substr(file.rfind('/') + 1);
    const bool computes = name.starts_with("libwithy-") && !name.starts_with("libwithy-hdf5");
    // The program itself has no name there.
    if (!computes && file != self && !file.empty()) continue;
    const std::string id = build_id(object);
    ids.push_back(id.empty() ? hash_of(file.empty() ? "/proc/self/exe" : file) : id);
  }
  std::sort(ids.begin(), ids.end());
  std::string text;
  for (const std::string& id : ids) text += id + ' ';
  return {WITHY_VERSION, git_description, sha256(text)};
}

}  // namespace

const BuildIdentity& build_identity() {
  static const BuildIdentity identity = identify();
  return identity;
}

std::string library_identity(const std::string& file) {
  const std::vector<dl_phdr_info> objects = loaded_objects();
  const auto id = [&](const std::string& path) {
    const auto object = std::find_if(objects.begin(), objects.end(), [&](auto& o) { return o.dlpi_name == path; });
    return object == objects.end() ? std::string() : build_id(*object);
  };
  std::string found = id(file);
  if (!found.empty()) return found;
  std::error_code none;
  const std::string path = std::filesystem::canonical(file, none).string();
  if (none) return {};
  found = id(path);
  return found.empty() ? hash_of(path) : found;
}

}  // namespace withy
