#include <pybind11/stl.h>

#include <utility>

#include "withy/bindings/python/bindings.hpp"
#include "withy/bindings/python/followed.hpp"
#include "withy/bindings/python/made.hpp"
#include "withy/campaign/cases.hpp"
#include "withy/campaign/plan.hpp"
#include "withy/campaign/sweep_page.hpp"
#include "withy/campaign/sweep_run.hpp"
#include "withy/host/library.hpp"

namespace withy::python {
namespace {

/// A plan with its store, read and opened once in a process, which then runs any of its shards.
class OpenSweep {
 public:
  /// \param plugin_folders those of the library, for commands that repeat a case
  OpenSweep(host::Library library, const std::string& plan, const std::string& store, bool anew,
            std::vector<std::string> plugin_folders)
      : library_(std::move(library)),
        plan_(campaign::read_plan(plan, library_.registry(), std::move(plugin_folders))),
        store_(store, plan_, anew) {}

  [[nodiscard]] std::string fingerprint() const { return plan_.fingerprint; }
  [[nodiscard]] std::uint64_t size() const { return campaign::Cases(plan_).size(); }

  /// Cases of the shard, those that were done before, those that ran now; why the sweep stops here, if it does.
  py::tuple run(std::uint64_t shard, std::uint64_t shards, std::size_t jobs, const py::object& progress) const {
    const campaign::SweepOutcome outcome = followed(progress, [&](const host::Follow& follow) {
      const campaign::SweepSettings settings{jobs, shard, shards, {follow.interrupted, follow.progress}};
      return campaign::run_sweep(plan_, library_.registry(), store_, settings);
    });
    const bool stops = plan_.stop_on_failure && outcome.failure;
    return py::make_tuple(outcome.cases, outcome.before, outcome.ran,
                          stops ? py::object(py::str(outcome.failure->message)) : py::none());
  }

 private:
  host::Library library_;
  campaign::Plan plan_;
  campaign::Store store_;
};

/// Writes the tables of a store: how many cases it has, how many are done, have failed.
py::tuple collect(const std::string& store) {
  const py::gil_scoped_release released;
  const campaign::Collected collected = campaign::collect(store);
  campaign::write_sweep_page(store, collected);
  const py::gil_scoped_acquire held;
  return py::make_tuple(collected.cases, collected.done, collected.failed);
}

}  // namespace
}  // namespace withy::python

template <>
class pybind11::detail::type_caster<withy::python::OpenSweep>
    : public withy::python::MadeCaster<withy::python::OpenSweep> {};

namespace withy::python {

void bind_sweep(py::module_& m) {
  py::class_<OpenSweep>(m, "Sweep")
      .def(py::init<host::Library, const std::string&, const std::string&, bool, std::vector<std::string>>())
      .def_property_readonly("fingerprint", &OpenSweep::fingerprint)
      .def_property_readonly("size", &OpenSweep::size)
      .def("run", &OpenSweep::run);
  m.def("collect", &collect);
}

}  // namespace withy::python
