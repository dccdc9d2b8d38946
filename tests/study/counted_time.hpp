/// \file
/// Searches whose time goes by evaluations: what they find is the same on any machine.
#pragma once

#include <cstddef>
#include <string>

#include "withy/study/prepared.hpp"
#include "withy/study/search_time.hpp"

namespace withy::test {

/// An evaluation of `quadratic` takes about this on one machine of 2024; of others in proportion.
class CountedTime final : public study::SearchTime {
 public:
  [[nodiscard]] double now() const override { return seconds_; }
  [[nodiscard]] double of_evaluation(const study::Prepared& model) const override {
    double seconds = 0;
    const Layout& layout = model.equations->layout();
    for (std::size_t b = 0; b < layout.modes_of.size(); ++b) {
      const Slot* slot = layout.modes(b);
      const double modes = slot != nullptr ? static_cast<double>(slot->speeds) : 0;
      // Bodies that have a formulation of their own are ruthless.
      const std::string& formulation = model.model().bodies()[b].terms ? "ruthless" : model.scene.formulation_name;
      seconds += (1e-7 + 2e-8 * modes + 1e-8 * modes * modes) * beside_quadratic(formulation);
    }
    return seconds;
  }
  void evaluated(const study::Prepared& model, std::size_t count) override {
    seconds_ += static_cast<double>(count) * of_evaluation(model);
  }

 private:
  static double beside_quadratic(const std::string& formulation) {
    return formulation == "ruthless" ? 0.4 : formulation == "linear" ? 0.6 : formulation == "exact" ? 3 : 1;
  }
  double seconds_ = 0;
};

}  // namespace withy::test
