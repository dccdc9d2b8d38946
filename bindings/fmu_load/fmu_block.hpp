/// \file
/// An FMU as the inside of a sampled controller.
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "withy/bindings/fmu_load/instance.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/loads/control/control_block.hpp"

namespace withy::fmu_load {

/// What of an FMU is measured, commanded and set beforehand.
struct Wiring {
  std::vector<std::uint32_t> inputs, outputs, parameters;
  std::vector<double> parameter_values;
};

/// An FMU keeps its state to itself; a State of withy is the only truth. So the block's numbers hold a ticket, made of
/// everything that the FMU has been told since its start, and the bytes of its state where it gives them. An instance
/// that has been told the same goes on; else a new one is given the bytes, or the law refuses.
class FmuBlock final : public ControlBlock, public ForeignLaw {
 public:
  /// \param file name for messages, \param line of the load in the text of its scene
  /// \throws FmuError where it cannot be instantiated, initialized or saved.
  FmuBlock(const std::string& file, int line, std::shared_ptr<const Program> program, Wiring wiring, double t);

  std::size_t inputs() const override { return wiring_.inputs.size(); }
  std::size_t outputs() const override { return wiring_.outputs.size(); }
  std::size_t memory() const override { return memory_; }
  void set_sample(double period) override { period_ = period; }
  void begin(double t, std::span<const double> w, std::span<double> z) const noexcept override;
  void output(double t, std::span<const double> w, std::span<const double> z,
              std::span<double> v) const noexcept override;
  void sample(double t, std::span<const double> w, std::span<double> z, std::span<double> v) const noexcept override;

  const ForeignLaw* foreign() const override { return this; }
  std::string failure(std::span<const double> z) const override;
  std::string refusal(std::span<const double> z) const override;

 private:
  struct Kept {
    double ticket;
    std::unique_ptr<Instance> instance;
  };
  [[nodiscard]] std::unique_ptr<Instance> make() const;
  [[nodiscard]] std::unique_ptr<Instance> take(double ticket) const;
  [[nodiscard]] bool has(double ticket) const;
  void keep(double ticket, std::unique_ptr<Instance> instance) const;
  void write(std::span<double> z, double ticket, Instance& instance) const;
  void fail(std::span<double> z, double t, const char* why) const noexcept;
  [[nodiscard]] bool has_bytes(std::span<const double> z) const { return z.size() > 1 && z[1] >= 0; }
  [[nodiscard]] Values parameters() const { return {wiring_.parameters, wiring_.parameter_values}; }

  std::string name_;  ///< "FMU 'valve.fmu' (line 12 of the scene)"
  std::shared_ptr<const Program> program_;
  Wiring wiring_;
  std::size_t memory_ = 1;
  double period_ = 0;
  mutable std::mutex mutex_;
  mutable std::list<Kept> kept_;  ///< instances between their samples, the longest unused first
  mutable std::string failure_;   ///< of the last one
};

}  // namespace withy::fmu_load
