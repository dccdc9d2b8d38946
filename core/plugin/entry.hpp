/// \file
/// The one entry of a plugin library: a plain descriptor that the host reads, and finds to be understood, before it
/// calls anything in the library.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <string_view>

#include "withy/core/plugin/registry.hpp"

#define WITHY_STRING_(x) #x
#define WITHY_STRING(x) WITHY_STRING_(x)

namespace withy {

/// Version of the interfaces in core/plugin; it changes with any of them.
#define WITHY_SDK_VERSION 11

/// A property of the build that host and plugin must share, since C++ objects pass between them.
struct AbiProperty {
  const char* name;
  const char* value;
};

/// Everything that decides whether two builds understand each other's objects and arithmetic.
using AbiIdentity = std::array<AbiProperty, 10>;

namespace detail {

/// A number as text with static storage.
template <std::size_t N>
struct Decimal {
  static constexpr std::array<char, 21> text = [] {
    std::array<char, 21> reversed{};
    std::size_t count = 0;
    for (std::size_t rest = N; rest != 0 || count == 0; rest /= 10) {
      reversed[count++] = static_cast<char>('0' + rest % 10);
    }
    std::array<char, 21> digits{};
    for (std::size_t i = 0; i < count; ++i) digits[i] = reversed[count - 1 - i];
    return digits;
  }();
};

}  // namespace detail

/// The identity of the translation unit that evaluates it. Only at compile time: the linker may not put the value of
/// one unit in place of another's.
consteval AbiIdentity abi_identity() {
  return {{
      {"SDK version", WITHY_STRING(WITHY_SDK_VERSION)},
#if defined(__clang__)
      {"compiler", "clang " WITHY_STRING(__clang_major__)},
#else
      {"compiler", "gcc " WITHY_STRING(__GNUC__)},
#endif
#if defined(_LIBCPP_VERSION)
      {"standard library", "libc++ " WITHY_STRING(_LIBCPP_VERSION)},
#else
      {"standard library",
       "libstdc++ " WITHY_STRING(_GLIBCXX_RELEASE) " cxx11-abi " WITHY_STRING(_GLIBCXX_USE_CXX11_ABI)},
#endif
#if defined(_GLIBCXX_DEBUG)
      {"debug containers", "on"},
#else
      {"debug containers", "off"},
#endif
#if defined(__GXX_RTTI)
      {"run-time type information", "on"},
#else
      {"run-time type information", "off"},
#endif
// Mixed, they miss or invent errors in containers that cross the border.
#if defined(__SANITIZE_ADDRESS__)
      {"sanitizer", "address"},
#elif defined(__SANITIZE_THREAD__)
      {"sanitizer", "thread"},
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
      {"sanitizer", "address"},
#elif __has_feature(thread_sanitizer)
      {"sanitizer", "thread"},
#else
      {"sanitizer", "none"},
#endif
#else
      {"sanitizer", "none"},
#endif
// With -ffast-math no test for NaN holds, so no result could be trusted to be finite.
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
      {"arithmetic", "finite-math-only"},
#else
      {"arithmetic", "IEEE"},
#endif
      {"Eigen version",
       WITHY_STRING(EIGEN_WORLD_VERSION) "." WITHY_STRING(EIGEN_MAJOR_VERSION) "." WITHY_STRING(EIGEN_MINOR_VERSION)},
      {"alignment of Eigen's fixed sizes", detail::Decimal<alignof(Eigen::Matrix<double, 8, 1>)>::text.data()},
      {"alignment of Eigen's memory", detail::Decimal<EIGEN_MAX_ALIGN_BYTES>::text.data()},
  }};
}

/// Begins every descriptor: "withyplg".
inline constexpr std::uint64_t plugin_magic = 0x7769746879706c67;

/// What a library offers. The layout is fixed for ever, so that a host of any version can say what differs.
struct PluginDescriptor {
  std::uint64_t magic;
  std::uint32_t descriptor_size;  ///< sizeof(PluginDescriptor)
  std::uint32_t abi_properties;
  const AbiProperty* abi;  ///< `abi_properties` of them
  const char* name;
  /// Adds the library's plugins. On failure returns false with the reason, zero-terminated, in reason[0 … size−1].
  bool (*enroll)(Enrollment& enrollment, char* reason, std::size_t size);
};

/// The plugins of a descriptor, for a registry to admit. `origin` names the library in messages.
/// \throws PluginError where the descriptor is none, was built differently (the property and both values are named) or
/// its library reports a failure; nothing of the library is called before the identity is found equal.
Enrollment enroll_from(const PluginDescriptor& descriptor, const std::string& origin);

}  // namespace withy

/// Makes the entry of a plugin library, the data symbol `withy_plugin_<name>` (with '_' for '-'), from a function
/// `void enroll(withy::Enrollment&)`. The same symbol serves a static build: see plugins/host/static_plugins.hpp.
#define WITHY_PLUGIN(name, enroll_function)                                                                \
  namespace {                                                                                              \
  constexpr ::withy::AbiIdentity withy_abi_##name = ::withy::abi_identity();                               \
  bool withy_enroll_##name(::withy::Enrollment& enrollment, char* reason, std::size_t size) {              \
    const auto fail = [&](std::string_view text) {                                                         \
      reason[text.copy(reason, size - 1)] = '\0';                                                          \
      return false;                                                                                        \
    };                                                                                                     \
    try {                                                                                                  \
      enroll_function(enrollment);                                                                         \
      return true;                                                                                         \
    } catch (const std::exception& e) {                                                                    \
      return fail(e.what());                                                                               \
    } catch (...) {                                                                                        \
      return fail("an exception of unknown type");                                                         \
    }                                                                                                      \
  }                                                                                                        \
  }                                                                                                        \
  extern "C" {                                                                                             \
  extern __attribute__((visibility("default"))) const ::withy::PluginDescriptor withy_plugin_##name;       \
  }                                                                                                        \
  constinit const ::withy::PluginDescriptor withy_plugin_##name = {::withy::plugin_magic,                  \
                                                                   sizeof(::withy::PluginDescriptor),      \
                                                                   std::uint32_t{withy_abi_##name.size()}, \
                                                                   withy_abi_##name.data(),                \
                                                                   #name,                                  \
                                                                   &withy_enroll_##name}
