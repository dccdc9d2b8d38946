#include "withy/core/plugin/entry.hpp"

#include <algorithm>
#include <span>

namespace withy {
namespace {

constexpr AbiIdentity own_identity = abi_identity();
/// More than any version will have: a count beyond it is a damaged descriptor.
constexpr std::uint32_t most_abi_properties = 256;

/// The property that differs, with both values; empty where none does.
std::string difference(std::span<const AbiProperty> theirs) {
  for (const AbiProperty& p : theirs) {
    if (p.name == nullptr || p.value == nullptr) return "its list of build properties is damaged";
  }
  for (const AbiProperty& own : own_identity) {
    const auto it = std::find_if(theirs.begin(), theirs.end(),
                                 [&](const AbiProperty& p) { return std::string_view(p.name) == own.name; });
    if (it == theirs.end()) return "it does not state its " + std::string(own.name);
    if (std::string_view(it->value) != own.value) {
      return "its " + std::string(own.name) + " is " + it->value + ", this program's is " + own.value;
    }
  }
  for (const AbiProperty& p : theirs) {
    if (std::none_of(own_identity.begin(), own_identity.end(),
                     [&](const AbiProperty& own) { return std::string_view(p.name) == own.name; })) {
      return "it depends on a " + std::string(p.name) + " (" + p.value + ") this program does not know";
    }
  }
  return {};
}

}  // namespace

Enrollment enroll_from(const PluginDescriptor& descriptor, const std::string& origin) {
  if (descriptor.magic != plugin_magic) throw PluginError(origin + " has an entry that is no withy plugin descriptor");
  if (descriptor.descriptor_size != sizeof(PluginDescriptor)) {
    throw PluginError(origin + " has a plugin descriptor of " + std::to_string(descriptor.descriptor_size) +
                      " bytes where " + std::to_string(sizeof(PluginDescriptor)) + " are expected");
  }
  if (descriptor.abi == nullptr || descriptor.abi_properties > most_abi_properties) {
    throw PluginError(origin + " does not fit this program: its list of build properties is damaged");
  }
  if (const std::string text = difference({descriptor.abi, descriptor.abi_properties}); !text.empty()) {
    throw PluginError(origin + " does not fit this program: " + text);
  }
  if (descriptor.enroll == nullptr) throw PluginError(origin + " has a plugin descriptor without enroll function");
  Enrollment enrollment;
  std::array<char, 512> reason{};
  bool enrolled = false;
  try {
    enrolled = descriptor.enroll(enrollment, reason.data(), reason.size());
  } catch (...) {  // WITHY_PLUGIN lets none out; a handmade descriptor may
    throw PluginError(origin + " let an exception out of its enroll function");
  }
  if (!enrolled) {
    reason.back() = '\0';
    throw PluginError(origin + " failed to enroll its plugins: " + reason.data());
  }
  return enrollment;
}

}  // namespace withy
