#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/exchange/urdf.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/output_name.hpp"

namespace withy::app {
namespace {

struct ExportArguments : SceneArguments {
  std::string out;  ///< empty: the scene's name with .urdf
  bool force = false;
};

ExitStatus export_scene(const ExportArguments& a) {
  const Engine engine(a);
  exchange::Urdf urdf;
  try {
    urdf = exchange::write_urdf(engine.model(), engine.scene().name);
  } catch (const std::domain_error& e) {
    throw InputError(a.scene + ": " + e.what());
  }
  const std::string file = output_name(a.out, renamed(a.scene, ".urdf"), a.force, files_of(engine.scene()));
  write_file(file, urdf.text);
  print(a.json ? json_text(nlohmann::ordered_json{{"file", file}, {"remarks", urdf.remarks}})
               : written_text(urdf.remarks, file));
  return ExitStatus::done;
}

void add_export(Options& o, ExportArguments& a) {
  add_scene(o, a);
  o.value("--out", a.out, "FILE", "File; default: the scene's name with .urdf, in the working folder");
  o.flag("--force", a.force, "Replace a file that has the default name");
}

}  // namespace

const Command export_command = {"export", "Write the tree of a scene as URDF, for viewers and robots' software",
                                "  withy export scenes/commanded-arm.yaml --out arm.urdf",
                                &taking<ExportArguments, add_export, export_scene>};

}  // namespace withy::app
