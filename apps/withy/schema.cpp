#include <CLI/CLI.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"

namespace withy::app {

namespace {

ExitStatus schema(const CommonArguments& arguments) {
  const Plugins plugins(arguments);
  print(withy::schema(plugins.registry()) + '\n');
  return ExitStatus::done;
}

std::function<ExitStatus()> add_schema(CLI::App& c) {
  const auto arguments = std::make_shared<CommonArguments>();
  CommonArguments& a = *arguments;
  add_common(c, a);
  return [arguments] { return schema(*arguments); };
}

}  // namespace

const Command schema_command = {"schema", "Print the JSON Schema of scenes, for editors", "  withy schema",
                                &add_schema};

}  // namespace withy::app
