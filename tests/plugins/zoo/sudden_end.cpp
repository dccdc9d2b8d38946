// A load that ends the program from within an evaluation, in the way that its parameter names.
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "withy/core/plugin/entry.hpp"
#include "withy/core/plugin/load.hpp"

namespace {

class Bound final : public withy::BoundLoad {
 public:
  explicit Bound(std::string way) : way_(std::move(way)) {}
  std::size_t scratch() const override { return 0; }
  void add(double, std::span<const double>, std::span<const double>, std::span<double>,
           std::span<double>) const noexcept override {
    if (way_ == "exit") std::exit(0);
    fail();
  }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(withy::State&) const override {}

 private:
  void fail() const { throw std::runtime_error(way_); }
  std::string way_;
};

class SuddenEnd final : public withy::Load {
 public:
  explicit SuddenEnd(std::string way) : way_(std::move(way)) {}
  std::unique_ptr<withy::BoundLoad> bind(const withy::Model&) const override { return std::make_unique<Bound>(way_); }

 private:
  std::string way_;
};

void enroll(withy::Enrollment& enrollment) {
  enrollment.add(withy::Plugin<withy::Load>{
      .id = "zoo-sudden-end",
      .summary = "Ends the program",
      .parameters = {withy::text("way", "exit, or what the exception says")},
      .make = [](const withy::Value& p, const withy::MakeContext&) -> std::unique_ptr<withy::Load> {
        return std::make_unique<SuddenEnd>(p.text_at("way"));
      }});
}

}  // namespace

// The name is given from outside: expanded first.
#define ZOO_PLUGIN(name) WITHY_PLUGIN(name, enroll)
ZOO_PLUGIN(ZOO_SYMBOL);
