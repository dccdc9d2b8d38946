// Plugins that fail while a scene is built are reported at the place that names them.
#include <gmock/gmock.h>

#include <array>
#include <cfenv>
#include <cmath>
#include <limits>
#include <type_traits>

#include "scene_fixture.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"

namespace withy::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

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

/// A slider on the curve y = sin x; told faults are in its pose, H, bias, their derivatives or its kernel.
class OnSine final : public Hinge {
 public:
  explicit OnSine(std::string fault) : fault_(std::move(fault)) {}
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = fault_ == "reference" ? nan : 0; }
  void motion(std::span<const double> x, std::span<const double> rates, HingeMotion& out) const noexcept override {
    out.pose.R.setIdentity();
    if (fault_ == "size-of-R") out.pose.R *= 2;
    if (fault_ == "shear") out.pose.R(0, 1) = 0.2;
    if (fault_ == "mirror") out.pose.R(2, 2) = -1;
    out.pose.p = Vector3(x[0], fault_ == "place" ? nan : std::sin(x[0]), 0);
    out.H.setZero(6, fault_ == "width" ? 2 : 1);
    out.H(3, 0) = 1;
    out.H(4, 0) = (fault_ == "H" ? 1.01 : 1) * std::cos(x[0]);
    out.bias.setZero();
    if (fault_ != "bias") out.bias[4] = -std::sin(x[0]) * rates[0] * rates[0];
  }
  void motion_derivative(std::span<const double> x, std::span<const double> rates, std::size_t along,
                         HingeMotion& out) const override {
    if (fault_ == "throws") throw std::runtime_error("out of order");
    if (fault_ == "default") return Hinge::motion_derivative(x, rates, along, out);
    out.H.setZero(6, fault_ == "width-of-derivative" ? 2 : 1);
    out.H(4, 0) = (fault_ == "derivative-of-H" ? 5 : 1) * -std::sin(x[0]);
    out.bias.setZero();
    out.bias[4] = (fault_ == "derivative-of-bias" ? 5 : 1) * -std::cos(x[0]) * rates[0] * rates[0];
  }
  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = fault_ == "derivatives" ? 2 * rates[0] : rates[0];
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

/// sin 3t with one mistake.
class Wave final : public Motion {
 public:
  explicit Wave(std::string fault) : fault_(std::move(fault)) {}
  bool locks() const override {
    if (fault_ == "throws") throw std::runtime_error("out of order");
    return false;
  }
  MotionPoint at(double t) const noexcept override {
    const double w = fault_ == "fast" ? 3e9 : 3;
    MotionPoint p{std::sin(w * t), w * std::cos(w * t), -w * w * std::sin(w * t)};
    if (fault_ == "step" && t > 0.5) p.position += 1;
    if (fault_ == "rate") p.rate *= 2, p.acceleration *= 2;
    if (fault_ == "acceleration") p.acceleration += 1;
    if (fault_ == "no-rate" && t > 0.5) p.rate = nan;
    return p;
  }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }

 private:
  std::string fault_;
};

/// Throws where it is asked what it is.
class Mute final : public Formulation {
 public:
  explicit Mute(std::string fault) : fault_(std::move(fault)) {}
  Terms terms() const override {
    if (fault_ == "terms") throw std::runtime_error("out of order");
    return {};
  }
  Standing standing() const override {
    if (fault_ == "standing") throw std::runtime_error("out of order");
    return {};
  }
  std::unique_ptr<EquationsOfMotion> compile(std::shared_ptr<const Model>) const override { return nullptr; }

 private:
  std::string fault_;
};

/// A share of the complete second order, and where it is lopsided of one field alone.
class Shared final : public StrainKinematics {
 public:
  Shared(double share, bool lopsided) : share_(share), lopsided_(lopsided) {}
  std::string_view name() const override { return "shared"; }
  StrainOrder order() const override { return StrainOrder::quadratic; }
  Vector3 displacement_slope(const SectionField& i, const SectionField& j, const Vector3& theta) const override {
    if (lopsided_) return share_ * i.rotation.cross(j.rotation.cross(Vector3::UnitX()));
    return share_ * StrainKinematics::displacement_slope(i, j, theta);
  }

 private:
  double share_;
  bool lopsided_;
};

template <bool lopsided>
std::unique_ptr<StrainKinematics> shared(const Value& p, const MakeContext&) {
  return std::make_unique<Shared>(p.number_at("share"), lopsided);
}

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

/// Bends as x², or says so wrongly.
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
    const auto add_faulty = [&]<class Interface, class Faulty>(const char* id, std::type_identity<Interface>,
                                                               std::type_identity<Faulty>) {
      Plugin<Interface> plugin;
      plugin.id = id;
      plugin.parameters = {text("fault", "what is wrong with it").otherwise("nothing")};
      plugin.make = [](const Value& p, const MakeContext&) -> std::unique_ptr<Interface> {
        return std::make_unique<Faulty>(p.text_at("fault"));
      };
      e.add(std::move(plugin));
    };
    add_faulty("wave", std::type_identity<Motion>{}, std::type_identity<Wave>{});
    add_faulty("mute", std::type_identity<Formulation>{}, std::type_identity<Mute>{});
    const auto add_kinematics = [&](const char* id, ParameterSpec share, auto make) {
      Plugin<StrainKinematics> plugin;
      plugin.id = id;
      plugin.parameters = {std::move(share)};
      plugin.make = make;
      e.add(std::move(plugin));
    };
    const auto share = [] { return number("share", "1", "of the complete second order"); };
    add_kinematics("with-default", share().otherwise(0.5), &shared<false>);
    add_kinematics("with-need", share(), &shared<false>);
    add_kinematics("lopsided", share().otherwise(0.5), &shared<true>);
    add_faulty("misplaced", std::type_identity<Body>{}, std::type_identity<Misplaced>{});
    add_faulty("mistaken", std::type_identity<Sensor>{}, std::type_identity<Mistaken>{});
    add_faulty("parabola", std::type_identity<ModeFamily>{}, std::type_identity<Parabola>{});
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
  static std::string with_sine(const std::string& fault) {
    return "format: withy/1\ntime: {end: 1}\nbodies: {b: {type: lump}}\nhinges:\n  h: {type: sine, parent: "
           "world, child: b, fault: " +
           fault + "}\n";
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
}

TEST_F(HostilePlugins, WhoseLoadsBeginWhereThereIsNoNumberAreReportedAtTheLoad) {
  EXPECT_EQ(problems(with("type: lump") + "loads:\n  l: {type: begins-nowhere}\n", registry),
            "s.yaml:8:3: /loads/l: load 'l' has the simulation begin where a coordinate is nan");
}

TEST_F(HostilePlugins, WhoseHingesDoNotMoveAsTheySayAreReported) {
  const auto hinge = [&](const std::string& fault) { return problems(with_sine(fault), registry); };
  const std::string made = "s.yaml:5:3: /hinges/h: hinge 'sine' made a motion that cannot be: ";
  EXPECT_EQ(hinge("nothing"), "");
  EXPECT_EQ(hinge("default"), "");
  EXPECT_THAT(hinge("H"), testing::StartsWith(made + "column 1 of H is (0 0 0 1 1.01 0) in the axes of M"));
  EXPECT_THAT(hinge("bias"), testing::StartsWith(made + "the bias is (0 0 0 0 0 0) in the axes of M"));
  EXPECT_EQ(hinge("kernel"), made + "it does not move as the kernel that it says it is");
  EXPECT_EQ(hinge("derivatives"), made +
                                      "it has as many rates as coordinates, and the derivative of coordinate 1 is 2 "
                                      "where rate 1 is 1; need rates that are the derivatives, or more coordinates, "
                                      "as a quaternion has");
  EXPECT_EQ(hinge("size"), made + "it has 1 coordinates and 1 rates, the kernel that it says it is has 7 and 6");
  EXPECT_EQ(hinge("width"), made + "H has 2 columns; need one a rate, 1");
}

// R^T R - 1: 3 times the identity; of the shear by a, a in two corners and a² in one.
TEST_F(HostilePlugins, WhoseHingesHaveNoPoseThatIsARotationAreReported) {
  const auto hinge = [&](const std::string& fault) { return problems(with_sine(fault), registry); };
  const std::string made = "s.yaml:5:3: /hinges/h: hinge 'sine' made a motion that cannot be: ";
  EXPECT_EQ(hinge("size-of-R"), made + "R of its pose is no rotation: R^T R is off the identity by 5.19615");
  EXPECT_EQ(hinge("shear"), made + "R of its pose is no rotation: R^T R is off the identity by 0.285657");
  EXPECT_EQ(hinge("mirror"), made + "R of its pose is a reflection, of determinant -1");
  EXPECT_EQ(hinge("reference"), made + "coordinate 1 of its reference is nan");
  EXPECT_EQ(hinge("place"), made + "its pose is not finite near its reference");
}

TEST_F(HostilePlugins, WhoseHingesGiveDerivativesThatAreNoneAreReported) {
  const auto hinge = [&](const std::string& fault) { return problems(with_sine(fault), registry); };
  const std::string at = "s.yaml:5:3: /hinges/h: hinge 'sine' ", made = at + "made a motion that cannot be: ";
  EXPECT_EQ(hinge("throws"), at + "does not say what it is: out of order");
  EXPECT_EQ(hinge("width-of-derivative"), made + "the derivative of H along rate 1 has 2 columns; need one a rate, 1");
  EXPECT_THAT(hinge("derivative-of-H"), testing::StartsWith(made + "the derivative of H along rate 1, column 1, is "));
  EXPECT_THAT(hinge("derivative-of-bias"), testing::StartsWith(made + "the derivative of the bias along rate 1 is "));
}

// sin 3t, its rate and its acceleration, or others.
TEST_F(HostilePlugins, WhoseMotionsHaveRatesThatAreNoneAreReported) {
  const auto motion = [&](const std::string& fault) {
    return problems(with_sine("nothing") + "motions:\n  m: {type: wave, hinge: h, fault: " + fault + "}\n", registry);
  };
  const std::string at = "s.yaml:7:3: /motions/m: motion 'wave' ", made = at + "made a course that cannot be: ";
  EXPECT_EQ(motion("nothing"), "");
  EXPECT_EQ(motion("step"), "") << "what jumps between the times that are looked at";
  EXPECT_EQ(motion("fast"), "") << "what no difference follows";
  EXPECT_THAT(motion("rate"), testing::StartsWith(made + "at t = 0.137174 s its rate is 5.49908; differences of its "
                                                         "coordinate give 2.7495"));
  EXPECT_THAT(motion("acceleration"), testing::StartsWith(made + "at t = 0.137174 s its acceleration is -2.60005; "
                                                                 "differences of its rate give -3.6000"));
  EXPECT_EQ(motion("no-rate"), made + "at t = 0.683013 s its rate is nan, where its coordinate is finite");
  EXPECT_EQ(motion("throws"), at + "does not say what it is: out of order");
}

TEST_F(HostilePlugins, WhoseFormulationsThrowWhereTheyAreAskedForTheirTermsAreReported) {
  const auto formulation = [&](const std::string& fault) {
    return problems(with("type: lump") + "formulation: {name: mute, fault: " + fault + "}\n", registry);
  };
  EXPECT_THAT(formulation("terms"), testing::HasSubstr("'mute' does not say what it is: out of order"));
  EXPECT_THAT(formulation("standing"), testing::HasSubstr("'mute' does not say what it is: out of order"));
}

TEST_F(HostilePlugins, WhoseStrainKinematicsAreNoneAreReportedWhereTheyAreNamed) {
  const auto kinematics = [&](const std::string& id) {
    return problems(with("type: lump") + "formulation: {kinematics: " + id + ", truncation: none}\n", registry);
  };
  const std::string at = "/formulation/kinematics: strain kinematics '";
  EXPECT_EQ(kinematics("with-default"), "") << "its parameter has its default";
  EXPECT_THAT(kinematics("with-need"), testing::HasSubstr(at + "with-need' needs 'share', and a scene names strain "
                                                               "kinematics without parameters"));
  EXPECT_THAT(kinematics("lopsided"), testing::HasSubstr(at + "lopsided' made one that cannot be: displacement_slope "
                                                              "is not symmetric: it gives ("));
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
