#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"

namespace withy::app {

ExitStatus schema(const CommonArguments& arguments) {
  const Plugins plugins(arguments);
  print(withy::schema(plugins.registry()) + '\n');
  return ExitStatus::done;
}

}  // namespace withy::app
