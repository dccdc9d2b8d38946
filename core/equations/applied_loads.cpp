#include "withy/core/equations/applied_loads.hpp"

#include <algorithm>

#include "withy/core/sweep/node.hpp"

namespace withy {

AppliedLoads::AppliedLoads(const Model& model, Terms terms) : model_(model) {
  std::vector<FrameIndex> frames;
  std::size_t scratch = 0;
  for (const LoadNode& node : model.loads()) {
    scratch = std::max(scratch, node.load->scratch());
    frames.insert(frames.end(), node.load->frames().begin(), node.load->frames().end());
  }
  sweep::WorkLayout memory;
  scratch_offset_ = memory.take<double>(scratch);
  if (!frames.empty()) {
    frames_ = frames.size();
    paths_ = std::make_unique<const FramePaths>(model, terms, frames);
    motions_offset_ = memory.take<FrameMotion>(frames_);
    wrenches_offset_ = memory.take<Wrench>(frames_);
    paths_offset_ = memory.size();
  }
  work_size_ = memory.size() + (paths_ != nullptr ? paths_->work_size() : 0);
}

void AppliedLoads::add(double t, std::span<const double> y, std::span<double> efforts, std::byte* work,
                       int only) const noexcept {
  const auto positions = y.first(model_.layout().positions);
  const auto speeds = y.subspan(model_.layout().positions, model_.layout().speeds);
  const std::vector<LoadNode>& loads = model_.loads();
  const auto wanted = [only](std::size_t i) { return only < 0 || i == static_cast<std::size_t>(only); };
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const BoundLoad& load = *loads[i].load;
    if (wanted(i)) load.add(t, positions, speeds, efforts, {sweep::at<double>(work, scratch_offset_), load.scratch()});
  }
  model_.add_discrete_efforts(t, y, efforts, only);
  if (paths_ == nullptr) return;
  const std::span<FrameMotion> motions(sweep::at<FrameMotion>(work, motions_offset_), frames_);
  const std::span<Wrench> wrenches(sweep::at<Wrench>(work, wrenches_offset_), frames_);
  paths_->motions(positions, speeds, motions, work + paths_offset_);
  std::size_t first = 0;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const BoundLoad& load = *loads[i].load;
    const std::size_t count = load.frames().size();
    const auto own = wrenches.subspan(first, count);
    if (wanted(i)) {
      loads[i].wrenches(t, y, motions.subspan(first, count), own);
    } else {
      std::fill(own.begin(), own.end(), Wrench{});
    }
    first += count;
  }
  paths_->add_efforts(wrenches, efforts, work + paths_offset_);
}

}  // namespace withy
