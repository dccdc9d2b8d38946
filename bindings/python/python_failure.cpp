#include "withy/bindings/python/python_failure.hpp"

#include <filesystem>
#include <map>
#include <thread>
#include <utility>

namespace withy::python {
namespace {

struct Raised {
  std::string text;
  py::object exception;
};

/// By the threads that asked. Touched with the interpreter held; never freed, for the interpreter may be gone before.
std::map<std::thread::id, Raised>& raised() {
  static auto* all = new std::map<std::thread::id, Raised>;
  return *all;
}

/// Where the innermost of its calls stands, " (gusts.py, line 12)"; empty where it has no traceback.
std::string place_of(py::object trace) {
  if (!trace || trace.is_none()) return {};
  while (!trace.attr("tb_next").is_none()) trace = trace.attr("tb_next");
  const auto file = trace.attr("tb_frame").attr("f_code").attr("co_filename").cast<std::string>();
  return " (" + std::filesystem::path(file).filename().string() + ", line " +
         std::to_string(trace.attr("tb_lineno").cast<int>()) + ")";
}

}  // namespace

std::string Failure::text() const {
  const std::lock_guard lock(mutex_);
  return failed_ ? text_ : std::string();
}

std::string Failure::keep(const std::string& what) {
  const std::lock_guard lock(mutex_);
  if (!failed_) text_ = "written in Python (line " + std::to_string(line_) + " of the scene), " + what;
  failed_ = true;
  return text_;
}

void Failure::note(const py::error_already_set& e, double t) {
  const std::string at = " at t = " + brief(t) + " s";
  py::object exception = e.value();
  std::string what = "raised an exception" + at;
  try {
    const auto words = py::str(exception).cast<std::string>();
    what = "raised " + py::str(e.type().attr("__name__")).cast<std::string>() + at +
           (words.empty() ? "" : ": " + words) + place_of(e.trace());
    if (e.trace()) exception.attr("__traceback__") = e.trace();
  } catch (const std::exception&) {
    PyErr_Clear();  // its text cannot be had
  }
  std::string text = keep(what);
  raised()[std::this_thread::get_id()] = {std::move(text), std::move(exception)};
  // Raised again where the call has come back. Last: whatever asks Python would raise it here.
  if (e.matches(PyExc_KeyboardInterrupt)) PyErr_SetInterrupt();
}

void Failure::note(const std::string& why, double t) {
  std::string text = keep("has failed at t = " + brief(t) + " s: " + why);
  raised()[std::this_thread::get_id()] = {std::move(text), py::reinterpret_borrow<py::object>(PyExc_ValueError)(why)};
}

py::object raised_by_load(const std::string& message) {
  const auto own = raised().extract(std::this_thread::get_id());
  if (own.empty() || message.find(own.mapped().text) == std::string::npos) return {};
  return own.mapped().exception;
}

}  // namespace withy::python
