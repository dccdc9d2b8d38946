/// \file
/// How calls of FMI 3.0 come to instances.
#pragma once

#include "withy/bindings/fmi/fmi3.h"
#include "withy/bindings/fmi/guarded.hpp"

namespace withy::fmi {

/// An instance, and what the version keeps beside it.
class Instance3 : public Instance {
 public:
  using Instance::Instance;
  fmi3IntermediateUpdateCallback update = nullptr;
  fmi3InstanceEnvironment environment = nullptr;
  bool early_return = false;
};

static_assert(fmi3OK == static_cast<int>(Status::ok) && fmi3Fatal == static_cast<int>(Status::fatal));
inline fmi3Status status3(Status s) { return static_cast<fmi3Status>(s); }

/// All modes but that inside the callback of a step, and all.
inline constexpr unsigned settled =
    Mode::instantiated | Mode::initialization | Mode::event | Mode::continuous | Mode::step | Mode::terminated;
inline constexpr unsigned any_mode = settled | Mode::intermediate;

/// A call that is ok where it does not throw.
template <class Act>
fmi3Status call3(fmi3Instance c, const char* function, unsigned modes, Allowed::In kinds, Act&& act) {
  return status3(guarded(c, function, {modes, kinds}, [&](Instance& i) {
    act(static_cast<Instance3&>(i));
    return Status::ok;
  }));
}

}  // namespace withy::fmi
