/// \file
/// Simulations and their snapshots in C.
#include <algorithm>

#include "withy/bindings/c/handles.hpp"

namespace host = withy::host;

using withy::c::good;
using withy::c::guarded;
using withy::c::make;
using withy::c::need;
using withy::c::need_size;
using withy::c::port_at;

withy_status withy_simulation_create(withy_scene* scene, withy_simulation** simulation) {
  return make(scene, simulation, [&] { return host::Simulation(scene->value); });
}

double withy_simulation_time(const withy_simulation* s) { return good(s) ? s->value.time() : 0; }
size_t withy_simulation_inputs(const withy_simulation* s) { return good(s) ? s->value.inputs().size() : 0; }
size_t withy_simulation_outputs(const withy_simulation* s) { return good(s) ? s->value.outputs().size() : 0; }
withy_port withy_simulation_input_port(const withy_simulation* s, size_t index) {
  return good(s) ? port_at(s->value.inputs(), index) : withy_port{nullptr, nullptr};
}
withy_port withy_simulation_output_port(const withy_simulation* s, size_t index) {
  return good(s) ? port_at(s->value.outputs(), index) : withy_port{nullptr, nullptr};
}

withy_status withy_simulation_input_index(withy_simulation* s, const char* name, size_t* index) {
  return guarded(s, [&] {
    need(name != nullptr && index != nullptr, "need a name and a place for the index");
    *index = s->value.input_index(name);
  });
}

withy_status withy_simulation_output_index(withy_simulation* s, const char* name, size_t* index) {
  return guarded(s, [&] {
    need(name != nullptr && index != nullptr, "need a name and a place for the index");
    *index = s->value.output_index(name);
  });
}

withy_status withy_simulation_set_input(withy_simulation* s, size_t index, double value) {
  return guarded(s, [&] {
    need(index < s->value.inputs().size(), "there is no input of that index");
    s->value.set_input(index, value);
  });
}

withy_status withy_simulation_input(withy_simulation* s, size_t index, double* value) {
  return guarded(s, [&] {
    need(value != nullptr, "need a place for the value");
    need(index < s->value.inputs().size(), "there is no input of that index");
    *value = s->value.input(index);
  });
}

withy_status withy_simulation_output(withy_simulation* s, size_t index, double* value) {
  return guarded(s, [&] {
    need(value != nullptr, "need a place for the value");
    need(index < s->value.outputs().size(), "there is no output of that index");
    *value = s->value.output(index);
  });
}

withy_status withy_simulation_output_values(withy_simulation* s, double* values, size_t count) {
  return guarded(s, [&] {
    need(values != nullptr, "need an array");
    const auto now = s->value.output_values();
    need_size(count, now.size(), "values");
    std::copy(now.begin(), now.end(), values);
  });
}

withy_status withy_simulation_step(withy_simulation* s, double t) {
  return guarded(s, [&] { s->value.step(t); });
}

withy_status withy_simulation_advance_to(withy_simulation* s, double t, int* reached) {
  return guarded(s, [&] {
    const bool there = s->value.advance_to(t);
    if (reached != nullptr) *reached = there ? 1 : 0;
  });
}

const char* withy_simulation_state(withy_simulation* s) {
  return guarded(s, [&] { s->state = s->value.state(); }) == WITHY_OK ? s->state.c_str() : nullptr;
}

withy_status withy_simulation_snapshot(withy_simulation* s, withy_snapshot** snapshot) {
  return make(s, snapshot, [&] { return s->value.snapshot(); });
}

withy_status withy_simulation_restore(withy_simulation* s, const withy_snapshot* snapshot) {
  return guarded(s, [&] {
    need(good(snapshot), "need a snapshot");
    s->value.restore(snapshot->value);
  });
}
