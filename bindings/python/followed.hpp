/// \file
/// Calls that take long: without the interpreter, ended by Ctrl-C, heard of by a function of Python.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "withy/host/scene.hpp"

namespace withy::python {

namespace py = pybind11;

/// Lets Python handle signals while a call goes on, some twenty times a second: Ctrl-C ends the call, and what its
/// handler raised is raised when the call is back. The calling thread alone asks Python; others of a study follow it.
class Signals {
 public:
  /// By the thread that calls from now on.
  void begin() {
    caller_ = std::this_thread::get_id();
    asked_ = Clock::now();
  }
  bool pending() {
    if (ended_ || std::this_thread::get_id() != caller_) return ended_;
    const auto now = Clock::now();
    if (now - asked_ < std::chrono::milliseconds(50)) return false;
    asked_ = now;
    const py::gil_scoped_acquire held;
    if (PyErr_CheckSignals() == 0) return false;
    raised_.emplace();
    return ended_ = true;
  }
  /// With the interpreter held.
  void raise() {
    ended_ = false;
    if (auto raised = std::exchange(raised_, std::nullopt)) throw std::move(*raised);
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::thread::id caller_;
  Clock::time_point asked_;
  std::atomic<bool> ended_ = false;
  std::optional<py::error_already_set> raised_;
};

/// Raises what a signal's handler raises that nobody has called yet, as of an interrupt that came while a law in Python
/// was at work. With the interpreter held.
inline void raise_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// Calls `act` without the interpreter. Ctrl-C ends it, and so does what `progress` raises.
template <class Act>
auto followed(const py::object& progress, Act&& act) {
  Signals signals;
  signals.begin();
  std::optional<py::error_already_set> failed;
  std::atomic<bool> over = false;  // read by all threads of a study
  host::Follow follow;
  follow.interrupted = [&] { return over || signals.pending(); };
  if (!progress.is_none())
    follow.progress = [&](double done, double all) {
      const py::gil_scoped_acquire held;
      if (failed) return;
      try {
        progress(done, all);
      } catch (py::error_already_set& e) {
        failed.emplace(std::move(e));
        over = true;
      }
    };
  const auto raise = [&] {
    signals.raise();
    if (failed) throw std::move(*failed);
    raise_signals();
  };
  try {
    auto result = [&] {
      const py::gil_scoped_release released;
      return act(std::as_const(follow));
    }();
    raise();
    return result;
  } catch (const py::error_already_set&) {
    throw;
  } catch (...) {
    raise();  // why it ended
    throw;
  }
}

/// Calls `act` without the interpreter, with a copy of the scene: another thread of Python may set values of the scene
/// itself meanwhile.
template <class Act>
auto of_a_copy(const host::Scene& scene, const py::object& progress, Act&& act) {
  const host::Scene own(scene);
  return followed(progress, [&](const host::Follow& follow) { return act(own, follow); });
}

}  // namespace withy::python
