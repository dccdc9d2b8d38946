#include "withy/bindings/fmi/resources.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "withy/scene/document.hpp"

namespace withy::fmi {

std::string write_recipe(const std::string& scene_file, const SceneOptions& options) {
  const nlohmann::ordered_json recipe{{"scene", scene_file},
                                      {"formulation", options.formulation},
                                      {"integrator", options.integrator},
                                      {"set", options.overrides}};
  return recipe.dump(1) + '\n';
}

SceneValues read_resources(const std::string& resources) {
  const std::filesystem::path folder = resources;
  try {
    const auto recipe = nlohmann::json::parse(read_bytes((folder / recipe_file).string()));
    SceneOptions options;
    options.formulation = recipe.at("formulation");
    options.integrator = recipe.at("integrator");
    options.overrides = recipe.at("set").get<std::vector<std::string>>();
    const std::string scene = recipe.at("scene");
    SceneValues values = SceneValues::read((folder / scene_folder / scene).string());
    values.apply(options);
    return values;
  } catch (const nlohmann::json::exception& e) {
    throw std::runtime_error((folder / recipe_file).string() + ": is not what withy has written: " + e.what());
  }
}

std::string folder_of(std::string_view location) {
  if (!location.starts_with("file:")) {
    if (location.find("://") != std::string_view::npos)
      throw std::invalid_argument("resources at '" + std::string(location) + "': need a file of this machine");
    return std::string(location);
  }
  location.remove_prefix(5);
  if (location.starts_with("//")) {
    location.remove_prefix(2);
    const std::size_t path = location.find('/');
    const std::string_view host = location.substr(0, path);
    if (path == std::string_view::npos || (!host.empty() && host != "localhost"))
      throw std::invalid_argument("resources at 'file://" + std::string(location) + "': need a file of this machine");
    location.remove_prefix(path);
  }
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string folder;
  for (std::size_t i = 0; i < location.size(); ++i) {
    if (location[i] == '%' && i + 2 < location.size() && digit(location[i + 1]) >= 0 && digit(location[i + 2]) >= 0) {
      folder += static_cast<char>(16 * digit(location[i + 1]) + digit(location[i + 2]));
      i += 2;
    } else {
      folder += location[i];
    }
  }
  return folder;
}

}  // namespace withy::fmi
