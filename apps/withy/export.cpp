#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/exchange/urdf.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"

namespace withy::app {
namespace {

struct ExportArguments : SceneArguments {
  std::string out;  ///< empty: the scene's name with .urdf
};

ExitStatus export_scene(const ExportArguments& a) {
  const Engine engine(a);
  exchange::Urdf urdf;
  try {
    urdf = exchange::write_urdf(engine.model(), engine.scene().name);
  } catch (const std::domain_error& e) {
    throw InputError(a.scene + ": " + e.what());
  }
  const std::string file =
      a.out.empty() ? std::filesystem::path(a.scene).filename().replace_extension(".urdf").string() : a.out;
  write_file(file, urdf.text);
  if (a.json) {
    print(json_text(nlohmann::ordered_json{{"file", file}, {"remarks", urdf.remarks}}));
  } else {
    std::string text;
    for (const std::string& remark : urdf.remarks) text += "* " + remark + "\n";
    print(text + "written: " + file + "\n");
  }
  return ExitStatus::done;
}

std::function<ExitStatus()> add_export(CLI::App& c) {
  const auto arguments = std::make_shared<ExportArguments>();
  add_scene(c, *arguments);
  c.add_option("--out", arguments->out, "File; default: the scene's name with .urdf, in the working folder")
      ->type_name("FILE");
  return [arguments] { return export_scene(*arguments); };
}

}  // namespace

const Command export_command = {"export", "Write the tree of a scene as URDF, for viewers and robots' software",
                                "  withy export scenes/commanded-arm.yaml --out arm.urdf", &add_export};

}  // namespace withy::app
