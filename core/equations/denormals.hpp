/// \file
/// Evaluations count denormal numbers as zero.
#pragma once

#include "withy/core/plugin/floating_point.hpp"

namespace withy::equations {

/// While it lives denormal numbers count as zero: products of coordinates below 1e-154, as of vibrations that have died
/// away, would each cost a hundred cycles. Then the processor's floating-point state is the host's again; where a load
/// or a motion has changed it meanwhile, that is noted for who steps.
class DenormalsAreZero {
#ifdef __SSE2__
 public:
  DenormalsAreZero() : state_(__builtin_ia32_stmxcsr()) {
    __builtin_ia32_ldmxcsr(state_ | flush_to_zero | denormals_are_zero);
    set_ = __builtin_ia32_stmxcsr();
  }
  ~DenormalsAreZero() {
    const unsigned changed = (__builtin_ia32_stmxcsr() ^ set_) & control;
    if (changed != 0) [[unlikely]]
      note_changed_arithmetic(changed);
    __builtin_ia32_ldmxcsr(state_);
  }
  DenormalsAreZero(const DenormalsAreZero&) = delete;
  DenormalsAreZero& operator=(const DenormalsAreZero&) = delete;

 private:
  static constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x40;
  static constexpr unsigned control = 0xffc0;  ///< all but the flags of past operations
  unsigned state_;
  unsigned set_;  ///< what the processor has made of the bits asked for: valgrind, as one, keeps neither of them
#endif
};

}  // namespace withy::equations
