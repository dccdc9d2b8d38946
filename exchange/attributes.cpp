#include "attributes.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <charconv>
#include <cmath>

#include "withy/core/spatial/direction.hpp"
#include "withy/scene/names.hpp"

namespace withy::exchange {
namespace {

constexpr std::string_view xml_spaces = " \t\r\n";

/// Numbers with spaces between them; nothing where there is anything else.
std::optional<std::vector<double>> spaced_numbers(std::string_view text) {
  std::vector<double> all;
  for (;;) {
    const std::size_t first = text.find_first_not_of(xml_spaces);
    if (first == std::string_view::npos) return all;
    text.remove_prefix(first);
    const std::size_t end = std::min(text.find_first_of(xml_spaces), text.size());
    std::string_view word = text.substr(0, end);
    if (word.front() == '+') word.remove_prefix(1);
    double x = 0;
    const auto [at, wrong] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (wrong != std::errc{} || at != word.data() + word.size() || !std::isfinite(x)) return {};
    all.push_back(x);
    text.remove_prefix(end);
  }
}

}  // namespace

void Attributes::error(std::string_view key, const std::string& what) const {
  Place place = element_.place;
  place.path += fmt::format("/@{}", key);
  diagnostics_.error(place, what);
}

std::optional<std::vector<double>> Attributes::numbers(std::string_view key, std::size_t least,
                                                       std::size_t most) const {
  const std::string* text = element_.find(key);
  if (text == nullptr) return {};
  auto all = spaced_numbers(*text);
  if (all && all->size() >= least && all->size() <= most) return all;
  const std::string count = least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
  error(key, fmt::format("got {}; need {} finite {} with spaces between them", in_quotes(*text), count,
                         most == 1 ? "number" : "numbers"));
  return {};
}

double Attributes::number(std::string_view key, double otherwise) const {
  const auto read = numbers(key, 1, 1);
  return read ? read->front() : otherwise;
}

Vector3 Attributes::vector(std::string_view key, const Vector3& otherwise) const {
  const auto read = numbers(key, 3, 3);
  return read ? Vector3((*read)[0], (*read)[1], (*read)[2]) : otherwise;
}

Vector3 Attributes::direction(std::string_view key, const Vector3& otherwise) const {
  if (const auto unit = unit_along(vector(key, otherwise))) return *unit;
  error(key, "got the direction 0 0 0; need one of any length but zero");
  return otherwise;
}

std::string Attributes::required(std::string_view key) const {
  const std::string* text = element_.find(key);
  if (text != nullptr && !text->empty()) return *text;
  error(key, "missing");
  return {};
}

Matrix3 inertia_matrix(double xx, double yy, double zz, double xy, double xz, double yz) {
  Matrix3 I;
  I << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return I;
}

void InertiaRule::settle(const std::string& link, const Place& place, double mass, Matrix3& inertia) const {
  if (!(mass >= 0)) return diagnostics.error(place, fmt::format("got the mass {} kg; need at least 0", mass));
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(inertia);
  const Vector3 I = principal.eigenvalues();
  const double rounding = 1e-12 * inertia.cwiseAbs().maxCoeff();
  if (I[0] >= -rounding && I[2] - I[0] - I[1] <= rounding) return;
  if (!mend)
    return diagnostics.error(
        place, fmt::format("no distribution of mass has principal moments {:.6g}, {:.6g}, {:.6g} kg m^2 about its "
                           "centre: need each at least 0 and none above the sum of the other two (--mend-inertias "
                           "takes the nearest that are so)",
                           I[0], I[1], I[2]));
  // Second moments along the principal axes, ∫ x² dm = (I_y + I_z − I_x)/2: none may be negative.
  const Vector3 second = (Vector3::Constant(I.sum() / 2) - I).cwiseMax(0.0);
  const Vector3 mended = Vector3::Constant(second.sum()) - second;
  inertia = principal.eigenvectors() * mended.asDiagonal() * principal.eigenvectors().transpose();
  remarks.push_back(
      fmt::format("link {}: no distribution of mass has its principal moments {:.4g}, {:.4g}, {:.4g} kg m^2; taken are "
                  "{:.4g}, {:.4g}, {:.4g}",
                  in_quotes(link), I[0], I[1], I[2], mended[0], mended[1], mended[2]));
}

}  // namespace withy::exchange
