#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>

#include "withy/bindings/python/parts_in_python.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/names.hpp"

namespace withy::python {
namespace {

/// What a dict of Python says, in the words of its places: "particles[2].mass". Everything thrown is a py::value_error.
class Said {
 public:
  /// \param where empty for the whole \param known its members; any other is refused, with the nearest of these
  Said(const py::handle& given, std::string where, const std::vector<std::string>& known) : where_(std::move(where)) {
    of_ = dict_of(given, where_.empty() ? "shape()" : where_);
    for (const auto& member : of_)
      if (const std::string key = py::str(member.first); std::find(known.begin(), known.end(), key) == known.end())
        throw py::value_error(place(key) + ": unknown key " + in_quotes(key) + suggestion(key, known));
  }
  [[nodiscard]] bool has(const char* key) const { return of_.contains(key); }
  [[nodiscard]] std::string place(const std::string& key) const { return where_.empty() ? key : where_ + "." + key; }
  /// Of the type; it must be there. \param need what that is, in words
  template <class Type>
  [[nodiscard]] Type value(const char* key, const char* need) const {
    if (!has(key)) throw py::value_error(place(key) + ": missing; need " + need);
    try {
      return of_[key].cast<Type>();
    } catch (const py::cast_error&) {
      throw unlike(place(key), need, of_[key]);
    }
  }
  /// Of a shape, row by row; zero where they are absent.
  [[nodiscard]] std::vector<double> numbers(const char* key, std::vector<py::ssize_t> shape) const;
  /// Calls for each item of a list, with the place it has.
  template <class Act>
  void each(const char* key, Act&& act) const {
    int count = 0;
    for (const py::handle item : iterated(key)) act(item, place(key) + "[" + std::to_string(count++) + "]");
  }
  /// Calls for each member of a dict, with its name and place.
  template <class Act>
  void each_named(const char* key, Act&& act) const {
    for (const auto& [name, item] : dict_of(of_[key], place(key)))
      act(std::string(py::str(name)), item, place(key) + "." + std::string(py::str(name)));
  }

 private:
  static py::value_error unlike(const std::string& where, const char* need, const py::handle& got) {
    return py::value_error(where + ": need " + need + ", not " + Py_TYPE(got.ptr())->tp_name);
  }
  static py::dict dict_of(const py::handle& given, const std::string& where) {
    try {
      return given.cast<py::dict>();
    } catch (const std::exception&) {
      throw unlike(where, "a dict", given);
    }
  }
  [[nodiscard]] py::iterator iterated(const char* key) const {
    try {
      return py::iter(of_[key]);
    } catch (const py::error_already_set&) {
      throw unlike(place(key), "a list of dicts", of_[key]);
    }
  }

  py::dict of_;
  std::string where_;
};

std::vector<double> Said::numbers(const char* key, std::vector<py::ssize_t> shape) const {
  std::size_t count = 1;
  for (const py::ssize_t n : shape) count *= static_cast<std::size_t>(n);
  std::vector<double> numbers(count);
  if (!has(key)) return numbers;
  const std::string where = place(key);
  if (of_[key].is_none()) throw unlike(where, "numbers", of_[key]);  // to numpy it is NaN
  try {
    const Array given(of_[key]);
    if (!std::equal(shape.begin(), shape.end(), given.shape(), given.shape() + given.ndim()))
      throw py::value_error(where + ": need the shape " + std::string(py::str(py::cast(shape))));
    std::copy_n(given.data(), count, numbers.begin());
  } catch (const py::error_already_set& e) {  // numpy's, which does not know what it was asked for
    throw py::value_error(where + ": " + std::string(py::str(e.value())));
  }
  return numbers;
}

/// What says where a point is and how it moves with the modes, beside these.
std::vector<std::string> point_members(std::vector<std::string> others) {
  others.insert(others.end(), {"position", "phi", "psi", "gamma", "theta"});
  return others;
}

PointExpansion expansion_of(const Said& of, py::ssize_t n) {
  PointExpansion at = PointExpansion::rigid(Vector3(of.numbers("position", {3}).data()), n);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto phi = of.numbers("phi", {3, n}), psi = of.numbers("psi", {3, n}), gamma = of.numbers("gamma", {3, n, n}),
             theta = of.numbers("theta", {3, n, n});
  at.phi = Eigen::Map<const Rows>(phi.data(), 3, n);
  at.psi = Eigen::Map<const Rows>(psi.data(), 3, n);
  for (std::size_t k = 0; k < 3; ++k) {
    at.gamma[k] = Eigen::Map<const Rows>(gamma.data() + static_cast<py::ssize_t>(k) * n * n, n, n);
    at.theta[k] = Eigen::Map<const Rows>(theta.data() + static_cast<py::ssize_t>(k) * n * n, n, n);
  }
  return at;
}

class PythonBody final : public Body {
 public:
  explicit PythonBody(const py::object& shape) {
    const Said given(shape, "", {"modes", "particles", "sections", "stations", "stiffness", "damping", "length"});
    if (given.has("modes")) shape_.mode_names = given.value<std::vector<std::string>>("modes", "a list of names");
    const auto n = static_cast<py::ssize_t>(shape_.modes());
    if (given.has("particles"))
      given.each("particles", [&](const py::handle& each, std::string where) {
        const Said particle(each, std::move(where), point_members({"mass"}));
        shape_.particles.push_back({particle.value<double>("mass", "a number"), expansion_of(particle, n)});
      });
    if (given.has("sections"))
      given.each("sections", [&](const py::handle& each, std::string where) {
        const Said section(each, std::move(where), point_members({"inertia"}));
        shape_.sections.push_back({Matrix3(section.numbers("inertia", {3, 3}).data()), expansion_of(section, n)});
      });
    const auto stiffness = given.numbers("stiffness", {n, n}), damping = given.numbers("damping", {n, n});
    shape_.stiffness = Eigen::Map<const Eigen::MatrixXd>(stiffness.data(), n, n);
    shape_.damping = Eigen::Map<const Eigen::MatrixXd>(damping.data(), n, n);
    if (given.has("length")) shape_.length = given.value<double>("length", "a number");
    stations_.emplace("root", PointExpansion::rigid(Vector3::Zero(), n));
    if (given.has("stations"))
      given.each_named("stations", [&](const std::string& name, const py::handle& at, std::string where) {
        stations_.insert_or_assign(name, expansion_of(Said(at, std::move(where), point_members({})), n));
      });
    check();
  }
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    const auto* text = std::get_if<std::string>(&name);
    const auto found = text == nullptr ? stations_.end() : stations_.find(*text);
    return found == stations_.end() ? std::nullopt : std::optional(found->second);
  }
  std::string stations() const override {
    std::string names;
    for (const auto& [name, at] : stations_) names += (names.empty() ? "" : ", ") + name;
    return names;
  }
  std::string measured_station() const override {
    return stations_.count("tip") > 0 ? "tip" : shape_.most_compliant(stations_);
  }

 private:
  void check() const {
    const auto refuse = [](const char* why) { throw py::value_error(why); };
    if (shape_.particles.empty()) refuse("particles: need at least one");
    const auto finite = [](const PointExpansion& at) {
      return at.X.allFinite() && at.phi.allFinite() && at.psi.allFinite() &&
             std::all_of(at.gamma.begin(), at.gamma.end(), [](const auto& g) { return g.allFinite(); }) &&
             std::all_of(at.theta.begin(), at.theta.end(), [](const auto& g) { return g.allFinite(); });
    };
    for (const Particle& p : shape_.particles)
      if (!(p.mass >= 0 && std::isfinite(p.mass)) || !finite(p.at))
        refuse("particles: need finite numbers and masses of at least 0");
    for (const Section& s : shape_.sections)
      if (!s.inertia.allFinite() || !finite(s.at)) refuse("sections: need finite numbers");
    for (const auto& [name, at] : stations_)
      if (!finite(at)) refuse("stations: need finite numbers");
    const std::set<std::string> names(shape_.mode_names.begin(), shape_.mode_names.end());
    if (names.size() != shape_.mode_names.size() || names.contains(""))
      refuse("modes: need a name of its own for each");
    const Eigen::MatrixXd& K = shape_.stiffness;
    if (!K.allFinite() || !shape_.damping.allFinite() || (K - K.transpose()).norm() > 1e-9 * K.norm())
      refuse("stiffness and damping: need finite numbers, the stiffness symmetric");
  }
  ModalShape shape_;
  std::map<std::string, PointExpansion> stations_;
};

}  // namespace

std::unique_ptr<Body> make_python_body(const Value& p, const MakeContext& context) {
  const py::gil_scoped_acquire held;
  const py::object* object = object_of(p, context);
  if (object == nullptr) return nullptr;
  try {
    return std::make_unique<PythonBody>(object->attr("shape")());
  } catch (const std::exception& e) {
    context.diagnostics.error(p.at("object").place(), std::string("Python: ") + e.what());
  }
  return nullptr;
}

}  // namespace withy::python
