/// \file
/// The program by its commands.
#pragma once

#include "withy/program/command.hpp"

namespace withy::app {

const program::Program& withy_program();

}  // namespace withy::app
