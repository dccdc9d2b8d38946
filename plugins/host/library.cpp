#include "withy/plugins/host/library.hpp"

#include <link.h>

#include <algorithm>
#include <boost/dll/shared_library.hpp>
#include <cstring>
#include <deque>
#include <fstream>
#include <map>
#include <mutex>
#include <vector>

#include "withy/core/plugin/entry.hpp"
#include "withy/core/plugin/floating_point.hpp"
#include "withy/plugins/host/trust.hpp"

namespace withy {
namespace {

/// What the loader of the system says, without what Boost wraps around it.
std::string loader_message(const std::exception& e) {
  const std::string text = e.what();
  const std::string before = "(dlerror system message: ";
  const std::size_t start = text.find(before);
  const std::size_t end = text.rfind(')');
  if (start == std::string::npos || end == std::string::npos || end < start) return text;
  return text.substr(start + before.size(), end - start - before.size());
}

/// What the process has loaded. Never destroyed, so that no library is unloaded, not even at exit: objects made by
/// plugins may outlive any order.
struct Loaded {
  std::mutex mutex;  ///< of loading: hosts of several threads share what follows
  std::deque<boost::dll::shared_library> libraries;
  /// A library does its harm when it is first loaded; that it did is remembered, since it stays loaded.
  std::map<std::filesystem::path, std::string> harmful;
};

Loaded& loaded() {
  static auto& all = *new Loaded;
  return all;
}

/// The dynamic linker maps what the program headers say, and the first access beyond the file's end is a SIGBUS: a file
/// that was cut short, as by a copy that failed, is found before. What is no ELF file of this machine is left to it.
bool is_cut_short(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  ElfW(Ehdr) head = {};
  if (!in.read(reinterpret_cast<char*>(&head), sizeof head)) return false;
  if (std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0 || head.e_phentsize != sizeof(ElfW(Phdr))) return false;
  const std::uintmax_t size = std::filesystem::file_size(file);
  in.seekg(static_cast<std::streamoff>(head.e_phoff));
  for (int i = 0; i < head.e_phnum; ++i) {
    ElfW(Phdr) part = {};
    if (!in.read(reinterpret_cast<char*>(&part), sizeof part)) return true;
    if (part.p_type == PT_LOAD && (part.p_offset > size || part.p_filesz > size - part.p_offset)) return true;
  }
  return false;
}

const boost::dll::shared_library& open(const std::filesystem::path& file) {
  using boost::dll::load_mode::type;
  boost::dll::shared_library library;
  library.load(file, static_cast<type>(boost::dll::load_mode::rtld_now | boost::dll::load_mode::rtld_local));
  return loaded().libraries.emplace_back(std::move(library));
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

void check_promise(const Enrollment& enrollment, const Manifest& manifest, const std::string& file) {
  std::vector<std::string> enrolled;
  for (const auto& [name, summary] : enrollment.summaries()) {
    if (!is_plugin_id(name.substr(name.find('/') + 1))) {
      throw PluginError(file + " enrolls '" + name + "', whose id is not 1 to 64 of a-z, 0-9 and '-'");
    }
    enrolled.push_back(name);
  }
  std::vector<std::string> missing;
  std::vector<std::string> excess;
  std::set_difference(manifest.provides.begin(), manifest.provides.end(), enrolled.begin(), enrolled.end(),
                      std::back_inserter(missing));
  std::set_difference(enrolled.begin(), enrolled.end(), manifest.provides.begin(), manifest.provides.end(),
                      std::back_inserter(excess));
  if (!missing.empty()) throw PluginError(file + " does not enroll " + list(missing) + ", which its manifest promises");
  if (!excess.empty()) throw PluginError(file + " enrolls " + list(excess) + ", which its manifest does not promise");
}

}  // namespace

Enrollment load_library(const std::filesystem::path& directory, const Manifest& manifest) {
  const std::string named = (directory / manifest.library).string();
  std::filesystem::path file;
  std::string exposed;
  try {
    const bool elsewhere = std::filesystem::is_symlink(named);
    file = elsewhere ? std::filesystem::canonical(named) : std::filesystem::path(named);
    exposed = elsewhere ? exposure(file) : exposure_in_safe_directory(file);
    if (!std::filesystem::is_regular_file(file))
      throw PluginError("the plugin library " + named + " cannot be loaded: it is no file");
    if (is_cut_short(file)) throw PluginError("the plugin library " + named + " cannot be loaded: it is cut short");
  } catch (const std::filesystem::filesystem_error& e) {
    throw PluginError("the plugin library " + named + " cannot be read: " + e.code().message());
  }
  if (!exposed.empty()) throw PluginError("the plugin library " + named + " is refused: " + exposed);

  const std::lock_guard lock(loaded().mutex);
  FloatingPointGuard guard;
  const auto check_floating_point = [&] {
    auto& harmful = loaded().harmful;
    if (const std::string changed = guard.restore(); !changed.empty()) harmful.emplace(file, changed);
    if (const auto it = harmful.find(file); it != harmful.end()) {
      throw PluginError("the plugin library " + named + " is refused: it changes " + it->second +
                        " for the whole program (as linking with -ffast-math does)");
    }
  };
  try {
    const boost::dll::shared_library& library = open(file);
    check_floating_point();
    const auto& descriptor = library.get<const PluginDescriptor>(manifest.entry);
    Enrollment enrollment = enroll_from(descriptor, named);
    check_floating_point();
    check_promise(enrollment, manifest, named);
    return enrollment;
  } catch (const std::system_error& e) {
    throw PluginError("the plugin library " + named + " cannot be loaded: " + loader_message(e));
  }
}

}  // namespace withy
