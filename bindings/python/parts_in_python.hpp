/// \file
/// Loads and bodies whose objects are of Python.
#pragma once

#include <memory>

#include "withy/bindings/python/bindings.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy::python {

/// The object that a part of a scene names, with the interpreter held; null after a report.
const py::object* object_of(const Value& p, const MakeContext& context);
/// The body that an object's `shape()` describes; null after a report.
std::unique_ptr<Body> make_python_body(const Value& p, const MakeContext& context);

}  // namespace withy::python
