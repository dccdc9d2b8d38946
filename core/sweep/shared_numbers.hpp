/// \file
/// Constants of a node that equal nodes share.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

namespace withy::sweep {

/// A vector that is made once and read from then on; copies read the same numbers. A chain of equal links so keeps one
/// copy of them, which stays in the nearest caches while the sweeps go through the links.
template <class T>
class SharedNumbers {
 public:
  SharedNumbers() = default;
  SharedNumbers(std::vector<T> numbers) {  // NOLINT(google-explicit-constructor): a vector's other name
    if (!numbers.empty()) all_ = std::make_shared<std::vector<T>>(std::move(numbers));
    look();
  }

  [[nodiscard]] const T* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }

  /// Changes the numbers of this one alone by `change(std::vector<T>&)`.
  template <class Change>
  void edit(Change&& change) {
    if (all_ == nullptr || all_.use_count() > 1)
      all_ = std::make_shared<std::vector<T>>(all_ == nullptr ? std::vector<T>{} : *all_);
    change(*all_);
    look();
  }
  /// Becomes a copy of `other` where the numbers are equal to the last bit.
  void share(const SharedNumbers& other) {
    if (size_ != 0 && size_ == other.size_ && std::memcmp(data_, other.data_, size_ * sizeof(T)) == 0) *this = other;
  }

 private:
  void look() {
    data_ = all_ == nullptr ? nullptr : all_->data();
    size_ = all_ == nullptr ? 0 : all_->size();
  }

  std::shared_ptr<std::vector<T>> all_;
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace withy::sweep
