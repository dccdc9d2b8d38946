// Libraries that load and fit, but enroll what they should not, or fail to. Each case is an entry of its own.
#include <limits>
#include <stdexcept>

#include "point_mass.hpp"
#include "withy/core/plugin/entry.hpp"

namespace {

using withy::Enrollment;

void half(Enrollment& e) { e.add(zoo::point_mass("zoo-half")); }  // its manifest promises a second

void excess(Enrollment& e) {
  e.add(zoo::point_mass("zoo-excess"));
  e.add(zoo::point_mass("zoo-unannounced"));
}

void half_and_throws(Enrollment& e) {
  e.add(zoo::point_mass("zoo-half-and-throws"));
  throw std::runtime_error("no licence found");
}

void nothing(Enrollment&) {}

void two(Enrollment& e) {  // nothing wrong with it
  e.add(zoo::point_mass("zoo-two"));
  e.add(zoo::point_mass("zoo-two-more"));
}

void twice(Enrollment& e) {
  e.add(zoo::point_mass("zoo-twice"));
  e.add(zoo::point_mass("zoo-twice"));
}

void malformed_id(Enrollment& e) { e.add(zoo::point_mass("Zoo Malformed")); }

void no_factory(Enrollment& e) {
  auto plugin = zoo::point_mass("zoo-no-factory");
  plugin.make = nullptr;
  e.add(std::move(plugin));
}

void throws_text(Enrollment&) { throw std::runtime_error("the material data base is missing"); }

void throws_number(Enrollment&) { throw 7; }

void throws_long(Enrollment&) { throw std::runtime_error(std::string(100'000, 'x')); }

/// A body whose shape has a NaN: its library is in order, its content is not.
class Poisoned final : public zoo::PointMass {
 public:
  Poisoned() { shape_.particles.front().at.X.y() = std::numeric_limits<double>::quiet_NaN(); }
};

void nan_body(Enrollment& e) {
  auto plugin = zoo::point_mass("zoo-nan-body");
  plugin.make = [](const withy::Value&, const withy::MakeContext&) -> std::unique_ptr<withy::Body> {
    return std::make_unique<Poisoned>();
  };
  e.add(std::move(plugin));
}

}  // namespace

WITHY_PLUGIN(zoo_half, half);
WITHY_PLUGIN(zoo_excess, excess);
WITHY_PLUGIN(zoo_half_and_throws, half_and_throws);
WITHY_PLUGIN(zoo_nothing, nothing);
WITHY_PLUGIN(zoo_two, two);
WITHY_PLUGIN(zoo_twice, twice);
WITHY_PLUGIN(zoo_malformed_id, malformed_id);
WITHY_PLUGIN(zoo_no_factory, no_factory);
WITHY_PLUGIN(zoo_throws_text, throws_text);
WITHY_PLUGIN(zoo_throws_number, throws_number);
WITHY_PLUGIN(zoo_throws_long, throws_long);
WITHY_PLUGIN(zoo_nan_body, nan_body);
