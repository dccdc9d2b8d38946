/// \file
/// Calls of plugins' code while a model is built, whatever it throws.
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "withy/core/plugin/registry.hpp"

namespace withy {

/// Calls `call`. What it throws is blamed on `who`: "load 'gust' cannot be bound".
/// \throws std::invalid_argument as the call does, or with `who` and the text of another exception; std::bad_alloc;
/// PluginError where a library is refused.
template <class Call>
decltype(auto) plugin_call(const std::string& who, Call&& call) {
  try {
    return call();
  } catch (const std::invalid_argument&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const PluginError&) {
    throw;
  } catch (const std::exception& e) {
    throw std::invalid_argument(who + ": " + e.what());
  } catch (...) {
    throw std::invalid_argument(who + ": it throws what is no exception of C++");
  }
}

}  // namespace withy
