#include <set>
#include <string>

#include "withy/apps/withy/engine.hpp"
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
  const std::string text = withy::schema(plugins.registry());
  print(text + '\n');
  std::set<std::string> reasons;
  for (const PluginRecord& record : plugins.host().plugins())
    if (record.state == PluginRecord::State::refused && reasons.insert(record.reason).second)
      complain("left out: " + record.reason);
  return ExitStatus::done;
}

void add_schema(Options& o, SchemaArguments& a) {
  add_common(o, a);
  o.flag("--sweep", a.sweep, "Of the plans of sweeps instead");
}

}  // namespace

const Command schema_command = {"schema", "Print the JSON Schema of scenes, for editors",
                                "  withy schema\n  withy schema --sweep", &taking<SchemaArguments, add_schema, schema>};

}  // namespace withy::app
