#include "mjcf_defaults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "withy/core/spatial/direction.hpp"
#include "withy/scene/names.hpp"

namespace withy::exchange {
namespace {

/// The forms of an orientation beside `quat`: they are one attribute, of which the last one given counts.
constexpr std::array<std::string_view, 4> turns = {"axisangle", "euler", "xyaxes", "zaxis"};

/// Of elements without a class.
const std::string main_class = "main";

bool is_turn(std::string_view key) { return std::find(turns.begin(), turns.end(), key) != turns.end(); }

/// Whether an element says itself what a default would.
bool says(const Element& element, const std::string& key) {
  if (!is_turn(key)) return element.find(key) != nullptr;
  return std::any_of(turns.begin(), turns.end(), [&](std::string_view turn) { return element.find(turn) != nullptr; });
}

}  // namespace

bool turns_itself(const Element& element) {
  return std::any_of(element.attributes.begin(), element.attributes.end(),
                     [](const auto& attribute) { return attribute.first == "quat" || is_turn(attribute.first); });
}

void check_orientation(const Element& element, Diagnostics& diagnostics) {
  std::vector<std::string> given;
  for (const auto& [key, value] : element.attributes)
    if (key == "quat" || is_turn(key)) given.push_back(key);
  if (given.size() > 1)
    diagnostics.error(element.place, fmt::format("got the orientations {}; need one of them", listed(given)));
}

void MjcfDefaults::add_global(const Element& element, std::vector<std::string>& remarks) {
  const std::string* called = element.find("class");
  if (called != nullptr && *called != "main" && global_.insert(*called).second)
    remarks.push_back(fmt::format(
        "<default class={}> on line {} stands at the top level: it is taken for the default of all elements "
        "without a class, as MuJoCo does up to 3.1.6; later versions refuse it",
        in_quotes(*called), element.place.line));
  add(element, main_class, {});
}

void MjcfDefaults::add(const Element& element, const std::string& name, const std::string& around) {
  auto& mine = classes_[name];
  if (!around.empty()) mine = classes_[around];
  for (const Element& e : element.children) {
    if (e.name == "default") continue;
    OfElement& all = mine[e.name];
    std::erase_if(all, [&](const auto& one) { return is_turn(one.first) && says(e, one.first); });
    for (const auto& [key, value] : e.attributes) all[key] = value;
  }
  for (const Element& e : element.children) {
    if (e.name != "default") continue;
    const std::string* called = e.find("class");
    add(e, called != nullptr ? *called : main_class, name);
  }
}

Element MjcfDefaults::completed(const Element& element, const std::string& around, Diagnostics& diagnostics) const {
  const std::string* own = element.find("class");
  const std::string said = own != nullptr ? *own : around.empty() ? main_class : around;
  const std::string& name = global_.contains(said) ? main_class : said;
  check_orientation(element, diagnostics);
  Element whole{element.name, element.attributes, {}, element.place};
  const auto found = classes_.find(name);
  if (found == classes_.end()) {
    if (name != main_class) diagnostics.error(element.place, "there is no default class " + in_quotes(name));
    return whole;
  }
  const auto of_element = found->second.find(element.name);
  if (of_element == found->second.end()) return whole;
  for (const auto& [key, value] : of_element->second)
    if (!says(element, key)) whole.attributes.emplace_back(key, value);
  return whole;
}

Matrix3 MjcfAngles::rotation(const Element& element, Diagnostics& diagnostics) const {
  const Attributes a(element, diagnostics);
  if (const auto v = a.numbers("axisangle", 4, 4)) {
    const auto axis = unit_along(Vector3((*v)[0], (*v)[1], (*v)[2]));
    if (axis) return Eigen::AngleAxisd(unit * (*v)[3], *axis).toRotationMatrix();
    a.error("axisangle", "got the axis 0 0 0; need a direction");
  }
  if (element.find("euler") != nullptr) {
    const Vector3 angles = a.vector("euler", Vector3::Zero());
    Matrix3 R = Matrix3::Identity();
    for (std::size_t i = 0; i < 3; ++i) {
      const auto letter = static_cast<unsigned char>(euler[i]);
      const Vector3 axis = Vector3::Unit(std::tolower(letter) - 'x');
      const Matrix3 turn = Eigen::AngleAxisd(unit * angles[static_cast<Eigen::Index>(i)], axis).toRotationMatrix();
      R = std::islower(letter) != 0 ? Matrix3(R * turn) : Matrix3(turn * R);  // capitals: about fixed axes
    }
    return R;
  }
  if (const auto v = a.numbers("xyaxes", 6, 6)) {
    const auto x = unit_along(Vector3((*v)[0], (*v)[1], (*v)[2])), y = unit_along(Vector3((*v)[3], (*v)[4], (*v)[5]));
    if (x && y && x->cross(*y).norm() > 0) {
      Matrix3 R;
      R.col(0) = *x;
      R.col(2) = x->cross(*y).normalized();
      R.col(1) = R.col(2).cross(R.col(0));
      return R;
    }
    a.error("xyaxes", "got parallel axes; need two directions");
  }
  if (element.find("zaxis") != nullptr)
    return rotation_between(Vector3::UnitZ(), a.direction("zaxis", Vector3::UnitZ()));
  if (const auto q = a.numbers("quat", 4, 4)) {
    const auto unit_one = unit_along(Eigen::Vector4d((*q)[0], (*q)[1], (*q)[2], (*q)[3]));
    if (unit_one) return rotation_from_quaternion((*unit_one)[0], (*unit_one)[1], (*unit_one)[2], (*unit_one)[3]);
    a.error("quat", "got 0 0 0 0; need a quaternion");
  }
  return Matrix3::Identity();
}

}  // namespace withy::exchange
