/// \file
/// Putting down and taking up again what a part of a run remembers, in one list of numbers.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace withy {

/// Goes through the members of an object, always in the same order: writes them to a list of numbers, or reads them
/// back bit by bit. One function that names the members serves both ways.
class Memory {
 public:
  /// Writes.
  Memory() = default;
  /// Reads what another has written.
  explicit Memory(std::span<const double> numbers) : reading_(true), rest_(numbers) {}

  /// A number, a count below 2⁵³, a truth value or an enumerator.
  /// \throws std::invalid_argument where fewer numbers are left than are to be read.
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void operator()(T& value) {
    if (reading_) {
      value = static_cast<T>(take());
    } else {
      written_.push_back(static_cast<double>(value));
    }
  }
  /// Its length, then its elements.
  template <class T>
  requires std::is_class_v<T>
  void operator()(T& list) {
    auto size = static_cast<std::size_t>(list.size());
    (*this)(size);
    if (reading_) {
      if (size > rest_.size()) fail();
      list.resize(static_cast<decltype(list.size())>(size));
    }
    for (auto& element : list) (*this)(element);
  }

  [[nodiscard]] bool reading() const { return reading_; }
  /// What was written.
  [[nodiscard]] const std::vector<double>& numbers() const { return written_; }
  /// \throws std::invalid_argument where numbers are left that nobody has read.
  void finish() const {
    if (reading_ && !rest_.empty()) fail();
  }

 private:
  double take() {
    if (rest_.empty()) fail();
    const double value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
  }
  [[noreturn]] static void fail() { throw std::invalid_argument("what was saved is not of what is restored from it"); }

  bool reading_ = false;
  std::span<const double> rest_;
  std::vector<double> written_;
};

}  // namespace withy
