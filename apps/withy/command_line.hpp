/// \file
/// Reads the command line.
#pragma once

#include <functional>
#include <variant>

#include "withy/apps/withy/command.hpp"

namespace withy::app {

/// The command asked for, ready to run; or the exit status where there is nothing to run: help and the version have
/// been printed, or what is wrong with the command line has been reported on stderr.
std::variant<std::function<ExitStatus()>, ExitStatus> read_command_line(int argc, const char* const* argv);

}  // namespace withy::app
