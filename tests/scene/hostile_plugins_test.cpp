// Plugins that fail while a scene is built are reported at the place that names them.
#include <gmock/gmock.h>

#include <array>
#include <cfenv>
#include <cmath>
#include <limits>

#include "faulty_plugin.hpp"
#include "scene_fixture.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/plugin/sensor.hpp"

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

/// A body with one mistake in what it says of its stations.
class Misplaced final : public Body {
 public:
  explicit Misplaced(std::string fault) : fault_(std::move(fault)) {
    shape_.particles.push_back({1, PointExpansion::rigid(Vector3::Zero(), 0)});
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(0, 0);
  }
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    if (fault_ == "throws" || (fault_ == "throws-late" && name == StationName("side")))
      throw std::runtime_error("out of order");
    if (name != StationName("root")) return {};
    return PointExpansion::rigid(Vector3::Zero(), 0);
  }
  std::string stations() const override { return "root"; }
  std::string measured_station() const override { return fault_ == "measured" ? "nose" : ""; }
  std::vector<std::string> measured_beside() const override {
    if (fault_ == "beside") return {"ear"};
    return {};
  }
  std::span<const std::shared_ptr<const Body>> segments() const override {
    static const std::array<std::shared_ptr<const Body>, 2> none;
    if (fault_ == "segments") return none;
    return {};
  }

 private:
  std::string fault_;
  ModalShape shape_;
};

/// A body of two modes whose stations, where it is measured or along it, may be those of a rigid one.
class Unsized final : public Body {
 public:
  explicit Unsized(std::string fault) : fault_(std::move(fault)) {
    PointExpansion end = PointExpansion::rigid(Vector3::UnitX(), modes);
    end.phi(1, 0) = end.phi(2, 1) = 1;
    shape_.particles.push_back({1, std::move(end)});
    shape_.mode_names = {"y", "z"};
    shape_.stiffness = 100 * Eigen::Matrix2d::Identity();
    shape_.damping = Eigen::Matrix2d::Zero();
    shape_.length = 1;
  }
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    if (name == StationName("root")) return PointExpansion::rigid(Vector3::Zero(), modes);
    const bool along = std::holds_alternative<double>(name);
    if (!along && name != StationName(measured_station())) return {};
    PointExpansion at = shape_.particles[0].at;
    if (fault_ == (along ? "none-along" : "none")) return PointExpansion::rigid(at.X, 0);
    if (fault_ == (along ? "one-along" : "one")) at.phi = Matrix3X::Zero(3, 1);
    if (along) at.phi *= 0.1;
    return at;
  }
  std::string stations() const override { return "root, end, numbers"; }
  std::string measured_station() const override { return "end"; }

 private:
  static constexpr Eigen::Index modes = 2;
  std::string fault_;
  ModalShape shape_;
};

/// Acts at a frame that its scene may not have.
class Elsewhere final : public Load {
 public:
  explicit Elsewhere(FrameIndex at) : at_(at) {}
  std::unique_ptr<BoundLoad> bind(const Model&) const override { return std::make_unique<Bound>(at_); }

 private:
  class Bound final : public BoundLoad {
   public:
    explicit Bound(FrameIndex at) : at_(at) {}
    std::size_t scratch() const override { return 0; }
    void add(double, std::span<const double>, std::span<const double>, std::span<double>,
             std::span<double>) const noexcept override {}
    std::span<const FrameIndex> frames() const override { return {&at_, 1}; }
    std::vector<double> discontinuities() const override { return {}; }
    double end() const override { return 0; }
    void begin(State&) const override {}

   private:
    FrameIndex at_;
  };
  FrameIndex at_;
};

/// A sensor with one mistake.
class Mistaken final : public Sensor {
 public:
  explicit Mistaken(std::string fault) : fault_(std::move(fault)) {}
  std::unique_ptr<BoundSensor> bind(const Model&, std::span<const SensorNode>) const override {
    return std::make_unique<Bound>(fault_);
  }

 private:
  class Bound final : public BoundSensor {
   public:
    explicit Bound(std::string fault) : fault_(std::move(fault)) {}
    std::vector<SensorColumn> columns() const override {
      if (fault_ == "throws") throw std::runtime_error("out of order");
      if (fault_ == "comma") return {{"a,b", "m"}};
      return {{"", "m"}};
    }
    std::vector<SectionPlace> sections() const override {
      if (fault_ == "body") return {{9, 0.1}};
      if (fault_ == "section") return {{0, 0.1}};
      return {};
    }
    void read(SensedState& state, const SensorInputs& inputs, std::span<double> values) const noexcept override {
      values[0] = 0;
      if (fault_ == "frame") values[0] = state.motion({0, 77}).position.x();
      if (fault_ == "no-body") values[0] = state.acceleration({9, 0}).linear.x();
      if (fault_ == "hinge") values[0] = state.reaction(-1).force.x();
      if (fault_ == "unasked") values[0] = state.section(inputs.first_section).inner.force.x();
    }

   private:
    std::string fault_;
  };
  std::string fault_;
};

/// Bends as x², or says so wrongly; or as 1 − cos 200 x.
class Parabola final : public ModeFamily {
 public:
  explicit Parabola(std::string fault) : fault_(std::move(fault)) {}
  std::size_t most() const override { return 1; }
  std::unique_ptr<ShapeFunctions> functions(const BeamData& beam, std::size_t) const override {
    return std::make_unique<Functions>(fault_, beam.length);
  }

 private:
  class Functions final : public ShapeFunctions {
   public:
    Functions(std::string fault, double length) : fault_(std::move(fault)), length_(length) {}
    std::size_t count() const override { return fault_ == "none" ? 0 : 1; }
    double wave_number() const override { return 2 / length_; }
    void evaluate(double x, std::span<double> phi, std::span<double> slope,
                  std::span<double> curvature) const override {
      if (fault_ == "waves") {
        constexpr double waves = 200;
        phi[0] = 1 - std::cos(waves * x);
        slope[0] = waves * std::sin(waves * x);
        curvature[0] = waves * waves * std::cos(waves * x);
        return;
      }
      const double size = std::sqrt(5.0) / length_ / length_;
      phi[0] = size * x * x;
      slope[0] = (fault_ == "slope" ? 4 : 2) * size * x;
      curvature[0] = 2 * size;
    }

   private:
    std::string fault_;
    double length_;
  };
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
    e.add(faulty_plugin<Body, Misplaced>("misplaced"));
    e.add(faulty_plugin<Body, Unsized>("unsized"));
    e.add(faulty_plugin<Sensor, Mistaken>("mistaken"));
    e.add(faulty_plugin<ModeFamily, Parabola>("parabola"));
    Plugin<Load> elsewhere;
    elsewhere.id = "elsewhere";
    elsewhere.parameters = {number("body", "1", "index"), number("frame", "1", "index")};
    elsewhere.make = [](const Value& p, const MakeContext&) -> std::unique_ptr<Load> {
      return std::make_unique<Elsewhere>(
          FrameIndex{static_cast<int>(p.number_at("body")), static_cast<int>(p.number_at("frame"))});
    };
    e.add(std::move(elsewhere));
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
  EXPECT_EQ(
      problem("type: null"),
      "s.yaml:4:7: /bodies/b/type: missing; need one of: beam, greedy, lump, misplaced, modal, nan, null, number, "
      "plate, refused, rigid, rootless, rounds, throws, unsized");
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

TEST_F(HostilePlugins, WhoseStationsThrowOrAreMissingAreReportedAtTheBody) {
  const std::string who = "s.yaml:4:3: /bodies/b: body plugin 'misplaced' ";
  EXPECT_EQ(problem("type: misplaced"), "");
  EXPECT_EQ(problem("type: misplaced, fault: throws"), who + "does not say what the body is: out of order");
  EXPECT_EQ(problem("type: misplaced, fault: measured"),
            who + "measures at a station that the body does not have, \"nose\"; need root");
  EXPECT_EQ(problem("type: misplaced, fault: beside"),
            who + "measures beside at a station that the body does not have, \"ear\"; need root");
  EXPECT_EQ(problem("type: misplaced, fault: segments"), who + "made no segment 1 of 2");
  EXPECT_EQ(problems(replaced(with("type: misplaced, fault: throws-late"), "child: b", "child: b.side"), registry),
            who + "does not say what the body is: out of order");
}

TEST_F(HostilePlugins, WhoseMeasuredStationsHaveAnotherNumberOfModesAreReported) {
  const auto body = [&](const std::string& fault) { return problem("type: unsized, fault: " + fault); };
  const auto refusal = [](const std::string& frame, const std::string& size) {
    return "frame '" + frame + "' of body 'b' cannot be used: Phi is " + size + ", not 3 by 2";
  };
  EXPECT_EQ(body("nothing"), "");
  EXPECT_THAT(body("none"), testing::HasSubstr(refusal("end", "3 by 0")));
  EXPECT_THAT(body("one"), testing::HasSubstr(refusal("end", "3 by 1")));
  EXPECT_THAT(body("none-along"), testing::HasSubstr(refusal("at_5", "3 by 0")));
  EXPECT_THAT(body("one-along"), testing::HasSubstr(refusal("at_5", "3 by 1")));
}

TEST_F(HostilePlugins, WhoseLoadsActWhereThereIsNoFrameAreReportedAtTheLoad) {
  const auto load = [&](const std::string& at) {
    return problems(with("type: lump") + "loads:\n  l: {type: elsewhere, " + at + "}\n", registry);
  };
  const std::string who = "s.yaml:8:3: /loads/l: load 'l' acts at ";
  EXPECT_EQ(load("body: 0, frame: 0"), "");
  EXPECT_EQ(load("body: 0, frame: 77"), who + "frame 77 of body 'b', which the scene has not");
  EXPECT_EQ(load("body: 0, frame: -1"), who + "frame -1 of body 'b', which the scene has not");
  EXPECT_EQ(load("body: 9, frame: 0"), who + "frame 0 of body 9, which the scene has not");
  EXPECT_EQ(load("body: -1, frame: 0"), who + "frame 0 of body -1, which the scene has not");
}

TEST_F(HostilePlugins, WhoseSensorsGiveOrAskForWhatThereIsNotAreReportedAtTheOutput) {
  const auto sensor = [&](const std::string& fault) {
    return problems(with("type: lump") + "outputs:\n  o: {type: mistaken, fault: " + fault + "}\n", registry);
  };
  const std::string at = "s.yaml:8:3: /outputs/o: the sensor ";
  EXPECT_EQ(sensor("nothing"), "");
  EXPECT_EQ(sensor("throws"), at + "does not say what it gives: out of order");
  EXPECT_THAT(sensor("comma"), testing::StartsWith(at + "gives numbers that cannot be: number 1 has a name with a"));
  EXPECT_EQ(sensor("body"), at + "cannot be read: it asks for a section of body 9, and there are 1");
  EXPECT_EQ(sensor("section"),
            at + "cannot be read: it asks for the section at x = 0.1 m of body 'b', which cannot be cut there");
  EXPECT_EQ(sensor("frame"), at + "cannot be read: it asks for frame 77 of body 'b', which the scene has not");
  EXPECT_EQ(sensor("no-body"), at + "cannot be read: it asks for frame 0 of body 9, which the scene has not");
  EXPECT_EQ(sensor("hinge"), at + "cannot be read: it asks for hinge -1, and there are 1");
  EXPECT_EQ(sensor("unasked"), at + "cannot be read: it asks for section 0, and there are 0");
}

TEST_F(HostilePlugins, WhoseFunctionsAreNotAsTheySayAreReportedAtTheFamily) {
  const auto family = [&](const std::string& fault) {
    return problem(
        "type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 10, modes: 1, family: {name: "
        "parabola, fault: " +
        fault + "}}");
  };
  const std::string made = "mode family 'parabola' made functions that cannot be: ";
  EXPECT_EQ(family("nothing"), "");
  EXPECT_THAT(family("none"), testing::EndsWith("/family/name: " + made + "there are 0, where 1 are asked for"));
  EXPECT_THAT(family("slope"), testing::HasSubstr(made + "function 1 has the slope "));
  EXPECT_THAT(family("waves"), testing::HasSubstr(made + "their greatest wave number is 2 1/m, and they vary faster"));
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
