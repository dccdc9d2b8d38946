/// \file
/// Evaluations count denormal numbers as zero.
#pragma once

namespace withy::equations {

/// While it lives denormal numbers count as zero: products of coordinates below 1e-154, as of vibrations that have died
/// away, would each cost a hundred cycles. Then the processor's floating-point state is the host's again.
class DenormalsAreZero {
#ifdef __SSE2__
 public:
  DenormalsAreZero() : state_(__builtin_ia32_stmxcsr()) {
    __builtin_ia32_ldmxcsr(state_ | flush_to_zero | denormals_are_zero);
  }
  ~DenormalsAreZero() { __builtin_ia32_ldmxcsr(state_); }
  DenormalsAreZero(const DenormalsAreZero&) = delete;
  DenormalsAreZero& operator=(const DenormalsAreZero&) = delete;

 private:
  static constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x40;
  unsigned state_;
#endif
};

}  // namespace withy::equations
