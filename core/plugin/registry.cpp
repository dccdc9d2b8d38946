#include "withy/core/plugin/registry.hpp"

#include <algorithm>
#include <stdexcept>

#include "withy/core/plugin/parameter_faults.hpp"

namespace withy {
namespace {

template <class Interface, class Map>
void check(const std::vector<Plugin<Interface>>& incoming, const Map& present, const std::string& origin) {
  const std::string kind(kind_name<Interface>());
  for (std::size_t i = 0; i < incoming.size(); ++i) {
    const Plugin<Interface>& plugin = incoming[i];
    const std::string name = kind + " '" + plugin.id + "'";
    if (!is_plugin_id(plugin.id))
      throw std::invalid_argument(name + " from " + origin + ": ids are 1 to 64 of a-z, 0-9 and '-'");
    if (plugin.make == nullptr) throw std::invalid_argument(name + " from " + origin + " has no factory");
    if (const std::string fault = parameter_fault(plugin.parameters); !fault.empty())
      throw std::invalid_argument(name + " from " + origin + ": " + fault);
    if (const auto it = present.find(plugin.id); it != present.end()) {
      throw std::invalid_argument(name + " is in two places: " + it->second.origin + " and " + origin);
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (incoming[j].id == plugin.id) throw std::invalid_argument(name + " is twice in " + origin);
    }
  }
}

}  // namespace

bool is_plugin_id(std::string_view text) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  });
}

std::map<std::string, std::string> Enrollment::summaries() const {
  std::map<std::string, std::string> summaries;
  const auto collect = [&]<class Interface>(const std::vector<Plugin<Interface>>& plugins) {
    for (const auto& plugin : plugins) {
      summaries.emplace(std::string(kind_name<Interface>()) + "/" + plugin.id, plugin.summary);
    }
  };
  std::apply([&](const auto&... kind) { (collect(kind), ...); }, plugins_);
  return summaries;
}

void Registry::admit(Enrollment enrollment, const std::string& origin) {
  const std::lock_guard lock(*mutex_);
  const auto each = [&](auto&& action) {
    std::apply([&](auto&... kind) { (action(kind), ...); }, enrollment.plugins_);
  };
  each([&]<class Interface>(std::vector<Plugin<Interface>>& plugins) {
    check(plugins, std::get<Map<Interface>>(maps_), origin);
  });
  each([&]<class Interface>(std::vector<Plugin<Interface>>& plugins) {
    for (Plugin<Interface>& plugin : plugins) {
      plugin.origin = origin;
      std::string id = plugin.id;
      std::get<Map<Interface>>(maps_).emplace(std::move(id), std::move(plugin));
    }
  });
}

void Registry::set_loader(std::function<bool(Registry&, std::string_view, std::string_view)> load,
                          std::function<std::vector<std::string>(std::string_view)> list) {
  const std::lock_guard lock(*mutex_);
  loader_ = std::move(load);
  lister_ = std::move(list);
}

std::vector<std::string> Registry::sorted_unique(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace withy
