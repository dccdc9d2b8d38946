/// \file
/// Objects that nobody has made: Simulation.__new__(Simulation) without __init__.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace withy::python {

/// What arguments and `self` are taken by where they are a T: pybind11 gives an object without a T uninitialized memory
/// for one, and whatever reads it fails or crashes. Of each class that Python can make, as
/// `template <> class pybind11::detail::type_caster<T> : public withy::python::MadeCaster<T> {};`, ahead of its use.
template <class T>
class MadeCaster : public pybind11::detail::type_caster_base<T> {
 public:
  /// \throws pybind11::type_error where the object has no T
  bool load(pybind11::handle source, bool convert) {
    const pybind11::detail::type_info* type = this->typeinfo;
    if (source && type != nullptr && PyType_IsSubtype(Py_TYPE(source.ptr()), type->type) != 0) {
      auto* object = reinterpret_cast<pybind11::detail::instance*>(source.ptr());
      if (!object->get_value_and_holder(type).holder_constructed())
        throw pybind11::type_error(std::string(Py_TYPE(source.ptr())->tp_name) +
                                   ".__init__() has not made this object");
    }
    return pybind11::detail::type_caster_base<T>::load(source, convert);
  }
};

}  // namespace withy::python
