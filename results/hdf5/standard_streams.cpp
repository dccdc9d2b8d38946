// The archives of HDF5 read stdout and stderr as programs do, which the code of a shared library cannot: they are
// linked with --wrap, and mean these instead (cmake/WithyStaticHdf5.cmake).
#include <cstdio>

extern "C" {
extern std::FILE* __real_stdout;
extern std::FILE* __real_stderr;
[[gnu::visibility("hidden")]] std::FILE* __wrap_stdout = nullptr;
[[gnu::visibility("hidden")]] std::FILE* __wrap_stderr = nullptr;
}

namespace {

[[gnu::constructor]] void take_streams() {
  __wrap_stdout = __real_stdout;
  __wrap_stderr = __real_stderr;
}

}  // namespace
