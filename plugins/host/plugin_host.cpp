#include "withy/plugins/host/plugin_host.hpp"

#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <mutex>

#include "withy/plugins/host/library.hpp"
#include "withy/plugins/host/manifest.hpp"
#include "withy/plugins/host/trust.hpp"

namespace withy {
namespace fs = std::filesystem;

/// The manifests of all directories and what has become of their libraries.
class PluginHost::Catalogue {
 public:
  explicit Catalogue(const std::vector<fs::path>& directories) {
    for (const fs::path& directory : directories) add_directory(directory);
    refuse_duplicates();
  }

  bool load(Registry& registry, std::string_view kind, std::string_view id);
  std::vector<std::string> ids(std::string_view kind) const;
  std::vector<PluginRecord> records() const;
  std::map<std::string, std::string> versions() const;

 private:
  struct Library {
    fs::path file;  ///< the manifest, or a directory that cannot be read
    Manifest manifest;
    std::string refusal;  ///< empty where it is not refused
    bool loaded = false;
    std::map<std::string, std::string> summaries;

    bool provides(const std::string& name) const {
      return std::binary_search(manifest.provides.begin(), manifest.provides.end(), name);
    }
    fs::path library() const { return file.parent_path() / manifest.library; }
  };

  void add_directory(const fs::path& given);
  void add_manifest(const fs::directory_entry& entry, const std::string& exposed_directory);
  void refuse_duplicates();
  void load(Registry& registry, Library& library);

  mutable std::mutex mutex_;           ///< guards what loading changes: refusal, loaded and summaries of a library
  std::vector<fs::path> directories_;  ///< canonical
  std::vector<Library> libraries_;
};

void PluginHost::Catalogue::add_directory(const fs::path& given) {
  const auto refuse = [&](const std::string& why) {
    Library entry;
    entry.file = given;
    entry.refusal = "the plugin directory " + given.string() + " cannot be read: " + why;
    libraries_.push_back(std::move(entry));
  };
  try {
    const fs::path directory = fs::canonical(given);
    if (!fs::is_directory(directory)) return refuse("it is not a directory");
    if (std::find(directories_.begin(), directories_.end(), directory) != directories_.end()) return;
    directories_.push_back(directory);
    const std::string exposed = exposure(directory);
    std::vector<fs::directory_entry> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
      if (entry.path().native().ends_with(".plugin")) files.push_back(entry);
    }
    std::sort(files.begin(), files.end());
    for (const fs::directory_entry& file : files) add_manifest(file, exposed);
  } catch (const fs::filesystem_error& e) {
    refuse(e.code().message());
  }
}

void PluginHost::Catalogue::add_manifest(const fs::directory_entry& entry, const std::string& exposed_directory) {
  const fs::path& file = entry.path();
  Library library;
  library.file = file;
  try {
    library.manifest = read_manifest(file);
    std::string exposed = exposed_directory;
    // The directory is canonical: a file in it that is no link has no other directories above it.
    if (exposed.empty())
      exposed = entry.is_symlink() ? exposure(fs::canonical(file)) : exposure_in_safe_directory(file);
    if (!exposed.empty()) library.refusal = "the plugin " + file.string() + " is refused: " + exposed;
  } catch (const PluginError& e) {
    library.refusal = e.what();
  }
  libraries_.push_back(std::move(library));
}

void PluginHost::Catalogue::refuse_duplicates() {
  std::map<std::string, std::vector<Library*>> providers;
  for (Library& library : libraries_) {
    if (!library.refusal.empty()) continue;
    for (const std::string& name : library.manifest.provides) providers[name].push_back(&library);
  }
  for (const auto& [name, libraries] : providers) {
    if (libraries.size() < 2) continue;
    std::string files;
    for (const Library* library : libraries) files += (files.empty() ? "" : " and ") + library->library().string();
    for (Library* library : libraries) library->refusal = "the plugin '" + name + "' is in two places: " + files;
  }
}

bool PluginHost::Catalogue::load(Registry& registry, std::string_view kind, std::string_view id) {
  const std::lock_guard lock(mutex_);
  const std::string name = std::string(kind) + "/" + std::string(id);
  const Library* refused = nullptr;
  for (Library& library : libraries_) {
    if (library.provides(name)) {
      if (library.refusal.empty()) {
        load(registry, library);
        return true;
      }
      refused = &library;
    } else if (!library.refusal.empty() && library.manifest.provides.empty() && library.file.stem() == id &&
               refused == nullptr) {
      refused = &library;  // its manifest cannot be read, but by its name it would be the one
    }
  }
  if (refused != nullptr) throw PluginError(refused->refusal);
  return false;
}

void PluginHost::Catalogue::load(Registry& registry, Library& library) {
  try {
    Enrollment enrollment = load_library(library.file.parent_path(), library.manifest);
    auto summaries = enrollment.summaries();
    registry.admit(std::move(enrollment), library.library().string());
    library.summaries = std::move(summaries);
    library.loaded = true;
  } catch (const PluginError& e) {
    library.refusal = e.what();
    throw;
  } catch (const std::invalid_argument& e) {
    library.refusal = std::string(e.what());
    throw PluginError(library.refusal);
  }
}

std::vector<std::string> PluginHost::Catalogue::ids(std::string_view kind) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> ids;
  const std::string prefix = std::string(kind) + "/";
  for (const Library& library : libraries_) {
    if (!library.refusal.empty()) continue;
    for (const std::string& name : library.manifest.provides) {
      if (name.starts_with(prefix)) ids.push_back(name.substr(prefix.size()));
    }
  }
  return ids;
}

std::vector<PluginRecord> PluginHost::Catalogue::records() const {
  const std::lock_guard lock(mutex_);
  std::vector<PluginRecord> records;
  std::size_t count = 0;
  for (const Library& library : libraries_) count += std::max<std::size_t>(1, library.manifest.provides.size());
  records.reserve(count);
  for (const Library& library : libraries_) {
    PluginRecord record;
    record.file = library.file;
    record.version = library.manifest.version;
    record.reason = library.refusal;
    if (!library.refusal.empty()) {
      record.state = PluginRecord::State::refused;
    } else if (library.loaded) {
      record.state = PluginRecord::State::loaded;
    }
    if (library.manifest.provides.empty()) {
      records.push_back(std::move(record));
      continue;
    }
    record.file = library.library();
    for (const std::string& name : library.manifest.provides) {
      record.kind = name.substr(0, name.find('/'));
      record.id = name.substr(record.kind.size() + 1);
      const auto summary = library.summaries.find(name);
      record.summary = summary == library.summaries.end() ? "" : summary->second;
      records.push_back(record);
    }
  }
  std::stable_sort(records.begin(), records.end(), [](const PluginRecord& a, const PluginRecord& b) {
    return std::tie(a.kind, a.id) < std::tie(b.kind, b.id);
  });
  return records;
}

std::map<std::string, std::string> PluginHost::Catalogue::versions() const {
  std::map<std::string, std::string> versions;
  for (const Library& library : libraries_)
    if (!library.manifest.provides.empty()) versions[library.library().string()] = library.manifest.version;
  return versions;
}

PluginHost::PluginHost(const std::vector<fs::path>& directories)
    : catalogue_(std::make_shared<Catalogue>(directories)) {}

fs::path PluginHost::default_directory() {
  const fs::path library = fs::canonical(boost::dll::this_line_location()).parent_path();
  const fs::path installed = (library / WITHY_PLUGINS_FROM_LIBRARY).lexically_normal();
  return fs::is_directory(installed) ? installed : library / "withy" / "plugins";  // the build tree has one lib
}

void PluginHost::attach(Registry& registry) const {
  registry.set_loader([catalogue = catalogue_](Registry& asking, std::string_view kind,
                                               std::string_view id) { return catalogue->load(asking, kind, id); },
                      [catalogue = catalogue_](std::string_view kind) { return catalogue->ids(kind); });
}

std::vector<PluginRecord> PluginHost::plugins() const { return catalogue_->records(); }

std::map<std::string, std::string> PluginHost::versions() const { return catalogue_->versions(); }

}  // namespace withy
