/// \file
/// `withy manual`: the manual page, made of the same words as the help.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <sstream>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/command_tree.hpp"
#include "withy/apps/withy/output.hpp"

namespace withy::app {
namespace {

/// Text of a paragraph for roff: signs that it would take for its own are guarded.
std::string roff(const std::string& text) {
  std::string out;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    begins = c == '\n';
  }
  return out;
}

std::string option_text(const CLI::Option& option) {
  std::string head;
  if (option.get_positional()) {
    head = "\\fI" + roff(option.get_name(true)) + "\\fR";
  } else {
    for (const std::string& name : option_names(option))
      head += (head.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
    if (takes_value(option)) head += " \\fI" + roff(value_name(option)) + "\\fR";
  }
  std::string meaning = option.get_description();
  if (const auto words = choices(option); !words.empty()) {
    meaning += meaning.empty() ? "One of" : "; one of";
    for (const std::string& w : words) meaning += (w == words.front() ? " " : ", ") + w;
  }
  return ".TP\n" + head + '\n' + roff(meaning) + '\n';
}

/// The lines under "Examples:".
std::string examples_text(const CLI::App& parser) {
  std::istringstream footer(parser.get_footer());
  std::string text, line;
  std::getline(footer, line);
  while (std::getline(footer, line)) text += roff(line.substr(line.find_first_not_of(' '))) + '\n';
  return text.empty() ? "" : ".PP\nExamples:\n.PP\n.nf\n.RS\n" + text + ".RE\n.fi\n";
}

std::string command_text(const std::string& before, const CLI::App& parser) {
  std::string name = before + ' ' + parser.get_name(), text;
  std::string arguments;
  for (const CLI::Option* o : parser.get_options())
    if (o->get_positional()) arguments += " \\fI" + roff(o->get_name(true)) + "\\fR";
  const auto parts = parser.get_subcommands({});
  if (parts.empty() || before == "withy")
    text = fmt::format(".SS \"{}\"\n\\fB{}\\fR{}{}\n.PP\n{}.\n", roff(name), roff(name),
                       parts.empty() ? "" : " \\fICOMMAND\\fR", arguments + " [\\fIoptions\\fR]",
                       roff(parser.get_description()));
  for (const CLI::Option* o : parser.get_options())
    if (o->get_name() != "--help") text += option_text(*o);
  text += examples_text(parser);
  for (const CLI::App* part : parts) text += command_text(name, *part);
  return text;
}

constexpr const char* page_end = R"(.SH "EXIT STATUS"
.TP
0
done
.TP
1
the simulation stopped before its end; results up to there are kept
.TP
2
bad input: the command line, a scene, a state
.TP
3
a plugin, a file that cannot be written, memory
.TP
130
interrupted
.SH ENVIRONMENT
.TP
\fBNO_COLOR\fR
where it is set, nothing is coloured; only terminals are shown colours at all
.SH "SEE ALSO"
The folder \fIdocs\fR of the sources: the tutorial, the format of scenes, the theory, the glossary.
)";

ExitStatus manual() {
  const auto program = command_tree();
  std::string text = ".\\\" Made by `withy manual`.\n.TH WITHY 1 \"\" \"withy " WITHY_VERSION "\" \"User commands\"\n" +
                     std::string(".SH NAME\nwithy \\- ") + roff(program->get_description()) +
                     "\n.SH SYNOPSIS\n\\fBwithy\\fR \\fICOMMAND\\fR [\\fIarguments\\fR] [\\fIoptions\\fR]\n.br\n"
                     "\\fBwithy\\fR \\fICOMMAND\\fR \\fB\\-\\-help\\fR\n.SH COMMANDS\n";
  for (const CLI::App* command : program->get_subcommands({})) text += command_text("withy", *command);
  print(text + page_end);
  return ExitStatus::done;
}

std::function<ExitStatus()> add_manual(CLI::App&) { return &manual; }

}  // namespace

const Command manual_command = {"manual", "Print the manual page, withy.1", "  withy manual", &add_manual};

}  // namespace withy::app
