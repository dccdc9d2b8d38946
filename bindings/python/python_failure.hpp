/// \file
/// What code in Python has raised in the middle of a simulation, which stops with its words.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <mutex>
#include <string>

#include "withy/core/simulation/diagnosis.hpp"

namespace withy::python {

namespace py = pybind11;

/// The failure of one load, its first: what it then gives means nothing, and the run is to stop.
class Failure {
 public:
  /// \param line of the load in the text of its scene
  explicit Failure(int line) : line_(line) {}
  [[nodiscard]] bool any() const { return failed_; }
  void forget() { failed_ = false; }
  /// "written in Python (line 13 of the scene), raised ValueError at t = 0.31 s: no wind (gusts.py, line 12)"; empty:
  /// it has not failed.
  [[nodiscard]] std::string text() const;
  /// With the interpreter held. \param t [s] at which it was asked
  void note(const py::error_already_set& e, double t);
  /// What it gives cannot be. \param why a clause
  void note(const std::string& why, double t);

 private:
  std::string keep(const std::string& what);

  int line_;
  mutable std::mutex mutex_;
  std::atomic<bool> failed_ = false;
  std::string text_;
};

/// The exception that a load raised in this thread last, with its traceback, where its words are in the message of a
/// bad end; null where they are not. With the interpreter held.
py::object raised_by_load(const std::string& message);

/// Calls Python at the time t; what it raises is noted, and false returned.
template <class Act>
bool guarded_call(Failure& failure, double t, Act&& act) noexcept {
  const py::gil_scoped_acquire held;
  try {
    act();
    return true;
  } catch (const py::error_already_set& e) {
    failure.note(e, t);
  } catch (const std::exception& e) {
    failure.note(e.what(), t);
  }
  return false;
}

}  // namespace withy::python
