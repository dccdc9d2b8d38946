#include "withy/results/report/drawing.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "withy/core/kinematics/observation.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Points along a line: enough for the highest mode that models of a body have.
constexpr int most_sections = 24;
constexpr int least_sections = 4;
/// Points of all bodies together, about.
constexpr std::size_t most_points = 1500;
/// Nodes of a body of data.
constexpr std::size_t most_nodes = 200;

Pose pose_of(const WorldPose& p) {
  return {Eigen::Map<const RowMajor>(p.rotation.data()), Eigen::Map<const Vector3>(p.position.data())};
}

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

int add_frame(BodyNode& node, PointExpansion section, const Vector3& offset) {
  node.frames.push_back({"", std::move(section), {Matrix3::Identity(), offset}});
  return static_cast<int>(node.frames.size()) - 1;
}

/// The homogeneous box with a body's mass and inertia about its centre of mass: edges [m] and pose.
Json box_json(const ModalShape& shape) {
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
  if (!(mass > 0)) return nullptr;
  const Vector3 center = moment / mass;
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(about_origin - mass * square(center));
  const Vector3& I = principal.eigenvalues();
  Vector3 edges;
  for (int i = 0; i < 3; ++i) edges[i] = std::sqrt(std::max(0.0, 6 * (I.sum() - 2 * I[i]) / mass));
  Matrix3 R = principal.eigenvectors();
  if (R.determinant() < 0) R.col(0) *= -1;
  return {{"edges", vector_json(edges)}, {"pose", pose_json({R, center})}};
}

}  // namespace

Drawing::Drawing(const std::shared_ptr<const Model>& model, const Terms& terms, Looks looks)
    : looks_(std::move(looks)), tips_(tips(*model)) {
  const std::shared_ptr<const Model> own = Model::in_kinematics(model, terms);
  std::vector<BodyNode> bodies = own->bodies();
  parts_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Part& part = parts_[b];
    const Eigen::Index modes = bodies[b].body->shape().modes();
    part.flexible = modes > 0;
    part.frame = add_frame(bodies[b], PointExpansion::rigid(Vector3::Zero(), modes), Vector3::Zero());
    add_points(bodies[b], part);
    if (part.kind == Kind::line) add_sections(bodies[b], part);
  }
  for (const HingeNode& hinge : own->hinges()) {
    if (hinge.parent < 0) continue;
    Part& part = parts_[static_cast<std::size_t>(hinge.parent)];
    part.children.push_back(hinge.child);
    part.hung.push_back(hinge.parent_frame);
    part.offsets.push_back(hinge.offset);
  }
  for (const Part& part : parts_)
    size_ += 7 + (part.flexible ? (part.turns ? 6 : 3) * part.points.size() + 7 * part.hung.size() : 0);
  model_ = std::make_shared<const Model>(std::move(bodies), own->hinges(), own->gravity());
  seen_ = observed_model(*model_, terms)->make_observation();
}

void Drawing::add_points(BodyNode& node, Part& part) const {
  const auto drawn = [&] {
    if (add_strip(node, part) || add_line(node, part)) return true;
    std::istringstream names(node.body->stations());
    std::string name;
    while (std::getline(names >> std::ws, name, ',') && part.points.size() < most_nodes) {
      if (auto section = node.body->station(name)) part.points.push_back(add_frame(node, *section, Vector3::Zero()));
    }
    part.kind = part.flexible ? Kind::points : Kind::box;
    return part.flexible;
  };
  if (!drawn()) {
    // A rigid body's points are its frames.
    part.points.clear();
    for (int f = 0; f < part.frame; ++f) part.points.push_back(f);
  }
  for (const int f : part.points) {
    const Frame& frame = node.frames[static_cast<std::size_t>(f)];
    part.at_rest.push_back(frame.section.X + frame.pose.p);
  }
}

bool Drawing::add_line(BodyNode& node, Part& part) const {
  const double length = node.body->shape().length;
  if (!(length > 0) || !node.body->station(0.0) || !node.body->station(length)) return false;
  const int sections = std::clamp(static_cast<int>(most_points / parts_.size()), least_sections, most_sections);
  for (int i = 0; i <= sections; ++i) {
    auto section = node.body->station(length * i / sections);
    if (!section || section->X.tail<2>().norm() > 1e-9 * length) return false;
    part.points.push_back(add_frame(node, std::move(*section), Vector3::Zero()));
  }
  part.kind = Kind::line;
  return true;
}

void Drawing::add_sections(const BodyNode& node, Part& part) const {
  std::vector<double> places;
  for (const Vector3& p : part.at_rest) places.push_back(p.x());
  part.sections = looks_.sections(node, places);
  const bool round = std::all_of(part.sections.begin(), part.sections.end(), [](const Outline& o) {
    return !o.rectangle && std::abs(o.y - o.z) <= 1e-3 * std::max(o.y, o.z);
  });
  const bool twists =
      part.flexible && node.frames[static_cast<std::size_t>(part.points.back())].section.psi.row(0).any();
  part.turns = twists && !round;
}

const Surface* Drawing::surface(std::size_t body) const {
  const BodyNode& node = model_->bodies()[body];
  return looks_.surface(node.segment ? node.segment->whole : node.name);
}

/// Of a body with corners `left` and `right` at its tip: sections across its middle line, which stay straight.
bool Drawing::add_strip(BodyNode& node, Part& part) const {
  const double length = node.body->shape().length;
  const auto left = node.body->station("left"), right = node.body->station("right");
  if (!left || !right || !(length > 0) || !node.body->station(0.0)) return false;
  constexpr int sections = 16;
  for (int i = 0; i <= sections; ++i) {
    const auto section = node.body->station(length * i / sections);
    if (!section) return false;
    const bool tip = i == sections;
    const Vector3 none = Vector3::Zero();
    part.points.push_back(tip ? add_frame(node, *left, none)
                              : add_frame(node, *section, Vector3::UnitY() * left->X.y()));
    part.points.push_back(add_frame(node, *section, none));
    part.points.push_back(tip ? add_frame(node, *right, none)
                              : add_frame(node, *section, Vector3::UnitY() * right->X.y()));
  }
  part.columns = 3;
  part.kind = Kind::strip;
  return true;
}

Json Drawing::part_json(std::size_t body) const {
  const Part& part = parts_[body];
  const BodyNode& node = model_->bodies()[body];
  static constexpr const char* kinds[] = {"box", "line", "strip", "points"};
  Json j{{"name", node.segment ? node.segment->whole : node.name},
         {"kind", kinds[static_cast<int>(part.kind)]},
         {"parent", model_->hinges()[body].parent},
         {"moves", model_->hinges()[body].hinge->coordinates() > 0},
         {"flexible", part.flexible}};
  j["points"] = Json::array();
  for (const Vector3& X : part.at_rest)
    for (const double x : X) j["points"].push_back(x);
  if (part.kind == Kind::strip) j["columns"] = part.columns;
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

Json Drawing::parts() const {
  Json all = Json::array();
  for (std::size_t b = 0; b < parts_.size(); ++b) all.push_back(part_json(b));
  return all;
}

/// The drawn model has no loads, and so none of their discrete states.
std::span<const double> Drawing::without_discrete(std::span<const double> y) const {
  return y.first(model_->layout().size());
}

void Drawing::append(std::span<const double> y, std::vector<float>& numbers) {
  seen_->observe(without_discrete(y));
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const Part& part = parts_[b];
    const auto body = static_cast<int>(b);
    const Pose X_WB = pose_of(seen_->frame_pose(body, part.frame));
    append_pose(X_WB, numbers);
    if (!part.flexible) continue;
    const Pose X_BW = X_WB.inverse();
    for (std::size_t i = 0; i < part.points.size(); ++i) {
      const WorldPose point = seen_->frame_pose(body, part.points[i]);
      const Vector3 r = X_BW.p + X_BW.R * Eigen::Map<const Vector3>(point.position.data());
      append_vector(r - part.at_rest[i], numbers);
    }
    for (std::size_t i = 0; part.turns && i < part.points.size(); ++i)
      append_vector((X_BW * pose_of(seen_->frame_pose(body, part.points[i]))).R.col(1), numbers);
    for (std::size_t i = 0; i < part.hung.size(); ++i)
      append_pose(X_BW * pose_of(seen_->frame_pose(body, part.hung[i])) * part.offsets[i], numbers);
  }
}

std::vector<std::vector<Vector3>> Drawing::lines(std::span<const double> y) {
  seen_->observe(without_discrete(y));
  std::vector<std::vector<Vector3>> all;
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const Part& part = parts_[b];
    const auto place = [&](int frame) { return pose_of(seen_->frame_pose(static_cast<int>(b), frame)); };
    if (part.kind == Kind::line || part.kind == Kind::strip) {
      all.emplace_back();
      for (std::size_t i = part.columns / 2; i < part.points.size(); i += part.columns)
        all.back().push_back(place(part.points[i]).p);
      continue;
    }
    for (std::size_t i = 0; i < part.hung.size(); ++i)
      all.push_back({place(part.frame).p, (place(part.hung[i]) * part.offsets[i]).p});
    const int tip = model_->bodies()[b].frame("tip");
    if (tip >= 0) all.push_back({place(part.frame).p, place(tip).p});
  }
  return all;
}

std::vector<std::string> Drawing::rates() const {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < parts_.size(); ++b)
    if (parts_[b].flexible) names.push_back(model_->bodies()[b].name);
  return names;
}

void Drawing::append_rates(std::vector<double>& numbers) const {
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    if (!parts_[b].flexible) continue;
    const WorldVelocity v = seen_->frame_velocity(static_cast<int>(b), parts_[b].frame);
    numbers.push_back(Eigen::Map<const Vector3>(v.angular.data()).norm());
  }
}

std::vector<std::string> Drawing::deflections() const {
  std::vector<std::string> names;
  for (const Tip& tip : tips_)
    if (tip.flexible && tip.length > 0) names.push_back(tip.body);
  return names;
}

void Drawing::append_deflections(std::vector<double>& numbers) const {
  for (const Tip& tip : tips_) {
    if (!tip.flexible || !(tip.length > 0)) continue;
    const auto d = deflection(*seen_, tip);
    numbers.push_back(Eigen::Map<const Vector3>(d.data()).norm() / tip.length);
  }
}

std::pair<Eigen::Index, Eigen::Index> widest_plane(const Vector3& low, const Vector3& high) {
  Eigen::Index thinnest = 0;
  (high - low).minCoeff(&thinnest);
  return {thinnest == 0 ? 1 : 0, thinnest == 2 ? 1 : 2};
}

}  // namespace withy
