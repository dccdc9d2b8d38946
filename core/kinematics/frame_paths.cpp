#include "withy/core/kinematics/frame_paths.hpp"

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/kinematics/frame_pass.hpp"
#include "withy/core/shape/section_fields.hpp"

namespace withy {

FramePaths::FramePaths(const Model& model, Terms terms, const std::vector<FrameIndex>& frames, bool untruncated)
    : link_of_(model.bodies().size(), -1), untruncated_(untruncated) {
  for (const FrameIndex& f : frames) frames_.push_back(place(model, terms, f, Pose{}));
  sweep::WorkLayout memory;
  hinge_offset_ = memory.take<frame_pass::HingeStep>(links_.size());
  for (Link& link : links_) {
    strict_ = strict_ || (link.modes > 0 && link.truncation == Truncation::strict);
    symmetric_ = symmetric_ || (link.modes > 0 && link.truncation == Truncation::symmetric);
    if (link.order != StrainOrder::exact || link.truncation != Truncation::none || link.modes == 0) {
      for (const std::size_t s : link.sections) {
        link.particles = link.particles || !sections_[s].turns;
        sections_[s].partials = partials_;
        partials_ += static_cast<std::size_t>(link.modes);
      }
      continue;
    }
    // The rod wants its sections as stations of a node.
    NodeSpec node;
    node.modes = static_cast<std::size_t>(link.modes);
    node.rod = model.bodies()[static_cast<std::size_t>(link.hinge->child)].body->rod();
    for (const std::size_t s : link.sections) {
      sections_[s].turns = true;
      sections_[s].station = node.stations.size();
      sections_[s].partials = partials_;
      partials_ += node.modes;
      node.stations.push_back({sections_[s].at, {}});
    }
    auto rod = std::make_shared<Rod>();
    rod->kinematics = sweep::RodKinematics<Spatial>(node);
    rod->work = memory.take<Pack>(sweep::rod_work(rod->kinematics, static_cast<int>(link.modes)));
    link.rod = std::move(rod);
  }
  partials_offset_ = memory.take<Spatial::Twist>(partials_);
  full_offset_ = Pass<double>::take(*this, memory);
  if (strict_) first_order_offset_ = Pass<frame_pass::Dual>::take(*this, memory);
  if (symmetric_) first_order_offset_ = Pass<frame_pass::Second>::take(*this, memory);
  if (strict_ || symmetric_) {
    gathered_offset_ = memory.take<frame_pass::Gathered>(links_.size());
    by_mode_offset_ = memory.take<Matrix3>(2 * modes_);
  }
  turning_offset_ = memory.take<FrameAcceleration>(untruncated ? links_.size() : 0);
  work_size_ = memory.size();
}

FramePaths::~FramePaths() = default;

void FramePaths::motions(std::span<const double> positions, std::span<const double> speeds,
                         std::span<FrameMotion> motions, std::byte* work) const noexcept {
  Pass<double> full(*this, work, full_offset_);
  full.outward(positions, speeds);
  for (std::size_t i = 0; i < frames_.size(); ++i) motions[i] = full.frame(frames_[i]);
  if (strict_) Pass<frame_pass::Dual>(*this, work, first_order_offset_).outward(positions, speeds);
  if (symmetric_) Pass<frame_pass::Second>(*this, work, first_order_offset_).outward(positions, speeds);
}

void FramePaths::velocity_accelerations(std::span<FrameAcceleration> accelerations, std::byte* work) const noexcept {
  auto* const of_links = sweep::at<FrameAcceleration>(work, turning_offset_);
  const Pass<double> full(*this, work, full_offset_);
  full.turn(of_links);
  for (std::size_t i = 0; i < frames_.size(); ++i) accelerations[i] = full.acceleration(frames_[i], of_links);
}

void FramePaths::add_efforts(std::span<const Wrench> wrenches, std::span<double> efforts,
                             std::byte* work) const noexcept {
  if (strict_) {
    Pass<frame_pass::Dual>(*this, work, first_order_offset_).inward(wrenches, efforts);
  } else if (symmetric_) {
    Pass<frame_pass::Second>(*this, work, first_order_offset_).inward(wrenches, efforts);
  } else {
    Pass<double>(*this, work, full_offset_).inward(wrenches, efforts);
  }
}

std::size_t FramePaths::link(const Model& model, Terms terms, int body) {
  // Iterative, outermost body first: chains may be long.
  std::vector<int> missing;
  for (int b = body; b >= 0 && link_of_[static_cast<std::size_t>(b)] < 0;
       b = model.hinges()[static_cast<std::size_t>(b)].parent)
    missing.push_back(b);
  for (const int b : std::vector<int>(missing.rbegin(), missing.rend())) {
    const auto index = static_cast<std::size_t>(b);
    const BodyNode& node = model.bodies()[index];
    const HingeNode& hinge = model.hinges()[index];
    const Terms own = node.terms.value_or(terms);
    Link l{.hinge = &hinge,
           .slot = model.layout().hinges[index],
           .at_world = hinge.parent < 0,
           .F = {0, 0, hinge.offset},
           .M = {},
           .modes = node.body->shape().modes(),
           .modal = {},
           .mode = modes_,
           .order = own.strain,
           .truncation = untruncated_ ? Truncation::none : own.truncation,
           .sections = {},
           .particles = false,
           .rod = nullptr};
    if (l.modes > 0) l.modal = *model.layout().modes(index);
    modes_ += static_cast<std::size_t>(l.modes);
    if (!l.at_world) l.F = place(model, terms, {hinge.parent, hinge.parent_frame}, hinge.offset);
    link_of_[index] = static_cast<int>(links_.size());
    links_.push_back(std::move(l));
    links_.back().M = place(model, terms, {b, hinge.child_frame}, Pose{});
  }
  return static_cast<std::size_t>(link_of_[static_cast<std::size_t>(body)]);
}

FramePaths::Place FramePaths::place(const Model& model, Terms terms, FrameIndex frame, const Pose& offset) {
  const std::size_t l = link(model, terms, frame.body);
  const FramePlace f = place_of(model, frame);
  const Pose pose = f.pose * offset;
  const bool turns = frame.frame >= 0 || !field_of(model)->point(frame).second.isZero(0);
  for (const std::size_t s : links_[l].sections) {
    if (!same_section(sections_[s].at, f.section)) continue;
    sections_[s].turns = sections_[s].turns || turns;
    return {l, s, pose};
  }
  links_[l].sections.push_back(sections_.size());
  const auto by_pairs = [](const std::array<Eigen::MatrixXd, 3>& m) {
    std::vector<Vector3> all;
    const bool zero = m[0].isZero(0) && m[1].isZero(0) && m[2].isZero(0);
    for (Eigen::Index i = 0; !zero && i < m[0].rows(); ++i)
      for (Eigen::Index j = 0; j < m[0].cols(); ++j) all.emplace_back(m[0](i, j), m[1](i, j), m[2](i, j));
    return all;
  };
  sections_.push_back(
      {f.section, moved_by_modes(f.section), turns, 0, 0, by_pairs(f.section.gamma), by_pairs(f.section.theta)});
  return {l, sections_.size() - 1, pose};
}

}  // namespace withy
