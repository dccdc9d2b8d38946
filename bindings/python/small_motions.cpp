#include <pybind11/stl.h>

#include <optional>
#include <utility>

#include "withy/bindings/python/bindings.hpp"
#include "withy/bindings/python/followed.hpp"

namespace withy::python {
namespace {

using host::Follow;
using host::Given;
using host::Scene;
using Names = std::vector<std::string>;
/// A file, or a name and the text that it stands for.
using Source = std::pair<std::string, std::optional<std::string>>;

Given given(const Source& source) { return {source.first, source.second}; }

std::string modes(const Scene& s, const Names& lock, const Source& at, const Names& spin, const std::string& sweep,
                  std::size_t count, bool as_is, bool floquet, const std::optional<Names>& blades, double period,
                  bool effective_mass, const Names& damp, const py::object& progress) {
  const host::ModesWish wish{{given(at), spin}, sweep, count, as_is, floquet, blades, period, effective_mass, damp};
  return of_a_copy(s, progress, [&](const Scene& own, const Follow& f) { return own.modes(lock, f, wish); });
}

std::string linearize(const Scene& s, const Names& inputs, const Names& outputs, const Names& lock, const Source& at,
                      const Names& spin) {
  return of_a_copy(s, py::none(), [&](const Scene& own, const Follow& /*it is short*/) {
    return own.linearize(inputs, outputs, lock, {given(at), spin});
  });
}

std::string response(const Scene& s, const std::string& input, const std::string& output, const Names& lock,
                     const Source& at, const Names& spin, std::optional<double> from, std::optional<double> to,
                     int points, std::optional<int> reduce) {
  return of_a_copy(s, py::none(), [&](const Scene& own, const Follow& /*it is short*/) {
    return own.response({input, output, from, to, points, reduce}, lock, {given(at), spin});
  });
}

std::string equilibrium(const Scene& s, const Names& lock, const Source& at, const Names& spin) {
  return of_a_copy(s, py::none(), [&](const Scene& own, const Follow& /*it is short*/) {
    return own.equilibrium(lock, {given(at), spin});
  });
}

/// JSON, times, efforts and rates of each drive, and the run.
py::tuple inverse(const Scene& s, const Source& motion, const py::object& progress) {
  host::Inverse found = of_a_copy(
      s, progress, [&](const Scene& own, const Follow& follow) { return own.inverse(given(motion), follow); });
  const auto rows = static_cast<py::ssize_t>(found.times.size());
  py::list drives;
  for (host::Inverse::Drive& drive : found.drives)
    drives.append(py::make_tuple(drive.effort_on.name, array_of(std::move(drive.effort), {rows}),
                                 array_of(std::move(drive.rate), {rows})));
  return py::make_tuple(found.json, array_of(std::move(found.times), {rows}), drives, tuple_of(std::move(found.run)));
}

}  // namespace

void bind_small_motions(py::class_<Scene>& scene) {
  scene.def("modes", &modes)
      .def("linearize", &linearize)
      .def("response", &response)
      .def("equilibrium", &equilibrium)
      .def("inverse", &inverse);
}

}  // namespace withy::python
