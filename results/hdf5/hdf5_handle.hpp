/// \file
/// Identifiers of the HDF5 library that close themselves.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace withy {

/// An identifier; negative where there is none.
class Hdf5Handle {
 public:
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, herr_t (*closer)(hid_t)) : id_(id), close_(closer) {}
  ~Hdf5Handle() { static_cast<void>(close()); }
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    static_cast<void>(close());
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
    return *this;
  }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): as the library's functions take them
  [[nodiscard]] bool valid() const { return id_ >= 0; }
  /// What closing said; 0 where nothing is open.
  herr_t close() noexcept { return id_ < 0 ? 0 : close_(std::exchange(id_, -1)); }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

/// What the library said of the last call that failed, where it first failed; empty where it said nothing.
inline std::string hdf5_error() {
  std::string text;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
        auto& first = *static_cast<std::string*>(out);
        if (first.empty() && error->desc != nullptr) first = error->desc;
        return 0;
      },
      &text);
  return text;
}

}  // namespace withy
