#include <fmt/format.h>

#include <utility>

#include "withy/program/command_description.hpp"

namespace withy::program {
namespace {

/// One word of the command line and what may follow it, for a shell's script: "sweep run".
struct Place {
  std::string words;
  std::vector<std::pair<std::string, std::string>> parts;    ///< commands of the command, with what they do
  std::vector<std::pair<std::string, std::string>> options;  ///< `--out`, with its meaning
  std::vector<std::pair<std::string, std::string>> values;   ///< "--out" or "1", the first argument: a kind or words
};

/// Which plugins an option names: "formulation" of "--formulations"; empty where it names none.
std::string plugins_named(const OptionDescription& option) {
  if (!option.value.starts_with("ID") || option.names.empty()) return {};
  const std::string& name = option.names.front();
  if (name == "--reference") return "formulation";
  for (const std::string kind : {"formulation", "integrator"})
    if (name == "--" + kind || name == "--" + kind + 's') return kind;
  return name == "--families" ? "mode-family" : "";
}

/// What completes a value: the words that it may be, `plugin:KIND` or, of a list, `plugins:KIND`, or `files` or
/// `folders`; empty where only the user knows.
std::string values_of(const OptionDescription& option) {
  std::string words;
  for (const std::string& w : option.choices) words += (words.empty() ? "" : " ") + w;
  if (!words.empty()) return words;
  if (const std::string kind = plugins_named(option); !kind.empty())
    return (option.value == "ID" ? "plugin:" : "plugins:") + kind;
  const bool out = !option.names.empty() && option.names.front() == "--out";
  if (out || option.value == "STORE" || option.value == "DIR" || option.value == "FOLDER") return "folders";
  return !option.argument.empty() || option.value == "FILE" ? "files" : "";
}

/// What stands before the first semicolon, colon or line's end.
std::string first_sentence(const std::string& text) { return text.substr(0, text.find_first_of(";:\n")); }

Place place_of(const std::string& words, const CommandDescription& command) {
  Place place{words, {}, {}, {}};
  for (const CommandDescription& part : command.parts) place.parts.emplace_back(part.name, part.meaning);
  std::size_t position = 0;
  for (const OptionDescription& o : command.options) {
    const std::string values = values_of(o);
    if (!o.argument.empty()) place.values.emplace_back(std::to_string(++position), values);
    for (const std::string& name : o.names) {
      place.options.emplace_back(name, first_sentence(o.meaning));
      if (o.takes_value) place.values.emplace_back(name, values.empty() ? "none" : values);
    }
  }
  return place;
}

std::vector<Place> places_of(const CommandDescription& program) {
  std::vector<Place> all = {place_of("", program)};
  for (const CommandDescription& command : program.parts) {
    all.push_back(place_of(command.name, command));
    for (const CommandDescription& part : command.parts) all.push_back(place_of(command.name + ' ' + part.name, part));
  }
  return all;
}

std::string names(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string text;
  for (const auto& [name, meaning] : entries) text += (text.empty() ? "" : " ") + name;
  return text;
}

constexpr const char* bash_head = R"(# Completion of withy for bash; made by `withy completion bash`.
_withy() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} place= position=0 parts= options= values= i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$place/${COMP_WORDS[i]}" in
)";
constexpr const char* bash_middle = R"(      */-*) ;;
      *) [[ ${COMP_WORDS[i-1]} == --* ]] || ((++position)) ;;
    esac
  done
  ((++position))
  case "$place" in
)";
// A list is completed behind its last comma.
constexpr const char* bash_end = R"sh(  esac
  local before_it=
  [[ $word == *,* ]] && before_it=${word%,*},
  if [[ $word == -* ]]; then COMPREPLY=($(compgen -W "$options" -- "$word")); return; fi
  case "$values" in
    none) COMPREPLY=() ;;
    folders) compopt -o filenames; COMPREPLY=($(compgen -d -- "$word")) ;;
    plugin:* | plugins:*) COMPREPLY=($(compgen -P "$before_it" -W "$(withy plugins 2> /dev/null |
      sed -n "s/^${values#*:}  *\([^ ]*\).*/\1/p")" -- "${word#"$before_it"}")) ;;
    files) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")) ;;
    *) COMPREPLY=($(compgen -W "$parts $values" -- "$word")) ;;
  esac
}
complete -F _withy withy
)sh";

/// What the word before the cursor leaves to complete, at one place of the command line.
std::string bash_values(const Place& place) {
  std::string text, positions;
  for (const auto& [name, values] : place.values) {
    if (name.front() == '-')
      text += fmt::format("        {}) values=\"{}\" ;;\n", name, values);
    else
      positions += fmt::format("{}) values=\"{}\" ;; ", name, values);
  }
  // Behind the last argument comes another of its kind.
  return text + (positions.empty()
                     ? "        *) ;;\n"
                     : fmt::format("        *) case $position in {}*) values=files ;; esac ;;\n", positions));
}

/// Inside single quotes of zsh, and of a description in brackets.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else if (c == '[' || c == ']' || c == ':' || c == '\\')
      out += std::string("\\") + c;
    else
      out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string zsh_action(const std::string& values) {
  if (values == "files") return "_files";
  if (values == "folders") return "_files -/";
  if (const std::size_t colon = values.find(':'); colon != std::string::npos)
    return fmt::format("{}compadd - ${{(f)\"$(withy plugins 2> /dev/null | sed -n \"s/^{}  *\\([^ ]*\\).*/\\1/p\")\"}}",
                       values.starts_with("plugins") ? "_sequence " : "", values.substr(colon + 1));
  return values.empty() || values == "none" ? " " : "(" + values + ")";
}

std::string zsh_place(const Place& p) {
  std::string name = p.words;
  for (char& c : name)
    if (c == ' ') c = '_';
  std::string text = fmt::format("_withy_{}() {{\n", name);
  if (!p.parts.empty()) {
    text += "  local -a parts=(\n";
    for (const auto& [part, meaning] : p.parts) text += fmt::format("    '{}:{}'\n", part, quoted(meaning));
    return text +
           "  )\n  if (( CURRENT == 2 )); then _describe 'command' parts; return; fi\n  local part=$words[2]\n  shift "
           "words; (( CURRENT-- ))\n" +
           fmt::format("  (( $+functions[_withy_{0}{1}$part] )) && _withy_{0}{1}$part || _files\n}}\n", name,
                       name.empty() ? "" : "_");
  }
  text += "  _arguments -S";
  for (const auto& [option, meaning] : p.options) {
    std::string action;
    for (const auto& [of, values] : p.values)
      if (of == option) action = ": :" + zsh_action(values);
    text += fmt::format(" \\\n    '*{}[{}]{}'", option, quoted(meaning), action);
  }
  for (const auto& [position, values] : p.values)
    if (position.front() != '-') text += fmt::format(" \\\n    '{}: :{}'", position, zsh_action(values));
  return text + " \\\n    '*: :_files'\n}\n";
}

}  // namespace

std::string bash_completion(const CommandDescription& program) {
  std::string text = bash_head;
  const std::vector<Place> all = places_of(program);
  for (const Place& p : all)
    for (const auto& [name, meaning] : p.parts)
      text += fmt::format("      {}/{}) place=\"{}{}{}\"; position=0 ;;\n", p.words.empty() ? "" : '"' + p.words + '"',
                          name, p.words, p.words.empty() ? "" : " ", name);
  text += bash_middle;
  for (const Place& p : all)
    text += fmt::format("    \"{}\")\n      parts=\"{}\" options=\"{}\"\n      case \"$before\" in\n{}      esac ;;\n",
                        p.words, names(p.parts), names(p.options), bash_values(p));
  return text + bash_end;
}

std::string zsh_completion(const CommandDescription& program) {
  std::string text = "#compdef withy\n# Completion of withy for zsh; made by `withy completion zsh`.\n";
  for (const Place& p : places_of(program)) text += zsh_place(p);
  return text + "_withy_\n";
}

}  // namespace withy::program
