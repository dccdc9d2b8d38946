#include "withy/results/report/animation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "withy/results/report/base64.hpp"
#include "withy/results/report/solids.hpp"
#include "withy/results/results_error.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

/// Of tubes and beads; the rings of a deep tree are many.
constexpr std::size_t sides = 8;
/// Half the thickness of the thinnest tube, over that of rods.
constexpr double least_of_radius = 0.3;
/// The thickness of the thinnest sheet, over the same.
constexpr double least_of_sheet = 0.2;

template <class Number>
std::vector<Number> array_of(const Json& run, const Json& index) {
  return numbers_of<Number>(run.at("arrays").at(index.get<std::size_t>()).get_ref<const std::string&>());
}

std::vector<std::array<std::uint32_t, 3>> triangles_of(const Json& run, const Json& index) {
  const auto corners = array_of<std::uint32_t>(run, index);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return triangles;
}

Vector3 vector_of(const Json& json, std::size_t at = 0) {
  return {json.at(at).get<double>(), json.at(at + 1).get<double>(), json.at(at + 2).get<double>()};
}

template <class Numbers>
Pose pose_from(const Numbers& n, std::size_t at) {
  const auto number = [&](std::size_t i) { return static_cast<double>(n[at + i]); };
  return {Eigen::Quaterniond(number(3), number(4), number(5), number(6)).normalized().toRotationMatrix(),
          Vector3(number(0), number(1), number(2))};
}

/// Points that a tube joins: those of a line, and of a body of data where they lie in a plane, in order of their way
/// from the root; of a body of data that has a volume none.
std::vector<std::size_t> joined(const std::string& kind, const std::vector<Vector3>& points) {
  std::vector<std::size_t> order;
  if ((kind != "line" && kind != "points") || points.size() < 2) return order;
  order.resize(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (kind == "line") return order;
  Matrix3 spread = Matrix3::Zero();
  const Vector3 center =
      std::accumulate(points.begin(), points.end(), Vector3(Vector3::Zero())) / double(points.size());
  for (const Vector3& p : points) spread += (p - center) * (p - center).transpose();
  const Vector3 along = Eigen::SelfAdjointEigenSolver<Matrix3>(spread).eigenvalues();
  if (along[0] > 1e-9 * along[2]) return {};
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return points[i].squaredNorm() < points[j].squaredNorm(); });
  return order;
}

}  // namespace

std::size_t Animation::Body::size() const {
  const std::size_t deformed = shapes.empty() ? (turns ? 6 : 3) * points.size() : weights();
  return 7 + (flexible ? deformed + 7 * hung : 0);
}

Animation::Body Animation::body_of(const nlohmann::ordered_json& part, const nlohmann::ordered_json& run) {
  Body body;
  body.name = part.at("name");
  body.kind = part.at("kind");
  body.flexible = part.at("flexible");
  body.columns = part.value("columns", std::size_t{1});
  body.thickness = part.value("thickness", 0.0);
  if (part.contains("shapes")) body.shapes = array_of<float>(run, part.at("shapes"));
  const Json& points = part.at("points");
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) body.points.push_back(vector_of(points, i));
  body.line = joined(body.kind, body.points);
  if (part.contains("box") && !part.at("box").is_null()) {
    body.has_box = true;
    body.edges = vector_of(part.at("box").at("edges"));
    body.box = pose_from(part.at("box").at("pose"), 0);
  }
  body.ends.emplace_back(Vector3::Zero());
  for (const Json& hung : part.at("hung")) body.ends.push_back(vector_of(hung));
  body.hung = part.at("hung").size();
  if (part.contains("sections")) {
    const Json& sections = part.at("sections");
    const auto widths = array_of<float>(run, sections.at("widths"));
    for (std::size_t i = 0; i + 1 < widths.size(); i += 2)
      body.outlines.push_back({sections.at("rectangle").get<bool>(), widths[i], widths[i + 1]});
    body.turns = sections.at("turns");
  }
  if (part.contains("triangles")) body.triangles = triangles_of(run, part.at("triangles"));
  if (part.contains("surface")) {
    Surface& given = body.given.emplace();
    const auto vertices = array_of<float>(run, part.at("surface").at(0));
    for (std::size_t i = 0; i + 2 < vertices.size(); i += 3)
      given.vertices.emplace_back(vertices[i], vertices[i + 1], vertices[i + 2]);
    given.triangles = triangles_of(run, part.at("surface").at(1));
  }
  if (part.contains("tip")) body.ends.push_back(vector_of(part.at("tip")));
  return body;
}

Animation::Animation(std::string_view text) try {
  const Json run = Json::parse(text);
  const Json& motion = run.at("animation");
  title_ = run.at("title");
  size_ = motion.at("size");
  numbers_ = array_of<float>(run, motion.at("numbers"));
  const std::vector<double> times = array_of<double>(run, motion.at("times"));
  for (std::size_t i = 0; i < times.size(); ++i) {
    // 32 bits tell times apart in what is written of this.
    if (!times_.empty() && !(static_cast<float>(times[i]) > static_cast<float>(times_.back()))) {
      moments_.back() = i;
      continue;
    }
    times_.push_back(times[i]);
    moments_.push_back(i);
  }
  if (times.empty() || numbers_.size() != times.size() * size_) throw ResultsError("the report holds no motion");
  if (const Vector3 g = vector_of(motion.at("gravity")); g.norm() > 0) up_ = -g.normalized();
  std::size_t at = 0;
  for (const Json& part : motion.at("parts")) {
    bodies_.push_back(body_of(part, run));
    bodies_.back().at = at;
    at += bodies_.back().size();
  }
  if (motion.contains("remainders")) remainders_ = array_of<float>(run, motion.at("remainders"));
  if (at != size_ || (far() && remainders_.size() != 3 * bodies_.size() * times.size()))
    throw ResultsError("the report holds other numbers than it says");
  join_segments(motion.at("parts"));
  radius_ = 0.011 * extent();
} catch (const Json::exception&) {
  throw ResultsError("the report holds no motion that this program can read");
}

/// Segments have the name of their beam, each but the first on the one before it; others have names of their own.
void Animation::join_segments(const Json& parts) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    body.root = b;
    const auto parent = parts[b].at("parent").get<std::ptrdiff_t>();
    if (parent < 0 || static_cast<std::size_t>(parent) >= b) continue;
    const Body& before = bodies_[static_cast<std::size_t>(parent)];
    if (before.name != body.name) continue;
    const Json& on = parts[static_cast<std::size_t>(parent)];
    const auto child = std::find(on.at("children").begin(), on.at("children").end(), Json(b));
    if (child == on.at("children").end()) continue;
    const Json& hung = on.at("hung").at(static_cast<std::size_t>(child - on.at("children").begin()));
    body.root = before.root;
    body.from_root = before.from_root * pose_from(hung.get<std::vector<double>>(), 0);
  }
}

Pose Animation::undeformed(std::size_t body, std::size_t moment) const {
  return pose(bodies_[body].root, moment) * bodies_[body].from_root;
}

Pose Animation::pose(std::size_t body, std::size_t moment) const {
  Pose X = pose_from(numbers_, moments_[moment] * size_ + bodies_[body].at);
  if (far())
    X.p +=
        Eigen::Map<const Eigen::Vector3f>(&remainders_[3 * (moments_[moment] * bodies_.size() + body)]).cast<double>();
  return X;
}

Animation::Shape Animation::shape_at(const Body& body, std::size_t moment) const {
  Shape shape{body.points, {}};
  if (!body.flexible) return shape;
  const float* u = numbers_.data() + moments_[moment] * size_ + body.at + 7;
  if (!body.shapes.empty()) {
    const auto rows = static_cast<Eigen::Index>(3 * body.points.size()),
               count = static_cast<Eigen::Index>(body.weights());
    const Eigen::VectorXf moved = Eigen::Map<const Eigen::MatrixXf>(body.shapes.data(), rows, count) *
                                  Eigen::Map<const Eigen::VectorXf>(u, count);
    for (std::size_t i = 0; i < shape.points.size(); ++i)
      shape.points[i] += moved.segment<3>(3 * static_cast<Eigen::Index>(i)).cast<double>();
    return shape;
  }
  const auto next = [&u] {
    const Vector3 v = Eigen::Map<const Eigen::Vector3f>(u).cast<double>();
    u += 3;
    return v;
  };
  for (Vector3& p : shape.points) p += next();
  for (std::size_t i = 0; body.turns && i < body.points.size(); ++i) shape.y_axes.push_back(next());
  return shape;
}

/// Of the system at the first moment [m].
double Animation::extent() const {
  Eigen::AlignedBox3d room;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Pose X = pose(b, 0);
    room.extend(X.p);
    for (const Vector3& p : shape_at(bodies_[b], 0).points) room.extend(X.p + X.R * p);
    for (const Vector3& p : bodies_[b].ends) room.extend(X.p + X.R * p);
  }
  return std::max(room.diagonal().norm(), 1e-3);
}

/// What is thinner than can be seen is drawn as thick as can be.
Surface Animation::tube(const Body& body, const Shape& shape) const {
  const bool known = body.outlines.size() == shape.points.size();
  Tube tube{{}, {}, {Vector3::UnitY()}};
  if (!shape.y_axes.empty()) tube.y_axes.clear();
  for (const std::size_t i : body.line) {
    tube.line.push_back(shape.points[i]);
    if (!shape.y_axes.empty()) tube.y_axes.push_back(shape.y_axes[i]);
    const Outline outline = known ? body.outlines[i] : Outline{false, radius_, radius_};
    const double least = least_of_radius * radius_;
    tube.outlines.push_back({outline.rectangle, std::max(outline.y, least), std::max(outline.z, least)});
  }
  Surface surface;
  add_tube(tube, sides, surface);
  return surface;
}

Surface Animation::drawn(const Body& body, const Shape& shape) const {
  if (body.given) return *body.given;
  Surface surface;
  if (body.kind == "strip") {
    add_sheet(shape.points, body.columns, std::max(body.thickness, least_of_sheet * radius_), surface);
    return surface;
  }
  if (body.kind == "mesh") return {shape.points, body.triangles};
  if (body.line.size() > 1) return tube(body, shape);
  if (body.kind == "points")
    for (const Vector3& p : shape.points) add_bead(p, radius_, surface);
  if (body.kind != "box") return surface;
  if (body.has_box) add_box(body.edges.cwiseMax(1.6 * radius_), body.box, surface);
  const Vector3 from = body.has_box ? body.box.p : Vector3(Vector3::Zero());
  for (const Vector3& end : body.ends)
    if ((end - from).norm() > radius_)
      add_tube({{from, end}, {{false, 0.5 * radius_, 0.5 * radius_}}, {Vector3::UnitZ()}}, sides, surface);
  return surface;
}

Surface Animation::surface(std::size_t body) const { return drawn(bodies_[body], {bodies_[body].points, {}}); }

std::vector<Vector3> Animation::vertices(std::size_t body, std::size_t moment) const {
  return drawn(bodies_[body], shape_at(bodies_[body], moment)).vertices;
}

}  // namespace withy
