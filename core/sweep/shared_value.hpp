/// \file
/// A large constant of a node that equal nodes share.
#pragma once

#include <memory>
#include <utility>

namespace withy::sweep {

/// A value that is made once and read from then on, as SharedNumbers; none where nobody has set it.
template <class T>
class SharedValue {
 public:
  SharedValue() = default;
  SharedValue(T value)  // NOLINT(google-explicit-constructor): a value's other name
      : own_(std::make_shared<T>(std::move(value))) {}

  const T& operator*() const { return *own_; }
  const T* operator->() const { return own_.get(); }
  [[nodiscard]] bool empty() const { return own_ == nullptr; }

  /// Changes the value of this one alone by `change(T&)`.
  template <class Change>
  void edit(Change&& change) {
    if (own_ == nullptr || own_.use_count() > 1)
      own_ = own_ == nullptr ? std::make_shared<T>() : std::make_shared<T>(*own_);
    change(*own_);
  }
  /// Becomes a copy of `other` where same(value, value of other) says that they are equal to the last bit.
  template <class Same>
  void share(const SharedValue& other, Same&& same) {
    if (own_ != nullptr && other.own_ != nullptr && same(*own_, *other.own_)) own_ = other.own_;
  }

 private:
  std::shared_ptr<T> own_;
};

}  // namespace withy::sweep
