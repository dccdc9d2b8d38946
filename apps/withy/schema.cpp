#include <CLI/CLI.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/campaign/plan_schema.hpp"

namespace withy::app {

namespace {

struct SchemaArguments : CommonArguments {
  bool sweep = false;
};

ExitStatus schema(const SchemaArguments& arguments) {
  if (arguments.sweep) {
    print(campaign::plan_schema() + '\n');
    return ExitStatus::done;
  }
  const Plugins plugins(arguments);
  print(withy::schema(plugins.registry()) + '\n');
  return ExitStatus::done;
}

std::function<ExitStatus()> add_schema(CLI::App& c) {
  const auto arguments = std::make_shared<SchemaArguments>();
  SchemaArguments& a = *arguments;
  add_common(c, a);
  c.add_flag("--sweep", a.sweep, "Of the plans of sweeps instead");
  return [arguments] { return schema(*arguments); };
}

}  // namespace

const Command schema_command = {"schema", "Print the JSON Schema of scenes, for editors",
                                "  withy schema\n  withy schema --sweep", &add_schema};

}  // namespace withy::app
