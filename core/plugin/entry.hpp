/// \file
/// The one entry of a plugin library: a plain descriptor, readable before any of the library's code runs.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "withy/core/plugin/registry.hpp"

#define WITHY_STRING_(x) #x
#define WITHY_STRING(x) WITHY_STRING_(x)

namespace withy {

/// Version of the interfaces in core/plugin; it changes with any of them.
#define WITHY_SDK_VERSION 1

/// A property of the build that host and plugin must share, since C++ objects pass between them.
struct AbiProperty {
  const char* name;
  const char* value;
};

/// Everything that decides whether two builds understand each other's objects.
using AbiIdentity = std::array<AbiProperty, 6>;

/// The identity of the translation unit that calls it; usable in constant initialization.
constexpr AbiIdentity abi_identity() {
  return {{{"SDK version", WITHY_STRING(WITHY_SDK_VERSION)},
#if defined(__clang__)
           {"compiler", "clang " WITHY_STRING(__clang_major__)},
#else
           {"compiler", "gcc " WITHY_STRING(__GNUC__)},
#endif
           {"standard library",
            "libstdc++ " WITHY_STRING(_GLIBCXX_RELEASE) " cxx11-abi " WITHY_STRING(_GLIBCXX_USE_CXX11_ABI)},
#if defined(_GLIBCXX_DEBUG)
           {"debug containers", "on"},
#else
           {"debug containers", "off"},
#endif
           {"Eigen version", WITHY_STRING(EIGEN_WORLD_VERSION) "." WITHY_STRING(EIGEN_MAJOR_VERSION) "." WITHY_STRING(
                                 EIGEN_MINOR_VERSION)},
#if EIGEN_MAX_ALIGN_BYTES == 16
           {"Eigen alignment", "16"}
#elif EIGEN_MAX_ALIGN_BYTES == 32
           {"Eigen alignment", "32"}
#elif EIGEN_MAX_ALIGN_BYTES == 64
           {"Eigen alignment", "64"}
#else
           {"Eigen alignment", "none"}
#endif
  }};
}

/// Layout is fixed for ever: a host of any version can read it and say what differs.
struct PluginDescriptor {
  std::uint64_t magic = 0x7769746879706c67;  ///< "withyplg"
  std::uint32_t descriptor_size = sizeof(PluginDescriptor);
  std::uint32_t abi_properties = 0;
  const AbiProperty* abi = nullptr;  ///< `abi_properties` of them
  const char* name = nullptr;
  /// Adds the library's plugins. Returns null, or why it could not (a string that outlives the call). Never throws.
  const char* (*enroll)(Enrollment&) noexcept = nullptr;
};

}  // namespace withy

/// Makes the entry of a plugin library, the data symbol `withy_plugin_<name>`, from a function
/// `void enroll(withy::Enrollment&)`. The same symbol serves a static build: see plugins/host/static_plugins.hpp.
#define WITHY_PLUGIN(name, enroll_function)                                                              \
  namespace {                                                                                            \
  constexpr ::withy::AbiIdentity withy_abi_##name = ::withy::abi_identity();                             \
  const char* withy_enroll_##name(::withy::Enrollment& enrollment) noexcept {                            \
    try {                                                                                                \
      enroll_function(enrollment);                                                                       \
      return nullptr;                                                                                    \
    } catch (const std::exception& e) {                                                                  \
      static std::string text;                                                                           \
      text = e.what();                                                                                   \
      return text.c_str();                                                                               \
    } catch (...) {                                                                                      \
      return "an exception of unknown type";                                                             \
    }                                                                                                    \
  }                                                                                                      \
  }                                                                                                      \
  extern "C" __attribute__((visibility("default"))) const ::withy::PluginDescriptor withy_plugin_##name; \
  extern "C" const ::withy::PluginDescriptor withy_plugin_##name = {                                     \
      0x7769746879706c67,                                                                                \
      sizeof(::withy::PluginDescriptor),                                                                 \
      static_cast<std::uint32_t>(withy_abi_##name.size()),                                               \
      withy_abi_##name.data(),                                                                           \
      #name,                                                                                             \
      &withy_enroll_##name}
