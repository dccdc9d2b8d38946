/// \file
/// All commands with their options, for what is made of them: completion of shells, the manual page.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace withy::app {

/// The program with every command. Nothing of it is to be parsed or called.
std::unique_ptr<CLI::App> command_tree();

/// "--formulations", "--formulation", "-h".
std::vector<std::string> option_names(const CLI::Option& option);
bool takes_value(const CLI::Option& option);
/// "FILE", "N,N,…": what the help writes for a value; without the words that it may be.
std::string value_name(const CLI::Option& option);
/// The words that a value may be; empty where it is free.
std::vector<std::string> choices(const CLI::Option& option);
/// What stands before the first semicolon, colon or line's end.
std::string first_sentence(const std::string& text);

}  // namespace withy::app
