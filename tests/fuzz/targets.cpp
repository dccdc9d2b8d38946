#include "withy/tests/fuzz/targets.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "withy/bodies/modal/sid.hpp"
#include "withy/bodies/modal/sid_body.hpp"
#include "withy/campaign/list_file.hpp"
#include "withy/campaign/segment.hpp"
#include "withy/exchange/import.hpp"
#include "withy/fem/mesh.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/results/checkpoint_files.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/results_error.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/state.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/recorded_motion.hpp"
#include "withy/tests/fuzz/calls.hpp"

namespace withy::fuzz {
namespace {

namespace fs = std::filesystem;

/// With the project's plugins, made once.
Registry& registry() {
  static Registry& all = *[] {
    auto* made = new Registry;
    enroll_static_plugins(*made);
    return made;
  }();
  return all;
}

/// A folder in memory, of this process, with a file of the bytes.
fs::path file_of(std::string_view bytes, const std::string& name) {
  static const fs::path folder = [] {
    const fs::path made = fs::path("/dev/shm") / ("withy-fuzz-" + std::to_string(::getpid()));
    fs::create_directories(made);
    return made;
  }();
  write_file(folder / name, bytes);
  return folder / name;
}

constexpr const char* pendulum = R"(format: withy/1
time: {end: 1}
bodies:
  a: {type: rigid, mass: 1, center_of_mass: [1, 0, 0], inertia: [1, 1, 1, 0, 0, 0]}
  b: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 100, modes: 1}}
hinges:
  shoulder: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  elbow: {type: revolute, axis: [0, 0, 1], parent: a, child: b}
)";

const Scene& small_scene() {
  static const Scene& scene = *new Scene(parse_scene(pendulum, "scene.yaml", registry()));
  return scene;
}

void read_a_scene(std::string_view bytes) {
  try {
    parse_scene(bytes, "scene.yaml", registry());
  } catch (const SceneError&) {
  }
}

void read_a_state(std::string_view bytes) {
  try {
    parse_state(bytes, "state.json", *small_scene().model, small_scene().initial);
  } catch (const SceneError&) {
  }
}

void read_input_data(std::string_view bytes) {
  try {
    SidReport report;
    body_of(sid::read(bytes), {}, report);
  } catch (const sid::FormatError&) {
  } catch (const std::domain_error&) {
  }
}

void read_a_deck(std::string_view bytes) {
  try {
    fem::read_mesh(file_of(bytes, "deck.inp"));
  } catch (const fem::InputError&) {
  }
}

void read_a_result_file(std::string_view bytes) {
  try {
    fem::read_mesh(file_of(bytes, "deck.frd"));
  } catch (const fem::InputError&) {
  }
}

void read_csv(std::string_view bytes) {
  const std::string file = file_of(bytes, "table.csv").string();
  try {
    study::read_recorded_motion(file, *small_scene().model);
  } catch (const study::InputError&) {
  }
  try {
    campaign::read_list_column(file, "mass", false);
  } catch (const study::InputError&) {
  }
}

/// The first byte says of what kind the rest is.
void read_a_model(std::string_view bytes) {
  constexpr const char* names[] = {"model.urdf", "model.xml", "model.dat"};
  if (bytes.empty()) return;
  exchange::ModelImport what;
  what.file = file_of(bytes.substr(1), names[static_cast<unsigned char>(bytes[0]) % 3]).string();
  what.length = what.file.ends_with(".dat") ? 60 : 0;
  try {
    exchange::import_model(what, registry());
  } catch (const SceneError&) {
  }
}

void read_a_checkpoint(std::string_view bytes) {
  const fs::path file = file_of(bytes, "checkpoint.cbor");
  try {
    static_cast<void>(CheckpointFiles(file.parent_path(), "fingerprint").read());
  } catch (const ResultsError&) {
  }
}

void read_a_segment(std::string_view bytes) {
  static const std::string fingerprint(64, 'a');
  campaign::SegmentReader reader(file_of(bytes, "1-of-1.0.segment"), fingerprint);
  while (const auto record = reader.next()) campaign::decode(*record);
  campaign::decode(bytes);
}

}  // namespace

const std::map<std::string, Target>& targets() {
  static const std::map<std::string, Target> all = {{"scene", &read_a_scene},     {"state", &read_a_state},
                                                    {"sid", &read_input_data},    {"deck", &read_a_deck},
                                                    {"frd", &read_a_result_file}, {"csv", &read_csv},
                                                    {"model", &read_a_model},     {"checkpoint", &read_a_checkpoint},
                                                    {"segment", &read_a_segment}, {"c", &call_the_c_interface},
                                                    {"fmu", &call_an_fmu}};
  return all;
}

}  // namespace withy::fuzz
