/// \file
/// A thruster: a force fixed in a frame, on or off.
#include <algorithm>
#include <optional>

#include "withy/core/plugin/direction.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/loads/frame_load.hpp"

namespace withy {
namespace {

/// On for on ≤ t < off [s].
struct Firing {
  double on, off;
};

class BoundThruster final : public FrameLoad {
 public:
  BoundThruster(FrameIndex frame, const Vector3& thrust, std::vector<Firing> firings)
      : FrameLoad({frame}), thrust_(thrust), firings_(std::move(firings)) {}
  void wrenches(double t, std::span<const FrameMotion> motions, std::span<Wrench> wrenches) const noexcept override {
    const auto next =
        std::upper_bound(firings_.begin(), firings_.end(), t, [](double time, const Firing& f) { return time < f.on; });
    const bool on = next != firings_.begin() && t < std::prev(next)->off;
    wrenches[0] = {};
    if (on) wrenches[0].force = motions[0].R * thrust_;
  }
  std::vector<double> discontinuities() const override {
    std::vector<double> times;
    for (const Firing& f : firings_) {
      if (times.empty() || times.back() != f.on) times.push_back(f.on);
      times.push_back(f.off);
    }
    return times;
  }
  double end() const override { return firings_.back().off; }

 private:
  Vector3 thrust_;
  std::vector<Firing> firings_;
};

class Thruster final : public Load {
 public:
  Thruster(std::string frame, const Vector3& thrust, std::vector<Firing> firings)
      : frame_(std::move(frame)), thrust_(thrust), firings_(std::move(firings)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundThruster>(frame_index(model, frame_), thrust_, firings_);
  }

 private:
  std::string frame_;
  Vector3 thrust_;
  std::vector<Firing> firings_;
};

std::unique_ptr<Load> make_thruster(const Value& p, const MakeContext& context) {
  bool good = true;
  const auto error = [&](const Value& at, const char* message) {
    context.diagnostics.error(at.place(), message);
    good = false;
  };
  const std::optional<Vector3> direction = direction_at(p, "direction", context);
  std::vector<Firing> firings;
  for (const Value& row : p.at("firings").items()) {
    const Firing f{row.items()[0].number(), row.items()[1].number()};
    if (!(f.on < f.off)) error(row, "is switched off before it is on; need rows [on, off]");
    if (!firings.empty() && f.on < firings.back().off) error(row, "begins before the row above it ends");
    firings.push_back(f);
  }
  if (firings.empty()) error(p.at("firings"), "has no row; need [on, off] at least once");
  if (!good || !direction) return nullptr;
  return std::make_unique<Thruster>(p.text_at("frame"), p.number_at("thrust") * *direction, std::move(firings));
}

}  // namespace

void enroll_thruster(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "thruster",
       .summary = "Force fixed in a frame, switched on and off",
       .parameters = {text("frame", "frame that it acts at: body.frame, or body for its root")
                          .naming(ParameterSpec::Refers::frame),
                      number("thrust", "N", "force while it is on").above(0),
                      vector("direction", 3, "1", "of the force on the body, in the axes of the frame, of any length"),
                      table("firings", {"s", "s"}, "times on and off")},
       .make = &make_thruster});
}

}  // namespace withy
