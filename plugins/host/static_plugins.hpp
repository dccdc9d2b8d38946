/// \file
/// The plugins linked into a program that has no plugin directory: link `withy-plugins-static`.
#pragma once

#include <span>

namespace withy {

class Registry;
struct PluginDescriptor;

/// The descriptors of all plugins of the build, sorted by name: the same symbols the libraries show.
std::span<const PluginDescriptor* const> static_plugins();

/// Admits all of them; their origin is "built in".
/// \throws PluginError where one does not fit this program or fails. \throws std::invalid_argument as Registry::admit.
void enroll_static_plugins(Registry& registry);

}  // namespace withy
