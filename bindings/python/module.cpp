/// \file
/// The extension module withy._withy: what the Python package shows of withy::host. Everything that needs no speed is
/// in the package's own sources beside this file.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <system_error>
#include <utility>

#include "withy/bindings/python/bindings.hpp"
#include "withy/bindings/python/followed.hpp"
#include "withy/bindings/python/made.hpp"
#include "withy/bindings/python/one_at_a_time.hpp"
#include "withy/bindings/python/python_failure.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/host/equations.hpp"
#include "withy/host/simulation.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/results_folder.hpp"
#include "withy/study/input_error.hpp"

namespace py = pybind11;

namespace {

using withy::host::Equations;
using withy::host::Event;
using withy::host::Scene;
using withy::host::Simulation;
using withy::host::SimulationStopped;
using withy::host::Snapshot;
using withy::python::Array;
using withy::python::array_of;
using withy::python::names_of;
using withy::python::OneAtATime;
using withy::python::readable;
using withy::python::Signals;
using withy::python::units_of;

std::span<const double> span_of(const Array& a, std::size_t size, const char* what) {
  if (a.ndim() != 1 || static_cast<std::size_t>(a.size()) != size)
    throw py::value_error(std::string(what) + ": need an array of " + std::to_string(size) + " numbers");
  return {a.data(), size};
}

/// Equations that Python's threads share, one evaluation at a time.
struct SharedEquations {
  SharedEquations(const Scene& scene, const std::string& formulation) : equations(scene, formulation) {}

  Array derivatives(double t, const Array& y) {
    const std::span<const double> at = span_of(y, equations.size(), "y");
    Array y_dot(static_cast<py::ssize_t>(at.size()));
    evaluate(t, at, {y_dot.mutable_data(), at.size()});
    return y_dot;
  }
  Array derivatives_many(double t, const Array& y) {
    const std::size_t n = equations.size();
    if (y.ndim() != 2 || static_cast<std::size_t>(y.shape(1)) != n)
      throw py::value_error("y: need an array of rows of " + std::to_string(n) + " numbers");
    const auto size = static_cast<std::size_t>(y.size());
    Array y_dot({y.shape(0), y.shape(1)});
    const std::span<double> out(y_dot.mutable_data(), size);
    std::string why;
    {
      const py::gil_scoped_release released;
      const OneAtATime::Turn turn(busy);
      const withy::host::EvaluatedRows done = equations.derivatives_many(t, {y.data(), size}, out);
      if (!done.evaluation.ok()) why = "row " + std::to_string(done.rows) + ": " + equations.reason(t, done.evaluation);
    }
    if (!why.empty()) throw SimulationStopped("singular", why, t);
    return y_dot;
  }
  Array jacobian(double t, const Array& y) {
    const std::span<const double> at = span_of(y, equations.size(), "y");
    const auto n = static_cast<py::ssize_t>(at.size());
    Array J({n, n});
    const std::span<double> out(J.mutable_data(), at.size() * at.size());
    const py::gil_scoped_release released;
    const OneAtATime::Turn turn(busy);
    equations.jacobian(t, at, out);
    return J;
  }
  Array normalized(const Array& y) {
    const std::span<const double> at = span_of(y, equations.size(), "y");
    Array scaled(static_cast<py::ssize_t>(at.size()));
    const std::span<double> out(scaled.mutable_data(), at.size());
    std::copy(at.begin(), at.end(), out.begin());
    // Who holds the lock may need the interpreter, for a load in Python.
    const py::gil_scoped_release released;
    const OneAtATime::Turn turn(busy);
    equations.normalize(out);
    return scaled;
  }
  void evaluate(double t, std::span<const double> y, std::span<double> y_dot) {
    std::string why;
    {
      const py::gil_scoped_release released;
      const OneAtATime::Turn turn(busy);
      const withy::Evaluation evaluation = equations.derivatives(t, y, y_dot);
      if (evaluation.ok()) return;
      why = equations.reason(t, evaluation);
    }
    throw SimulationStopped("singular", why, t);
  }

  Equations equations;
  OneAtATime busy;
};

/// A simulation that Python's threads share, one step at a time.
struct SharedSimulation {
  explicit SharedSimulation(const Scene& scene) : simulation(scene, [this] { return signals.pending(); }) {}

  template <class Act>
  auto call(Act&& act) {
    try {
      const py::gil_scoped_release released;
      const OneAtATime::Turn turn(busy);
      signals.begin();
      return act(simulation);
    } catch (const SimulationStopped&) {
      signals.raise();
      withy::python::raise_signals();
      throw;
    }
  }
  /// What only reads, and what a law may therefore ask of the simulation that calls it.
  template <class Act>
  auto look(Act&& act) {
    if (busy.mine()) return act(std::as_const(simulation));
    const py::gil_scoped_release released;
    const OneAtATime::Turn turn(busy);
    return act(std::as_const(simulation));
  }

  Signals signals;
  Simulation simulation;
  OneAtATime busy;
};

}  // namespace

template <>
class pybind11::detail::type_caster<SharedEquations> : public withy::python::MadeCaster<SharedEquations> {};
template <>
class pybind11::detail::type_caster<SharedSimulation> : public withy::python::MadeCaster<SharedSimulation> {};
template <>
class pybind11::detail::type_caster<Snapshot> : public withy::python::MadeCaster<Snapshot> {};

namespace {

/// Raises an exception of the package.
template <class... Arguments>
void raise(const char* name, Arguments&&... arguments) {
  const py::object type = py::module_::import("withy._errors").attr(name);
  const py::object error = type(std::forward<Arguments>(arguments)...);
  PyErr_SetObject(type.ptr(), error.ptr());
}

/// From what a load written in Python raised, where that is the reason.
void raise_stopped(const SimulationStopped& e) {
  const py::object cause = withy::python::raised_by_load(e.what());
  const py::object error =
      py::module_::import("withy._errors").attr("SimulationStopped")(readable(e.what()), e.status(), e.time());
  if (cause) PyException_SetCause(error.ptr(), cause.inc_ref().ptr());
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const withy::SceneError& e) {
    raise("SceneError", readable(e.what()));
  } catch (const withy::study::InputError& e) {
    raise("SceneError", readable(e.what()));
  } catch (const withy::PluginError& e) {
    raise("PluginError", readable(e.what()));
  } catch (const SimulationStopped& e) {
    raise_stopped(e);
  } catch (const withy::ResultsError& e) {
    raise("StoreError", readable(e.what()));
  } catch (const withy::FolderBusy& e) {
    raise("StoreError", readable(e.what()));
  } catch (const std::out_of_range& e) {
    PyErr_SetObject(PyExc_KeyError, readable(e.what()).ptr());
  } catch (const std::system_error& e) {
    const py::object error = py::reinterpret_borrow<py::object>(PyExc_OSError)(e.code().value(), readable(e.what()));
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
  }
}

void bind_equations(py::module_& m) {
  using E = SharedEquations;
  py::class_<E>(m, "Equations")
      .def(py::init<const Scene&, const std::string&>())
      .def("derivatives", &E::derivatives, py::arg("t"), py::arg("y"),
           "derivatives(t, y) -> numpy.ndarray\n\nTime derivative of y [n] at the time t [s]; the interpreter is free "
           "meanwhile.\n\nRaises:\n"
           "    SimulationStopped: where the mass matrix cannot be solved or something is not finite.\n"
           "    ValueError: where y has another shape.")
      .def("derivatives_many", &E::derivatives_many, py::arg("t"), py::arg("y"),
           "derivatives_many(t, y) -> numpy.ndarray\n\nTime derivatives [m, n] of the m states in the rows of y [m, n] "
           "at the time t [s], four or eight at once where the formulation is symmetric and every hinge has one rate. "
           "A row gets the same bits whatever the others, and agrees with derivatives(t, row) to rounding.\n\nRaises:\n"
           "    SimulationStopped: with the number of the first row that cannot be evaluated.\n"
           "    ValueError: where y has another shape.")
      .def("jacobian", &E::jacobian, py::arg("t"), py::arg("y"),
           "jacobian(t, y) -> numpy.ndarray\n\nDerivatives [n, n] of derivatives(t, y) with respect to y [n], in SI "
           "units; exact, but for parts that loads leave to differences; with respect to a quaternion along its unit "
           "sphere, but for its own rate, which is linear in all four of its components.\n\nRaises:\n    "
           "SimulationStopped, ValueError: as derivatives() does.")
      .def("normalize", &E::normalized, py::arg("y"),
           "normalize(y) -> numpy.ndarray\n\ny [n] with its quaternions scaled to unit length and its loops closed, a "
           "copy.\n\n"
           "Raises:\n    ValueError: where y has another shape, or no state near by closes the loops.")
      .def_property_readonly(
          "names", [](const E& e) { return names_of(e.equations.states()); },
          "Names of the numbers of y, as those of the result columns.")
      .def_property_readonly(
          "units", [](const E& e) { return units_of(e.equations.states()); },
          "Their SI units; empty for modal coordinates.")
      .def_property_readonly(
          "t0", [](const E& e) { return e.equations.t0(); }, "Initial time [s].")
      .def_property_readonly(
          "y0",
          [](const E& e) {
            const std::vector<double>& y0 = e.equations.y0();
            return array_of(y0, {static_cast<py::ssize_t>(y0.size())});
          },
          "Initial state of the scene [n], a copy.")
      .def("_input_names", [](const E& e) { return names_of(e.equations.inputs()); })
      .def("_input_units", [](const E& e) { return units_of(e.equations.inputs()); })
      .def("_input", [](const E& e, std::size_t i) { return e.equations.input(i); })
      .def("_set_input", [](E& e, std::size_t i, double value) {
        const py::gil_scoped_release released;
        const OneAtATime::Turn turn(e.busy);
        e.equations.set_input(i, value);
      });
}

void bind_simulation(py::module_& m) {
  py::class_<Snapshot>(m, "Snapshot", "Everything that the steps of a Simulation to come depend on. Can be pickled.")
      .def_property_readonly("time", &Snapshot::time, "[s]")
      .def(py::pickle(
          [](const Snapshot& s) { return py::make_tuple(s.numbers()); },
          [](const py::tuple& state) { return Snapshot::of_numbers(state[0].cast<std::vector<double>>()); }));
  using S = SharedSimulation;
  py::class_<S>(m, "Simulation")
      .def(py::init<const Scene&>())
      .def_property_readonly(
          "time", [](S& s) { return s.look([](const Simulation& own) { return own.time(); }); }, "Present time [s].")
      .def(
          "step", [](S& s, double t) { s.call([t](Simulation& own) { own.step(t); }); }, py::arg("t"),
          "step(t) -> None\n\nIntegrates to the time t [s] and lands on it exactly, passing events on the way.\n\n"
          "Raises:\n    SimulationStopped: with the physical reason where it cannot go on; it stands at its last "
          "accepted state, and each step raises the same until restore().\n"
          "    ValueError: where t lies before the present time or is not finite.")
      .def(
          "advance_to", [](S& s, double t) { return s.call([t](Simulation& own) { return own.advance_to(t); }); },
          py::arg("t"),
          "advance_to(t) -> bool\n\nAs step(), but halts at an event with `stop: true` that comes first. Returns "
          "whether t [s] is reached: False also where such an event is at t itself.\n\nRaises:\n    SimulationStopped, "
          "ValueError: as step() does.")
      .def(
          "snapshot", [](S& s) { return s.call([](Simulation& own) { return own.snapshot(); }); },
          "snapshot() -> Snapshot\n\nWhat restore() goes back to.\n\nRaises:\n    SimulationStopped: as step() did, "
          "where it "
          "cannot go on: nothing goes on from there.")
      .def(
          "restore", [](S& s, const Snapshot& to) { s.call([&to](Simulation& own) { own.restore(to); }); },
          py::arg("snapshot"),
          "restore(snapshot) -> None\n\nGoes on from there bit by bit as the simulation did that made it, with the "
          "same inputs and times.\n\nRaises:\n    ValueError: where the snapshot is of another scene; nothing changes "
          "then.")
      .def_property_readonly(
          "state", [](S& s) { return s.call([](Simulation& own) { return own.state(); }); },
          "The present state as JSON text, in the form of `initial` in a scene.")
      .def_property_readonly(
          "evaluations", [](S& s) { return s.look([](const Simulation& own) { return own.evaluations(); }); },
          "Evaluations of the equations of motion so far.")
      .def_property_readonly(
          "events",
          [](S& s) {
            const std::vector<Event> last = s.look([](const Simulation& own) { return own.events(); });
            py::list events;
            for (const Event& e : last) events.append(py::make_tuple(e.name, e.time, e.direction));
            return events;
          },
          "Events of the last step: tuples of name, time [s] and direction (+1 from below, -1 from "
          "above).")
      .def("_input_names", [](const S& s) { return names_of(s.simulation.inputs()); })
      .def("_input_units", [](const S& s) { return units_of(s.simulation.inputs()); })
      .def("_output_names", [](const S& s) { return names_of(s.simulation.outputs()); })
      .def("_output_units", [](const S& s) { return units_of(s.simulation.outputs()); })
      .def("_input", [](S& s, std::size_t i) { return s.call([i](Simulation& own) { return own.input(i); }); })
      .def("_set_input",
           [](S& s, std::size_t i, double x) { s.call([i, x](Simulation& own) { own.set_input(i, x); }); })
      .def("_output", [](S& s, std::size_t i) { return s.call([i](Simulation& own) { return own.output(i); }); })
      .def("_outputs", [](S& s) {
        return s.call([](Simulation& own) {
          const auto now = own.output_values();
          return std::vector<double>(now.begin(), now.end());
        });
      });
}

}  // namespace

PYBIND11_MODULE(_withy, m) {
  m.doc() = "The engine of the package withy.";
  py::register_exception_translator(&translate);
  withy::python::bind_scene(m);
  bind_equations(m);
  bind_simulation(m);
  withy::python::bind_sweep(m);
  withy::python::bind_parts_in_python(m);
}
