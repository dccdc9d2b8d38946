#include "withy/results/report/drawing.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <unordered_map>

#include "withy/core/kinematics/observation.hpp"
#include "withy/core/shape/section_fields.hpp"
#include "withy/results/report/seen_pose.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

/// Points along a line: enough for the highest mode that models of a body have.
constexpr int most_sections = 24;
constexpr int least_sections = 4;
/// Points of all bodies together, about.
constexpr std::size_t most_points = 1500;
/// Nodes of a body of data.
constexpr std::size_t most_nodes = 200;
/// Points of a plate: along it, and across.
constexpr int strip_rows = 16, strip_columns = 8;

void append_vector(const Vector3& v, std::vector<float>& numbers) {
  for (int i = 0; i < 3; ++i) numbers.push_back(static_cast<float>(v[i]));
}

void append_pose(const Pose& X, std::vector<float>& numbers) {
  append_vector(X.p, numbers);
  const Eigen::Quaterniond q(X.R);
  for (const double c : {q.w(), q.x(), q.y(), q.z()}) numbers.push_back(static_cast<float>(c));
}

Json vector_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json pose_json(const Pose& X) {
  const Eigen::Quaterniond q(X.R);
  return {X.p.x(), X.p.y(), X.p.z(), q.w(), q.x(), q.y(), q.z()};
}

/// Whether a body's root is where the body is, whatever its modes.
bool root_is_body(const BodyNode& node) {
  const Frame& root = node.frames.front();
  return root.section.X.isZero(0) && root.pose.p.isZero(0) && root.pose.R.isIdentity(0) &&
         !moved_by_modes(root.section);
}

/// A homogeneous box: edges [m] and pose in its body.
struct MassBox {
  Vector3 edges;
  Pose pose;
};

/// That with a body's mass and inertia about its centre of mass; of a body without mass none.
std::optional<MassBox> mass_box(const ModalShape& shape) {
  double mass = 0;
  Vector3 moment = Vector3::Zero();
  Matrix3 about_origin = Matrix3::Zero();
  const auto square = [](const Vector3& c) -> Matrix3 { return -skew(c) * skew(c); };
  for (const Particle& p : shape.particles) {
    mass += p.mass;
    moment += p.mass * p.at.X;
    about_origin += p.mass * square(p.at.X);
  }
  for (const Section& s : shape.sections) about_origin += s.inertia;
  if (!(mass > 0)) return std::nullopt;
  const Vector3 center = moment / mass;
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(about_origin - mass * square(center));
  const Vector3& I = principal.eigenvalues();
  Vector3 edges;
  for (int i = 0; i < 3; ++i) edges[i] = std::sqrt(std::max(0.0, 6 * (I.sum() - 2 * I[i]) / mass));
  Matrix3 R = principal.eigenvectors();
  if (R.determinant() < 0) R.col(0) *= -1;
  return MassBox{edges, {R, center}};
}

Json box_json(const ModalShape& shape) {
  const std::optional<MassBox> box = mass_box(shape);
  if (!box) return nullptr;
  return {{"edges", vector_json(box->edges)}, {"pose", pose_json(box->pose)}};
}

}  // namespace

Drawing::Drawing(const std::shared_ptr<const Model>& model, const Terms& terms, Looks looks,
                 const EquationsOfMotion* equations)
    : looks_(std::move(looks)), model_(Model::in_kinematics(model, terms)) {
  parts_.resize(model_->bodies().size());
  std::unordered_map<const Body*, std::size_t> first;  // equal bodies are one object
  std::vector<BodyNode> framed;
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const BodyNode& node = model_->bodies()[b];
    Part& part = parts_[b];
    part.flexible = node.body->shape().modes() > 0;
    const Terms& own = node.terms ? *node.terms : terms;
    if (add_strip(node, part, own.strain != StrainOrder::linear) ||
        add_mesh(node, part, own.strain != StrainOrder::linear))
      continue;
    const auto [twin, fresh] =
        node.terms || !part.flexible ? std::pair(first.end(), true) : first.try_emplace(node.body.get(), b);
    if (fresh) {
      add_points(node, model_->hinges()[b].hinge, terms, part);
    } else {
      const Part& same = parts_[twin->second];
      part.kind = same.kind;
      part.at_rest = same.at_rest;
      part.bent = same.bent;
    }
    if (part.kind == Kind::line) add_sections(node, part);
  }
  hang(model_->hinges());
  see(terms, equations);
}

/// What hangs on each part, and how many numbers a moment has with it.
void Drawing::hang(const std::vector<HingeNode>& hinges) {
  for (const HingeNode& hinge : hinges) {
    if (hinge.parent < 0) continue;
    Part& part = parts_[static_cast<std::size_t>(hinge.parent)];
    part.children.push_back(hinge.child);
    part.hung.push_back(hinge.parent_frame);
    part.offsets.push_back(hinge.offset);
  }
  for (const Part& part : parts_) {
    const std::size_t points = part.bent == nullptr ? 0 : part.at_rest.size();
    const auto shapes = static_cast<std::size_t>(part.shapes.shapes().cols());
    size_ += 7 + (part.flexible ? (part.turns ? 6 : 3) * points + shapes + 7 * part.hung.size() : 0);
  }
}

/// Makes the observation, of a model with a frame more where a body's root is not where the body is.
void Drawing::see(const Terms& terms, const EquationsOfMotion* equations) {
  const std::vector<BodyNode>& given = model_->bodies();
  if (!std::all_of(given.begin(), given.end(), root_is_body)) {
    equations = nullptr;
    std::vector<BodyNode> bodies = given;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (root_is_body(bodies[b])) continue;
      parts_[b].frame = static_cast<int>(bodies[b].frames.size());
      bodies[b].frames.push_back({"", PointExpansion::rigid(Vector3::Zero(), bodies[b].body->shape().modes()), {}});
    }
    model_ = std::make_shared<const Model>(std::move(bodies), model_->hinges(), model_->gravity());
  }
  seen_ = equations != nullptr ? equations->make_observation() : observed_model(*model_, terms)->make_observation();
}

void Drawing::add_points(const BodyNode& node, const std::shared_ptr<const Hinge>& hinge, const Terms& terms,
                         Part& part) const {
  std::vector<PointExpansion> points = along(node);
  part.kind = !points.empty() ? Kind::line : part.flexible ? Kind::points : Kind::box;
  if (part.kind == Kind::points) {
    std::istringstream names(node.body->stations());
    std::string name;
    while (std::getline(names >> std::ws, name, ',') && points.size() < most_nodes)
      if (auto section = node.body->station(name)) points.push_back(std::move(*section));
  }
  for (const PointExpansion& point : points) part.at_rest.push_back(point.X);
  if (part.flexible) part.bent = std::make_shared<BentBody>(node, hinge, terms, points);
  // The points of a rigid body that is no line are its frames.
  if (part.kind == Kind::box)
    for (const Frame& frame : node.frames) part.at_rest.push_back(frame.section.X + frame.pose.p);
}

/// Sections at even distances along a slender body; of another none.
std::vector<PointExpansion> Drawing::along(const BodyNode& node) const {
  const double length = node.body->shape().length;
  std::vector<PointExpansion> points;
  if (!(length > 0) || !node.body->station(0.0) || !node.body->station(length)) return points;
  const int sections = std::clamp(static_cast<int>(most_points / parts_.size()), least_sections, most_sections);
  for (int i = 0; i <= sections; ++i) {
    auto section = node.body->station(length * i / sections);
    if (!section || section->X.tail<2>().norm() > 1e-9 * length) return {};
    points.push_back(std::move(*section));
  }
  return points;
}

void Drawing::add_sections(const BodyNode& node, Part& part) const {
  std::vector<double> places;
  for (const Vector3& p : part.at_rest) places.push_back(p.x());
  part.sections = looks_.sections(node, places);
  const bool round = std::all_of(part.sections.begin(), part.sections.end(), [](const Outline& o) {
    return !o.rectangle && std::abs(o.y - o.z) <= 1e-3 * std::max(o.y, o.z);
  });
  part.turns = part.flexible && !round && node.body->station(part.at_rest.back().x())->psi.row(0).any();
}

const Surface* Drawing::surface(std::size_t body) const {
  const BodyNode& node = model_->bodies()[body];
  return looks_.surface(node.scene_name());
}

/// Of a body with corners `left` and `right` at its tip and stations "(x, y)": its surface, row by row from the root,
/// each from the left.
bool Drawing::add_strip(const BodyNode& node, Part& part, bool second_order) const {
  const double length = node.body->shape().length;
  const auto left = node.body->station("left"), right = node.body->station("right");
  if (!left || !right || !(length > 0)) return false;
  const double y_left = left->X.y(), width = y_left - right->X.y();
  std::vector<PointExpansion> points;
  for (int i = 0; i <= strip_rows; ++i)
    for (int j = 0; j <= strip_columns; ++j) {
      auto point =
          node.body->station(fmt::format("({}, {})", length * i / strip_rows, y_left - width * j / strip_columns));
      if (!point) return false;
      part.at_rest.push_back(point->X);
      points.push_back(std::move(*point));
    }
  part.shapes = {points, second_order};
  part.columns = strip_columns + 1;
  part.thickness = looks_.thickness(node.name);
  part.kind = Kind::strip;
  return true;
}

/// Of a body of modes whose outer faces the scene names.
bool Drawing::add_mesh(const BodyNode& node, Part& part, bool second_order) const {
  const ModeSurface* given = looks_.mode_surface(node.name);
  if (given == nullptr) return false;
  part.at_rest = given->mesh.vertices;
  part.triangles = given->mesh.triangles;
  part.shapes = {given->first, second_order ? given->second : Eigen::MatrixXf(given->first.rows(), 0)};
  part.kind = Kind::mesh;
  return true;
}

/// Weights of the shapes of a body at a state of the drawn model.
Eigen::VectorXf Drawing::weights(std::size_t body, std::span<const double> y) const {
  const Slot* modes = model_->layout().modes(body);
  return modes == nullptr ? Eigen::VectorXf()
                          : parts_[body].shapes.weights(y.subspan(modes->position, modes->positions));
}

/// Where a vertex is that shapes displace, in the world, at the state last seen.
Vector3 Drawing::place(std::size_t body, std::size_t point, const Eigen::VectorXf& weights) const {
  const Part& part = parts_[body];
  Vector3 displacement = Vector3::Zero();
  if (weights.size() > 0)
    displacement = (part.shapes.shapes().middleRows<3>(3 * static_cast<Eigen::Index>(point)) * weights).cast<double>();
  const Pose X_WB = seen_pose(*seen_, static_cast<int>(body), part.frame);
  return X_WB.p + X_WB.R * (part.at_rest[point] + displacement);
}

Json Drawing::part(std::size_t body) const {
  const Part& part = parts_[body];
  const BodyNode& node = model_->bodies()[body];
  static constexpr const char* kinds[] = {"box", "line", "strip", "mesh", "points"};
  Json j{{"name", node.scene_name()},
         {"kind", kinds[static_cast<int>(part.kind)]},
         {"parent", model_->hinges()[body].parent},
         {"moves", model_->hinges()[body].hinge->coordinates() > 0},
         {"flexible", part.flexible}};
  j["points"] = Json::array();
  for (const Vector3& X : part.at_rest)
    for (const double x : X) j["points"].push_back(x);
  if (part.kind == Kind::strip) {
    j["columns"] = part.columns;
    j["thickness"] = part.thickness;
  }
  if (!part.flexible && part.kind == Kind::box) j["box"] = box_json(node.body->shape());
  j["children"] = part.children;
  j["hung"] = Json::array();
  for (std::size_t i = 0; i < part.hung.size(); ++i) {
    const Frame& frame = node.frames[static_cast<std::size_t>(part.hung[i])];
    j["hung"].push_back(pose_json(Pose{Matrix3::Identity(), frame.section.X} * frame.pose * part.offsets[i]));
  }
  const int tip = node.frame("tip");
  if (tip >= 0) {
    const Frame& frame = node.frames[static_cast<std::size_t>(tip)];
    j["tip"] = vector_json(frame.section.X + frame.pose.p);
  }
  return j;
}

/// Bends the body to its modal coordinates at a state. False where it is rigid, or shapes displace its points.
bool Drawing::bend(std::size_t body, std::span<const double> y) {
  const Part& part = parts_[body];
  if (part.bent == nullptr) return false;
  const Slot& modes = *model_->layout().modes(body);
  part.bent->bend(y.subspan(modes.position, modes.positions));
  return true;
}

/// A drawn model with frames of its own has no loads, and so none of their discrete states.
std::span<const double> Drawing::without_discrete(std::span<const double> y) const {
  return y.first(model_->layout().size());
}

double Drawing::extent(std::span<const double> y) {
  seen_->observe(without_discrete(y));
  Eigen::AlignedBox3d room;
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const Part& part = parts_[b];
    const Pose X_WB = seen_pose(*seen_, static_cast<int>(b), part.frame);
    const auto add = [&](const Vector3& p) { room.extend(X_WB.p + X_WB.R * p); };
    for (const Vector3& p : part.at_rest) add(p);
    if (part.flexible || part.kind != Kind::box) continue;
    if (const Surface* given = surface(b)) {
      for (const Vector3& p : given->vertices) add(p);
    } else if (const auto box = mass_box(model_->bodies()[b].body->shape())) {
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        add(box->pose.p + box->pose.R * (0.5 * sign.cwiseProduct(box->edges)));
      }
    }
  }
  return room.isEmpty() ? 0 : room.diagonal().norm();
}

void Drawing::append(std::span<const double> y, std::vector<float>& numbers, std::vector<float>& remainders) {
  const std::span<const double> state = without_discrete(y);
  seen_->observe(state);
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const Part& part = parts_[b];
    const auto body = static_cast<int>(b);
    const Pose X_WB = seen_pose(*seen_, body, part.frame);
    append_pose(X_WB, numbers);
    append_vector(X_WB.p - X_WB.p.cast<float>().cast<double>(), remainders);
    if (!part.flexible) continue;
    const Eigen::VectorXf w = weights(b, state);
    numbers.insert(numbers.end(), w.begin(), w.end());
    const std::size_t points = bend(b, state) ? part.at_rest.size() : 0;
    for (std::size_t i = 0; i < points; ++i) append_vector(part.bent->section(i).p - part.at_rest[i], numbers);
    for (std::size_t i = 0; part.turns && i < points; ++i) append_vector(part.bent->section(i).R.col(1), numbers);
    const Pose X_BW = X_WB.inverse();
    for (std::size_t i = 0; i < part.hung.size(); ++i)
      append_pose(X_BW * seen_pose(*seen_, body, part.hung[i]) * part.offsets[i], numbers);
  }
}

std::vector<std::vector<Vector3>> Drawing::lines(std::span<const double> y) {
  const std::span<const double> state = without_discrete(y);
  seen_->observe(state);
  std::vector<std::vector<Vector3>> all;
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const Part& part = parts_[b];
    const auto pose_at = [&](int frame) { return seen_pose(*seen_, static_cast<int>(b), frame); };
    if (part.kind == Kind::strip) {
      const Eigen::VectorXf w = weights(b, state);
      all.emplace_back();
      for (std::size_t i = part.columns / 2; i < part.at_rest.size(); i += part.columns)
        all.back().push_back(place(b, i, w));
      continue;
    }
    if (part.kind == Kind::line) {
      const bool bent = bend(b, state);
      const Pose X_WB = pose_at(part.frame);
      all.emplace_back();
      for (std::size_t i = 0; i < part.at_rest.size(); ++i)
        all.back().push_back(X_WB.p + X_WB.R * (bent ? part.bent->section(i).p : part.at_rest[i]));
      continue;
    }
    for (std::size_t i = 0; i < part.hung.size(); ++i)
      all.push_back({pose_at(part.frame).p, (pose_at(part.hung[i]) * part.offsets[i]).p});
    const int tip = model_->bodies()[b].frame("tip");
    if (tip >= 0) all.push_back({pose_at(part.frame).p, pose_at(tip).p});
  }
  return all;
}

std::pair<Eigen::Index, Eigen::Index> widest_plane(const Vector3& low, const Vector3& high) {
  Eigen::Index thinnest = 0;
  (high - low).minCoeff(&thinnest);
  return {thinnest == 0 ? 1 : 0, thinnest == 2 ? 1 : 2};
}

}  // namespace withy
