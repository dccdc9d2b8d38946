/// \file
/// Calls of plugins' code, whatever it throws.
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "withy/core/plugin/registry.hpp"

namespace withy {

/// Calls `call`, code of a plugin. What it throws is blamed on `who`. It costs nothing where nothing is thrown.
/// \tparam Error what is thrown then, made of a text
/// \param who the text's beginning: "load 'gust' cannot be bound"; anything a std::string is made of
/// \throws Error as the call does, or with `who` and the text of another exception; std::bad_alloc; PluginError where a
/// library is refused.
template <class Error = std::invalid_argument, class Who, class Call>
decltype(auto) plugin_call(const Who& who, Call&& call) {
  try {
    return call();
  } catch (const std::exception& e) {
    const bool right = dynamic_cast<const Error*>(&e) != nullptr || dynamic_cast<const PluginError*>(&e) != nullptr ||
                       dynamic_cast<const std::bad_alloc*>(&e) != nullptr;
    if (right) throw;
    throw Error(std::string(who) + ": " + e.what());
  } catch (...) {
    throw Error(std::string(who) + ": it throws what is no exception of C++");
  }
}

}  // namespace withy
