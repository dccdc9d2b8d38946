#include "withy/host/scene.hpp"

#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <utility>

#include "withy/bindings/python/bindings.hpp"
#include "withy/bindings/python/followed.hpp"
#include "withy/bindings/python/python_failure.hpp"
#include "withy/results/hdf5_recorder.hpp"
#include "withy/results/output_file.hpp"
#include "withy/scene/scene.hpp"

namespace withy::python {
namespace {

using host::Follow;
using host::Library;
using host::LibraryOptions;
using host::Result;
using host::Scene;

py::tuple run(const Scene& scene, const py::object& progress) {
  return tuple_of(of_a_copy(scene, progress, [](const Scene& own, const Follow& follow) { return own.run(follow); }));
}

/// The table of a run as results.h5 has it.
void write_hdf5(const std::filesystem::path& path, const std::vector<std::string>& names,
                const std::vector<std::string>& units, const Array& table,
                const std::vector<std::pair<std::string, std::string>>& descriptions) {
  if (const std::string missing = withy::hdf5_missing(); !missing.empty()) throw std::runtime_error(missing);
  std::vector<withy::Column> columns;
  for (std::size_t c = 0; c < names.size(); ++c) columns.push_back({names[c], units[c]});
  withy::Part part(path);  // a disk that is full leaves the file that was there
  auto file = withy::make_hdf5_recorder(part.path());
  file->begin(columns);
  for (py::ssize_t row = 0; row < table.shape(0); ++row) file->row({table.data(row, 0), columns.size()});
  for (const auto& [name, text] : descriptions) file->describe(name, text);
  file->end();
  part.finish();
}

/// The plugins, with loads and bodies in Python; remarks go to a function, or nowhere.
Library open_library(std::vector<std::filesystem::path> plugins, const py::object& log) {
  LibraryOptions options{std::move(plugins), {}};
  if (!log.is_none())
    options.log = [log](std::string_view remark) {
      const py::gil_scoped_acquire held;
      try {
        log(readable(remark));
      } catch (py::error_already_set& e) {
        e.discard_as_unraisable("withy's log");
      }
    };
  Library made(std::move(options));
  admit_parts_in_python(made.registry());
  return made;
}

}  // namespace

py::tuple tuple_of(Result result) {
  const auto rows = static_cast<py::ssize_t>(result.rows()), columns = static_cast<py::ssize_t>(result.columns.size());
  const py::object cause = raised_by_load(result.message);
  return py::make_tuple(result.status, result.message, names_of(result.columns), units_of(result.columns),
                        array_of(std::move(result.values), {rows, columns}), result.json, cause ? cause : py::none());
}

void bind_scene(py::module_& m) {
  py::class_<Library>(m, "Library")
      .def(py::init(&open_library), py::arg("plugins"), py::arg("log"))
      .def("schema", [](const Library& l) {
        return withy::schema(l.registry(), [&l](const std::string& why) { l.log("left out: " + why); });
      });
  const auto axes = [](const std::vector<std::string>& formulations, const std::vector<std::string>& families,
                       const std::vector<int>& modes, const std::vector<std::string>& integrators,
                       const std::vector<double>& tolerances) {
    return Scene::Axes{formulations, families, modes, integrators, tolerances};
  };
  using Names = std::vector<std::string>;
  m.def("write_hdf5", &write_hdf5);
  py::class_<Scene> scene(m, "Scene");
  bind_small_motions(scene);
  bind_tune(scene);
  scene.def_static("read", &Scene::read)
      .def_static("parse", [](const Library& l, const std::string& text,
                              const std::string& name) { return Scene::parse(l, text, name); })
      .def_static("parse", [](const Library& l, const std::string& text, const std::string& name,
                              const std::string& folder) { return Scene::parse(l, text, name, folder); })
      .def("copy", [](const Scene& s) { return Scene(s); })
      .def("set", [](Scene& s, const std::string& path, const std::string& text) { s.set(path, text); })
      // Of a copy too: a body in Python is asked for its shape, and another thread may have its turn there.
      .def("check", [](const Scene& s) { Scene(s).check(); })
      .def_property_readonly("text", &Scene::text)
      .def_property_readonly("name", [](const Scene& s) { return file_name(s.name()); })
      .def_property_readonly("changes", &Scene::changes)
      .def_property_readonly("folder", [](const Scene& s) { return file_name(s.folder()); })
      .def("run", &run)
      .def("compare",
           [](const Scene& s, const Names& formulations, const std::string& reference, const Names& outputs,
              const py::object& progress) {
             return of_a_copy(s, progress, [&](const Scene& own, const Follow& f) {
               return own.compare(formulations, reference, f, outputs);
             });
           })
      .def("trade",
           [axes](const Scene& s, const Names& outputs, const Names& formulations, const Names& families,
                  const std::vector<int>& modes, const Names& integrators, const std::vector<double>& tolerances,
                  std::size_t jobs, const py::object& progress) {
             return of_a_copy(s, progress, [&](const Scene& own, const Follow& f) {
               return own.trade(axes(formulations, families, modes, integrators, tolerances), jobs, f, outputs);
             });
           })
      .def("advise",
           [axes](const Scene& s, const std::string& accuracy, const Names& outputs, const Names& formulations,
                  const Names& families, const std::vector<int>& modes, const Names& integrators,
                  const std::vector<double>& tolerances, std::optional<double> seconds, const py::object& progress) {
             return of_a_copy(s, progress, [&](const Scene& own, const Follow& f) {
               return own.advise(accuracy, outputs, axes(formulations, families, modes, integrators, tolerances), f,
                                 seconds);
             });
           })
      .def_property_readonly("values", [](const Scene& s) { return Scene(s).values(); });
}

}  // namespace withy::python
