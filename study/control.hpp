/// \file
/// What the caller of a study may do while it goes on.
#pragma once

#include <functional>

namespace withy::study {

/// Both may be empty. Where a study uses several threads, they call one at a time.
struct Control {
  std::function<bool()> interrupted;                      ///< asked often: true ends the study soon
  std::function<void(double done, double all)> progress;  ///< time [s] of a run, or points of a study

  [[nodiscard]] bool stop() const { return interrupted && interrupted(); }
  void tell(double done, double all) const {
    if (progress) progress(done, all);
  }
};

}  // namespace withy::study
