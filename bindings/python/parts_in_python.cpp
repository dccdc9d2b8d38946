/// \file
/// Loads and bodies written in Python, for trying out: plugins of the type `python`, whose objects stand in a table.
#include "withy/bindings/python/parts_in_python.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "withy/bindings/python/python_failure.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/loads/control/control_load.hpp"
#include "withy/loads/frame_load.hpp"

namespace withy::python {

namespace {

/// Objects by the names that scenes have of them. Touched with the interpreter held; never freed, for the interpreter
/// may be gone before.
std::map<std::string, py::object, std::less<>>& objects() {
  static auto* all = new std::map<std::string, py::object, std::less<>>;
  return *all;
}

}  // namespace

const py::object* object_of(const Value& p, const MakeContext& context) {
  const auto found = objects().find(p.text_at("object"));
  if (found != objects().end()) return &found->second;
  context.diagnostics.error(p.at("object").place(),
                            "this process has no object of Python '" + p.text_at("object") +
                                "': make the part anew with withy.python_load or withy.python_body");
  return nullptr;
}

namespace {

Array copied(std::span<const double> numbers) {
  return Array(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

/// Numbers that Python gives: a scalar for one, else a sequence. \throws py::value_error where they are not as many
void take(const py::object& given, std::span<double> to, const char* what) {
  const Array numbers = numbers_given(given, what);
  if (static_cast<std::size_t>(numbers.size()) != to.size())
    throw py::value_error(std::string(what) + " gives " + std::to_string(numbers.size()) + " numbers; need " +
                          std::to_string(to.size()));
  std::copy_n(numbers.data(), to.size(), to.begin());
}

/// A controller in Python: `effort(t, w)`, or with states z, `rates(t, w, z)` and `effort(t, w, z)`.
class PythonBlock final : public ControlBlock, public ForeignLaw {
 public:
  PythonBlock(py::object object, int line, std::size_t inputs, std::size_t outputs)
      : inputs_(inputs), outputs_(outputs), failure_(line) {
    effort_ = py::hasattr(object, "effort") ? object.attr("effort") : object;
    if (PyCallable_Check(effort_.ptr()) == 0) throw py::type_error("need a function, or an object with effort()");
    if (py::hasattr(object, "states")) states_ = object.attr("states").cast<std::vector<std::string>>();
    if (!states_.empty()) rates_ = object.attr("rates");
    if (py::hasattr(object, "begin")) begin_ = object.attr("begin");
  }
  PythonBlock(const PythonBlock&) = delete;
  PythonBlock& operator=(const PythonBlock&) = delete;
  ~PythonBlock() override {
    const py::gil_scoped_acquire held;
    effort_ = rates_ = begin_ = py::object();
  }
  std::size_t inputs() const override { return inputs_; }
  std::size_t outputs() const override { return outputs_; }
  std::vector<std::string> states() const override { return states_; }
  void set_sample(double period) override { period_ = period; }
  void begin(double t, std::span<const double> w, std::span<double> z) const noexcept override {
    std::fill(z.begin(), z.end(), 0.0);
    if (begin_) guarded_call(failure_, t, [&] { take(begin_(t, copied(w)), z, "begin()"); });
  }
  void rates(double t, std::span<const double> w, std::span<const double> z,
             std::span<double> rates) const noexcept override {
    if (!states_.empty()) call(rates, t, [&] { take(rates_(t, copied(w), copied(z)), rates, "rates()"); });
  }
  void output(double t, std::span<const double> w, std::span<const double> z,
              std::span<double> v) const noexcept override {
    call(v, t,
         [&] { take(states_.empty() ? effort_(t, copied(w)) : effort_(t, copied(w), copied(z)), v, "effort()"); });
  }
  /// One step of the explicit Euler method.
  void advance(double t, std::span<const double> w, std::span<double> z) const noexcept override {
    if (states_.empty()) return;
    std::vector<double> rate(z.size());
    rates(t, w, z, rate);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += period_ * rate[i];
  }
  const ForeignLaw* foreign() const override { return this; }
  std::string failure(std::span<const double> /*discrete*/) const override { return failure_.text(); }
  std::string refusal(std::span<const double> /*discrete*/) const override { return {}; }
  void forget() const override { failure_.forget(); }

 private:
  template <class Act>
  void call(std::span<double> results, double t, Act&& act) const noexcept {
    std::fill(results.begin(), results.end(), 0.0);
    if (!failure_.any()) guarded_call(failure_, t, act);
    if (failure_.any()) std::fill(results.begin(), results.end(), std::nan(""));
  }

  std::size_t inputs_, outputs_;
  py::object effort_, rates_, begin_;
  std::vector<std::string> states_;
  double period_ = 0;
  mutable Failure failure_;
};

Array array_of_vector(const Vector3& v) { return Array(3, v.data()); }

Vector3 vector_of(const py::handle& given, const char* what) {
  std::array<double, 3> numbers{};
  take(py::reinterpret_borrow<py::object>(given), numbers, what);
  return {numbers[0], numbers[1], numbers[2]};
}

/// `wrench(t, position, R, velocity, angular_velocity)` gives a moment and a force, all in world axes.
class BoundPythonWrench final : public FrameLoad, public ForeignLaw {
 public:
  BoundPythonWrench(FrameIndex frame, py::object object, int line)
      : FrameLoad({frame}), object_(std::move(object)), failure_(line) {}
  BoundPythonWrench(const BoundPythonWrench&) = delete;
  BoundPythonWrench& operator=(const BoundPythonWrench&) = delete;
  ~BoundPythonWrench() override {
    const py::gil_scoped_acquire held;
    object_ = py::object();
  }
  void wrenches(double t, std::span<const FrameMotion> motions, std::span<Wrench> wrenches) const noexcept override {
    wrenches[0] = {};
    if (!failure_.any())
      guarded_call(failure_, t, [&] {
        const FrameMotion& m = motions[0];
        Array R({3, 3});
        for (int i = 0; i < 9; ++i) R.mutable_data()[i] = m.R(i / 3, i % 3);
        const auto given = object_
                               .attr("wrench")(t, array_of_vector(m.position), R, array_of_vector(m.velocity),
                                               array_of_vector(m.angular_velocity))
                               .cast<std::pair<py::object, py::object>>();
        wrenches[0] = {vector_of(given.first, "the moment of wrench()"),
                       vector_of(given.second, "the force of wrench()")};
      });
    if (failure_.any()) wrenches[0].moment = wrenches[0].force = Vector3::Constant(std::nan(""));
  }
  std::string failure(std::span<const double> /*discrete*/) const override { return failure_.text(); }
  std::string refusal(std::span<const double> /*discrete*/) const override { return {}; }
  void forget() const override { failure_.forget(); }

 private:
  py::object object_;
  mutable Failure failure_;
};

class PythonWrench final : public Load {
 public:
  PythonWrench(std::string frame, std::string object, int line)
      : frame_(std::move(frame)), object_(std::move(object)), line_(line) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    const py::gil_scoped_acquire held;
    return std::make_unique<BoundPythonWrench>(frame_index(model, frame_), objects().at(object_), line_);
  }

 private:
  std::string frame_, object_;
  int line_;
};

std::unique_ptr<Load> make_python_load(const Value& p, const MakeContext& context) {
  const py::gil_scoped_acquire held;
  const py::object* object = object_of(p, context);
  if (object == nullptr) return nullptr;
  if (p.has("frame")) {
    for (const char* key : {"of", "to", "hinge", "component", "sample", "delay"})
      if (p.has(key)) {
        context.diagnostics.error(p.at(key).place(), "a load at a frame has none");
        return nullptr;
      }
    if (py::hasattr(*object, "wrench"))
      return std::make_unique<PythonWrench>(p.text_at("frame"), p.text_at("object"), p.place().line);
    context.diagnostics.error(p.place(), "the object has no wrench(), which a load at a frame needs");
    return nullptr;
  }
  std::optional<ControlEnds> ends = read_ends(p, context);
  if (!ends) return nullptr;
  ends->measures_nothing = !p.has("of") && !p.has("hinge");
  ends->rate_too = !p.has("of") && p.has("hinge");
  const std::size_t inputs = p.has("of") ? ends->of.size() : (p.has("hinge") ? 2 : 0);
  try {
    auto block =
        std::make_shared<PythonBlock>(*object, p.place().line, inputs, std::max<std::size_t>(1, ends->to.size()));
    block->set_sample(ends->sample);
    return make_control(std::move(*ends), std::move(block));
  } catch (const std::exception& e) {
    context.diagnostics.error(p.at("object").place(), std::string("Python: ") + e.what());
  }
  return nullptr;
}

ParameterSpec object_parameter() { return text("object", "name that withy.python_load or python_body has given it"); }

}  // namespace

void admit_parts_in_python(Registry& registry) {
  Enrollment parts;
  parts.add<Load>({.id = "python",
                   .summary = "A law written in Python, for trying out: slow",
                   .parameters = control_parameters(
                       {object_parameter(), text("frame", "frame that it acts at by a wrench, in place of all else")
                                                .naming(ParameterSpec::Refers::frame)
                                                .optional()}),
                   .make = &make_python_load});
  parts.add<Body>({.id = "python",
                   .summary = "A body whose mass, stiffness and modes Python gives",
                   .parameters = {object_parameter()},
                   .make = &make_python_body});
  registry.admit(std::move(parts), "the module withy");
}

void bind_parts_in_python(py::module_& m) {
  m.def("keep", [](const std::string& name, const py::object& object) { objects().emplace(name, object); });
}

}  // namespace withy::python
