#include "withy/results/report/looks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "withy/scene/mesh_file.hpp"

namespace withy {
namespace {

/// E/ρ of metals [m²/s²], and ρ of aluminium [kg/m³].
constexpr double metal_modulus = 2.6e7, metal_density = 2700;
/// Half axes of a solid ellipse over its radii of gyration.
constexpr double solid = 2;
constexpr double most_of_length = 0.1;

/// A number, or of a table over x what it has there.
double at_place(const Value& value, double x) {
  if (value.kind() == Value::Kind::number) return value.number();
  const auto& rows = value.items();
  const auto number = [](const Value& row, std::size_t i) { return row.items()[i].number(); };
  std::size_t k = 1;
  while (k + 1 < rows.size() && number(rows[k], 0) < x) ++k;
  if (rows.size() < 2) return number(rows[0], 1);
  const double x0 = number(rows[k - 1], 0), x1 = number(rows[k], 0);
  const double w = std::clamp((x - x0) / (x1 - x0), 0.0, 1.0);
  return (1 - w) * number(rows[k - 1], 1) + w * number(rows[k], 1);
}

Pose pose_of_visual(const Value& visual) {
  const std::vector<double> p = visual.at("position").numbers(), q = visual.at("orientation").numbers();
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(), Vector3(p[0], p[1], p[2])};
}

Surface surface_of(const Value& visual, const std::filesystem::path& folder) {
  Surface surface;
  if (const Value* box = visual.find("box")) {
    const std::vector<double> e = box->numbers();
    add_box({e[0], e[1], e[2]}, {Matrix3::Identity(), Vector3::Zero()}, surface);
  } else if (const Value* sphere = visual.find("sphere")) {
    add_ball(sphere->number(), surface);
  } else if (const Value* cylinder = visual.find("cylinder")) {
    const double r = cylinder->number_at("radius"), half = cylinder->number_at("length") / 2;
    add_tube({{{0, 0, -half}, {0, 0, half}}, {{false, r, r}}, {Vector3::UnitX()}}, 32, surface);
  } else if (const Value* mesh = visual.find("mesh")) {
    TriangleMesh read = read_mesh(folder / mesh->text());
    surface = {std::move(read.vertices), std::move(read.triangles)};
    for (Vector3& v : surface.vertices) v *= visual.number_at("scale");
  }
  const Pose pose = pose_of_visual(visual);
  for (Vector3& v : surface.vertices) v = pose.p + pose.R * v;
  return surface;
}

Outline given_section(const Value& visual, double x) {
  if (const Value* radius = visual.find("radius")) {
    const double r = at_place(*radius, x);
    return {false, r, r};
  }
  return {true, at_place(visual.at("width"), x) / 2, at_place(visual.at("height"), x) / 2};
}

/// Whether a body of the scene has modes.
bool bends(const Scene& scene, const std::string& body) {
  const auto& all = scene.model->bodies();
  return std::any_of(all.begin(), all.end(),
                     [&](const BodyNode& node) { return node.name == body && node.body->shape().modes() > 0; });
}

}  // namespace

Outline equivalent_section(const Value& beam, double x) {
  const double mu = at_place(beam.at("mass_per_length"), x);
  // Squares of the radii of gyration for deflection along y and along z; 0: not known yet.
  double square[2] = {0, 0}, EI[2] = {0, 0};
  for (const int k : {0, 1}) {
    const Value* bending = beam.find(k == 0 ? "bending_y" : "bending_z");
    if (bending == nullptr) continue;
    EI[k] = at_place(bending->at("stiffness"), x);
    if (const Value* inertia = bending->find("rotary_inertia")) square[k] = at_place(*inertia, x) / mu;
    if (const Value* extension = beam.find("extension"); extension != nullptr && !(square[k] > 0))
      square[k] = EI[k] / at_place(extension->at("stiffness"), x);
  }
  if (const Value* torsion = beam.find("torsion")) {
    const double polar = at_place(torsion->at("inertia"), x) / mu;
    for (const int k : {0, 1}) {
      const double other = square[1 - k];
      if (square[k] > 0) continue;
      if (other > 0 && other < polar)
        square[k] = polar - other;
      else if (!(other > 0))
        square[k] = polar * (EI[0] > 0 && EI[1] > 0 ? EI[k] / (EI[0] + EI[1]) : 0.5);
    }
  }
  for (const int k : {0, 1})
    if (!(square[k] > 0) && EI[k] > 0) square[k] = EI[k] / mu / metal_modulus;
  for (const int k : {0, 1})
    if (!(square[k] > 0)) square[k] = square[1 - k];
  if (!(square[0] > 0)) square[0] = square[1] = mu / metal_density / (4 * std::numbers::pi);
  const double most = most_of_length * beam.number_at("length");
  return {false, std::min(solid * std::sqrt(square[0]), most), std::min(solid * std::sqrt(square[1]), most)};
}

double equivalent_thickness(const Value& plate) {
  const double nu = plate.number_at("poisson_ratio");
  const double square = 12 * (1 - nu * nu) * plate.number_at("stiffness") / plate.number_at("mass_per_area");
  return std::min(std::sqrt(square / metal_modulus),
                  most_of_length * std::min(plate.number_at("length"), plate.number_at("width")));
}

Looks::Looks(const Scene& scene) {
  const std::filesystem::path folder = scene.folder_now();
  auto known = std::make_shared<Known>();
  for (const auto& [name, value] : scene.source.at("bodies").members()) {
    known->bodies.emplace(name, &value);
    const Value* visual = value.find("visual");
    if (visual == nullptr) continue;
    if (visual->has("mesh") && bends(scene, name)) {
      known->mode_surfaces.emplace(name, read_mode_surface(folder / visual->text_at("mesh")));
      continue;
    }
    if (Surface surface = surface_of(*visual, folder); !surface.triangles.empty())
      known->surfaces.emplace(name, std::move(surface));
  }
  known_ = std::move(known);
}

const Value* Looks::body(const std::string& name) const {
  const auto found = known_->bodies.find(name);
  return found == known_->bodies.end() ? nullptr : found->second;
}

const Surface* Looks::surface(const std::string& body) const {
  const auto found = known_->surfaces.find(body);
  return found == known_->surfaces.end() ? nullptr : &found->second;
}

const ModeSurface* Looks::mode_surface(const std::string& body) const {
  const auto found = known_->mode_surfaces.find(body);
  return found == known_->mode_surfaces.end() ? nullptr : &found->second;
}

double Looks::thickness(const std::string& name) const {
  const Value* plate = body(name);
  if (plate == nullptr) return 0;
  const Value* visual = plate->find("visual");
  if (visual != nullptr && visual->has("thickness")) return visual->number_at("thickness");
  return plate->text_at("type") == "plate" ? equivalent_thickness(*plate) : 0;
}

std::vector<Outline> Looks::sections(const BodyNode& node, const std::vector<double>& x) const {
  std::vector<Outline> sections;
  const Value* beam = body(node.scene_name());
  if (beam == nullptr) return sections;
  const Value* visual = beam->find("visual");
  if (visual == nullptr && beam->text_at("type") != "beam") return sections;
  const double before = node.segment ? static_cast<double>(node.segment->index) * node.body->shape().length : 0;
  for (const double at : x)
    sections.push_back(visual != nullptr ? given_section(*visual, before + at)
                                         : equivalent_section(*beam, before + at));
  return sections;
}

}  // namespace withy
