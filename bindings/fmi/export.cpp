#include "withy/bindings/fmi/export.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "withy/bindings/fmi/documentation.hpp"
#include "withy/bindings/fmi/model_exchange.hpp"
#include "withy/bindings/fmi/resources.hpp"
#include "withy/bindings/fmi/zip_file.hpp"
#include "withy/plugins/host/plugin_host.hpp"
#include "withy/results/output_name.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/sha256.hpp"
#include "withy/scene/visual.hpp"
#include "withy/study/input_error.hpp"

namespace withy::fmi {
namespace {

namespace fs = std::filesystem;

/// The folder with the library and what it brings.
fs::path library_folder() {
  const fs::path folder = PluginHost::default_directory().parent_path() / "fmu";
  if (!fs::exists(folder / "fmu.so"))
    throw PluginError((folder / "fmu.so").string() +
                      ": the library for FMUs is not there; build or install all of withy");
  return folder;
}

/// Name of a library: letters, digits and '_' of the file's name, not a digit first.
std::string identifier_of(const fs::path& out) {
  std::string name = out.stem().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c >= 128 || std::isalnum(c) == 0; }, '_');
  return name.empty() || std::isdigit(static_cast<unsigned char>(name.front())) != 0 ? "fmu_" + name : name;
}

/// The library in an FMU has withy's own plugins alone.
void check_plugins(const study::Prepared& prepared) {
  const fs::path own = PluginHost::default_directory();
  for (const PluginUsed& plugin : prepared.scene.sources.plugins) {
    if (plugin.kind == "load" && plugin.id == "fmu")
      throw study::InputError(prepared.scene.file +
                              ": a load of type 'fmu': an FMU does not carry another one; connect the two in the "
                              "program that imports them");
    std::error_code ignored;
    if (plugin.file == "built in" || fs::equivalent(fs::path(plugin.file).parent_path(), own, ignored)) continue;
    throw study::InputError(prepared.scene.file + ": " + plugin.kind + " '" + plugin.id + "' is of " + plugin.file +
                            ", which is none of withy's own plugins; an FMU has those alone");
  }
}

/// A file that the scene names by `path`, into a folder of the archive; \return its bytes
/// \param carried names of those that are there, which the scene may name twice
std::string add_named(ZipFile& zip, const std::string& folder, const Scene& scene, const std::string& path,
                      std::set<std::string>& carried) {
  const fs::path name = fs::path(path).lexically_normal();
  if (name.is_absolute() || (name.begin() != name.end() && *name.begin() == ".."))
    throw study::InputError(scene.file + ": file '" + path +
                            "' is not beside or below the scene; an FMU carries files by names relative to it");
  std::string bytes = read_bytes((fs::path(scene.folder_now()) / name).string());
  if (carried.insert(name.generic_string()).second) zip.add(folder + name.generic_string(), bytes);
  return bytes;
}

void add_scene(ZipFile& zip, const study::Prepared& prepared, const SceneOptions& options) {
  const fs::path file = prepared.scene.file;
  const std::string folder = std::string("resources/") + scene_folder + '/';
  SceneOptions asked = options;
  asked.overrides = prepared.scene.settings;  // outputs that were asked for, too
  zip.add(std::string("resources/") + recipe_file, write_recipe(file.filename().string(), asked));
  zip.add(folder + file.filename().string(), prepared.values.text());
  std::set<std::string> carried{file.filename().string()};
  for (const FileUsed& used : prepared.scene.sources.files) {
    if (sha256(add_named(zip, folder, prepared.scene, used.path, carried)) != used.sha256)
      throw study::InputError(used.path + ": has changed since the scene was read");
  }
  // Pictures have files too, which the scene is not read without.
  for (const std::string& mesh : meshes_of(prepared.scene.source.at("bodies")))
    add_named(zip, folder, prepared.scene, mesh, carried);
}

void add_library(ZipFile& zip, const Description& d) {
  const fs::path folder = library_folder();
  const std::string platform = d.version == 2 ? "linux64" : "x86_64-linux";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = entry.path().filename().string();
    zip.add("binaries/" + platform + '/' + (name == "fmu.so" ? d.identifier + ".so" : name),
            read_bytes(entry.path().string()));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "licenses"))
    zip.add("documentation/licenses/" + entry.path().filename().string(), read_bytes(entry.path().string()));
}

}  // namespace

Exported export_fmu(const study::Prepared& prepared, const SceneOptions& options, Registry& registry,
                    const Export& what) {
  check_plugins(prepared);
  if (what.model_exchange) refuse_model_exchange(prepared);
  Exported made{{what.version, what.model_exchange, what.co_simulation, identifier_of(what.out), {}},
                variables_of(prepared, registry)};
  made.description.token = token_of(prepared, made.variables);
  keep_inputs(what.out, files_of(prepared.scene));
  ZipFile zip(what.out);
  zip.add("modelDescription.xml", model_description(made.description, prepared, made.variables));
  zip.add("documentation/index.html", documentation_page(made.description, prepared, made.variables));
  add_library(zip, made.description);
  add_scene(zip, prepared, options);
  zip.finish();
  made.bytes = fs::file_size(what.out);
  return made;
}

}  // namespace withy::fmi
