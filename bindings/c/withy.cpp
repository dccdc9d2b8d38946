/// \file
/// The C interface on withy::host.
#include "withy/bindings/c/withy.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <map>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "withy/core/plugin/registry.hpp"
#include "withy/host/equations.hpp"
#include "withy/host/simulation.hpp"

namespace {

namespace host = withy::host;

enum class Kind : std::uint64_t {
  none = 0x6465617377697468,  // of handles that have ended
  library = 0x7769746879000001,
  scene,
  result,
  simulation,
  snapshot,
  equations
};

/// Why the last call of each thread with one handle failed.
class ErrorsOfThreads {
 public:
  /// That of the calling thread; null where none of its calls has failed yet. It stays where it is.
  std::string* find() noexcept {
    if (!any_.load(std::memory_order_relaxed)) return nullptr;  // a thread sees at least what it has set itself
    const std::lock_guard lock(mutex_);
    const auto found = texts_.find(std::this_thread::get_id());
    return found == texts_.end() ? nullptr : &found->second;
  }
  /// \throws std::bad_alloc
  std::string& make() {
    const std::lock_guard lock(mutex_);
    any_.store(true, std::memory_order_relaxed);
    return texts_[std::this_thread::get_id()];
  }

 private:
  std::mutex mutex_;
  std::map<std::thread::id, std::string> texts_;
  std::atomic<bool> any_ = false;
};

/// What every handle begins with.
class Handle {
 public:
  explicit Handle(Kind k) : kind(k) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  virtual ~Handle() { *const_cast<volatile Kind*>(&kind) = Kind::none; }  // kept, though nothing reads it

  [[nodiscard]] const char* error() const noexcept {
    const std::string* text = is_shared() ? errors_.find() : &error_;
    return text == nullptr ? "" : text->c_str();
  }
  void forget_error() const noexcept {
    std::string* text = is_shared() ? errors_.find() : &error_;
    if (text != nullptr && !text->empty()) text->clear();
  }
  /// Where there is no memory for it there is none.
  void tell(std::initializer_list<const char*> why) const noexcept {
    forget_error();
    try {
      std::string& text = is_shared() ? errors_.make() : error_;
      for (const char* part : why) text += part;
    } catch (...) {
      forget_error();
    }
  }

  Kind kind;

 private:
  /// Threads use it at the same time; another handle goes from one thread to the next, and its error with it.
  [[nodiscard]] bool is_shared() const noexcept { return kind == Kind::library || kind == Kind::scene; }

  mutable std::string error_;
  mutable ErrorsOfThreads errors_;
};

template <class T, Kind which>
struct Holding : Handle {
  explicit Holding(T made) : Handle(which), value(std::move(made)) {}
  static constexpr Kind its_kind = which;
  T value;
};

}  // namespace

struct withy_library : Holding<host::Library, Kind::library> {
  using Holding::Holding;
};
struct withy_scene : Holding<host::Scene, Kind::scene> {
  using Holding::Holding;
};
struct withy_result : Holding<host::Result, Kind::result> {
  using Holding::Holding;
};
struct withy_simulation : Holding<host::Simulation, Kind::simulation> {
  using Holding::Holding;
  std::string state;
};
struct withy_snapshot : Holding<host::Snapshot, Kind::snapshot> {
  using Holding::Holding;
};
struct withy_equations : Holding<host::Equations, Kind::equations> {
  using Holding::Holding;
};

namespace {

/// Null, one that has ended (as far as its memory still shows it), or one of another kind is no handle.
template <class H>
bool good(const H* handle) {
  return handle != nullptr && handle->kind == H::its_kind;
}

/// Thrown for what WITHY_BAD_USE stands for.
struct BadUse : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void need(bool condition, const char* otherwise) {
  if (!condition) throw BadUse(otherwise);
}
void need_size(std::size_t got, std::size_t least, const char* array) {
  if (got != least)
    throw BadUse(std::string(array) + ": got an array of " + std::to_string(got) + " numbers; need " +
                 std::to_string(least));
}

/// What a handle is; null of none.
const char* name_of(Kind kind) {
  constexpr std::array names = {"library", "scene", "result", "simulation", "snapshot", "equations"};
  const std::uint64_t number = static_cast<std::uint64_t>(kind) - static_cast<std::uint64_t>(Kind::library);
  return number < names.size() ? names[number] : nullptr;
}

/// The handle of another kind says so, where it is one.
void refuse(const Handle* handle, Kind wanted) noexcept {
  if (handle != nullptr && name_of(handle->kind) != nullptr)
    handle->tell({"got a handle of another kind, '", name_of(handle->kind), "'; need '", name_of(wanted), "'"});
}

/// Does what a function is for; whatever it throws becomes a status and the handle's error.
template <class H, class Act>
withy_status guarded(H* handle, Act&& act) noexcept {
  if (!good(handle)) {
    refuse(handle, H::its_kind);
    return WITHY_BAD_USE;
  }
  const auto fail = [&](withy_status status, const char* why) {
    handle->tell({why});
    return status;
  };
  try {
    handle->forget_error();
    act();
    return WITHY_OK;
  } catch (const host::SimulationStopped& e) {
    return fail(WITHY_STOPPED, e.what());
  } catch (const BadUse& e) {
    return fail(WITHY_BAD_USE, e.what());
  } catch (const std::logic_error& e) {  // names, indices, numbers
    return fail(WITHY_BAD_USE, e.what());
  } catch (const withy::PluginError& e) {
    return fail(WITHY_ENVIRONMENT, e.what());
  } catch (const std::system_error& e) {
    return fail(WITHY_ENVIRONMENT, e.what());
  } catch (const std::bad_alloc&) {
    return fail(WITHY_ENVIRONMENT, "memory has run out");
  } catch (const std::exception& e) {
    return fail(WITHY_BAD_INPUT, e.what());
  } catch (...) {
    return fail(WITHY_ENVIRONMENT, "a plugin has thrown what is no exception of the standard library");
  }
}

/// Makes a handle of another.
template <class Made, class H, class Make>
withy_status make(H* from, Made** target, Make&& function) noexcept {
  return guarded(from, [&] {
    need(target != nullptr, "need a place for the handle");
    *target = nullptr;
    *target = new Made(function());
  });
}

withy_port port_at(const std::vector<host::Port>& ports, std::size_t index) {
  if (index >= ports.size()) return {nullptr, nullptr};
  return {ports[index].name.c_str(), ports[index].unit.c_str()};
}

}  // namespace

const char* withy_version(void) { return WITHY_VERSION; }

const char* withy_error(const void* handle) {
  return handle == nullptr ? "the handle is null" : static_cast<const Handle*>(handle)->error();
}

void withy_free(void* handle) { delete static_cast<Handle*>(handle); }

withy_status withy_library_create(const withy_library_options* options, withy_library** library) {
  if (library == nullptr) return WITHY_BAD_USE;
  *library = nullptr;
  if (options != nullptr) {
    if (options->size < sizeof(withy_library_options)) return WITHY_BAD_USE;
    if (options->plugin_count > 0 && options->plugins == nullptr) return WITHY_BAD_USE;
    for (std::size_t i = 0; i < options->plugin_count; ++i)
      if (options->plugins[i] == nullptr) return WITHY_BAD_USE;
  }
  try {
    host::LibraryOptions own;
    if (options != nullptr) {
      for (std::size_t i = 0; i < options->plugin_count; ++i) own.plugins.emplace_back(options->plugins[i]);
      if (options->log != nullptr)
        own.log = [log = options->log, context = options->context](std::string_view remark) {
          log(context, std::string(remark).c_str());
        };
    }
    *library = new withy_library(host::Library(std::move(own)));
    return WITHY_OK;
  } catch (...) {
    return WITHY_ENVIRONMENT;
  }
}

withy_status withy_scene_read(withy_library* library, const char* file, withy_scene** scene) {
  return make(library, scene, [&] {
    need(file != nullptr, "need the name of a file");
    return host::Scene::read(library->value, file);
  });
}

withy_status withy_scene_parse(withy_library* library, const char* text, const char* name, withy_scene** scene) {
  return make(library, scene, [&] {
    need(text != nullptr, "need a text");
    return host::Scene::parse(library->value, text, name == nullptr ? "scene" : name);
  });
}

withy_status withy_scene_copy(withy_scene* scene, withy_scene** copy) {
  return make(scene, copy, [&] { return scene->value; });
}

withy_status withy_scene_set(withy_scene* scene, const char* path, const char* text) {
  return guarded(scene, [&] {
    need(path != nullptr && text != nullptr, "need a path and a text");
    scene->value.set(path, text);
  });
}

withy_status withy_scene_set_number(withy_scene* scene, const char* path, double value) {
  return guarded(scene, [&] {
    need(path != nullptr, "need a path");
    scene->value.set(path, value);
  });
}

withy_status withy_scene_check(withy_scene* scene) {
  return guarded(scene, [&] { scene->value.check(); });
}

withy_status withy_scene_run(withy_scene* scene, withy_result** result) {
  return make(scene, result, [&] { return scene->value.run(); });
}

const char* withy_result_status(const withy_result* r) { return good(r) ? r->value.status.c_str() : ""; }
const char* withy_result_message(const withy_result* r) { return good(r) ? r->value.message.c_str() : ""; }
const char* withy_result_json(const withy_result* r) { return good(r) ? r->value.json.c_str() : ""; }
size_t withy_result_rows(const withy_result* r) { return good(r) ? r->value.rows() : 0; }
size_t withy_result_columns(const withy_result* r) { return good(r) ? r->value.columns.size() : 0; }
withy_port withy_result_column(const withy_result* r, size_t index) {
  return good(r) ? port_at(r->value.columns, index) : withy_port{nullptr, nullptr};
}

withy_status withy_result_values(withy_result* result, const char* column, double* values, size_t count) {
  return guarded(result, [&] {
    need(column != nullptr && values != nullptr, "need a column and an array");
    const std::vector<double> numbers = result->value.column(column);
    need_size(count, numbers.size(), "values");
    std::copy(numbers.begin(), numbers.end(), values);
  });
}

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
