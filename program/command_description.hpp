/// \file
/// What a command line takes, as values: completion of shells and the manual page are made of it.
#pragma once

#include <string>
#include <vector>

namespace withy::program {

struct OptionDescription {
  std::vector<std::string> names;    ///< "--formulations", "--formulation", "-h"; empty: an argument by its place alone
  std::string argument;              ///< its name where it may be given by its place: "SCENE"; empty: by a name only
  std::string meaning;               ///< as the help has it
  std::string value;                 ///< "FILE", "N,N,…": what the help writes for a value
  std::vector<std::string> choices;  ///< the words that the value may be; empty where it is free
  bool takes_value = false;
  bool required = false;
  bool several = false;  ///< values may follow one another
};

struct CommandDescription {
  std::string name, meaning;
  std::vector<OptionDescription> options;  ///< in the order of the help
  std::vector<std::string> examples;       ///< a line each
  std::vector<CommandDescription> parts;   ///< commands of the command
};

/// Scripts that make a shell complete the program's command line; the first command is the program.
std::string bash_completion(const CommandDescription& program);
std::string zsh_completion(const CommandDescription& program);
/// The manual page in roff. \param version of the program, as it stands at the foot of the page.
std::string manual_page(const CommandDescription& program, const std::string& version);

}  // namespace withy::program
