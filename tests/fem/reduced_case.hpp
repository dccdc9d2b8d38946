/// \file
/// Meshes that CalculiX made, reduced. They are described in tests/reference/fem/README.md and scenes/meshes/README.md.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "withy/fem/reduce.hpp"

namespace withy::fem {

namespace fs = std::filesystem;

constexpr double pi = std::numbers::pi;

inline const fs::path data = WITHY_FEM_FILES;
inline const fs::path cantilever = fs::path(WITHY_MESHES) / "cantilever";
/// A mesh that CalculiX made, and its reduction.
struct Case {
  Mesh mesh;
  Matrices matrices;
  ReductionOptions options;
  Reduction body;

  Case(const fs::path& job, int modes, double highest = 0)
      : mesh(read_mesh(job.string() + ".inp")),
        matrices(combined(read_calculix(job.string() + ".sti", job.string() + ".dof"),
                          read_calculix(job.string() + ".mas", job.string() + ".dof"), mesh)) {
    options.root = nodes_of(mesh, "root");
    options.interfaces = {{"TIP", nodes_of(mesh, "TIP")}};
    options.modes = modes;
    options.highest = highest;
    body = reduce(matrices, options);
  }
};

class Folder {
 public:
  Folder() { fs::create_directories(path_); }
  ~Folder() { fs::remove_all(path_); }
  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] fs::path with(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

 private:
  fs::path path_ = fs::temp_directory_path() / ("withy-fem-" + std::to_string(getpid()));
};

/// What an InputError says; empty where there is none.
template <class Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

}  // namespace withy::fem
