#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>

#include "withy/program/command.hpp"
#include "withy/program/output.hpp"
#include "withy/scene/names.hpp"

namespace withy::program {
namespace {

/// Help as the parser has it, but for what may be given by its place or by a name: that one of the two is needed stands
/// in the list of arguments alone.
class Help final : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    if (is_positional || !option->get_positional()) return Formatter::make_option(option, is_positional);
    std::string head = make_option_name(option, false) + make_option_opts(option);
    const std::string needed = " " + get_label("REQUIRED");
    if (const std::size_t at = head.find(needed); at != std::string::npos) head.erase(at, needed.size());
    std::ostringstream out;
    CLI::detail::format_help(out, head, make_option_desc(option), column_width_);
    return out.str();
  }
};

/// Adds a command with its options; what it returns is called once they are read.
Call add(CLI::App& parser, const Command& command) {
  CLI::App& own = *parser.add_subcommand(command.name, command.meaning);
  own.footer(std::string("Examples:\n") + command.examples);
  Options options(own);
  return command.add(options);
}

/// The command that the words chose, or its part; the parser itself where they chose none.
const CLI::App& chosen_part(const CLI::App& parser) {
  const std::vector<CLI::App*> chosen = parser.get_subcommands();
  return chosen.empty() ? parser : chosen_part(*chosen.back());
}

/// "withy sweep run".
std::string words_of(const CLI::App& parser) {
  const CLI::App* around = parser.get_parent();
  return around == nullptr ? parser.get_name() : words_of(*around) + ' ' + parser.get_name();
}

/// What is wrong with words that the parser does not know: which option the first may have been.
std::string meant_option(const CLI::App& parser, const CLI::ExtrasError& e, int argc, const char* const* argv) {
  std::vector<std::string> known;
  for (const CLI::Option* option : parser.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  std::string first;
  for (int i = 1; i < argc; ++i) {
    const std::string word = std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
    if (!word.starts_with("-") || std::string(e.what()).find(word) == std::string::npos) continue;
    const std::string guess = nearest(word, known);
    if (!guess.empty() && guess != word) return in_quotes(word) + " is no option; did you mean " + guess + "?";
    if (first.empty() && guess != word) first = word;
  }
  const std::string scene =
      std::find(known.begin(), known.end(), "--set") == known.end() ? "" : "; --set PATH=VALUE sets what a scene says";
  return first.empty() ? std::string(e.what()) : in_quotes(first) + " is no option" + scene;
}

/// What is missing, and what it is.
std::string missing(const CLI::App& parser, const Program& program, const CLI::RequiredError& e) {
  for (const CLI::Option* option : parser.get_options())
    if (option->get_required() && option->count() == 0)
      return option->get_name(option->get_positional()) + " is missing: " + option->get_description();
  if (parser.get_subcommands({}).empty()) return e.what();
  std::string all;
  for (const CLI::App* part : parser.get_subcommands({})) all += (all.empty() ? "" : ", ") + part->get_name();
  return std::string("which command? ") + (parser.get_parent() == nullptr ? program.name : parser.get_name()) +
         " knows " + all;
}

/// Parses with this parser; what is not the command's to answer is printed, and its status returned.
std::optional<ExitStatus> parse(CLI::App& parser, const Program& program, int argc, const char* const* argv) {
  try {
    parser.parse(argc, argv);
    return {};
  } catch (const CLI::ExtrasError& e) {
    const CLI::App& of = chosen_part(parser);
    complain(meant_option(of, e, argc, argv));
    complain(words_of(of) + " --help names what there is");
    return ExitStatus::bad_input;
  } catch (const CLI::RequiredError& e) {
    const CLI::App& of = chosen_part(parser);
    complain(missing(of, program, e));
    complain(words_of(of) + " --help says more");
    return ExitStatus::bad_input;
  } catch (const CLI::ParseError& e) {
    std::ostringstream out;
    std::ostringstream err;
    const int code = parser.exit(e, out, err);
    print(out.str());
    complain(err.str());
    return code == 0 ? ExitStatus::done : ExitStatus::bad_input;
  }
}

/// One that names its commands, for its help, its version and what is wrong without a command.
ExitStatus without_command(CLI::App& parser, const Program& program, int argc, const char* const* argv) {
  parser.require_subcommand(1);
  for (const Command* command : program.commands) parser.add_subcommand(command->name, command->meaning);
  return parse(parser, program, argc, argv).value_or(ExitStatus::done);
}

ExitStatus unknown(const Program& program, const std::string& name) {
  std::vector<std::string> names;
  std::string all;
  for (const Command* command : program.commands) {
    names.emplace_back(command->name);
    all += (all.empty() ? "" : ", ") + names.back();
  }
  const std::string guess = nearest(name, names);
  complain(in_quotes(name) + " is no command" + (guess.empty() ? "" : "; did you mean '" + guess + "'?") +
           "\nCommands: " + all + "; " + program.name + " --help says what they do");
  return ExitStatus::bad_input;
}

OptionDescription description_of(const CLI::Option& option) {
  OptionDescription d;
  for (const std::string& name : option.get_lnames()) d.names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) d.names.push_back("-" + name);
  if (option.get_positional()) d.argument = option.get_name(true);
  d.required = option.get_required();
  d.several = option.get_expected_max() > 1;
  d.meaning = option.get_description();
  d.takes_value = option.get_items_expected_max() > 0;
  const std::string type = option.get_type_name();  // "WHEN:{auto,always,never}"
  d.value = type.substr(0, type.find(':'));
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return d;
  std::istringstream list(type.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(list, word, ',');) d.choices.push_back(word);
  return d;
}

CommandDescription description_of(const CLI::App& parser) {
  CommandDescription d{parser.get_name(), parser.get_description(), {}, {}, {}};
  for (const CLI::Option* option : parser.get_options()) d.options.push_back(description_of(*option));
  std::istringstream footer(parser.get_footer());
  std::string line;
  std::getline(footer, line);  // "Examples:"
  while (std::getline(footer, line)) d.examples.push_back(line.substr(line.find_first_not_of(' ')));
  for (const CLI::App* part : parser.get_subcommands({})) d.parts.push_back(description_of(*part));
  return d;
}

}  // namespace

std::variant<Call, ExitStatus> read_command_line(const Program& program, int argc, const char* const* argv) {
  CLI::App parser(program.meaning, program.name);
  parser.set_version_flag("--version", std::string(program.name) + ' ' + program.version);
  parser.formatter(std::make_shared<Help>());  // of all commands
  parser.footer(std::string("Examples:\n") + program.examples);
  const std::string name = argc > 1 ? argv[1] : "";
  if (name.empty() || name.front() == '-') return without_command(parser, program, argc, argv);
  for (const Command* command : program.commands) {
    if (name != command->name) continue;
    Call call = add(parser, *command);
    if (const auto status = parse(parser, program, argc, argv)) return *status;
    return call;
  }
  return unknown(program, name);
}

CommandDescription description_of(const Program& program) {
  CLI::App parser(program.meaning, program.name);
  parser.set_version_flag("--version", "");
  for (const Command* command : program.commands) static_cast<void>(add(parser, *command));
  return description_of(parser);
}

}  // namespace withy::program
