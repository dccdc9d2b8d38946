/// \file
/// A force or a moment at a frame as a function of time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "withy/loads/frame_load.hpp"
#include "withy/loads/time_law.hpp"

namespace withy {

/// `part` is the half of the wrench that acts: Wrench::force or Wrench::moment.
class FrameWrench final : public Load {
 public:
  FrameWrench(std::string frame, bool following, TimeLaw<Vector3> law, Vector3 Wrench::*part)
      : frame_(std::move(frame)), following_(following), law_(std::move(law)), part_(part) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<Bound>(frame_index(model, frame_), *this);
  }

  static std::vector<ParameterSpec> parameters(const std::string& what, const std::string& unit) {
    std::vector<ParameterSpec> all{
        text("frame", "frame that it acts at: body.frame, or body for its root").naming(ParameterSpec::Refers::frame),
        boolean("following", "its components are in the axes of the frame and turn with it; else in world axes")
            .otherwise(Value(false))};
    const std::vector<ParameterSpec> law = time_law_parameters<Vector3>(what, unit);
    all.insert(all.end(), law.begin(), law.end());
    return all;
  }
  static std::unique_ptr<Load> make(const Value& p, const MakeContext& context, Vector3 Wrench::*part) {
    std::optional<TimeLaw<Vector3>> law = TimeLawReader<Vector3>(p, context).read();
    if (!law) return nullptr;
    return std::make_unique<FrameWrench>(p.text_at("frame"), p.at("following").boolean(), std::move(*law), part);
  }

 private:
  class Bound final : public FrameLoad {
   public:
    Bound(FrameIndex frame, const FrameWrench& load)
        : FrameLoad({frame}), following_(load.following_), law_(load.law_), part_(load.part_) {}
    void wrenches(double t, std::span<const FrameMotion> motions, std::span<Wrench> wrenches) const noexcept override {
      const Vector3 given = law_(t);
      wrenches[0] = {};
      wrenches[0].*part_ = following_ ? Vector3(motions[0].R * given) : given;
    }
    std::vector<double> discontinuities() const override { return law_.discontinuities(); }
    double end() const override { return law_.end(); }

   private:
    bool following_;
    TimeLaw<Vector3> law_;
    Vector3 Wrench::*part_;
  };

  std::string frame_;
  bool following_;
  TimeLaw<Vector3> law_;
  Vector3 Wrench::*part_;
};

}  // namespace withy
