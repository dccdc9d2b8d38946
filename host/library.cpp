#include "withy/host/library.hpp"

#include <utility>

#include "withy/plugins/host/plugins.hpp"

namespace withy::host {

struct Library::Parts {
  Plugins plugins;
  std::function<void(std::string_view)> log;
};

Library::Library(LibraryOptions options)
    : parts_(std::make_shared<Parts>(Parts{Plugins(std::move(options.plugins)), std::move(options.log)})) {
  for (const PluginRecord& record : parts_->plugins.host().plugins())
    if (record.state == PluginRecord::State::refused) log(record.reason);
}

Registry& Library::registry() const { return parts_->plugins.registry(); }

void Library::log(std::string_view remark) const {
  if (parts_->log) parts_->log(remark);
}

}  // namespace withy::host
