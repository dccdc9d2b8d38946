#include "withy/results/effective_mass_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/results/text_table.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Eigen::Vector3d& v) { return std::vector<double>(v.begin(), v.end()); }

}  // namespace

Json effective_mass_json(const study::EffectiveMasses& masses) {
  Json j{
      {"total", masses.total}, {"sum", numbers(masses.sum())}, {"turning", masses.turning}, {"modes", Json::array()}};
  const Eigen::Matrix3Xd each = masses.masses();
  for (Eigen::Index i = 0; i < each.cols(); ++i)
    j["modes"].push_back({{"hertz", masses.frequencies[i] / (2 * std::numbers::pi)},
                          {"mass", numbers(each.col(i))},
                          {"participation", numbers(masses.participation.col(i))}});
  return j;
}

std::string effective_mass_text(const study::EffectiveMasses& masses) {
  TextTable table({"mode", "frequency\n[Hz]", "x\n[%]", "y\n[%]", "z\n[%]"});
  const Eigen::Matrix3Xd each = masses.masses();
  const auto row = [&](const std::string& mode, const std::string& frequency, const Eigen::Vector3d& mass) {
    std::vector<std::string> cells = {mode, frequency};
    for (const double m : mass) cells.push_back(fmt::format("{:.2f}", 100 * m / masses.total));
    table.add(std::move(cells));
  };
  for (Eigen::Index i = 0; i < each.cols(); ++i) {
    if (each.col(i).maxCoeff() < 1e-3 * masses.total) continue;
    row(std::to_string(i + 1), fmt::format("{:.5g}", masses.frequencies[i] / (2 * std::numbers::pi)), each.col(i));
  }
  row("all", "", masses.sum());
  return fmt::format("Effective mass along the world's axes, of {:.5g} kg; undamped modes, lowest first\n{}\n{}",
                     masses.total,
                     masses.turning ? "The hinges turn and the modes with them: these are the shares at this angle. A "
                                      "base that shakes at one frequency is felt beside it by the rate of the turn.\n"
                                    : "",
                     table.str());
}

}  // namespace withy
