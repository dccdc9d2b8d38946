// Entries that are no good descriptors. Each is a symbol of its own, made by hand.
#include <cstdlib>
#include <stdexcept>

#include "withy/core/plugin/entry.hpp"

namespace {

using withy::AbiIdentity;
using withy::PluginDescriptor;

/// Nothing may be called in a library that does not fit: this ends the program.
bool never(withy::Enrollment&, char*, std::size_t) { std::abort(); }

bool escapes(withy::Enrollment&, char*, std::size_t) { throw std::runtime_error("through the entry"); }

/// Fills the whole buffer and forgets the end of the text.
bool unterminated(withy::Enrollment&, char* reason, std::size_t size) {
  std::fill_n(reason, size, '?');
  return false;
}

constexpr AbiIdentity identity = withy::abi_identity();

constexpr AbiIdentity with_foreign(std::size_t i) {
  AbiIdentity changed = identity;
  changed[i].value = "foreign";
  return changed;
}
constexpr AbiIdentity foreign[] = {with_foreign(0), with_foreign(1), with_foreign(2), with_foreign(3), with_foreign(4),
                                   with_foreign(5), with_foreign(6), with_foreign(7), with_foreign(8), with_foreign(9)};
static_assert(std::size(foreign) == std::tuple_size_v<AbiIdentity>, "one library a property");

constexpr withy::AbiProperty unknown_property[] = {identity[0],
                                                   identity[1],
                                                   identity[2],
                                                   identity[3],
                                                   identity[4],
                                                   identity[5],
                                                   identity[6],
                                                   identity[7],
                                                   identity[8],
                                                   identity[9],
                                                   {"byte order", "middle"}};
constexpr withy::AbiProperty null_property[] = {{nullptr, nullptr}};

constexpr std::uint32_t size = sizeof(PluginDescriptor);
constexpr std::uint32_t count = std::tuple_size_v<AbiIdentity>;

}  // namespace

#define ENTRY(name, ...)                                                                        \
  extern "C" {                                                                                  \
  extern __attribute__((visibility("default"))) const PluginDescriptor withy_plugin_zoo_##name; \
  }                                                                                             \
  constinit const PluginDescriptor withy_plugin_zoo_##name = {__VA_ARGS__}

#define FOREIGN(i) ENTRY(abi_##i, withy::plugin_magic, size, count, foreign[i].data(), "zoo", &never)

FOREIGN(0);
FOREIGN(1);
FOREIGN(2);
FOREIGN(3);
FOREIGN(4);
FOREIGN(5);
FOREIGN(6);
FOREIGN(7);
FOREIGN(8);
FOREIGN(9);
ENTRY(abi_unknown, withy::plugin_magic, size, count + 1, unknown_property, "zoo", &never);
ENTRY(abi_missing, withy::plugin_magic, size, count - 1, identity.data(), "zoo", &never);
ENTRY(abi_null, withy::plugin_magic, size, count, nullptr, "zoo", &never);
ENTRY(abi_null_text, withy::plugin_magic, size, 1, null_property, "zoo", &never);
ENTRY(abi_endless, withy::plugin_magic, size, 0xffffffff, identity.data(), "zoo", &never);
ENTRY(magic, 0x1234, size, count, identity.data(), "zoo", &never);
ENTRY(size, withy::plugin_magic, size + 8, count, identity.data(), "zoo", &never);
ENTRY(null_table, 0, 0, 0, nullptr, nullptr, nullptr);
ENTRY(null_enroll, withy::plugin_magic, size, count, identity.data(), "zoo", nullptr);
ENTRY(escapes, withy::plugin_magic, size, count, identity.data(), "zoo", &escapes);
ENTRY(unterminated, withy::plugin_magic, size, count, identity.data(), "zoo", &unterminated);
