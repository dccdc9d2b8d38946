/// \file
/// Equations of motion in C.
#include <algorithm>

#include "withy/bindings/c/handles.hpp"

namespace host = withy::host;

using withy::c::good;
using withy::c::guarded;
using withy::c::make;
using withy::c::need;
using withy::c::need_size;
using withy::c::port_at;

withy_status withy_equations_create(withy_scene* scene, const char* formulation, withy_equations** equations) {
  return make(scene, equations,
              [&] { return host::Equations(scene->value, formulation == nullptr ? "" : formulation); });
}

withy_status withy_equations_copy(withy_equations* equations, withy_equations** copy) {
  return make(equations, copy, [&] { return equations->value; });
}

size_t withy_equations_size(const withy_equations* e) { return good(e) ? e->value.size() : 0; }
withy_port withy_equations_state_port(const withy_equations* e, size_t index) {
  return good(e) ? port_at(e->value.states(), index) : withy_port{nullptr, nullptr};
}

withy_status withy_equations_initial(withy_equations* e, double* t0, double* y0, size_t count) {
  return guarded(e, [&] {
    need(y0 != nullptr, "need an array");
    need_size(count, e->value.size(), "y0");
    std::copy(e->value.y0().begin(), e->value.y0().end(), y0);
    if (t0 != nullptr) *t0 = e->value.t0();
  });
}

withy_status withy_equations_set_input(withy_equations* e, const char* name, double value) {
  return guarded(e, [&] {
    need(name != nullptr, "need a name");
    e->value.set_input(name, value);
  });
}

withy_status withy_equations_derivatives(withy_equations* e, double t, const double* y, double* y_dot, size_t count) {
  return guarded(e, [&] {
    need(y != nullptr && y_dot != nullptr, "need two arrays");
    const withy::Evaluation evaluation = e->value.derivatives(t, {y, count}, {y_dot, count});
    if (!evaluation.ok()) throw host::SimulationStopped("singular", e->value.reason(t, evaluation), t);
  });
}

withy_status withy_equations_jacobian(withy_equations* e, double t, const double* y, size_t count, double* jacobian) {
  return guarded(e, [&] {
    need(y != nullptr && jacobian != nullptr, "need two arrays");
    e->value.jacobian(t, {y, count}, {jacobian, count * count});
  });
}

withy_status withy_equations_normalize(withy_equations* e, double* y, size_t count) {
  return guarded(e, [&] {
    need(y != nullptr, "need an array");
    e->value.normalize({y, count});
  });
}
