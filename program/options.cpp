#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "withy/program/command.hpp"
#include "withy/scene/names.hpp"

namespace withy::program {

namespace {

template <class T>
struct Plain {
  using Type = T;
};
template <class T>
struct Plain<std::optional<T>> {
  using Type = T;
};
/// Each number of a list is read by itself.
template <class T>
requires std::is_arithmetic_v<T>
struct Plain<std::vector<T>> {
  using Type = T;
};

/// What is wrong with a text that is to be a value of a type; the parser's own words are the text alone, it takes -1
/// for the greatest number without a sign, "nan" and "inf" for numbers, and an empty text for an option that is not
/// there.
template <class T>
std::string problem_of(const std::string& text) {
  if constexpr (std::is_arithmetic_v<T>) {
    T read{};
    bool good = CLI::detail::lexical_cast(text, read) && !(std::is_unsigned_v<T> && text.starts_with('-'));
    if constexpr (std::is_floating_point_v<T>) good = good && std::isfinite(read);
    const char* needed = std::is_floating_point_v<T> ? "finite number"
                         : std::is_unsigned_v<T>     ? "whole number from 0"
                                                     : "whole number";
    if (!good) return "got " + in_quotes(text) + "; need a " + needed;
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (text.empty()) return "got an empty text; leave it out, or give it a value";
  }
  return {};
}

template <class T>
void check_type(CLI::Option& option) {
  option.check(CLI::Validator([](const std::string& text) { return problem_of<typename Plain<T>::Type>(text); }, ""));
}

}  // namespace

template <class T>
Options& Options::argument(const std::string& names, T& value, const std::string& meaning) {
  last_ = parser_.add_option(names, value, meaning);
  check_type<T>(*last_);
  return *this;
}

template <class T>
Options& Options::value(const std::string& names, T& value, const std::string& type, const std::string& meaning) {
  last_ = parser_.add_option(names, value, meaning)->type_name(type);
  check_type<T>(*last_);
  return *this;
}

template <class T>
Options& Options::list(const std::string& names, T& values, const std::string& type, const std::string& meaning) {
  value(names, values, type, meaning);
  last_->delimiter(',');
  return *this;
}

Options& Options::repeated(const std::string& names, std::vector<std::string>& values, const std::string& type,
                           const std::string& meaning) {
  value(names, values, type, meaning);
  last_->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->expected(1)->allow_extra_args(false);
  return *this;
}

template <class T>
Options& Options::flag(const std::string& names, T& value, const std::string& meaning) {
  // A value that may be left out would be set to false where it is: the parser takes it for a count.
  last_ = parser_
              .add_flag_function(
                  names, [&value](std::int64_t count) { value = count > 0; }, meaning)
              ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  return *this;
}

Options& Options::required() {
  last_->required();
  return *this;
}

Options& Options::with_default() {
  last_->capture_default_str();
  return *this;
}

Options& Options::positive() {
  last_->check(CLI::Validator(
      [](const std::string& text) {
        double x = 0;
        const bool good = CLI::detail::lexical_cast(text, x) && x > 0;
        return good ? std::string() : "got " + in_quotes(text) + "; need a number > 0";
      },
      "POSITIVE"));
  return *this;
}

template <class T>
Options& Options::between(T least, T most) {
  last_->check(CLI::Range(least, most));
  return *this;
}

Options& Options::among(std::initializer_list<const char*> words) {
  last_->check(CLI::IsMember(std::vector<std::string>(words.begin(), words.end())));
  return *this;
}

Options& Options::among(std::initializer_list<int> numbers) {
  last_->check(CLI::IsMember(std::vector<int>(numbers)));
  return *this;
}

Options& Options::checked(std::function<std::string(const std::string&)> problem) {
  last_->check(CLI::Validator([problem = std::move(problem)](std::string& text) { return problem(text); }, ""));
  return *this;
}

Options& Options::excludes(const std::string& other) {
  last_->excludes(parser_.get_option(other));
  return *this;
}

Call Options::parts(std::span<const Command* const> commands) {
  const auto chosen = std::make_shared<Call>();
  parser_.require_subcommand(1);
  for (const Command* command : commands) {
    CLI::App& part = *parser_.add_subcommand(command->name, command->meaning);
    part.footer(std::string("Examples:\n") + command->examples);
    Options options(part);
    part.callback([chosen, call = command->add(options)] { *chosen = call; });
  }
  return [chosen] { return (*chosen)(); };
}

// The values that commands are told.
#define WITHY_VALUE(T)                                                             \
  template Options& Options::argument(const std::string&, T&, const std::string&); \
  template Options& Options::value(const std::string&, T&, const std::string&, const std::string&);

WITHY_VALUE(std::string)
WITHY_VALUE(int)
WITHY_VALUE(std::uint64_t)
WITHY_VALUE(double)
WITHY_VALUE(std::optional<int>)
WITHY_VALUE(std::optional<double>)
WITHY_VALUE(std::vector<std::string>)
WITHY_VALUE(std::optional<std::vector<std::string>>)
WITHY_VALUE(std::vector<int>)
WITHY_VALUE(std::vector<double>)

template Options& Options::list(const std::string&, std::vector<std::string>&, const std::string&, const std::string&);
template Options& Options::list(const std::string&, std::optional<std::vector<std::string>>&, const std::string&,
                                const std::string&);
template Options& Options::list(const std::string&, std::vector<int>&, const std::string&, const std::string&);
template Options& Options::list(const std::string&, std::vector<double>&, const std::string&, const std::string&);
template Options& Options::flag(const std::string&, bool&, const std::string&);
template Options& Options::flag(const std::string&, std::optional<bool>&, const std::string&);
template Options& Options::between(int, int);
template Options& Options::between(std::uint64_t, std::uint64_t);

}  // namespace withy::program
