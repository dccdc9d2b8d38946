#include "withy/results/report/arrows.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/kinematics/observation.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/model/model.hpp"

namespace withy {
namespace {

using RotationRows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// The body, or of a body that was cut the piece, with a place along it, and the place in that.
std::pair<int, double> piece_at(const Model& model, const std::string& body, double x) {
  const std::vector<int> pieces = model.segments(body);
  for (const int piece : pieces) {
    const double length = model.bodies()[static_cast<std::size_t>(piece)].body->shape().length;
    if (x <= length || piece == pieces.back()) return {piece, std::min(x, length)};
    x -= length;
  }
  return {-1, 0};
}

}  // namespace

Arrows::Arrows(const Scene& scene, const Terms& terms, const std::vector<Column>& columns) : columns_(columns) {
  const Value* outputs = scene.source.find("outputs");
  if (outputs == nullptr || outputs->members().empty()) return;
  const std::shared_ptr<const Model> own = Model::in_kinematics(scene.model, terms);
  std::vector<BodyNode> bodies = own->bodies();
  for (const auto& [name, value] : outputs->members()) add(name, value, *own, bodies);
  if (arrows_.empty()) return;
  model_ = std::make_shared<const Model>(std::move(bodies), own->hinges(), own->gravity());
  seen_ = observed_model(*model_, terms)->make_observation();
}

void Arrows::add(const std::string& output, const Value& value, const Model& model, std::vector<BodyNode>& bodies) {
  const std::string& type = value.text_at("type");
  if (const Value* constraint = value.find("constraint"); type == "reaction" && constraint != nullptr) {
    for (const LoopClosure* loop : loops_of(model)) {
      if (loop->name() != constraint->text() || loop->b().body < 0) continue;
      add_vector(output, "force", ".fx", loop->b(), loop->a(), loop->offset().R);
      add_vector(output, "moment", ".mx", loop->b(), loop->a(), loop->offset().R);
    }
  } else if (type == "reaction") {
    const HingeNode& hinge = model.hinges()[static_cast<std::size_t>(model.hinge(value.text_at("hinge")))];
    const FrameIndex at{hinge.child, hinge.child_frame}, axes{hinge.parent, hinge.parent_frame};
    add_vector(output, "force", ".fx", at, axes, hinge.offset.R);
    add_vector(output, "moment", ".mx", at, axes, hinge.offset.R);
  } else if (type == "section") {
    const auto [piece, x] = piece_at(model, value.text_at("of"), value.number_at("at"));
    if (piece < 0) return;
    BodyNode& node = bodies[static_cast<std::size_t>(piece)];
    auto section = node.body->station(x);
    if (!section) return;
    node.frames.push_back({"", std::move(*section), {Matrix3::Identity(), Vector3::Zero()}});
    const FrameIndex at{piece, static_cast<int>(node.frames.size()) - 1};
    add_vector(output, "force", ".fx", at, at);
    add_vector(output, "moment", ".mx", at, at);
  } else if (type == "accelerometer" || type == "frame") {
    const std::optional<FrameIndex> at = model.find_frame(value.text_at("of"));
    const std::string in = type == "frame" ? value.text_at("in") : "own";
    if (!at || (in != "own" && in != "world")) return;
    add_vector(output, "acceleration", type == "frame" ? ".ax" : ".x", *at, in == "own" ? *at : FrameIndex{-1, 0});
  }
}

void Arrows::add_vector(const std::string& output, const char* what, const char* first, FrameIndex at, FrameIndex axes,
                        const Matrix3& offset) {
  const auto column =
      std::find_if(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == output + first; });
  if (column == columns_.end()) return;
  arrows_.push_back({output + ' ' + what,
                     column->unit,
                     static_cast<std::size_t>(column - columns_.begin()),
                     at,
                     axes,
                     offset,
                     {},
                     {},
                     0});
}

void Arrows::append(std::span<const double> y, std::span<const double> row) {
  if (arrows_.empty()) return;
  seen_->observe(y.first(model_->layout().size()));
  for (Arrow& arrow : arrows_) {
    Matrix3 R = arrow.offset;
    if (arrow.axes.body >= 0) {
      const WorldPose axes = seen_->frame_pose(arrow.axes.body, arrow.axes.frame);
      R = Eigen::Map<const RotationRows>(axes.rotation.data()) * arrow.offset;
    }
    Vector3 v = R * Eigen::Map<const Vector3>(row.data() + arrow.column);
    if (!v.allFinite()) v.setZero();
    const WorldPose place = seen_->frame_pose(arrow.at.body, arrow.at.frame);
    for (const double x : place.position) {
      arrow.numbers.push_back(static_cast<float>(x));
      arrow.remainders.push_back(static_cast<float>(x - static_cast<double>(arrow.numbers.back())));
    }
    for (const double x : v) arrow.numbers.push_back(static_cast<float>(x));
    arrow.greatest = std::max(arrow.greatest, v.norm());
  }
}

}  // namespace withy
