/// \file
/// A spring and damper along the line between two points: force k (ℓ − ℓ₀) + c ℓ̇ of attraction.
#include <optional>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/frame_load.hpp"

namespace withy {
namespace {

struct SpringDamper {
  double stiffness = 0;    ///< k [N/m]
  double damping = 0;      ///< c [N s/m]
  double free_length = 0;  ///< ℓ₀ [m]

  /// Force on the point that sees the other at `d`, moving at `rate` relative to it. Where the two coincide there is no
  /// line between them: the damper acts along their motion, its limit on the way through, and the spring not at all.
  [[nodiscard]] Vector3 force(const Vector3& d, const Vector3& rate) const noexcept {
    const double length = d.stableNorm();
    if (!(length > 0)) return damping * rate;
    const Vector3 e = d / length;
    return (stiffness * (length - free_length) + damping * e.dot(rate)) * e;
  }
};

/// Between two frames, or a frame and a point of the world.
class Bound final : public FrameLoad {
 public:
  Bound(std::vector<FrameIndex> frames, const Vector3& anchor, const SpringDamper& spring)
      : FrameLoad(std::move(frames)), anchor_(anchor), spring_(spring) {}
  void wrenches(double /*t*/, std::span<const FrameMotion> motions,
                std::span<Wrench> wrenches) const noexcept override {
    const bool world = motions.size() < 2;
    const Vector3 other = world ? anchor_ : motions[1].position;
    const Vector3 rate = world ? Vector3::Zero() : motions[1].velocity;
    const Vector3 force = spring_.force(other - motions[0].position, rate - motions[0].velocity);
    wrenches[0] = {Vector3::Zero(), force};
    if (!world) wrenches[1] = {Vector3::Zero(), -force};
  }

 private:
  Vector3 anchor_;
  SpringDamper spring_;
};

class SpringDamperLoad final : public Load {
 public:
  SpringDamperLoad(std::string frame, std::optional<std::string> to, const Vector3& anchor, const SpringDamper& spring)
      : frame_(std::move(frame)), to_(std::move(to)), anchor_(anchor), spring_(spring) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    std::vector<FrameIndex> frames{frame_index(model, frame_)};
    if (to_) frames.push_back(frame_index(model, *to_));
    return std::make_unique<Bound>(std::move(frames), anchor_, spring_);
  }

 private:
  std::string frame_;
  std::optional<std::string> to_;
  Vector3 anchor_;
  SpringDamper spring_;
};

std::unique_ptr<Load> make_spring_damper(const Value& p, const MakeContext& context) {
  const SpringDamper spring{p.number_at("stiffness"), p.number_at("damping"), p.number_at("free_length")};
  bool good = true;
  const auto error = [&](const Value& at, const char* message) {
    context.diagnostics.error(at.place(), message);
    good = false;
  };
  if (spring.stiffness == 0 && spring.damping == 0) error(p, "does nothing; need 'stiffness' or 'damping'");
  if (p.has("to") == p.has("anchor")) error(p, "needs one of 'to', another frame, and 'anchor', a point of the world");
  std::optional<std::string> to;
  if (const Value* v = p.find("to")) {
    to = v->text();
    if (*to == p.text_at("frame")) error(*v, "is the frame itself; need another");
  }
  if (!good) return nullptr;
  Vector3 anchor = Vector3::Zero();
  if (const Value* v = p.find("anchor")) {
    const std::vector<double> x = v->numbers();
    anchor = {x[0], x[1], x[2]};
  }
  return std::make_unique<SpringDamperLoad>(p.text_at("frame"), std::move(to), anchor, spring);
}

}  // namespace

void enroll_spring_damper(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "spring-damper",
       .summary = "Linear spring and damper along the line between two frames, or a frame and a point of the world",
       .parameters =
           {text("frame", "frame at one end: body.frame, or body for its root").naming(ParameterSpec::Refers::frame),
            text("to", "frame at the other end").naming(ParameterSpec::Refers::frame).optional(),
            vector("anchor", 3, "m", "point of the world at the other end, world axes").optional(),
            number("stiffness", "N/m", "force for one metre").least(0).otherwise(0.0),
            number("damping", "N s/m", "force for one metre per second").least(0).otherwise(0.0),
            number("free_length", "m", "length at which the spring is slack").least(0).otherwise(0.0)},
       .make = &make_spring_damper});
}

}  // namespace withy
