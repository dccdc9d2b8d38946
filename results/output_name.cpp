#include "withy/results/output_name.hpp"

#include <system_error>

#include "withy/scene/scene.hpp"
#include "withy/scene/visual.hpp"
#include "withy/study/input_error.hpp"

namespace withy {

namespace fs = std::filesystem;

void keep_inputs(const fs::path& out, const std::vector<fs::path>& read) {
  std::error_code ignored;
  if (!fs::is_regular_file(out, ignored)) return;  // what is read from a pipe or device may go back there
  for (const fs::path& file : read)
    if (fs::equivalent(out, file, ignored))
      throw study::InputError(out.string() + " is " + (out == file ? "read" : file.string() + ", which is read") +
                              " by this command and is not replaced; name another file");
}

void keep_inputs_in(const fs::path& folder, const std::vector<std::string>& names, const std::vector<fs::path>& read) {
  std::error_code ignored;
  for (const std::string& name : names) {
    const fs::path out = folder / name;
    keep_inputs(out, read);
    if (!fs::is_directory(out, ignored)) continue;
    for (const fs::path& file : read)
      for (fs::path above = fs::weakly_canonical(file, ignored); above.has_relative_path(); above = above.parent_path())
        if (fs::equivalent(above, out, ignored))
          throw study::InputError(file.string() + " is read by this command, and " + out.string() +
                                  " is to be replaced; name another folder");
  }
}

std::string output_name(const std::string& given, const fs::path& otherwise, bool force,
                        const std::vector<fs::path>& read) {
  const fs::path file = given.empty() ? otherwise : fs::path(given);
  keep_inputs(file, read);
  std::error_code ignored;
  if (given.empty() && !force && fs::is_regular_file(file, ignored))
    throw study::InputError(file.string() + " is there already: name another file, or add --force to replace it");
  return file.string();
}

fs::path renamed(const fs::path& file, const char* ending) { return file.filename().replace_extension(ending); }

std::vector<fs::path> files_of(const Scene& scene, const std::string& also) {
  const fs::path folder = scene.folder_now();
  std::vector<fs::path> all{folder / fs::path(scene.file).filename(), also};
  for (const FileUsed& used : scene.sources.files) all.push_back(folder / used.path);
  for (const std::string& mesh : meshes_of(scene.source.at("bodies"))) all.push_back(folder / mesh);
  return all;
}

std::string written_text(const std::vector<std::string>& remarks, const std::string& file) {
  std::string text;
  for (const std::string& remark : remarks) text += "* " + remark + "\n";
  return text + "written: " + file + "\n";
}

}  // namespace withy
