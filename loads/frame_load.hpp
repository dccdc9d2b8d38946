/// \file
/// What loads that act at frames share.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// A load that acts by wrenches alone.
class FrameLoad : public BoundLoad {
 public:
  explicit FrameLoad(std::vector<FrameIndex> frames) : frames_(std::move(frames)) {}
  std::size_t scratch() const override { return 0; }
  void add(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> /*efforts*/, std::span<double> /*scratch*/) const noexcept override {}
  std::span<const FrameIndex> frames() const override { return frames_; }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(State& /*state*/) const override {}

 private:
  std::vector<FrameIndex> frames_;
};

/// The frame that a scene calls "body.frame", or "body" for its root; of a body that was cut, its segment's.
/// \throws std::invalid_argument where the model has none.
inline FrameIndex frame_index(const Model& model, const std::string& name) {
  if (const std::optional<FrameIndex> index = model.find_frame(name)) return *index;
  const std::size_t dot = name.find('.');
  const std::string body = name.substr(0, dot);
  if (model.segments(body).empty()) throw std::invalid_argument("there is no body '" + body + "'");
  throw std::invalid_argument("body '" + body + "' has no frame '" + name.substr(dot + 1) +
                              "'; a station without a name becomes one under the body's 'frames'");
}

}  // namespace withy
