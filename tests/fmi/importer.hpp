/// \file
/// An importer of FMUs for tests: it unpacks what `fmi::export_fmu` has packed, reads the model description as text,
/// and loads the library with every function of the standard.
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <minizip/unzip.h>

#include <boost/property_tree/xml_parser.hpp>
#include <cstdarg>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/bindings/fmi/export.hpp"
#include "withy/bindings/fmi/fmi2.h"
#include "withy/bindings/fmi/fmi3.h"
#include "withy/host/scene.hpp"
#include "withy/tests/host/arm.hpp"

namespace withy::test {

inline const std::string commanded = SCENES "/commanded-arm.yaml";

using Tree = boost::property_tree::ptree;

/// A variable as the model description has it.
struct Described {
  std::string name;
  std::uint32_t reference = 0;
  std::map<std::string, std::string> attributes;  ///< of the variable and of its type
};

/// An FMU in a folder of its own, removed at the end of the tests.
struct Unpacked {
  std::filesystem::path folder;
  Tree xml;  ///< of fmiModelDescription
  std::string token, identifier;
  std::vector<Described> variables;

  [[nodiscard]] std::filesystem::path library(int version) const {
    return folder / "binaries" / (version == 2 ? "linux64" : "x86_64-linux") / (identifier + ".so");
  }
  [[nodiscard]] std::uint32_t reference(const std::string& name) const {
    for (const Described& v : variables)
      if (v.name == name) return v.reference;
    throw std::out_of_range("no variable " + name);
  }
  /// Of all variables with this causality.
  [[nodiscard]] std::vector<std::uint32_t> of(const std::string& causality) const {
    std::vector<std::uint32_t> found;
    for (const Described& v : variables)
      if (v.attributes.at("causality") == causality) found.push_back(v.reference);
    return found;
  }
  /// Of the derivatives in the order of the states, and of the states.
  std::vector<std::uint32_t> derivatives, states;
};

inline std::map<std::string, std::string> attributes_of(const Tree& element) {
  std::map<std::string, std::string> all;
  if (const auto found = element.get_child_optional("<xmlattr>"))
    for (const auto& [key, value] : *found) all[key] = value.data();
  return all;
}

inline void unzip(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const unzFile zip = unzOpen64(file.c_str());
  if (zip == nullptr) throw std::runtime_error("no archive: " + file.string());
  for (int more = unzGoToFirstFile(zip); more == UNZ_OK; more = unzGoToNextFile(zip)) {
    char name[512] = {};
    unz_file_info64 info{};
    unzGetCurrentFileInfo64(zip, &info, name, sizeof name - 1, nullptr, 0, nullptr, 0);
    std::string bytes(info.uncompressed_size, '\0');
    if (unzOpenCurrentFile(zip) != UNZ_OK ||
        unzReadCurrentFile(zip, bytes.data(), static_cast<unsigned>(bytes.size())) != static_cast<int>(bytes.size()) ||
        unzCloseCurrentFile(zip) != UNZ_OK)
      throw std::runtime_error("damaged: " + std::string(name));
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << bytes;
  }
  unzClose(zip);
}

inline Unpacked unpack(const std::filesystem::path& file, int version) {
  Unpacked fmu;
  fmu.folder = file.string() + ".d";
  unzip(file, fmu.folder);
  Tree whole;
  boost::property_tree::read_xml((fmu.folder / "modelDescription.xml").string(), whole);
  fmu.xml = whole.get_child("fmiModelDescription");
  const auto head = attributes_of(fmu.xml);
  fmu.token = head.at(version == 2 ? "guid" : "instantiationToken");
  fmu.identifier = attributes_of(fmu.xml.get_child("CoSimulation")).at("modelIdentifier");
  for (const auto& [tag, element] : fmu.xml.get_child("ModelVariables")) {
    if (tag == "<xmlcomment>") continue;
    Described v{{}, 0, attributes_of(element)};
    if (version == 2) v.attributes.merge(attributes_of(element.get_child("Real")));
    v.name = v.attributes.at("name");
    v.reference = static_cast<std::uint32_t>(std::stoul(v.attributes.at("valueReference")));
    fmu.variables.push_back(std::move(v));
  }
  for (const Described& v : fmu.variables) {
    if (!v.attributes.contains("derivative")) continue;
    const auto state = static_cast<std::uint32_t>(std::stoul(v.attributes.at("derivative")));
    fmu.derivatives.push_back(v.reference);
    // FMI 2.0 counts variables from 1, FMI 3.0 names their references.
    fmu.states.push_back(version == 2 ? fmu.variables.at(state - 1).reference : state);
  }
  return fmu;
}

/// A folder for the tests of one process.
inline const std::filesystem::path& scratch() {
  struct Folder {
    std::filesystem::path path = std::filesystem::temp_directory_path() / ("withy-fmi-" + std::to_string(::getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
  };
  static const Folder folder;
  return folder.path;
}

/// The FMU of a scene; the same for the same file and version.
inline const Unpacked& exported(const std::string& scene_file, int version) {
  static std::map<std::pair<std::string, int>, Unpacked> all;
  const auto key = std::pair(scene_file, version);
  if (const auto known = all.find(key); known != all.end()) return known->second;
  const auto prepared = host::Scene::read(library(), scene_file).prepare();
  const std::filesystem::path out =
      scratch() / (std::filesystem::path(scene_file).stem().string() + std::to_string(version) + ".fmu");
  static_cast<void>(fmi::export_fmu(*prepared, {}, library().registry(), {version, true, true, out}));
  return all.emplace(key, unpack(out, version)).first->second;
}

inline std::string busy_arm_file() {
  const std::filesystem::path file = scratch() / "busy-arm.yaml";
  std::ofstream(file) << busy_arm;
  return file.string();
}
inline std::string smooth_arm_file() {
  const std::filesystem::path file = scratch() / "smooth-arm.yaml";
  std::ofstream(file) << smooth_arm().text();
  return file.string();
}
/// The FMU of a scene in text. \param name of its file
inline const Unpacked& fmu_of_text(const std::string& name, const std::string& text) {
  const std::filesystem::path file = scratch() / (name + ".yaml");
  std::ofstream(file) << text;
  return exported(file.string(), 3);
}

// Lists of names, which the formatter indents anew each time.
// clang-format off
#define WITHY_FMI2_FUNCTIONS(X) \
  X(GetTypesPlatform) X(GetVersion) X(SetDebugLogging) X(Instantiate) X(FreeInstance) X(SetupExperiment) \
  X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset) X(GetReal) X(GetInteger) X(GetBoolean) \
  X(GetString) X(SetReal) X(SetInteger) X(SetBoolean) X(SetString) X(GetFMUstate) X(SetFMUstate) X(FreeFMUstate) \
  X(SerializedFMUstateSize) X(SerializeFMUstate) X(DeSerializeFMUstate) X(GetDirectionalDerivative) \
  X(EnterEventMode) X(NewDiscreteStates) X(EnterContinuousTimeMode) X(CompletedIntegratorStep) X(SetTime) \
  X(SetContinuousStates) X(GetDerivatives) X(GetEventIndicators) X(GetContinuousStates) \
  X(GetNominalsOfContinuousStates) X(SetRealInputDerivatives) X(GetRealOutputDerivatives) X(DoStep) X(CancelStep) \
  X(GetStatus) X(GetRealStatus) X(GetIntegerStatus) X(GetBooleanStatus) X(GetStringStatus)

#define WITHY_FMI3_FUNCTIONS(X) \
  X(GetVersion) X(SetDebugLogging) X(InstantiateModelExchange) X(InstantiateCoSimulation) \
  X(InstantiateScheduledExecution) X(FreeInstance) X(EnterInitializationMode) X(ExitInitializationMode) \
  X(EnterEventMode) X(Terminate) X(Reset) X(GetFloat32) X(GetFloat64) X(GetInt8) X(GetUInt8) X(GetInt16) \
  X(GetUInt16) X(GetInt32) X(GetUInt32) X(GetInt64) X(GetUInt64) X(GetBoolean) X(GetString) X(GetBinary) \
  X(GetClock) X(SetFloat32) X(SetFloat64) X(SetInt8) X(SetUInt8) X(SetInt16) X(SetUInt16) X(SetInt32) X(SetUInt32) \
  X(SetInt64) X(SetUInt64) X(SetBoolean) X(SetString) X(SetBinary) X(SetClock) X(GetNumberOfVariableDependencies) \
  X(GetVariableDependencies) X(GetFMUState) X(SetFMUState) X(FreeFMUState) X(SerializedFMUStateSize) \
  X(SerializeFMUState) X(DeserializeFMUState) X(GetDirectionalDerivative) X(GetAdjointDerivative) \
  X(EnterConfigurationMode) X(ExitConfigurationMode) X(GetIntervalDecimal) X(GetIntervalFraction) \
  X(GetShiftDecimal) X(GetShiftFraction) X(SetIntervalDecimal) X(SetIntervalFraction) X(SetShiftDecimal) \
  X(SetShiftFraction) X(EvaluateDiscreteStates) X(UpdateDiscreteStates) X(EnterContinuousTimeMode) \
  X(CompletedIntegratorStep) X(SetTime) X(SetContinuousStates) X(GetContinuousStateDerivatives) \
  X(GetEventIndicators) X(GetContinuousStates) X(GetNominalsOfContinuousStates) X(GetNumberOfEventIndicators) \
  X(GetNumberOfContinuousStates) X(EnterStepMode) X(GetOutputDerivatives) X(DoStep) X(ActivateModelPartition)
// clang-format on

inline void* loaded(const std::filesystem::path& library) {
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) throw std::runtime_error(dlerror());
  return handle;
}

template <class Function>
Function* symbol(void* handle, const char* name) {
  void* found = dlsym(handle, name);
  if (found == nullptr) throw std::runtime_error(std::string(name) + " is missing");
  return reinterpret_cast<Function*>(found);
}

/// All functions of FMI 2.0; throws where the library lacks one.
struct Fmi2 {
  explicit Fmi2(const Unpacked& fmu) : handle(loaded(fmu.library(2))) {}
  void* handle;
#define X(name) decltype(&fmi2##name) name = symbol<std::remove_pointer_t<decltype(&fmi2##name)>>(handle, "fmi2" #name);
  WITHY_FMI2_FUNCTIONS(X)
#undef X
};

struct Fmi3 {
  explicit Fmi3(const Unpacked& fmu) : handle(loaded(fmu.library(3))) {}
  void* handle;
#define X(name) decltype(&fmi3##name) name = symbol<std::remove_pointer_t<decltype(&fmi3##name)>>(handle, "fmi3" #name);
  WITHY_FMI3_FUNCTIONS(X)
#undef X
};

/// What FMUs have said.
struct Heard {
  int lines = 0;
  std::string last;
  std::vector<std::string> all;
};

inline void hear2(void* environment, fmi2String, fmi2Status, fmi2String, fmi2String format, ...) {
  va_list arguments;
  va_start(arguments, format);
  char text[2000];
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  auto& heard = *static_cast<Heard*>(environment);
  ++heard.lines;
  heard.all.push_back(heard.last = text);
}

inline void hear3(void* environment, fmi3Status, fmi3String, fmi3String message) {
  auto& heard = *static_cast<Heard*>(environment);
  ++heard.lines;
  heard.all.push_back(heard.last = message);
}

/// An instance of FMI 2.0 up to the end of its initialization.
struct Instance2 {
  Instance2(const Unpacked& fmu, fmi2Type type) : fmi(fmu), functions{&hear2, nullptr, nullptr, nullptr, &heard} {
    const std::string uri = "file://" + (fmu.folder / "resources").string();
    c = fmi.Instantiate("test", type, fmu.token.c_str(), uri.c_str(), &functions, fmi2False, fmi2False);
    if (c == nullptr) throw std::runtime_error(heard.last);
  }
  ~Instance2() { fmi.FreeInstance(c); }
  void initialize(double start = 0) {
    EXPECT_EQ(fmi.SetupExperiment(c, fmi2False, 0, start, fmi2False, 0), fmi2OK) << heard.last;
    EXPECT_EQ(fmi.EnterInitializationMode(c), fmi2OK) << heard.last;
    EXPECT_EQ(fmi.ExitInitializationMode(c), fmi2OK) << heard.last;
  }
  double get(std::uint32_t reference) {
    double value = 0;
    EXPECT_EQ(fmi.GetReal(c, &reference, 1, &value), fmi2OK) << heard.last;
    return value;
  }
  fmi2Status set(std::uint32_t reference, double value) { return fmi.SetReal(c, &reference, 1, &value); }

  Fmi2 fmi;
  Heard heard;
  fmi2CallbackFunctions functions;
  fmi2Component c = nullptr;
};

struct Instance3 {
  Instance3(const Unpacked& fmu, bool co_simulation, fmi3IntermediateUpdateCallback update = nullptr) : fmi(fmu) {
    const std::string path = (fmu.folder / "resources").string() + '/';
    c = co_simulation
            ? fmi.InstantiateCoSimulation("test", fmu.token.c_str(), path.c_str(), false, false, false, true, nullptr,
                                          0, &heard, &hear3, update)
            : fmi.InstantiateModelExchange("test", fmu.token.c_str(), path.c_str(), false, false, &heard, &hear3);
    if (c == nullptr) throw std::runtime_error(heard.last);
  }
  ~Instance3() { fmi.FreeInstance(c); }
  void initialize() {
    EXPECT_EQ(fmi.EnterInitializationMode(c, false, 0, 0, false, 0), fmi3OK) << heard.last;
    EXPECT_EQ(fmi.ExitInitializationMode(c), fmi3OK) << heard.last;
  }
  double get(std::uint32_t reference) {
    double value = 0;
    EXPECT_EQ(fmi.GetFloat64(c, &reference, 1, &value, 1), fmi3OK) << heard.last;
    return value;
  }
  fmi3Status set(std::uint32_t reference, double value) { return fmi.SetFloat64(c, &reference, 1, &value, 1); }

  Fmi3 fmi;
  Heard heard;
  fmi3Instance c = nullptr;
};

}  // namespace withy::test
