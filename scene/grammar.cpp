#include "withy/scene/grammar.hpp"

#include "withy/scene/units.hpp"
#include "withy/scene/visual.hpp"

namespace withy::grammar {
namespace {

Value numbers(std::initializer_list<double> xs) {
  std::vector<Value> items;
  for (const double x : xs) items.emplace_back(x);
  return Value::list(std::move(items));
}

std::vector<ParameterSpec> event_members() {
  return {text("hinge", "hinge whose coordinate or rate passes a value").optional(),
          integer("component", "which of the hinge's rates, counted from 0").least(0).otherwise(0.0),
          text("of", "what is watched: the rate's coordinate or the rate itself")
              .one_of({"position", "rate"})
              .otherwise("position"),
          text("signal", "number of an output, as imu.x, or column of a hinge that passes a value").optional(),
          text("limit", "load whose limit is reached (up) or left (down): a saturated actuator, a hinge at its stop")
              .optional(),
          number("value", std::string(any_unit), "value that it passes, in the unit of what is watched").otherwise(0.0),
          text("direction", "from below, from above, or both").one_of({"up", "down", "both"}).otherwise("both"),
          number("at", "s", "time at which it happens").optional(),
          text("after", "event after which it happens").optional(),
          number("delay", "s", "time from when it happens to when it acts").least(0).otherwise(0.0),
          boolean("repeat", "whether it acts every time; else once").otherwise(Value(false)),
          map("do",
              {texts("lock", "hinges that are locked where they are, by impulses").optional(),
               texts("unlock", "hinges that are free again").optional(),
               texts("release", "bodies that are let go, with all that hangs on them; each is welded").optional(),
               texts("switch_off", "loads that give no effort from then on").optional(),
               texts("switch_on", "loads that act as the scene states them").optional(),
               texts("set", "parameters of loads, as loads.motor.amplitude=5").optional()},
              "what is done then")
              .otherwise(Value::map({})),
          boolean("stop", "whether the run ends there").otherwise(Value(false))};
}

}  // namespace

const std::vector<ParameterSpec>& pose_members() {
  static const std::vector<ParameterSpec> members = {
      vector("position", 3, "m", "position of the frame's origin").otherwise(numbers({0, 0, 0})),
      vector("orientation", 4, "1", "how the frame is turned: unit quaternion w, x, y, z, axis and angle, or angles")
          .otherwise(numbers({1, 0, 0, 0}))};
  return members;
}

const std::vector<ParameterSpec>& scene_members() {
  static const std::vector<ParameterSpec> members = {
      text("format", "version of the scene format").one_of({"withy/1"}),
      text("name", "title of the scene").otherwise(""),
      vector("gravity", 3, "m/s^2", "acceleration of gravity, world axes").otherwise(numbers({0, 0, 0})),
      map("time",
          {number("end", "s", "end of the simulation; without it, the latest end of a load or motion")
               .least(0)
               .optional(),
           number("output", "s", "interval of the outputs").above(0).otherwise(0.01)},
          "span of the simulation")
          .otherwise(Value::map({})),
      map("limits",
          {number("deflection", "1", "deflection of a body, in its lengths, that counts as divergence")
               .above(0)
               .otherwise(1.0)},
          "what ends a simulation early")
          .otherwise(Value::map({})),
      named("events", event_members(), "what is looked for during a simulation, reported with its time, and done then")
          .otherwise(Value::map({})),
  };
  return members;
}

std::vector<std::string> special_keys() {
  return {"formulation", "integrator", "bodies", "hinges", "loads", "motions", "constraints", "initial", "outputs"};
}

const std::vector<ParameterSpec>& body_members() {
  static const std::vector<ParameterSpec> members = [] {
    std::vector<ParameterSpec> frame = pose_members();
    // A text specification with a unit takes a name or a number: see Checker::check.
    ParameterSpec at = text("at", "station that carries the frame: its name, or its coordinate along the body");
    at.unit = std::string("m");
    frame.push_back(std::move(at).otherwise("root"));
    return std::vector{
        text("type", "body plugin"),
        named("frames", frame, "frames for hinges and loads, each fixed to the section at a station")
            .otherwise(Value::map({})),
        text("formulation", "formulation for this body alone").naming(ParameterSpec::Refers::formulation).optional(),
        visual_spec()};
  }();
  return members;
}

const std::vector<ParameterSpec>& hinge_members() {
  static const std::vector<ParameterSpec> members = {
      text("type", "hinge plugin"), text("parent", "what the hinge hangs on: world, a body, or body.frame"),
      text("child", "what it carries: a body, or body.frame"),
      map("offset", pose_members(), "fixed pose of the hinge frame F in the parent's frame").otherwise(Value::map({})),
      number("reflected_inertia", "kg m^2|kg",
             "of a hinge of one rate: the inertia of its drive's rotor times the square of the gear's ratio")
          .least(0)
          .optional()};
  return members;
}

const std::vector<ParameterSpec>& load_members() {
  static const std::vector<ParameterSpec> members = {text("type", "load plugin")};
  return members;
}

const std::vector<ParameterSpec>& sensor_members() {
  static const std::vector<ParameterSpec> members = {
      text("type", "sensor plugin"),
      boolean("statistics", "whether its extremes, mean and root mean square over a run are found, between outputs too")
          .optional()};
  return members;
}

const std::vector<ParameterSpec>& motion_members() {
  static const std::vector<ParameterSpec> members = {
      motion_type(), text("hinge", "hinge that it moves").naming(ParameterSpec::Refers::hinge)};
  return members;
}

const std::vector<ParameterSpec>& constraint_members() {
  static const std::vector<ParameterSpec> members = {
      text("type", "what the constraint is").one_of({"hinge"}), text("hinge", "hinge plugin that closes the loop"),
      text("a", "frame that carries the hinge frame F: world, a body, or body.frame"),
      text("b", "frame that is the hinge frame M: world, a body, or body.frame"),
      map("offset", pose_members(), "fixed pose of F in frame a").otherwise(Value::map({}))};
  return members;
}

ParameterSpec choice_name(std::string_view kind, std::string_view otherwise) {
  return text("name", std::string(kind) + " plugin").otherwise(std::string(otherwise).c_str());
}

ParameterSpec motion_type() { return text("type", "motion plugin"); }

ParameterSpec family_name() { return text("name", "mode-family plugin"); }
ParameterSpec formulation_name() { return text("name", "formulation plugin"); }

Value named_formulation(Value given) {
  if (given.kind() != Value::Kind::map || given.find("name") != nullptr ||
      (given.find("kinematics") == nullptr && given.find("truncation") == nullptr))
    return given;
  const Place place = given.place();
  given.set("name", Value(std::string("general"), {place.line, place.column, place.path + "/name"}));
  return given;
}

}  // namespace withy::grammar
