#include "withy/results/run_command.hpp"

#include <algorithm>
#include <string_view>

namespace withy {
namespace {

/// As it is where every shell takes it for one word.
std::string one_word(const std::string& text) {
  constexpr std::string_view plain = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_./+,:@%-";
  return !text.empty() && text.find_first_not_of(plain) == std::string::npos ? text : quoted(text);
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + '\'';
}

std::string command_with(const std::string& command, const std::string& file,
                         const std::vector<std::string>& plugin_folders) {
  std::string text = command + ' ' + one_word(file);
  for (const std::string& folder : plugin_folders) text += " --plugins " + one_word(folder);
  return text;
}

}  // namespace withy
