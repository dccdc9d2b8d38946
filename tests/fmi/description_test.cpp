/// \file
/// What is in an FMU: a model description by the standard's rules, a library that needs nothing that is not there.
#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <set>
#include <sstream>

#include "withy/study/input_error.hpp"
#include "withy/tests/fmi/importer.hpp"

namespace withy::test {
namespace {

std::set<std::size_t> indices(const Tree& list, const char* tag, const char* key) {
  std::set<std::size_t> all;
  for (const auto& [name, element] : list) {
    if (name != tag) continue;
    const auto a = attributes_of(element);
    EXPECT_TRUE(all.insert(std::stoul(a.at(key))).second) << tag << " twice: " << a.at(key);
    const auto words = [](const std::string& text) {
      std::istringstream in(text);
      return std::distance(std::istream_iterator<std::string>(in), {});
    };
    if (a.contains("dependencies")) {
      EXPECT_EQ(words(a.at("dependencies")), words(a.at("dependenciesKind")));
    }
  }
  return all;
}

std::string needed(const std::filesystem::path& library) {
  std::string out;
  std::array<char, 4096> buffer{};
  std::FILE* pipe = popen(("readelf -d '" + library.string() + "'").c_str(), "r");
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) out.append(buffer.data(), n);
  EXPECT_EQ(pclose(pipe), 0);
  return out;
}

}  // namespace

TEST(Description, NamesReferencesUnitsAndStructureFollowTheRulesOfBothVersions) {
  for (const int version : {2, 3}) {
    for (const std::string& file :
         {busy_arm_file(), std::string(SCENES "/loads-of-the-slew.yaml"), std::string(SCENES "/imported-boom.yaml"),
          std::string(SCENES "/manipulator-pid.yaml")}) {
      const Unpacked& fmu = exported(file, version);
      std::set<std::string> names, units;
      for (const auto& [tag, unit] : fmu.xml.get_child("UnitDefinitions")) units.insert(attributes_of(unit).at("name"));
      std::set<std::size_t> outputs, derivatives, initial;
      int loads = 0, rates = 0;
      const std::size_t first = version == 2 ? 1 : 0;  // FMI 2.0 counts variables in the structure from 1
      for (std::size_t i = 0; i < fmu.variables.size(); ++i) {
        const Described& v = fmu.variables[i];
        EXPECT_EQ(v.reference, i);
        EXPECT_TRUE(names.insert(v.name).second) << v.name;
        EXPECT_EQ(v.name.find_first_of("\r\n\t"), std::string::npos);
        const auto at = [&](const char* key) {
          return v.attributes.contains(key) ? v.attributes.at(key) : std::string();
        };
        EXPECT_TRUE(!v.attributes.contains("unit") || units.contains(at("unit"))) << v.name;
        // Modal coordinates are numbers, their rates numbers a second.
        if (v.name.ends_with("].rate") || (v.name.starts_with("der(") && v.name.ends_with("])"))) {
          EXPECT_EQ(at("unit"), "1/s") << v.name;
          ++rates;
        }
        // Where states of loads begin follows from the rest of the start: theirs is a first guess.
        const bool load = at("initial") == "approx";
        loads += load ? 1 : 0;
        EXPECT_EQ(v.attributes.contains("start"), load || at("initial") == "exact" || at("causality") == "input")
            << v.name;
        if (at("causality") == "output") outputs.insert(i + first);
        if (v.attributes.contains("derivative")) derivatives.insert(i + first);
        if (load ||
            (at("initial") == "calculated" && (at("causality") == "output" || v.attributes.contains("derivative"))))
          initial.insert(i + first);
      }
      EXPECT_TRUE(rates > 0 || file == busy_arm_file()) << file;
      EXPECT_EQ(loads, file.ends_with("manipulator-pid.yaml") ? 7 : 0);  // three controllers, an actuator of two states
      const Tree& structure = fmu.xml.get_child("ModelStructure");
      if (version == 2) {
        EXPECT_EQ(indices(structure.get_child("Outputs"), "Unknown", "index"), outputs);
        EXPECT_EQ(indices(structure.get_child("Derivatives"), "Unknown", "index"), derivatives);
        EXPECT_EQ(indices(structure.get_child("InitialUnknowns"), "Unknown", "index"), initial);
      } else {
        EXPECT_EQ(indices(structure, "Output", "valueReference"), outputs);
        EXPECT_EQ(indices(structure, "ContinuousStateDerivative", "valueReference"), derivatives);
        EXPECT_EQ(indices(structure, "InitialUnknown", "valueReference"), initial);
      }
      EXPECT_EQ(fmu.xml.count("ModelExchange") + fmu.xml.count("CoSimulation"), 2U);
    }
  }
}

TEST(Description, AnFmuHasItsSceneItsFilesALibraryADocumentAndLicences) {
  const Unpacked& fmu = exported(SCENES "/imported-boom.yaml", 3);
  for (const char* file : {"resources/scene/imported-boom.yaml", "resources/scene/cantilever.SID_FEM",
                           "resources/withy.json", "documentation/index.html", "documentation/licenses/license.txt"})
    EXPECT_TRUE(std::filesystem::is_regular_file(fmu.folder / file)) << file;
  Instance3 instance(fmu, true);
  instance.initialize();
}

TEST(Description, AnFmuHasTheMeshesThatItsSceneIsNotReadWithout) {
  const std::filesystem::path folder = scratch() / "drawn";
  std::filesystem::create_directories(folder / "cad");
  std::ofstream(folder / "cad/bus.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(folder / "bus.yaml") << R"(format: withy/1
bodies: {bus: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], visual: {mesh: cad/bus.obj}}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: bus}}
loads: {motor: {type: input, hinge: axle}}
time: {end: 1}
)";
  const Unpacked& fmu = exported((folder / "bus.yaml").string(), 3);
  std::filesystem::remove_all(folder);
  EXPECT_TRUE(std::filesystem::is_regular_file(fmu.folder / "resources/scene/cad/bus.obj"));
  Instance3 instance(fmu, true);
  instance.initialize();
}

TEST(Description, TheLibraryNeedsTheRunTimesOfCAndCppAndWhatStandsBesideIt) {
  for (const int version : {2, 3}) {
    const std::filesystem::path library = exported(busy_arm_file(), version).library(version);
    std::istringstream lines(needed(library));
    std::string line;
    while (std::getline(lines, line)) {
      if (line.find("(NEEDED)") == std::string::npos) continue;
      const std::string name = line.substr(line.find('[') + 1, line.find(']') - line.find('[') - 1);
      static const std::set<std::string> everywhere{"libc.so.6", "libm.so.6", "libstdc++.so.6", "libgcc_s.so.1",
                                                    "ld-linux-x86-64.so.2"};
      if (everywhere.contains(name)) continue;
      EXPECT_TRUE(std::filesystem::is_regular_file(library.parent_path() / name)) << name;
    }
    EXPECT_NE(needed(library).find("Library runpath: [$ORIGIN]"), std::string::npos);
  }
}

TEST(Description, UnitsThatScenesAreNotWrittenWithAreThoseOfTheStandardOrNamesAlone) {
  const std::filesystem::path file = scratch() / "motor.yaml";
  std::ofstream(file) << R"(format: withy/1
bodies: {rotor: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: rotor}}
loads: {motor: {type: dc-motor, hinge: axle, reference: 2, resistance: 1, inductance: 0.1, torque_constant: 0.2}}
outputs: {drive: {type: control, of: motor}, turns: {type: expression, value: drive.command / 2, unit: <turns>}}
time: {end: 1}
)";
  for (const int version : {2, 3}) {
    const Unpacked& fmu = exported(file.string(), version);
    std::map<std::string, std::map<std::string, std::string>> units;
    for (const auto& [tag, unit] : fmu.xml.get_child("UnitDefinitions")) {
      const auto base = unit.get_child_optional("BaseUnit");
      units[attributes_of(unit).at("name")] = base ? attributes_of(*base) : std::map<std::string, std::string>{};
    }
    EXPECT_EQ(units.at("V"), (std::map<std::string, std::string>{{"kg", "1"}, {"m", "2"}, {"s", "-3"}, {"A", "-1"}}));
    EXPECT_EQ(units.at("A"), (std::map<std::string, std::string>{{"A", "1"}}));
    EXPECT_EQ(units.at("<turns>"), (std::map<std::string, std::string>{}));
  }
}

TEST(Description, ParametersOfWhatActsAlongASlidingHingeAreForcesAndLengths) {
  const std::filesystem::path file = scratch() / "slide.yaml";
  std::ofstream(file) << R"(format: withy/1
time: {end: 1, output: 0.1}
bodies: {a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}, b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]},
  c: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges:
  turn: {type: revolute, axis: [0, 0, 1], parent: world, child: a, reflected_inertia: 0.2}
  wrist: {type: prismatic, axis: [1, 0, 0], parent: a, child: b, reflected_inertia: 2}
  driven: {type: prismatic, axis: [1, 0, 0], parent: b, child: c}
motions: {swing: {type: sine, hinge: driven, amplitude: 0.1, period: 1, phase: 0.2}}
loads:
  push: {type: input, hinge: wrist}
  brake: {type: hinge-spring, hinge: wrist, stiffness: 20, damping: 2, free_position: 0.1, preload: 1}
  stop: {type: hinge-limit, hinge: wrist, lower: -1, stiffness: 100}
  torsion: {type: hinge-spring, hinge: turn, stiffness: 20}
  servo: {type: pd-controller, law: constant, hinges: {turn: {to: 0.1, stiffness: 1, damping: 0},
    wrist: {to: 0.1, stiffness: 1, damping: 0}}}
  hold: {type: pid, hinge: wrist, proportional: 3}
  far: {type: pid, of: wrist, to: push, proportional: 3, integral: 1}
  fast: {type: pid, of: turn.rate, hinge: turn, proportional: 3, limit: 2}
  lag: {type: actuator, of: far, to: push, frequency: 30, limit: 2}
)";
  const Unpacked& fmu = exported(file.string(), 3);
  const auto unit = [&](const std::string& path) {
    const auto& attributes = fmu.variables.at(fmu.reference(path)).attributes;
    return attributes.contains("unit") ? attributes.at("unit") : "";
  };
  for (const auto& [path, expected] :
       std::map<std::string, std::string>{{"loads.brake.stiffness", "N/m"},
                                          {"loads.brake.damping", "N s/m"},
                                          {"loads.brake.free_position", "m"},
                                          {"loads.brake.preload", "N"},
                                          {"loads.stop.lower", "m"},
                                          {"loads.stop.stiffness", "N/m"},
                                          {"loads.torsion.stiffness", "N m/rad"},
                                          {"motions.swing.amplitude", "m"},
                                          {"motions.swing.phase", "rad"},
                                          {"loads.servo.hinges.turn.stiffness", "N m/rad"},
                                          {"loads.servo.hinges.wrist.to", "m"},
                                          {"loads.servo.hinges.wrist.stiffness", "N/m"},
                                          {"loads.hold.proportional", "N/m"},
                                          {"loads.far.proportional", "N/m"},
                                          {"loads.far.integral", "N/(m s)"},
                                          {"loads.fast.proportional", ""},
                                          {"loads.fast.limit", "N m"},
                                          {"loads.lag.limit", "N"},
                                          {"loads.lag.frequency", "rad/s"},
                                          {"hinges.turn.reflected_inertia", "kg m^2"},
                                          {"hinges.wrist.reflected_inertia", "kg"}})
    EXPECT_EQ(unit(path), expected) << path;
  std::map<std::string, std::map<std::string, std::string>> units;
  for (const auto& [tag, element] : fmu.xml.get_child("UnitDefinitions"))
    units[attributes_of(element).at("name")] = attributes_of(element.get_child("BaseUnit"));
  EXPECT_EQ(units.at("N/(m s)"), (std::map<std::string, std::string>{{"kg", "1"}, {"s", "-3"}}));
}

TEST(Description, WhatCannotBeAnFmuIsRefusedWithItsReason) {
  const auto refused = [](host::Scene scene) -> std::string {
    const auto prepared = scene.prepare();
    try {
      static_cast<void>(
          fmi::export_fmu(*prepared, {}, library().registry(), {3, true, true, scratch() / "refused.fmu"}));
    } catch (const study::InputError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_NE(refused(host::Scene::parse(library(), busy_arm).formulation("auto")).find("'auto'"), std::string::npos);
  std::string text = busy_arm;
  text.replace(text.find("torque: {"), 6, "axle");
  EXPECT_NE(refused(host::Scene::parse(library(), text)).find("would be called 'axle'"), std::string::npos);
  host::Scene acting = host::Scene::parse(library(), busy_arm);
  acting.set("events.latch", "{hinge: axle, value: 0.1, do: {lock: axle}}");
  EXPECT_NE(refused(acting).find("/events/latch: an event acts on the motion"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(scratch() / "refused.fmu"));
}

/// What a scene names is found where it was, also by a host that has gone elsewhere since.
TEST(Description, AnFmuCarriesTheFilesOfTheFolderThatTheSceneWasReadIn) {
  const std::filesystem::path began = std::filesystem::current_path();
  for (const char* name : {"own", "other"}) std::filesystem::create_directories(scratch() / name);
  std::ofstream(scratch() / "own" / "shape.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(scratch() / "own" / "scene.yaml")
      << "format: withy/1\ntime: {end: 0.1}\n"
         "bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], visual: {mesh: shape.obj}}}\n"
         "hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}\n";
  std::filesystem::current_path(scratch() / "own");
  const auto prepared = host::Scene::read(library(), "scene.yaml").prepare();
  std::filesystem::current_path(scratch() / "other");
  const std::filesystem::path out = scratch() / "elsewhere.fmu";
  EXPECT_NO_THROW(static_cast<void>(fmi::export_fmu(*prepared, {}, library().registry(), {3, false, true, out})));
  EXPECT_TRUE(std::filesystem::exists(out));
  std::filesystem::current_path(began);
}

}  // namespace withy::test
