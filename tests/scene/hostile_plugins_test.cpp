// Plugins that fail while a scene is built are reported at the place that names them.
#include <gmock/gmock.h>

#include <cfenv>
#include <cmath>
#include <limits>

#include "scene_fixture.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/load.hpp"

namespace withy::test {
namespace {

/// A body whose mass is given and whose only other property is that it may lack its root.
class Lump final : public Body {
 public:
  Lump(double mass, bool has_root) : has_root_(has_root) {
    shape_.particles.push_back({mass, PointExpansion::rigid(Vector3::Zero(), 0)});
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(0, 0);
  }
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName&) const override {
    if (!has_root_) return {};
    return PointExpansion::rigid(Vector3::Zero(), 0);
  }
  std::string stations() const override { return "root"; }

 private:
  ModalShape shape_;
  bool has_root_;
};

/// A load that is bound to nothing.
class Unbound final : public Load {
 public:
  std::unique_ptr<BoundLoad> bind(const Model&) const override { return nullptr; }
};

enum class Deed { throws_number, throws_at_times, begins_nowhere };

/// A load that does nothing, but for one deed.
class Misbehaving final : public Load {
 public:
  explicit Misbehaving(Deed deed) : deed_(deed) {}
  std::unique_ptr<BoundLoad> bind(const Model&) const override {
    if (deed_ == Deed::throws_number) throw 42;
    return std::make_unique<Bound>(deed_);
  }

 private:
  class Bound final : public BoundLoad {
   public:
    explicit Bound(Deed deed) : deed_(deed) {}
    std::size_t scratch() const override { return 0; }
    void add(double, std::span<const double>, std::span<const double>, std::span<double>,
             std::span<double>) const noexcept override {}
    std::vector<double> discontinuities() const override {
      if (deed_ == Deed::throws_at_times) throw std::runtime_error("no times");
      return {};
    }
    double end() const override { return 0; }
    void begin(State& state) const override {
      if (deed_ == Deed::begins_nowhere) state.y[4] = std::numeric_limits<double>::quiet_NaN();
    }

   private:
    Deed deed_;
  };
  Deed deed_;
};

template <Deed deed>
std::unique_ptr<Load> misbehaving(const Value&, const MakeContext&) {
  return std::make_unique<Misbehaving>(deed);
}

/// A slider on the curve y = sin x; told faults are in its H, its bias or its kernel.
class OnSine final : public Hinge {
 public:
  explicit OnSine(std::string fault) : fault_(std::move(fault)) {}
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = 0; }
  void motion(std::span<const double> x, std::span<const double> rates, HingeMotion& out) const noexcept override {
    out.pose.R.setIdentity();
    out.pose.p = Vector3(x[0], std::sin(x[0]), 0);
    out.H.setZero(6, 1);
    out.H(3, 0) = 1;
    out.H(4, 0) = (fault_ == "H" ? 1.01 : 1) * std::cos(x[0]);
    out.bias.setZero();
    if (fault_ != "bias") out.bias[4] = -std::sin(x[0]) * rates[0] * rates[0];
  }
  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = rates[0];
  }
  void normalize(std::span<double>) const noexcept override {}
  std::optional<HingeKernel> kernel() const override {
    if (fault_ == "kernel") return HingeKernel{HingeKernel::Kind::prismatic, Vector3::UnitX()};
    if (fault_ == "size") return HingeKernel{HingeKernel::Kind::free, Vector3::UnitX()};
    return {};
  }

 private:
  std::string fault_;
};

class HostilePlugins : public SceneTest {
 protected:
  HostilePlugins() {
    using Made = std::unique_ptr<Body>;
    Enrollment e;
    const auto add = [&](const char* id, auto make, std::vector<ParameterSpec> parameters = {}) {
      Plugin<Body> plugin;
      plugin.id = id;
      plugin.parameters = std::move(parameters);
      plugin.make = make;
      e.add(std::move(plugin));
    };
    add("throws", [](const Value&, const MakeContext&) -> Made { throw std::runtime_error("no luck"); });
    add("null", [](const Value&, const MakeContext&) -> Made { return nullptr; });
    add("number", [](const Value&, const MakeContext&) -> Made { throw 5; });
    add("greedy", [](const Value&, const MakeContext&) -> Made { throw std::bad_alloc(); });
    add("rounds", [](const Value&, const MakeContext&) -> Made {
      std::fesetround(FE_UPWARD);
      return std::make_unique<Lump>(1, true);
    });
    Plugin<Load> unbound;
    unbound.id = "unbound";
    unbound.make = [](const Value&, const MakeContext&) -> std::unique_ptr<Load> {
      return std::make_unique<Unbound>();
    };
    e.add(std::move(unbound));
    const auto add_load = [&](const char* id, auto make) {
      Plugin<Load> load;
      load.id = id;
      load.make = make;
      e.add(std::move(load));
    };
    add_load("throws-number", &misbehaving<Deed::throws_number>);
    add_load("throws-at-times", &misbehaving<Deed::throws_at_times>);
    add_load("begins-nowhere", &misbehaving<Deed::begins_nowhere>);
    Plugin<Hinge> sine;
    sine.id = "sine";
    sine.parameters = {text("fault", "what is wrong with it").otherwise("nothing")};
    sine.make = [](const Value& p, const MakeContext&) -> std::unique_ptr<Hinge> {
      return std::make_unique<OnSine>(p.text_at("fault"));
    };
    e.add(std::move(sine));
    add("refused", [](const Value&, const MakeContext&) -> Made { throw PluginError("a refused library"); });
    add("nan", [](const Value&, const MakeContext&) -> Made {
      return std::make_unique<Lump>(std::numeric_limits<double>::quiet_NaN(), true);
    });
    add("rootless", [](const Value&, const MakeContext&) -> Made { return std::make_unique<Lump>(1, false); });
    add("lump", [](const Value&, const MakeContext&) -> Made { return std::make_unique<Lump>(1, true); },
        {number("strange", "furlong", "a unit nobody knows").optional(),
         boolean("hollow", "whether it is").otherwise(Value(false))});
    registry.admit(std::move(e), "test");
  }
  std::string with(const std::string& body) {
    return "format: withy/1\ntime: {end: 1}\nbodies:\n  b: {" + body +
           "}\nhinges:\n  h: {type: free, parent: world, child: b}\n";
  }
  std::string problem(const std::string& body) { return problems(with(body), registry); }
};

TEST_F(HostilePlugins, ThatThrowAreReported) {
  EXPECT_EQ(problem("type: throws"), "s.yaml:4:3: /bodies/b: body 'throws' cannot be made: no luck");
}

TEST_F(HostilePlugins, ThatMakeNothingAreReported) {
  EXPECT_EQ(problem("type: null"),
            "s.yaml:4:7: /bodies/b/type: missing; need one of: beam, greedy, lump, modal, nan, null, number, "
            "plate, refused, rigid, rootless, rounds, throws");
  EXPECT_EQ(problem("type: 'null'"), "s.yaml:4:3: /bodies/b: body 'null' cannot be made and does not say why");
}

TEST_F(HostilePlugins, ThatThrowWhatIsNoExceptionAreReported) {
  EXPECT_EQ(problem("type: number"),
            "s.yaml:4:3: /bodies/b: body 'number' cannot be made: it throws what is no exception of C++");
}

TEST_F(HostilePlugins, WithoutMemoryAreNoFaultOfTheScene) {
  EXPECT_THROW(parse_scene(with("type: greedy"), "s.yaml", registry), std::bad_alloc);
}

TEST_F(HostilePlugins, ThatChangeTheArithmeticAreRefusedAndItIsRestored) {
  try {
    parse_scene(with("type: rounds"), "s.yaml", registry);
    FAIL() << "the scene was read";
  } catch (const PluginError& e) {
    EXPECT_THAT(e.what(), testing::StartsWith("body 'rounds' of test changes the rounding mode"));
  }
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
}

TEST_F(HostilePlugins, ThatBindNothingAreReported) {
  EXPECT_EQ(problems(with("type: lump") + "loads:\n  l: {type: unbound}\n", registry),
            "s.yaml:8:3: /loads/l: load 'l' cannot be bound and does not say why");
}

TEST_F(HostilePlugins, WhoseLoadsThrowWhileTheyAreBoundAreReportedAtTheLoad) {
  const auto load = [&](const std::string& type) {
    return problems(with("type: lump") + "loads:\n  l: {type: " + type + "}\n", registry);
  };
  EXPECT_EQ(load("throws-number"),
            "s.yaml:8:3: /loads/l: load 'l' cannot be bound: it throws what is no exception of C++");
  EXPECT_EQ(load("throws-at-times"), "s.yaml:8:3: /loads/l: load 'l' does not say when it jumps or ends: no times");
}

TEST_F(HostilePlugins, WhoseLoadsBeginWhereThereIsNoNumberAreReportedAtTheLoad) {
  EXPECT_EQ(problems(with("type: lump") + "loads:\n  l: {type: begins-nowhere}\n", registry),
            "s.yaml:8:3: /loads/l: load 'l' has the simulation begin where a coordinate is nan");
}

TEST_F(HostilePlugins, WhoseHingesDoNotMoveAsTheySayAreReported) {
  const auto hinge = [&](const std::string& fault) {
    return problems(
        "format: withy/1\ntime: {end: 1}\nbodies: {b: {type: lump}}\nhinges:\n  h: {type: sine, parent: "
        "world, child: b, fault: " +
            fault + "}\n",
        registry);
  };
  const std::string made = "s.yaml:5:3: /hinges/h: hinge 'sine' made a motion that cannot be: ";
  EXPECT_EQ(hinge("nothing"), "");
  EXPECT_THAT(hinge("H"), testing::StartsWith(made + "column 1 of H is (0 0 0 1 1.01 0) in the axes of M"));
  EXPECT_THAT(hinge("bias"), testing::StartsWith(made + "the bias is (0 0 0 0 0 0) in the axes of M"));
  EXPECT_EQ(hinge("kernel"), made + "it does not move as the kernel that it says it is");
  EXPECT_EQ(hinge("size"), made + "it has 1 coordinates and 1 rates, the kernel that it says it is has 7 and 6");
}

TEST_F(HostilePlugins, ThatMakeImpossibleBodiesAreReported) {
  EXPECT_THAT(problem("type: nan"), testing::StartsWith("s.yaml:4:3: /bodies/b: body plugin 'nan' made a shape that "
                                                        "cannot be: "));
  EXPECT_EQ(problem("type: rootless"), "s.yaml:4:3: /bodies/b/frames: body 'b' has no station 'root'");
}

TEST_F(HostilePlugins, WhoseLibrariesAreRefusedAreNoFaultOfTheScene) {
  EXPECT_THROW(parse_scene(with("type: refused"), "s.yaml", registry), PluginError);
}

TEST_F(HostilePlugins, WithUnknownUnitsTakePlainNumbers) {
  EXPECT_EQ(problem("type: lump, strange: 3"), "");
  EXPECT_EQ(problem("type: lump, strange: 3 m"),
            "s.yaml:4:28: /bodies/b/strange: got \"3 m\": units are not known here: write a number in furlong; need "
            "finite [furlong]");
}

TEST_F(HostilePlugins, TakeBooleansOnlyAsTrueAndFalse) {
  EXPECT_EQ(problem("type: lump, hollow: true"), "");
  EXPECT_EQ(problem("type: lump, hollow: yes"), "s.yaml:4:27: /bodies/b/hollow: got \"yes\"; need true or false");
  EXPECT_EQ(problem("type: lump, hollow: 1"), "s.yaml:4:27: /bodies/b/hollow: got 1; need true or false");
}

}  // namespace
}  // namespace withy::test
