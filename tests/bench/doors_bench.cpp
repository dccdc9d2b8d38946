/// \file
/// One evaluation of the arm through each door, beside the engine's own call, in one run: least times of many rounds,
/// one door after the other in each, so that what else the machine does meets all of them. doors_bench.py adds Python.
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "withy/bindings/c/withy.h"
#include "withy/bindings/fmi/fmi2.h"
#include "withy/bindings/fmi/resources.hpp"
#include "withy/bindings/fmi/variables.hpp"
#include "withy/host/equations.hpp"
#include "withy/study/prepared.hpp"

namespace {

constexpr int rounds = 400, evaluations = 500;

/// Nanoseconds of one call of `evaluate`, in one round.
template <class Evaluate>
double round_time(Evaluate&& evaluate) {
  const auto began = std::chrono::steady_clock::now();
  for (int i = 0; i < evaluations; ++i) evaluate();
  const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - began;
  return passed.count() / evaluations;
}

/// The scene as an FMU of model exchange would have it, without the packing.
class Fmu {
 public:
  Fmu(const withy::study::Prepared& prepared, const withy::host::Library& library) {
    const auto variables = withy::fmi::variables_of(prepared, library.registry());
    const std::filesystem::path scene = prepared.scene.file;
    std::filesystem::create_directories(folder_ / withy::fmi::scene_folder);
    std::filesystem::copy(scene, folder_ / withy::fmi::scene_folder / scene.filename());
    std::ofstream(folder_ / withy::fmi::recipe_file) << withy::fmi::write_recipe(scene.filename().string(), {});
    void* handle = dlopen(FMU_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) return;
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
    };
    decltype(&fmi2Instantiate) instantiate = nullptr;
    decltype(&fmi2EnterInitializationMode) enter = nullptr, exit = nullptr, begin = nullptr;
    find(instantiate, "fmi2Instantiate");
    find(enter, "fmi2EnterInitializationMode");
    find(exit, "fmi2ExitInitializationMode");
    find(begin, "fmi2EnterContinuousTimeMode");
    find(set_time_, "fmi2SetTime");
    find(set_states_, "fmi2SetContinuousStates");
    find(get_, "fmi2GetDerivatives");
    const fmi2CallbackFunctions functions{};
    instance_ = instantiate("bench", fmi2ModelExchange, withy::fmi::token_of(prepared, variables).c_str(),
                            folder_.c_str(), &functions, fmi2False, fmi2False);
    good =
        instance_ != nullptr && enter(instance_) == fmi2OK && exit(instance_) == fmi2OK && begin(instance_) == fmi2OK;
  }
  Fmu(const Fmu&) = delete;
  Fmu& operator=(const Fmu&) = delete;
  ~Fmu() { std::filesystem::remove_all(folder_); }
  bool evaluate(double t, const std::vector<double>& y, std::vector<double>& y_dot) {
    return set_time_(instance_, t) == fmi2OK && set_states_(instance_, y.data(), y.size()) == fmi2OK &&
           get_(instance_, y_dot.data(), y_dot.size()) == fmi2OK;
  }
  bool good = false;

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("withy-doors-" + std::to_string(::getpid()));
  fmi2Component instance_ = nullptr;
  decltype(&fmi2SetTime) set_time_ = nullptr;
  decltype(&fmi2SetContinuousStates) set_states_ = nullptr;
  decltype(&fmi2GetDerivatives) get_ = nullptr;
};

}  // namespace

int main() {
  const withy::host::Library library;
  const auto scene = withy::host::Scene::read(library, SCENES "/two-link-slew.yaml");
  const auto prepared = scene.prepare();
  withy::host::Equations equations(scene);
  withy_library* c_library = nullptr;
  withy_scene* c_scene = nullptr;
  withy_equations* c_equations = nullptr;
  if (withy_library_create(nullptr, &c_library) != WITHY_OK ||
      withy_scene_read(c_library, SCENES "/two-link-slew.yaml", &c_scene) != WITHY_OK ||
      withy_equations_create(c_scene, nullptr, &c_equations) != WITHY_OK)
    return EXIT_FAILURE;

  std::vector<double> full = prepared->scene.initial.y, full_dot(full.size());
  const std::size_t n = equations.size();
  for (std::size_t i = 0; i < n; ++i) full[i] += 0.01 * static_cast<double>(i + 1);
  const std::vector<double> y(full.begin(), full.begin() + static_cast<std::ptrdiff_t>(n));
  std::vector<double> y_dot(n);
  withy::Work work = prepared->equations->make_work();
  Fmu fmu(*prepared, library);
  bool good = fmu.good;
  if (!good) return EXIT_FAILURE;
  double native = std::numeric_limits<double>::infinity(), cpp = native, c = native, fmi = native;
  for (int k = 0; k < rounds; ++k) {
    native =
        std::min(native, round_time([&] { good &= prepared->equations->derivatives(0.5, full, full_dot, work).ok(); }));
    cpp = std::min(cpp, round_time([&] { good &= equations.derivatives(0.5, y, y_dot).ok(); }));
    good &= std::equal(y_dot.begin(), y_dot.end(), full_dot.begin());
    c = std::min(c, round_time([&] {
                   good &= withy_equations_derivatives(c_equations, 0.5, y.data(), y_dot.data(), n) == WITHY_OK;
                 }));
    good &= std::equal(y_dot.begin(), y_dot.end(), full_dot.begin());
    fmi = std::min(fmi, round_time([&] { good &= fmu.evaluate(0.5, y, y_dot); }));
    good &= std::equal(y_dot.begin(), y_dot.end(), full_dot.begin());
  }
  std::printf(
      "engine %.1f ns\nC++    %.1f ns, %.3f of the engine's\nC      %.1f ns, %.3f of the engine's\n"
      "FMU    %.1f ns, %.3f of the engine's\n",
      native, cpp, cpp / native, c, c / native, fmi, fmi / native);
  for (void* handle : {static_cast<void*>(c_equations), static_cast<void*>(c_scene), static_cast<void*>(c_library)})
    withy_free(handle);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
