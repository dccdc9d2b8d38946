/// \file
/// The parts of the extension module, and what they share.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <string_view>
#include <vector>

#include "withy/bindings/python/made.hpp"
#include "withy/host/library.hpp"
#include "withy/host/scene.hpp"

template <>
class pybind11::detail::type_caster<withy::host::Library> : public withy::python::MadeCaster<withy::host::Library> {};
template <>
class pybind11::detail::type_caster<withy::host::Scene> : public withy::python::MadeCaster<withy::host::Scene> {};

namespace withy::python {

namespace py = pybind11;
using host::Port;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline py::list names_of(const std::vector<Port>& ports) {
  py::list names;
  for (const Port& port : ports) names.append(port.name);
  return names;
}
inline py::list units_of(const std::vector<Port>& ports) {
  py::list units;
  for (const Port& port : ports) units.append(port.unit);
  return units;
}

/// What may hold the bytes of a file that is not UTF-8, for people: those as \xb0.
inline py::str readable(std::string_view text) {
  PyObject* made = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "backslashreplace");
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}
/// The name of a file as Python has such names, from which os.fsencode() makes the same bytes.
inline py::str file_name(const std::string& name) {
  PyObject* made = PyUnicode_DecodeFSDefaultAndSize(name.data(), static_cast<py::ssize_t>(name.size()));
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

/// A vector as an array, without a copy.
inline Array array_of(std::vector<double> numbers, std::vector<py::ssize_t> shape) {
  auto* kept = new std::vector<double>(std::move(numbers));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<double>*>(p); });
  return Array(std::move(shape), kept->data(), owner);
}

/// Numbers that code in Python gives, in any shape. \param what gives them, for messages
/// \throws py::error_already_set as numpy refuses them; py::value_error where it gives nothing
inline Array numbers_given(const py::object& given, const char* what) {
  // To numpy nothing is a number that is none.
  if (given.is_none()) throw py::value_error(std::string(what) + " gives None; need numbers (is a 'return' missing?)");
  return Array(given);
}

/// A run as the package's Result takes it.
py::tuple tuple_of(host::Result result);

/// Libraries, scenes, their runs and studies.
void bind_scene(py::module_& m);
/// Modes, linear models, responses, steady states, what motions take.
void bind_small_motions(py::class_<host::Scene>& scene);
/// Fits to measured data.
void bind_tune(py::class_<host::Scene>& scene);
/// Plugins of the type `python` for a library.
void admit_parts_in_python(Registry& registry);
void bind_parts_in_python(py::module_& m);
/// Many cases of a scene, for executors of Python.
void bind_sweep(py::module_& m);

}  // namespace withy::python
