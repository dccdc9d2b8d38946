#include "withy/core/equations/applied_loads.hpp"

#include <algorithm>

#include "withy/core/sweep/node.hpp"

namespace withy {

AppliedLoads::AppliedLoads(const Model& model, Terms terms) : model_(model) {
  for (const LoadNode& node : model.loads()) {
    frames_.insert(frames_.end(), node.load->frames().begin(), node.load->frames().end());
    const auto* timed = dynamic_cast<const TimedEffort*>(node.load.get());
    timed_.push_back(timed == nullptr ? TimedLoad{} : TimedLoad{timed, timed->speed(), timed->law()});
  }
  sweep::WorkLayout memory;
  scratch_offset_ = memory.take<double>(model.load_scratch());
  if (!frames_.empty()) {
    paths_ = std::make_unique<const FramePaths>(model, terms, frames_);
    motions_offset_ = memory.take<FrameMotion>(frames_.size());
    wrenches_offset_ = memory.take<Wrench>(frames_.size());
    paths_offset_ = memory.size();
  }
  work_size_ = memory.size() + (paths_ != nullptr ? paths_->work_size() : 0);
}

bool AppliedLoads::only_timed() const {
  return paths_ == nullptr && model_.layout().continuous == 0 && model_.layout().discrete == 0 &&
         std::all_of(timed_.begin(), timed_.end(), [](const TimedLoad& load) { return load.effort != nullptr; });
}

void AppliedLoads::add(double t, std::span<const double> y, std::span<double> efforts, std::byte* work,
                       int only) const noexcept {
  const auto positions = y.first(model_.layout().positions);
  const auto speeds = y.subspan(model_.layout().positions, model_.layout().speeds);
  const std::vector<LoadNode>& loads = model_.loads();
  const auto wanted = [only](std::size_t i) { return only < 0 || i == static_cast<std::size_t>(only); };
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const BoundLoad& load = *loads[i].load;
    if (wanted(i)) load.add(t, positions, speeds, efforts, scratch(work).first(load.scratch()));
  }
  add_rest(t, y, efforts, work, only);
}

void AppliedLoads::add_to_timed(double t, std::span<const double> y, std::span<const double> timed,
                                std::span<double> efforts, std::byte* work) const noexcept {
  const auto positions = y.first(model_.layout().positions);
  const auto speeds = y.subspan(model_.layout().positions, model_.layout().speeds);
  const std::vector<LoadNode>& loads = model_.loads();
  for (std::size_t i = 0; i < loads.size(); ++i) {
    if (timed_[i].effort != nullptr) {
      efforts[timed_[i].speed] += timed[i];
    } else {
      loads[i].load->add(t, positions, speeds, efforts, scratch(work).first(loads[i].load->scratch()));
    }
  }
  add_rest(t, y, efforts, work, -1);
}

inline void AppliedLoads::add_rest(double t, std::span<const double> y, std::span<double> efforts, std::byte* work,
                                   int only) const noexcept {
  model_.add_state_efforts(t, y, efforts, scratch(work), only);
  if (paths_ != nullptr) paths_->add_efforts(wrenches(t, y, work, only), efforts, work + paths_offset_);
}

bool AppliedLoads::rates(double t, std::span<const double> y, std::span<double> y_dot, std::byte* work) const noexcept {
  return model_.continuous_rates(t, y, y_dot, scratch(work));
}

std::span<double> AppliedLoads::scratch(std::byte* work) const noexcept {
  return {sweep::at<double>(work, scratch_offset_), model_.load_scratch()};
}

std::span<const Wrench> AppliedLoads::wrenches(double t, std::span<const double> y, std::byte* work,
                                               int only) const noexcept {
  if (paths_ == nullptr) return {};
  const auto positions = y.first(model_.layout().positions);
  const auto speeds = y.subspan(model_.layout().positions, model_.layout().speeds);
  const std::span<FrameMotion> motions(sweep::at<FrameMotion>(work, motions_offset_), frames_.size());
  const std::span<Wrench> all(sweep::at<Wrench>(work, wrenches_offset_), frames_.size());
  paths_->motions(positions, speeds, motions, work + paths_offset_);
  std::size_t first = 0;
  for (std::size_t i = 0; i < model_.loads().size(); ++i) {
    const std::size_t count = model_.loads()[i].load->frames().size();
    const auto own = all.subspan(first, count);
    if (only < 0 || i == static_cast<std::size_t>(only)) {
      model_.loads()[i].wrenches(t, y, model_.layout(), motions.subspan(first, count), own, scratch(work));
    } else {
      std::fill(own.begin(), own.end(), Wrench{});
    }
    first += count;
  }
  return all;
}

}  // namespace withy
