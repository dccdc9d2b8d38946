/// \file
/// The target that WITHY_FUZZ names, for libFuzzer.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "withy/tests/fuzz/targets.hpp"

namespace {

withy::fuzz::Target named() {
  const char* name = std::getenv("WITHY_FUZZ");
  const auto& all = withy::fuzz::targets();
  const auto found = name == nullptr ? all.end() : all.find(name);
  if (found != all.end()) return found->second;
  std::fputs("WITHY_FUZZ names no target\n", stderr);
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const withy::fuzz::Target target = named();
  target({reinterpret_cast<const char*>(data), size});
  return 0;
}
