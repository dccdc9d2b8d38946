#include "withy/scene/visual.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "withy/scene/grammar.hpp"
#include "withy/scene/mesh_file.hpp"

namespace withy {
namespace {

constexpr const char* shapes[] = {"box", "sphere", "cylinder", "mesh", "radius", "width", "height", "thickness"};

/// Whether a shape is the section of a beam.
bool is_section(std::string_view key) { return key == "radius" || key == "width" || key == "height"; }
bool is_plate(const Body& body) { return body.station("left") && body.station("right"); }
bool is_beam(const Body& body) { return !is_plate(body) && body.shape().length > 0 && body.station(0.0); }
bool bends(const Body& body) { return body.shape().modes() > 0; }

/// Whether a body can be drawn with what is given of it.
bool fits(const std::string& given, const Body& body) {
  if (given == "thickness") return is_plate(body);
  if (is_section(given.substr(0, given.find(',')))) return is_beam(body);
  if (given == "mesh" && bends(body)) return !is_plate(body) && !is_beam(body);
  return !bends(body);
}

/// What there is to choose from for a body.
const char* choice(const Body& body) {
  if (is_plate(body)) return "thickness, for a plate";
  if (is_beam(body)) return "radius, or width and height, for a beam";
  if (bends(body)) return "mesh, with the .vtk file that withy import wrote, for a body of modes";
  return "box, sphere, cylinder or mesh, for a rigid body";
}

/// Whether the file of a mesh can be read, and has what the body needs.
bool check_mesh(const Value& visual, const Body& body, const std::string& directory, Diagnostics& diagnostics) {
  const Value& mesh = visual.at("mesh");
  const auto refuse = [&](const std::string& why) {
    diagnostics.error(mesh.place(), fmt::format("got '{}'; {}", mesh.text(), why));
    return false;
  };
  const std::filesystem::path file = std::filesystem::path(directory) / mesh.text();
  const Eigen::Index modes = body.shape().modes();
  try {
    if (modes == 0) {
      read_mesh(file);
      return true;
    }
    const Eigen::Index known = read_mode_surface(file).first.cols();
    if (known != modes)
      return refuse(
          fmt::format("it has the shapes of {} modes, the body has {}; need the file that withy import wrote "
                      "together with the body's",
                      known, modes));
  } catch (const std::domain_error& e) {
    return refuse(e.what());
  }
  const bool placed = visual.at("position").numbers() != std::vector<double>{0, 0, 0} ||
                      visual.at("orientation").numbers() != std::vector<double>{1, 0, 0, 0};
  if (placed || visual.number_at("scale") != 1)
    return refuse("its vertices are in m and in the body's axes; need no position, orientation or scale");
  return true;
}

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
      text("mesh", "a file, .stl or .obj, of a flexible body .vtk; a relative name starts at the scene's directory")
          .optional(),
      number("scale", "m", "length of the mesh's unit, as 1 mm").above(0).otherwise(1.0),
      number("radius", "m", "radius of a beam's round section").above(0).or_table("m").optional(),
      number("width", "m", "width along y of a beam's rectangular section").above(0).or_table("m").optional(),
      number("height", "m", "height along z of a beam's rectangular section").above(0).or_table("m").optional(),
      number("thickness", "m", "thickness of a plate").above(0).optional()};
  for (const ParameterSpec& pose : grammar::pose_members()) members.push_back(pose);
  return map("visual", std::move(members), "what the body looks like in pictures; no result depends on it").optional();
}

bool check_visual(const Value& visual, const Body& body, const std::string& directory, Diagnostics& diagnostics) {
  std::string given;
  for (const char* shape : shapes)
    if (visual.has(shape)) given += (given.empty() ? "" : ", ") + std::string(shape);
  const auto refuse = [&](const std::string& why) {
    diagnostics.error(visual.place(), why);
    return false;
  };
  if (given.empty()) return refuse(fmt::format("got no shape; need {}", choice(body)));
  if (given.find(',') != std::string::npos && given != "width, height")
    return refuse(fmt::format("got {}; need one shape: {}", given, choice(body)));
  if (given == "width" || given == "height") return refuse(fmt::format("got {} alone; need width and height", given));
  if (!fits(given, body)) return refuse(fmt::format("got {}; need {}", given, choice(body)));
  return given != "mesh" || check_mesh(visual, body, directory, diagnostics);
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
