/// \file
/// Handles of the C interface: what each holds, why its last call failed, and calls that throw nothing.
#pragma once

#include <atomic>
#include <cstddef>
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
#include <vector>

#include "withy/bindings/c/withy.h"
#include "withy/core/plugin/registry.hpp"
#include "withy/host/equations.hpp"
#include "withy/host/simulation.hpp"

namespace withy::c {

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

}  // namespace withy::c

struct withy_library : withy::c::Holding<withy::host::Library, withy::c::Kind::library> {
  using Holding::Holding;
};
struct withy_scene : withy::c::Holding<withy::host::Scene, withy::c::Kind::scene> {
  using Holding::Holding;
};
struct withy_result : withy::c::Holding<withy::host::Result, withy::c::Kind::result> {
  using Holding::Holding;
};
struct withy_simulation : withy::c::Holding<withy::host::Simulation, withy::c::Kind::simulation> {
  using Holding::Holding;
  std::string state;
};
struct withy_snapshot : withy::c::Holding<withy::host::Snapshot, withy::c::Kind::snapshot> {
  using Holding::Holding;
};
struct withy_equations : withy::c::Holding<withy::host::Equations, withy::c::Kind::equations> {
  using Holding::Holding;
};

namespace withy::c {

/// Null, one that has ended (as far as its memory still shows it), or one of another kind is no handle.
template <class H>
bool good(const H* handle) {
  return handle != nullptr && handle->kind == H::its_kind;
}

/// Why the last attempt of the calling thread to make a library failed, for which there is no handle.
std::string& why_no_library() noexcept;

/// Thrown for what WITHY_BAD_USE stands for.
struct BadUse : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// \throws BadUse with `otherwise` where the condition does not hold
void need(bool condition, const char* otherwise);
/// \throws BadUse where an array has not so many numbers as it needs. \param array its name
void need_size(std::size_t got, std::size_t least, const char* array);
/// The handle of another kind says so, where it is one.
void refuse(const Handle* handle, Kind wanted) noexcept;
/// Nulls beyond the last.
withy_port port_at(const std::vector<host::Port>& ports, std::size_t index);

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
  } catch (const PluginError& e) {
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

}  // namespace withy::c
