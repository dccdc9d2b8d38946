/// \file
/// What instances of both versions of the standard do alike: calls, and states as bytes.
#pragma once

#include <string>
#include <vector>

#include "withy/bindings/fmu_load/instance.hpp"

namespace withy::fmu_load {

/// A function of an FMU's library, by its type and name.
template <class F>
struct Named {
  using Function = F;
  const char* name;
};

/// \tparam V a version: its types Status, Component, State and Byte, its statuses `ok` and `warning`, and as Named the
/// functions that free an instance and deal with states
template <class V>
class InstanceOf : public Instance {
 public:
  explicit InstanceOf(const Program& program) : program_(program) {}

  std::vector<unsigned char> save() override {
    State state(*this);
    call(V::get_state, &state.kept);
    std::size_t size = 0;
    call(V::size_of_state, state.kept, &size);
    std::vector<unsigned char> bytes(size);
    call(V::write_state, state.kept, reinterpret_cast<typename V::Byte*>(bytes.data()), size);
    return bytes;
  }
  void restore(std::span<const unsigned char> bytes) override {
    State state(*this);
    call(V::read_state, reinterpret_cast<const typename V::Byte*>(bytes.data()), bytes.size(), &state.kept);
    call(V::set_state, state.kept);
  }

 protected:
  template <class F>
  [[nodiscard]] F* function(Named<F> named) const {
    return program_.function<F>(named.name);
  }
  /// \throws FmuError where the status is neither that all is well nor a warning
  template <class F, class... Arguments>
  void call(Named<F> named, Arguments... arguments) {
    heard_.clear();
    const typename V::Status status = function(named)(c_, arguments...);
    if (status != V::ok && status != V::warning) throw FmuError(failed_call(named.name, status, heard_));
  }
  /// Takes what a function that instantiates has given. \throws FmuError where that is nothing
  void take(typename V::Component made, const char* function, typename V::Status error) {
    c_ = made;
    if (c_ == nullptr) throw FmuError(failed_call(function, error, heard_));
  }

  /// Frees it, while all that the FMU calls back is still there: for destructors.
  void release() {
    if (c_ != nullptr) function(V::free_instance)(c_);
    c_ = nullptr;
  }

  std::string heard_;  ///< what the FMU has said in the last call

 private:
  /// A state that the FMU has given, until the end of a call.
  struct State {
    explicit State(InstanceOf& of) : owner(of) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
      if (kept != nullptr) owner.function(V::free_state)(owner.c_, &kept);
    }
    InstanceOf& owner;
    typename V::State kept = nullptr;
  };

  const Program& program_;
  typename V::Component c_ = nullptr;
};

}  // namespace withy::fmu_load
