/// \file
/// Commands of a program: what each is told, how it ends, how the command line is read.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "withy/program/command_description.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's name
class App;
class Option;
}  // namespace CLI

namespace withy::program {

/// Exit status of the program, the same for every command.
enum class ExitStatus : int {
  done = 0,
  stopped = 1,      ///< the simulation stopped before its end, with results up to there
  bad_input = 2,    ///< the command line, a scene or a state
  environment = 3,  ///< a plugin, a file that cannot be written, memory
  interrupted = 130
};

struct Command;
using Call = std::function<ExitStatus()>;

/// Tells the parser what a command takes, an option after the other. `names` are as "--formulations,--formulation"; a
/// name without dashes is that of an argument by its place. Values are numbers, texts, lists of them, and those that
/// may be left out (std::optional); they must outlive the parser.
class Options {
 public:
  explicit Options(CLI::App& parser) : parser_(parser) {}

  /// An argument by its place.
  template <class T>
  Options& argument(const std::string& names, T& value, const std::string& meaning);
  /// \param type what the help writes for the value: "FILE"
  template <class T>
  Options& value(const std::string& names, T& value, const std::string& type, const std::string& meaning);
  /// Values separated by commas.
  template <class T>
  Options& list(const std::string& names, T& values, const std::string& type, const std::string& meaning);
  /// Given once for each of its values.
  Options& repeated(const std::string& names, std::vector<std::string>& values, const std::string& type,
                    const std::string& meaning);
  /// \param value bool, or std::optional<bool>
  template <class T>
  Options& flag(const std::string& names, T& value, const std::string& meaning);

  // Of the option that was told last:
  Options& required();
  /// The help says what the value is where it is not given.
  Options& with_default();
  Options& positive();
  template <class T>
  Options& between(T least, T most);
  Options& among(std::initializer_list<const char*> words);
  Options& among(std::initializer_list<int> numbers);
  /// \param problem says what is wrong with a text; empty where nothing is
  Options& checked(std::function<std::string(const std::string&)> problem);
  Options& excludes(const std::string& other);

  /// The command is one of these, named after it: what is called is theirs.
  Call parts(std::span<const Command* const> commands);

 private:
  CLI::App& parser_;
  CLI::Option* last_ = nullptr;
};

/// A command. Its file defines it, with its arguments, its help and its call.
struct Command {
  const char* name;
  const char* meaning;   ///< a sentence
  const char* examples;  ///< a line each
  /// Tells the parser what the command takes; what it returns is called once that is read.
  Call (*add)(Options& options);
};

/// Command::add of a command that is `call`, given the arguments that `tell` tells of.
template <class Arguments, void (*tell)(Options&, Arguments&), ExitStatus (*call)(const Arguments&)>
Call taking(Options& options) {
  const auto arguments = std::make_shared<Arguments>();
  tell(options, *arguments);
  return [arguments] { return call(*arguments); };
}

struct Program {
  const char *name, *meaning, *version, *examples;
  std::span<const Command* const> commands;  ///< in the order of the help
};

/// The command asked for, ready to run; or the exit status where there is nothing to run: help and the version have
/// been printed, or what is wrong with the command line has been reported on stderr.
std::variant<Call, ExitStatus> read_command_line(const Program& program, int argc, const char* const* argv);

/// All commands with their options, for completion of shells and the manual page.
CommandDescription description_of(const Program& program);

}  // namespace withy::program
