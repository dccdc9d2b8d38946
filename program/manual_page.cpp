#include <fmt/format.h>

#include "withy/program/command_description.hpp"

namespace withy::program {
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

std::string option_text(const OptionDescription& option) {
  std::string head;
  if (!option.argument.empty()) {
    head = "\\fI" + roff(option.argument) + "\\fR";
  } else {
    for (const std::string& name : option.names) head += (head.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
    if (option.takes_value) head += " \\fI" + roff(option.value) + "\\fR";
  }
  std::string meaning = option.meaning;
  if (const auto& words = option.choices; !words.empty()) {
    meaning += meaning.empty() ? "One of" : "; one of";
    for (const std::string& w : words) meaning += (w == words.front() ? " " : ", ") + w;
  }
  return ".TP\n" + head + '\n' + roff(meaning) + '\n';
}

std::string examples_text(const CommandDescription& command) {
  std::string text;
  for (const std::string& line : command.examples) text += roff(line) + '\n';
  return text.empty() ? "" : ".PP\nExamples:\n.PP\n.nf\n.RS\n" + text + ".RE\n.fi\n";
}

/// "RUN...", "[FILE]".
std::string argument_text(const OptionDescription& option) {
  const std::string name = "\\fI" + roff(option.argument) + "\\fR" + (option.several ? "..." : "");
  return option.required ? name : '[' + name + ']';
}

/// \param before the words before the command's name, and whether it stands in the program's own list
std::string command_text(const std::string& before, bool first, const CommandDescription& command) {
  std::string name = before + ' ' + command.name, text, arguments;
  for (const OptionDescription& o : command.options)
    if (!o.argument.empty()) arguments += ' ' + argument_text(o);
  if (command.parts.empty() || first)
    text = fmt::format(".SS \"{}\"\n\\fB{}\\fR{}{}\n.PP\n{}.\n", roff(name), roff(name),
                       command.parts.empty() ? "" : " \\fICOMMAND\\fR", arguments + " [\\fIoptions\\fR]",
                       roff(command.meaning));
  for (const OptionDescription& o : command.options)
    if (o.names.empty() || o.names.front() != "--help") text += option_text(o);
  text += examples_text(command);
  for (const CommandDescription& part : command.parts) text += command_text(name, false, part);
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

}  // namespace

std::string manual_page(const CommandDescription& program, const std::string& version) {
  std::string text = ".\\\" Made by `withy manual`.\n.TH WITHY 1 \"\" \"withy " + version + "\" \"User commands\"\n" +
                     std::string(".SH NAME\nwithy \\- ") + roff(program.meaning) +
                     "\n.SH SYNOPSIS\n\\fBwithy\\fR \\fICOMMAND\\fR [\\fIarguments\\fR] [\\fIoptions\\fR]\n.br\n"
                     "\\fBwithy\\fR \\fICOMMAND\\fR \\fB\\-\\-help\\fR\n.SH COMMANDS\n";
  for (const CommandDescription& command : program.parts) text += command_text(program.name, true, command);
  return text + page_end;
}

}  // namespace withy::program
