#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>

#include "withy/bindings/python/parts_in_python.hpp"

namespace withy::python {
namespace {

/// A member of what Python gives, with a shape. Zero where it is absent. \throws py::value_error where it has another
std::vector<double> numbers_of(const py::dict& of, const char* key, std::vector<py::ssize_t> shape) {
  std::size_t count = 1;
  for (const py::ssize_t n : shape) count *= static_cast<std::size_t>(n);
  std::vector<double> numbers(count);
  if (!of.contains(key)) return numbers;
  const Array given = numbers_given(of[key], key);
  if (!std::equal(shape.begin(), shape.end(), given.shape(), given.shape() + given.ndim()))
    throw py::value_error(std::string(key) + ": need the shape " + std::string(py::str(py::cast(shape))));
  std::copy_n(given.data(), count, numbers.begin());
  return numbers;
}

PointExpansion expansion_of(const py::dict& of, py::ssize_t n) {
  PointExpansion at = PointExpansion::rigid(Vector3(numbers_of(of, "position", {3}).data()), n);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto phi = numbers_of(of, "phi", {3, n}), psi = numbers_of(of, "psi", {3, n}),
             gamma = numbers_of(of, "gamma", {3, n, n}), theta = numbers_of(of, "theta", {3, n, n});
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
  explicit PythonBody(const py::dict& given) {
    if (given.contains("modes")) shape_.mode_names = given["modes"].cast<std::vector<std::string>>();
    const auto n = static_cast<py::ssize_t>(shape_.modes());
    for (const py::handle each : given["particles"]) {
      const auto particle = each.cast<py::dict>();
      shape_.particles.push_back({particle["mass"].cast<double>(), expansion_of(particle, n)});
    }
    for (const py::handle each : given.contains("sections") ? given["sections"].cast<py::list>() : py::list()) {
      const auto section = each.cast<py::dict>();
      shape_.sections.push_back({Matrix3(numbers_of(section, "inertia", {3, 3}).data()), expansion_of(section, n)});
    }
    const auto stiffness = numbers_of(given, "stiffness", {n, n}), damping = numbers_of(given, "damping", {n, n});
    shape_.stiffness = Eigen::Map<const Eigen::MatrixXd>(stiffness.data(), n, n);
    shape_.damping = Eigen::Map<const Eigen::MatrixXd>(damping.data(), n, n);
    if (given.contains("length")) shape_.length = given["length"].cast<double>();
    stations_.emplace("root", PointExpansion::rigid(Vector3::Zero(), n));
    if (given.contains("stations"))
      for (const auto& [name, at] : given["stations"].cast<std::map<std::string, py::dict>>())
        stations_.insert_or_assign(name, expansion_of(at, n));
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
    return std::make_unique<PythonBody>(object->attr("shape")().cast<py::dict>());
  } catch (const std::exception& e) {
    context.diagnostics.error(p.at("object").place(), std::string("Python: ") + e.what());
  }
  return nullptr;
}

}  // namespace withy::python
