#include "withy/scene/visual.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "withy/scene/grammar.hpp"
#include "withy/scene/mesh_file.hpp"

namespace withy {
namespace {

constexpr const char* shapes[] = {"box", "sphere", "cylinder", "mesh", "radius", "width", "height"};

/// Whether a shape is the section of a beam.
bool is_section(std::string_view key) { return key == "radius" || key == "width" || key == "height"; }

}  // namespace

ParameterSpec visual_spec() {
  std::vector<ParameterSpec> members = {
      vector("box", 3, "m", "a box with these edges").above(0).optional(),
      number("sphere", "m", "a ball of this radius").above(0).optional(),
      map("cylinder",
          {number("radius", "m", "radius").above(0),
           number("length", "m", "length along z, half to each side").above(0)},
          "a cylinder about z")
          .optional(),
      text("mesh", "a file, .stl or .obj; a relative name starts at the scene's directory").optional(),
      number("scale", "m", "length of the mesh's unit, as 1 mm").above(0).otherwise(1.0),
      number("radius", "m", "radius of a beam's round section").above(0).or_table("m").optional(),
      number("width", "m", "width along y of a beam's rectangular section").above(0).or_table("m").optional(),
      number("height", "m", "height along z of a beam's rectangular section").above(0).or_table("m").optional()};
  for (ParameterSpec& pose : grammar::pose_members()) members.push_back(std::move(pose));
  return map("visual", std::move(members), "what the body looks like in pictures; no result depends on it").optional();
}

bool check_visual(const Value& visual, const Body& body, const std::string& directory, Diagnostics& diagnostics) {
  std::string given;
  for (const char* shape : shapes)
    if (visual.has(shape)) given += (given.empty() ? "" : ", ") + std::string(shape);
  const bool section = is_section(given.substr(0, given.find(',')));
  const auto refuse = [&](const Value& at, const std::string& why) {
    diagnostics.error(at.place(), why);
    return false;
  };
  if (given.empty())
    return refuse(visual, "got no shape; need box, sphere, cylinder, mesh, radius, or width and height");
  if (given.find(',') != std::string::npos && given != "width, height")
    return refuse(
        visual, fmt::format("got {}; need one shape: box, sphere, cylinder, mesh, radius, or width and height", given));
  if (given == "width" || given == "height")
    return refuse(visual, fmt::format("got {} alone; need width and height", given));
  if (section && !(body.shape().length > 0 && body.station(0.0)))
    return refuse(visual,
                  fmt::format("got {}, which are of a beam's section; need box, sphere, cylinder or mesh", given));
  if (!section && body.shape().modes() > 0)
    return refuse(visual,
                  fmt::format("got {}, which does not bend; a flexible body is drawn from its own data, a beam with "
                              "radius, or width and height, if these are given",
                              given));
  if (!visual.has("mesh")) return true;
  const Value& mesh = visual.at("mesh");
  try {
    read_mesh(std::filesystem::path(directory) / mesh.text());
  } catch (const std::domain_error& e) {
    return refuse(mesh, fmt::format("got '{}'; {}", mesh.text(), e.what()));
  }
  return true;
}

std::set<std::string> meshes_of(const Value& bodies) {
  std::set<std::string> files;
  for (const auto& [name, body] : bodies.members()) {
    const Value* visual = body.find("visual");
    if (visual != nullptr && visual->has("mesh")) files.insert(visual->text_at("mesh"));
  }
  return files;
}

}  // namespace withy
