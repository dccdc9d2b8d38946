/// \file
/// Models of other programs, imported, and the accelerations that they have.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/exchange/import.hpp"
#include "withy/host/equations.hpp"
#include "withy/scene/scene_error.hpp"

namespace withy::exchange {

inline const host::Library& plugins() {
  static const host::Library library;
  return library;
}

/// A file of scenes/models.
inline std::string model_file(const std::string& name) { return WITHY_MODELS "/" + name; }

inline std::string text_of_file(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A file for one test; removed at its end.
class Scratch {
 public:
  Scratch(const std::string& name, const std::string& text)
      : path_(std::filesystem::temp_directory_path() / ("withy-exchange-" + std::to_string(::getpid()) + name)) {
    write(text);
  }
  ~Scratch() { std::filesystem::remove(path_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  void write(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }
  [[nodiscard]] std::string file() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

inline ImportedScene imported(const ModelImport& what) { return import_model(what, plugins().registry()); }

/// What is wrong with it; empty where nothing is.
inline std::string problems_of(const ModelImport& what) {
  try {
    imported(what);
  } catch (const SceneError& e) {
    return e.what();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return {};
}

inline host::Scene scene_of(const ModelImport& what) { return host::Scene::parse(plugins(), imported(what).text); }

/// Accelerations by the names of the speeds, at a state of these numbers.
inline std::map<std::string, double> accelerations(host::Equations& f, const std::vector<double>& y) {
  std::vector<double> rates(f.size());
  EXPECT_TRUE(f.derivatives(0, y, rates).ok());
  std::map<std::string, double> all;
  for (std::size_t i = 0; i < f.size(); ++i) all[f.states()[i].name] = rates[i];
  return all;
}

/// Sets the number of this name in a state.
inline void put(const host::Equations& f, std::vector<double>& y, const std::string& name, double value) {
  for (std::size_t i = 0; i < f.size(); ++i)
    if (f.states()[i].name == name) {
      y[i] = value;
      return;
    }
  FAIL() << "no state " << name;
}

}  // namespace withy::exchange
