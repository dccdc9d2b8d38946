/// \file
/// Faults of the system, for LD_PRELOAD. WITHY_FAULT="CALLS:WHAT:N" spoils the N-th call, from 1, of those named that
/// is on a file whose path holds WITHY_FAULT_PATH:
///
///     CALLS  open, write, sync, close, rename, read: one or more, with '+' between
///     WHAT   the number of an error, as 28 (ENOSPC): from then on each call fails; "once" before it: that one alone;
///            short: half of what is to be written, or read, goes through; kill: the process is killed before the call
///
/// WITHY_FAULT_COUNT=FILE: at the end the number of such calls is written there. WITHY_CLOCK=SECONDS: the clock of the
/// day is anywhere within so many seconds of the truth, another place at each call, and the clock that does not go back
/// jumps ahead now and then.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

struct Plan {
  char calls[64] = "";
  bool once = false, cuts = false, kills = false;
  int error = 0;
  long at = 0;
  const char* path = std::getenv("WITHY_FAULT_PATH");
  const char* count_file = std::getenv("WITHY_FAULT_COUNT");

  Plan() {
    const char* text = std::getenv("WITHY_FAULT");
    char what[32] = "";
    if (text == nullptr || std::sscanf(text, "%63[^:]:%31[^:]:%ld", calls, what, &at) != 3) return;
    once = std::strncmp(what, "once", 4) == 0;
    cuts = std::strcmp(what, "short") == 0;
    kills = std::strcmp(what, "kill") == 0;
    error = std::atoi(once ? what + 4 : what);
  }
};

const Plan& plan() {
  static const Plan made;
  return made;
}

std::atomic<long> made_calls{0};

/// Told at the end, by exit or by a kill of the plan's own.
struct Telling {
  ~Telling() {
    if (plan().count_file == nullptr) return;
    if (std::FILE* file = std::fopen(plan().count_file, "we"); file != nullptr) {
      std::fprintf(file, "%ld\n", made_calls.load());
      std::fclose(file);
    }
  }
} telling;

enum class Fault { none, error, cut };

Fault fault(const char* call, const char* path) {
  const Plan& p = plan();
  if (p.at == 0 || p.path == nullptr || path == nullptr) return Fault::none;
  if (std::strstr(p.calls, call) == nullptr || std::strstr(path, p.path) == nullptr) return Fault::none;
  const long now = ++made_calls;
  if (now < p.at || ((p.once || p.cuts || p.kills) && now > p.at)) return Fault::none;
  if (p.kills) ::kill(::getpid(), SIGKILL);
  if (p.cuts) return Fault::cut;
  errno = p.error;
  return Fault::error;
}

struct Path {
  char text[4096] = "";
  explicit Path(int file) {
    char link[64];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = ::readlink(link, text, sizeof text - 1);
    if (length >= 0) text[length] = '\0';
  }
};

Fault fault(const char* call, int file) { return plan().at == 0 ? Fault::none : fault(call, Path(file).text); }

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

double clock_error() {
  static const char* text = std::getenv("WITHY_CLOCK");
  return text == nullptr ? 0 : std::atof(text);
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  std::va_list more;
  va_start(more, flags);
  const unsigned mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, unsigned) : 0;
  va_end(more);
  static const auto next = real<int(const char*, int, ...)>("open");
  return fault("open", path) == Fault::error ? -1 : next(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  std::va_list more;
  va_start(more, flags);
  const unsigned mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, unsigned) : 0;
  va_end(more);
  static const auto next = real<int(const char*, int, ...)>("open64");
  return fault("open", path) == Fault::error ? -1 : next(path, flags, mode);
}
std::FILE* fopen(const char* path, const char* mode) {
  static const auto next = real<std::FILE*(const char*, const char*)>("fopen");
  return fault("open", path) == Fault::error ? nullptr : next(path, mode);
}
std::FILE* fopen64(const char* path, const char* mode) {
  static const auto next = real<std::FILE*(const char*, const char*)>("fopen64");
  return fault("open", path) == Fault::error ? nullptr : next(path, mode);
}

ssize_t write(int file, const void* bytes, std::size_t count) {
  static const auto next = real<ssize_t(int, const void*, std::size_t)>("write");
  const Fault f = fault("write", file);
  return f == Fault::error ? -1 : next(file, bytes, f == Fault::cut ? (count + 1) / 2 : count);
}
ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t at) {
  static const auto next = real<ssize_t(int, const void*, std::size_t, off_t)>("pwrite");
  const Fault f = fault("write", file);
  return f == Fault::error ? -1 : next(file, bytes, f == Fault::cut ? (count + 1) / 2 : count, at);
}
ssize_t pwrite64(int file, const void* bytes, std::size_t count, off64_t at) {
  static const auto next = real<ssize_t(int, const void*, std::size_t, off64_t)>("pwrite64");
  const Fault f = fault("write", file);
  return f == Fault::error ? -1 : next(file, bytes, f == Fault::cut ? (count + 1) / 2 : count, at);
}
/// The C library writes what fwrite has collected by itself: a fault of that write is one of fwrite or fflush.
std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, std::FILE* file) {
  static const auto next = real<std::size_t(const void*, std::size_t, std::size_t, std::FILE*)>("fwrite");
  const Fault f = fault("write", ::fileno(file));
  if (f == Fault::none) return next(bytes, size, count, file);
  const int error = f == Fault::error ? plan().error : ENOSPC;
  const std::size_t written = next(bytes, size, count / 2, file);
  errno = error;
  return written;
}
int fflush(std::FILE* file) {
  static const auto next = real<int(std::FILE*)>("fflush");
  if (file == nullptr || fault("write", ::fileno(file)) != Fault::error) return next(file);
  const int error = errno;
  next(file);
  errno = error;
  return EOF;
}
int fclose(std::FILE* file) {
  static const auto next = real<int(std::FILE*)>("fclose");
  const bool fails = fault("close", ::fileno(file)) == Fault::error;
  const int error = errno, status = next(file);
  if (!fails) return status;
  errno = error;
  return EOF;
}
int fsync(int file) {
  static const auto next = real<int(int)>("fsync");
  return fault("sync", file) == Fault::error ? -1 : next(file);
}
int ftruncate(int file, off_t size) noexcept {
  static const auto next = real<int(int, off_t)>("ftruncate");
  return fault("write", file) == Fault::error ? -1 : next(file, size);
}
int rename(const char* from, const char* to) noexcept {
  static const auto next = real<int(const char*, const char*)>("rename");
  return fault("rename", to) == Fault::error ? -1 : next(from, to);
}
ssize_t read(int file, void* bytes, std::size_t count) {
  static const auto next = real<ssize_t(int, void*, std::size_t)>("read");
  const Fault f = fault("read", file);
  return f == Fault::error ? -1 : next(file, bytes, f == Fault::cut ? (count + 1) / 2 : count);
}

int clock_gettime(clockid_t id, struct timespec* time) noexcept {
  static const auto next = real<int(clockid_t, struct timespec*)>("clock_gettime");
  static std::atomic<unsigned> calls{0};
  static std::atomic<long> ahead{0};
  const int status = next(id, time);
  if (status != 0 || clock_error() == 0) return status;
  const unsigned call = ++calls;
  if (id == CLOCK_REALTIME)
    time->tv_sec += static_cast<time_t>(clock_error() * ((call * 2654435761U % 2001U) / 1000.0 - 1));
  if (id == CLOCK_MONOTONIC) {
    if (call % 97 == 0) ahead += static_cast<long>(clock_error());
    time->tv_sec += ahead;
  }
  return status;
}
time_t time(time_t* to) noexcept {
  struct timespec now = {};
  ::clock_gettime(CLOCK_REALTIME, &now);
  if (to != nullptr) *to = now.tv_sec;
  return now.tv_sec;
}
}
