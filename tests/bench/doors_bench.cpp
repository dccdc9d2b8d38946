/// \file
/// One evaluation of the arm through each door, beside the engine's own call, in one run: least times of many rounds,
/// one door after the other in each, so that what else the machine does meets all of them. doors_bench.py adds Python.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "withy/bindings/c/withy.h"
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
  bool good = true;
  double native = std::numeric_limits<double>::infinity(), cpp = native, c = native;
  for (int k = 0; k < rounds; ++k) {
    native =
        std::min(native, round_time([&] { good &= prepared->equations->derivatives(0.5, full, full_dot, work).ok(); }));
    cpp = std::min(cpp, round_time([&] { good &= equations.derivatives(0.5, y, y_dot).ok(); }));
    good &= std::equal(y_dot.begin(), y_dot.end(), full_dot.begin());
    c = std::min(c, round_time([&] {
                   good &= withy_equations_derivatives(c_equations, 0.5, y.data(), y_dot.data(), n) == WITHY_OK;
                 }));
    good &= std::equal(y_dot.begin(), y_dot.end(), full_dot.begin());
  }
  std::printf("engine %.1f ns\nC++    %.1f ns, %.3f of the engine's\nC      %.1f ns, %.3f of the engine's\n", native,
              cpp, cpp / native, c, c / native);
  for (void* handle : {static_cast<void*>(c_equations), static_cast<void*>(c_scene), static_cast<void*>(c_library)})
    withy_free(handle);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
