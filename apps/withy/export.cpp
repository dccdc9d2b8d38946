#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
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

void add_export(Options& o, ExportArguments& a) {
  add_scene(o, a);
  o.value("--out", a.out, "FILE", "File; default: the scene's name with .urdf, in the working folder");
}

}  // namespace

const Command export_command = {"export", "Write the tree of a scene as URDF, for viewers and robots' software",
                                "  withy export scenes/commanded-arm.yaml --out arm.urdf",
                                &taking<ExportArguments, add_export, export_scene>};

}  // namespace withy::app
