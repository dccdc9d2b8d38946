/// \file
/// A uniform rigid rod along x of the body frame, from `root` (x = 0) to `tip` (x = length), round and solid.
#include <cmath>

#include "bodies.hpp"

namespace example {
namespace {

using withy::PointExpansion;
using withy::Vector3;

class Rod final : public withy::Body {
 public:
  Rod(double length, double mass, double radius) : length_(length) {
    // Two equal particles at the Gauss points of [0, length]: mass, first and second moment of a uniform line.
    for (const double s : {-1.0, 1.0}) {
      shape_.particles.push_back({mass / 2, at(length / 2 * (1 + s / std::sqrt(3.0)))});
    }
    // What the thickness adds, summed over the length: m r²/2 about the axis, m r²/4 across.
    const double across = mass * radius * radius / 4;
    shape_.sections.push_back({Vector3(2 * across, across, across).asDiagonal(), at(length / 2)});
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(0, 0);
  }
  const withy::ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    if (name == StationName("root")) return at(0);
    if (name == StationName("tip")) return at(length_);
    const double* x = std::get_if<double>(&name);
    if (x == nullptr || !(*x >= 0 && *x <= length_)) return {};
    return at(*x);
  }
  std::string stations() const override {
    return "root, tip, or a coordinate x from 0 to " + std::to_string(length_) + " m";
  }

 private:
  static PointExpansion at(double x) { return PointExpansion::rigid(Vector3(x, 0, 0), 0); }

  double length_;
  withy::ModalShape shape_;
};

std::unique_ptr<withy::Body> make_rod(const withy::Value& p, const withy::MakeContext&) {
  return std::make_unique<Rod>(p.number_at("length"), p.number_at("mass"), p.number_at("radius"));
}

}  // namespace

withy::Plugin<withy::Body> rod() {
  return {.id = "rod",
          .summary = "Uniform rigid round rod along x",
          .parameters = {withy::number("length", "m", "length").above(0), withy::number("mass", "kg", "mass").above(0),
                         withy::number("radius", "m", "radius of its section").least(0).otherwise(0.0)},
          .make = &make_rod};
}

}  // namespace example
