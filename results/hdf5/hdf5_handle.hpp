/// \file
/// Identifiers of the HDF5 library that close themselves.
#pragma once

#include <hdf5.h>

#include <algorithm>
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

/// Before the first call of the library: it is silent, and does not end files of its own accord when the program ends,
/// which crashes where one could not be written (1.10). All that is open here closes itself.
inline void begin_hdf5() {
  H5dont_atexit();
  // What the library has freed waits for its next use, by itself up to 16 MB of each kind.
  constexpr int all = 1 << 20, of_one_size = 1 << 16;
  H5set_free_list_limits(all, of_one_size, all, of_one_size, all, of_one_size);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

/// What the library said of the last call that failed, where it first failed, in a few words; empty where it said
/// nothing.
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
  return text.substr(0, std::min(text.find(": time ="), text.find('\n')));  // addresses and the like follow
}

}  // namespace withy
