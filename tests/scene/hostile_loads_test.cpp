// Loads that are wrong about themselves while a scene is built are reported at the place that names them.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "scene_fixture.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/load.hpp"

namespace withy::test {
namespace {

constexpr std::size_t never_set = std::size_t{1} << 60U;

/// Two states that stay, of these names.
class Named final : public ContinuousPart {
 public:
  Named(std::string first, std::string second) : names_{std::move(first), std::move(second)} {}
  std::size_t states() const override { return names_.size(); }
  std::string name(std::size_t state) const override { return names_[state]; }
  void begin(const LoadView&, std::span<double> z) const noexcept override { std::fill(z.begin(), z.end(), 0.0); }
  void rates(const LoadView&, std::span<double> rates) const noexcept override {
    std::fill(rates.begin(), rates.end(), 0.0);
  }
  void add(const LoadView&, std::span<double>) const noexcept override {}

 private:
  std::array<std::string, 2> names_;
};

std::unique_ptr<ContinuousPart> named_after(const std::string& fault) {
  if (fault == "named") return std::make_unique<Named>("größe", "z.rate");
  if (fault == "twins") return std::make_unique<Named>("z", "z");
  if (fault == "nameless") return std::make_unique<Named>("z", "");
  if (fault == "newline") return std::make_unique<Named>("a\nb", "z");
  return nullptr;
}

/// Does nothing, and says one thing wrongly of it.
class BoundBoaster final : public BoundLoad, private DiscretePart {
 public:
  explicit BoundBoaster(std::string fault) : fault_(std::move(fault)), continuous_(named_after(fault_)) {}
  std::size_t scratch() const override { return fault_ == "scratch" ? never_set : 0; }
  void add(double, std::span<const double>, std::span<const double>, std::span<double>,
           std::span<double>) const noexcept override {}
  std::vector<double> discontinuities() const override {
    if (fault_ == "throws-at-times") throw std::runtime_error("no times");
    if (fault_ == "jumps-back") return {0.25, 0.25, 0.125};
    return {};
  }
  double end() const override { return fault_ == "endless" ? std::numeric_limits<double>::infinity() : 0; }
  void begin(State& state) const override {
    if (fault_ == "fewer") state.y.resize(1);
    if (fault_ == "more") state.y.push_back(0);
    if (fault_ == "late") state.time = 7;
    if (fault_ == "nowhere") state.y[4] = std::nan("");
  }
  const DiscretePart* discrete() const override { return this; }
  const ContinuousPart* continuous() const override { return continuous_.get(); }

 private:
  std::size_t states() const override { return fault_ == "states" ? never_set : 1; }
  std::size_t switches() const override { return fault_ == "switches" ? never_set : 0; }
  double period() const override {
    if (fault_ == "throws") throw std::runtime_error("no clock");
    if (fault_ == "backwards") return -1;
    if (fault_ == "never") return std::numeric_limits<double>::infinity();
    return fault_ == "nan" ? std::nan("") : 0.1;
  }
  void renew(double, std::span<const double>, std::span<const double>, const Crossing&, std::span<double>,
             std::span<double>) const noexcept override {}
  void add(double, std::span<const double>, std::span<double>) const noexcept override {}

  std::string fault_;
  std::unique_ptr<ContinuousPart> continuous_;
};

class Boaster final : public Load {
 public:
  explicit Boaster(std::string fault) : fault_(std::move(fault)) {}
  std::unique_ptr<BoundLoad> bind(const Model&) const override {
    if (fault_ == "throws-number") throw 42;
    if (fault_ == "binds-nothing") return nullptr;
    return std::make_unique<BoundBoaster>(fault_);
  }

 private:
  std::string fault_;
};

class HostileLoads : public SceneTest {
 protected:
  HostileLoads() {
    Plugin<Load> plugin;
    plugin.id = "boaster";
    plugin.parameters = {text("fault", "what is wrong with it").otherwise("nothing")};
    plugin.make = [](const Value& p, const MakeContext&) -> std::unique_ptr<Load> {
      return std::make_unique<Boaster>(p.text_at("fault"));
    };
    Enrollment e;
    e.add(std::move(plugin));
    registry.admit(std::move(e), "test");
  }
  std::string load(const std::string& fault) {
    return problems(
        "format: withy/1\ntime: {end: 1}\nbodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\nhinges: "
        "{h: {type: free, parent: world, child: b}}\nloads:\n  l: {type: boaster, fault: " +
            fault + "}\n",
        registry);
  }
};

const std::string who = "s.yaml:6:3: /loads/l: load 'l' ";

TEST_F(HostileLoads, ThatAreNotBoundAreReported) {
  EXPECT_EQ(load("binds-nothing"), who + "cannot be bound and does not say why");
  EXPECT_EQ(load("throws-number"), who + "cannot be bound: it throws what is no exception of C++");
}

TEST_F(HostileLoads, WithoutAFiniteEndAreReported) {
  EXPECT_EQ(load("throws-at-times"), who + "does not say when it jumps or ends: no times");
  EXPECT_EQ(load("endless"), who + "ends at no finite time; one that has no end of its own says 0");
}

TEST_F(HostileLoads, WhoseClocksHaveNoPeriodAreReported) {
  const std::string need = " s; need a finite period, or 0 where no clock renews it";
  EXPECT_EQ(load("nothing"), "");
  EXPECT_EQ(load("backwards"), who + "is renewed every -1" + need);
  EXPECT_EQ(load("never"), who + "is renewed every inf" + need);
  EXPECT_EQ(load("nan"), who + "is renewed every nan" + need);
  EXPECT_EQ(load("throws"), who + "does not say what it keeps: no clock");
}

TEST_F(HostileLoads, WhoseJumpsDoNotIncreaseAreReported) {
  EXPECT_EQ(load("jumps-back"), who + "says that it jumps at 0.25 s and then at 0.125 s; need times that increase");
}

TEST_F(HostileLoads, ThatSayToHaveMoreNumbersThanAnyMemoryAreReported) {
  const std::string says = who + "says that it has 1152921504606846976 ", most = "; 4294967296 are the most";
  EXPECT_EQ(load("scratch"), says + "numbers of scratch space" + most);
  EXPECT_EQ(load("states"), says + "discrete states" + most);
  EXPECT_EQ(load("switches"), says + "switching functions" + most);
}

// A state is kept by their names: run.json would have a key twice, or one that cannot be read.
TEST_F(HostileLoads, WhoseStatesCannotBeReadBackByTheirNamesAreReported) {
  const std::string has = who + "has continuous states that cannot be: ";
  EXPECT_EQ(load("named"), "");
  EXPECT_EQ(load("twins"), has + "two are named 'z'");
  EXPECT_EQ(load("nameless"), has + "number 2 has no name");
  EXPECT_EQ(load("newline"),
            has + "number 1 has a name with a comma, a quotation mark, a slash or a control character");
}

// A free hinge has 7 coordinates and 6 rates; behind them are the load's state, whether it is that of a run, and the
// work.
TEST_F(HostileLoads, ThatBeginWithAnotherStateAreReported) {
  EXPECT_EQ(load("fewer"), who + "does not begin: it leaves 1 numbers in the state where there are 16");
  EXPECT_EQ(load("more"), who + "does not begin: it leaves 17 numbers in the state where there are 16");
  EXPECT_EQ(load("nowhere"), who + "has the simulation begin where a coordinate is nan");
  EXPECT_EQ(load("late"), who + "does not begin: it sets the time to 7 s, which the scene says ('initial')");
}

}  // namespace
}  // namespace withy::test
