/// \file
/// Typed parts of a work memory.
#pragma once

#include <cstddef>
#include <span>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/sweep/node.hpp"

namespace withy::equations {

/// `count` elements of a type, somewhere in a work memory.
template <class T>
class Slice {
 public:
  Slice() = default;
  Slice(sweep::WorkLayout& layout, std::size_t count) : offset_(layout.take<T>(count)), count_(count) {}
  [[nodiscard]] std::span<T> in(Work& work) const { return {sweep::at<T>(work.data(), offset_), count_}; }

 private:
  std::size_t offset_ = 0, count_ = 0;
};

/// Memory that another class lays out by itself, aligned to 64.
class Region {
 public:
  Region() = default;
  Region(sweep::WorkLayout& layout, std::size_t bytes) : offset_(layout.take<std::byte>(bytes)) {}
  [[nodiscard]] std::byte* in(Work& work) const { return work.data() + offset_; }

 private:
  std::size_t offset_ = 0;
};

}  // namespace withy::equations
