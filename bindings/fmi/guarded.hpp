/// \file
/// What stands between a host in C and an instance: every call is checked, nothing throws across.
#pragma once

#include <algorithm>
#include <exception>
#include <new>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "withy/bindings/fmi/instance.hpp"

namespace withy::fmi {

/// The instance that a handle of a host is; null where it is none, as far as its memory shows.
inline Instance* instance_of(void* handle) {
  auto* instance = static_cast<Instance*>(handle);
  if (instance == nullptr || reinterpret_cast<std::uintptr_t>(handle) % alignof(Instance) != 0) return nullptr;
  return instance->kind_of_handle == Instance::living ? instance : nullptr;
}

/// \throws std::invalid_argument where a pointer is null.
inline void need(bool condition, const char* otherwise) {
  if (!condition) throw std::invalid_argument(otherwise);
}

/// Where a call may be made.
struct Allowed {
  unsigned modes;
  enum class In { both, model_exchange, co_simulation } kinds = In::both;
};

inline void check(const Instance& instance, const Allowed& allowed) {
  using In = Allowed::In;
  if (allowed.kinds == In::model_exchange && instance.kind() != Kind::model_exchange)
    throw std::invalid_argument("is of model exchange; the instance is of co-simulation");
  if (allowed.kinds == In::co_simulation && instance.kind() != Kind::co_simulation)
    throw std::invalid_argument("is of co-simulation; the instance is of model exchange");
  if (!instance.is_in(allowed.modes))
    throw std::invalid_argument(std::string("is not to be called in the mode ") + instance.mode_name());
}

/// Does what a function is for; `act` returns a status. What it throws becomes one, with a line in the log.
template <class Act>
Status guarded(void* handle, const char* function, const Allowed& allowed, Act&& act) noexcept {
  Instance* instance = instance_of(handle);
  if (instance == nullptr) return Status::error;
  const auto fail = [&](Status status, const char* category, const char* why) {
    try {
      instance->say(status, category, std::string(function) + ": " + why);
    } catch (...) {
      return Status::error;  // no memory for words
    }
    return status;
  };
  try {
    check(*instance, allowed);
    return act(*instance);
  } catch (const Discarded& e) {
    return fail(Status::discard, log_discards, e.what());
  } catch (const std::bad_alloc&) {
    return fail(Status::error, log_errors, "memory has run out");
  } catch (const std::exception& e) {
    return fail(Status::error, log_errors, e.what());
  } catch (...) {
    return fail(Status::error, log_errors, "what was thrown is no exception of the standard library");
  }
}

/// Makes an instance, or says why there is none. \returns null then
template <class Make>
Instance* made(const Log& log, const char* function, Make&& make) noexcept {
  const auto fail = [&](const char* why) -> Instance* {
    try {
      if (log.write) log.write(Status::error, log_errors, (std::string(function) + ": " + why).c_str());
    } catch (...) {
      return nullptr;
    }
    return nullptr;
  };
  try {
    return make();
  } catch (const std::exception& e) {
    return fail(e.what());
  } catch (...) {
    return fail("what was thrown is no exception of the standard library");
  }
}

/// The value references of a call.
inline std::span<const std::uint32_t> references(const std::uint32_t* vr, std::size_t count) {
  need(count == 0 || vr != nullptr, "need an array of value references");
  return {vr, count};
}

/// Which messages the host wants.
inline void set_logging(Instance& instance, bool on, std::size_t count, const char* const* categories) {
  need(count == 0 || categories != nullptr, "need the names of categories");
  std::set<std::string> wanted;
  for (std::size_t k = 0; k < count; ++k) {
    need(categories[k] != nullptr, "need the names of categories");
    wanted.insert(categories[k]);
  }
  instance.log().on = on;
  instance.log().categories = std::move(wanted);
}

/// Saves a state in the place of what a host may have there.
inline void save_at(Instance& instance, void** state) {
  need(state != nullptr, "need a place for the state");
  SavedState* saved = instance.save();
  if (*state != nullptr) instance.forget_if_own(static_cast<const SavedState*>(*state));
  *state = saved;
}

/// Frees a saved state, if there is one.
inline void forget_at(Instance& instance, void** state) {
  if (state == nullptr || *state == nullptr) return;
  instance.forget(static_cast<const SavedState*>(*state));
  *state = nullptr;
}

/// \param Byte of the version: char or unsigned char; `size_function` is for the message
template <class Byte>
void write_bytes(const Instance& instance, const void* state, Byte* bytes, std::size_t size,
                 const char* size_function) {
  const std::vector<unsigned char> found = instance.serialize(static_cast<const SavedState*>(state));
  if (bytes == nullptr || size < found.size())
    throw std::invalid_argument(std::string("need an array as long as ") + size_function + " says");
  std::copy(found.begin(), found.end(), bytes);
}

/// For types of which the FMU has no variable: nothing is asked for, or it is an error.
inline Status none_of(const Instance& instance, const std::uint32_t* vr, std::size_t count, const char* type) {
  if (count == 0) return Status::ok;
  throw std::invalid_argument(instance.variable(references(vr, count)[0]).quoted() + " is a real number, not of type " +
                              type);
}

}  // namespace withy::fmi
