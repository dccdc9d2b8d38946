/// \file
/// Many cases of a scene, for executors of Python.
#pragma once

#include <pybind11/pybind11.h>

namespace withy::python {

void bind_sweep(pybind11::module_& m);

}  // namespace withy::python
