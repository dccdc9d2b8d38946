/// \file
/// What a certificate says, statement by statement, against what results.csv, runs at other tolerances and other
/// commands give: scenes × formulations, and a mix.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using Column = std::vector<double>;

struct ClaimedCase {
  std::string scene, formulation;
  std::vector<std::string> sets = {};
};
void PrintTo(const ClaimedCase& c, std::ostream* out) {
  *out << c.scene << ' ' << c.formulation;
  for (const std::string& set : c.sets) *out << ' ' << set;
}

/// The base and the boom of beam-on-base.yaml, and where Gauss's rule of seven points wants the boom looked at.
constexpr double base_mass = 10, boom_mass = 3, boom_length = 2;
constexpr std::array<double, 7> gauss_at = {0.02544604382862076, 0.1292344072003028, 0.2970774243113014, 0.5,
                                            0.7029225756886985,  0.8707655927996972, 0.9745539561713792};
constexpr std::array<double, 7> gauss_weights = {0.06474248308443485, 0.1398526957446384, 0.1909150252525595,
                                                 0.2089795918367347,  0.1909150252525595, 0.1398526957446384,
                                                 0.06474248308443485};

/// Outputs that tell where the mass of beam-on-base.yaml is.
std::vector<std::string> outputs_of_mass() {
  std::vector<std::string> all = {"--set", "bodies.base.frames.centre={position: [0.1, -0.05, 0.02]}", "--set",
                                  "outputs.base_centre={type: frame, of: base.centre, show: position}"};
  for (std::size_t i = 0; i < gauss_at.size(); ++i) {
    const std::string name = "at" + std::to_string(i);
    std::ostringstream at;
    at.precision(17);
    at << boom_length * gauss_at.at(i);
    all.insert(all.end(), {"--set", "bodies.boom.frames." + name + "={at: " + at.str() + "}", "--set",
                           "outputs." + name + "={type: frame, of: boom." + name + ", show: position}"});
  }
  return all;
}

/// A run as a user has it: run.json and the columns of results.csv by their heads.
struct KeptRun {
  json summary;
  std::map<std::string, Column> columns;

  KeptRun(const ClaimedCase& c, const std::vector<std::string>& more) {
    const Folder folder;
    // Certificates look at steps, whatever the outputs: these are to miss no peak.
    std::vector<std::string> arguments = {"run",   c.scene, "--formulation", c.formulation,
                                          "--out", "out",   "--set",         "time.output=0.01"};
    for (const std::string& set : c.sets) arguments.insert(arguments.end(), {"--set", set});
    if (c.scene.find("beam-on-base") != std::string::npos) {
      const std::vector<std::string> outputs = outputs_of_mass();
      arguments.insert(arguments.end(), outputs.begin(), outputs.end());
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished f = withy(folder, arguments);
    EXPECT_EQ(f.status, 0) << f.err;
    summary = json::parse(folder.read("out/run.json"));
    const auto rows = lines(folder.read("out/results.csv"));
    const std::vector<std::string> heads = split(rows.at(0));
    for (std::size_t r = 1; r < rows.size(); ++r) {
      const auto cells = split(rows[r]);
      for (std::size_t i = 0; i < cells.size(); ++i) columns[heads[i]].push_back(std::stod(cells[i]));
    }
  }
  [[nodiscard]] const Column& of(const std::string& head) const { return columns.at(head); }
  [[nodiscard]] const json& certificate() const { return summary.at("certificate"); }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> cells;
    std::stringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    return cells;
  }
};

double greatest(const Column& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

/// Energy gained beyond the work done, over the greatest of energy, work and kinetic energy.
Column imbalance(const KeptRun& run) {
  const Column &kinetic = run.of("kinetic_energy[J]"), &potential = run.of("potential_energy[J]"),
               &work = run.of("work[J]");
  double scale = 0;
  Column left;
  for (std::size_t i = 0; i < work.size(); ++i) {
    const double energy = kinetic[i] + potential[i];
    scale = std::max({scale, std::abs(energy), std::abs(work[i]), kinetic[i]});
    left.push_back(energy - kinetic[0] - potential[0] - (work[i] - work[0]));
  }
  for (double& x : left) x /= scale;
  return left;
}

/// A vector of results.csv over its rows.
std::vector<Eigen::Vector3d> vectors(const KeptRun& run, const std::string& name, const std::string& unit) {
  const auto part = [&](const char* axis) -> const Column& { return run.of(name + '.' + axis + '[' + unit + ']'); };
  const Column &x = part("x"), &y = part("y"), &z = part("z");
  std::vector<Eigen::Vector3d> all;
  for (std::size_t i = 0; i < x.size(); ++i) all.emplace_back(x[i], y[i], z[i]);
  return all;
}

/// The greatest distance from the first value.
double greatest_change(const std::vector<Eigen::Vector3d>& of) {
  double most = 0;
  for (const Eigen::Vector3d& v : of) most = std::max(most, (v - of.front()).norm());
  return most;
}

std::vector<Eigen::Vector3d> mass_centres(const KeptRun& run) {
  std::vector<Eigen::Vector3d> centres = vectors(run, "base_centre", "m");
  for (Eigen::Vector3d& c : centres) c *= base_mass;
  for (std::size_t k = 0; k < gauss_at.size(); ++k) {
    const auto there = vectors(run, "at" + std::to_string(k), "m");
    for (std::size_t i = 0; i < centres.size(); ++i) centres[i] += boom_mass * gauss_weights.at(k) * there[i];
  }
  for (Eigen::Vector3d& c : centres) c /= base_mass + boom_mass;
  return centres;
}

double apart(const Column& a, const Column& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

const std::vector<std::string> exactly = {
    "--integrator",          "dop853",     "--set", "integrator.rtol=1e-11", "--set",
    "integrator.atol=1e-13", "--estimate", "never"};

/// A case with its run as it comes, with an estimate at any cost, and at a tolerance of 1e-11.
struct Claimed {
  explicit Claimed(const ClaimedCase& claimed)
      : c(claimed), run(claimed, {}), asked(claimed, {"--estimate", "always"}), truth(claimed, exactly) {}
  [[nodiscard]] bool conserves() const {
    return c.sets.empty() && (c.formulation == "linear" || c.formulation == "quadratic" || c.formulation == "exact");
  }
  const ClaimedCase& c;
  KeptRun run, asked, truth;
};

/// The drift, and whose it is: what it is at a tolerance of 1e-11 is the formulation's, the rest the integration's.
void expect_drift_and_its_shares(const Claimed& claimed) {
  const KeptRun &run = claimed.run, &truth = claimed.truth;
  const json& c = run.certificate();
  const Column drift = imbalance(run), model = imbalance(truth);
  const bool own = claimed.c.formulation.starts_with("symmetric");
  const double said = c.at(own ? "energy_drift_without_truncation" : "energy_drift");
  EXPECT_LE(greatest(drift), 1.01 * said + 1e-14) << "over the steps it is no less than over the outputs";
  EXPECT_LE(said, 1.2 * greatest(drift) + 1e-9);
  const json& by = claimed.asked.certificate().at("drift_by");
  const double by_model = by.at("model").at("energy"), by_integration = by.at("integration").at("energy");
  // The coarse steps of every run tell it to a fifth; without them nothing is said.
  EXPECT_EQ(c.at("drift_by").is_null(), c.at("estimated_error").is_null() && !claimed.conserves());
  if (!c.at("drift_by").is_null()) {
    EXPECT_NEAR(c.at("drift_by").at("model").at("energy"), by_model, 0.2 * by_model);
  }
  if (claimed.conserves()) {
    EXPECT_EQ(by_model, 0);
    EXPECT_EQ(by_integration, said);
    EXPECT_LT(greatest(model), 1e-9) << "the formulation conserves energy, as it says";
  } else {
    EXPECT_NEAR(by_model, greatest(model), 0.05 * greatest(model));
    if (!own) {
      EXPECT_LE(apart(drift, model), by_integration + 1e-9);
    }
    EXPECT_LT(by_integration, 0.1 * by_model) << "of a run with usual tolerances";
  }
}

void expect_momenta_of_free_trees_alone(const Claimed& claimed) {
  const KeptRun& run = claimed.run;
  const json& c = run.certificate();
  const bool free = claimed.c.scene.find("beam-on-base") != std::string::npos;
  ASSERT_EQ(c.at("momentum_drift").is_null(), !free);
  if (!free) return;
  const auto P = vectors(run, "linear_momentum", "kg m/s"), centres = mass_centres(run);
  auto L = vectors(run, "angular_momentum", "kg m^2/s");
  double relative = 0;  // energy of motion about the mass centre
  for (std::size_t i = 0; i < P.size(); ++i) {
    L[i] -= centres[i].cross(P[i]);
    relative = std::max(relative, run.of("kinetic_energy[J]")[i] - P[i].squaredNorm() / (2 * (base_mass + boom_mass)));
  }
  const std::map<std::string, double> seen = {
      {"linear", greatest_change(P) / std::sqrt(2 * (base_mass + boom_mass) * relative)},
      {"angular", greatest_change(L) / L.front().norm()}};
  for (const auto& [kind, off] : seen) {
    const double said = c.at("momentum_drift").at(kind);
    EXPECT_NEAR(said, off, 0.05 * off + 1e-9) << kind;
    const double by_model = claimed.asked.certificate().at("drift_by").at("model").at(kind);
    EXPECT_NEAR(by_model, claimed.conserves() ? 0 : said, 0.1 * said + 1e-9) << kind;
  }
}

/// Against the same scene in the model up, both at 1e-11.
void expect_error_against_the_model_up(const Claimed& claimed) {
  // Of `quadratic` it is made on demand.
  const KeptRun& asked = claimed.asked;
  const json& estimate = asked.certificate().at("estimated_error");
  if (claimed.c.formulation == "exact") {
    EXPECT_TRUE(estimate.is_null());
    EXPECT_EQ(asked.certificate().at("without_estimate"),
              "nothing is left out: kinematics is exact and nothing is truncated");
    return;
  }
  ClaimedCase up = claimed.c;
  up.formulation = estimate.at("against");
  up.sets.clear();
  EXPECT_EQ(up.formulation, claimed.c.formulation == "quadratic" && claimed.c.sets.empty() ? "exact" : "quadratic");
  const KeptRun &ours = claimed.truth, theirs(up, exactly);
  for (const auto& [tip, said] : estimate.at("tips").items()) {
    double real = 0;
    for (std::size_t i = 0; i < ours.of("t[s]").size(); ++i) {
      double d = 0;
      for (const char* axis : {".x[m]", ".y[m]", ".z[m]"})
        d = std::hypot(d, ours.of(tip + axis).at(i) - theirs.of(tip + axis).at(i));
      real = std::max(real, d);
    }
    EXPECT_NEAR(said.get<double>(), real, 0.1 * real + 1e-6) << tip;
  }
  for (const auto& [hinge, said] : estimate.at("hinges").items()) {
    const std::string head = hinge + "[rad]";
    if (ours.columns.count(head) == 0) continue;  // orientations are in the test of measures
    const double real = apart(ours.of(head), theirs.of(head));
    EXPECT_NEAR(said.get<double>(), real, 0.1 * real + 1e-6) << hinge;
  }
}

/// One column for each mode that is listed; bodies whose formulation is another, and no others.
void expect_modes_and_formulations_of_the_scene(const Claimed& claimed) {
  const KeptRun& run = claimed.run;
  const json& c = run.certificate();
  std::size_t listed = 0, kept = 0;
  for (const json& f : c.at("families")) {
    const std::string stem = f.at("body").get<std::string>() + '.' + f.at("strain").get<std::string>() + '.';
    const auto modes = f.at("modes").get<std::size_t>();
    listed += modes;
    EXPECT_EQ(run.columns.count(stem + std::to_string(modes) + "[1]"), 1U) << stem;
    EXPECT_EQ(run.columns.count(stem + std::to_string(modes + 1) + "[1]"), 0U) << stem;
    EXPECT_FALSE(f.at("family").get<std::string>().empty());
  }
  for (const auto& [head, values] : run.columns)
    if (head.find("bending") != std::string::npos && head.find(".rate") == std::string::npos) ++kept;
  EXPECT_EQ(listed, kept);
  EXPECT_EQ(c.at("formulation").at("name"), claimed.c.formulation);
  EXPECT_EQ(c.at("formulation").contains("bodies"), !claimed.c.sets.empty());
}

/// Deflections of tips from their columns, over the lengths in the scene.
void expect_deflections_of_the_tips(const Claimed& claimed) {
  const std::map<std::string, double> lengths = {{"link1", 0.9144}, {"link2", 0.9144}, {"boom", 2.0}};
  const KeptRun& run = claimed.run;
  for (const json& body : run.certificate().at("bodies")) {
    const std::string name = body.at("name");
    const std::string stem = name + ".tip.deflection_";
    double most = 0;
    for (std::size_t i = 0; i < run.of("t[s]").size(); ++i)
      most = std::max(most, std::hypot(run.of(stem + "x[m]")[i], run.of(stem + "y[m]")[i], run.of(stem + "z[m]")[i]));
    ASSERT_EQ(lengths.count(name), 1U) << name;
    const double said = body.at("deflection_over_length");
    EXPECT_NEAR(said, most / lengths.at(name), 0.02 * said) << name;
  }
}

/// The mean step, and the fastest pole as `withy modes --poles` lists it of the last state.
void expect_steps_and_pole(const Claimed& claimed) {
  const KeptRun& run = claimed.run;
  const json& steps = run.certificate().at("steps");
  const double mean = run.summary.at("t_end").get<double>() / run.summary.at("steps").get<double>();
  EXPECT_NEAR(steps.at("mean"), mean, 1e-9 * mean);
  EXPECT_NEAR(steps.at("step_times_fastest_mode"), mean * steps.at("fastest_mode").get<double>(), 1e-9);
  const Folder folder;
  folder.write("end.json", run.summary.at("final").dump());
  std::vector<std::string> arguments = {"modes", claimed.c.scene, "--formulations", claimed.c.formulation,
                                        "--at",  "end.json",      "--as-is",        "--json"};
  for (const std::string& set : claimed.c.sets) arguments.insert(arguments.end(), {"--set", set});
  const Finished f = withy(folder, arguments);
  ASSERT_EQ(f.status, 0) << f.err;
  double fastest = 0;
  const json answer = json::parse(f.out);
  for (const json& mode : answer.at("runs").at(0).at("points").at(0).at("modes"))
    fastest = std::max(fastest, mode.at("frequency").get<double>());
  EXPECT_NEAR(steps.at("fastest_mode"), fastest, 0.02 * fastest);
}

/// What is dropped, against `withy terms` over many outputs.
void expect_dropped_terms_of_the_ledger(const Claimed& claimed) {
  const KeptRun& run = claimed.run;
  const json& dropped = run.certificate().at("dropped");
  if (claimed.c.formulation == "exact") {
    EXPECT_TRUE(dropped.empty());
    return;
  }
  const Folder folder;
  std::vector<std::string> arguments = {"terms",         claimed.c.scene,       "--set", "time.output=0.025",
                                        "--formulation", claimed.c.formulation, "--json"};
  for (const std::string& set : claimed.c.sets) arguments.insert(arguments.end(), {"--set", set});
  const json ledger = json::parse(withy(folder, arguments).out);
  for (const auto& [group, terms] : ledger.at("groups").items()) {
    double most = 0;
    for (const auto& [name, size] : terms.items()) most = std::max(most, size.at("rms").get<double>());
    double sum = 0;
    for (const auto& [name, share] : dropped.at(group).at("terms").items()) {
      const double real = terms.at(name).at("rms").get<double>() / most;
      EXPECT_NEAR(share.get<double>(), real, 0.15 * real + 1e-4) << group << ' ' << name << ", of its samples";
      sum += share.get<double>();
    }
    if (!dropped.at(group).at("terms").empty()) {
      EXPECT_LE(dropped.at(group).at("share").get<double>(), 1.001 * sum + 1e-6) << "no more than its parts together";
    }
    EXPECT_GT(dropped.at(group).at("share").get<double>(), 0) << group;
  }
}

class Claims : public testing::TestWithParam<ClaimedCase> {};

TEST_P(Claims, OfACertificateHold) {
  const Claimed claimed(GetParam());
  if (HasFailure()) return;
  expect_modes_and_formulations_of_the_scene(claimed);
  expect_drift_and_its_shares(claimed);
  expect_momenta_of_free_trees_alone(claimed);
  expect_error_against_the_model_up(claimed);
  expect_deflections_of_the_tips(claimed);
  expect_steps_and_pole(claimed);
  expect_dropped_terms_of_the_ledger(claimed);
}

std::vector<ClaimedCase> claimed_cases() {
  std::vector<ClaimedCase> all;
  for (const char* scene : {"scenes/two-link-slew.yaml", "scenes/beam-on-base.yaml"})
    for (const char* formulation : {"ruthless", "consistent", "linear", "quadratic", "exact"})
      all.push_back({scene, formulation});
  all.push_back({"scenes/two-link-slew.yaml", "symmetric"});
  all.push_back({"scenes/two-link-slew.yaml", "quadratic", {"bodies.link1.formulation=ruthless"}});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Certificates, Claims, testing::ValuesIn(claimed_cases()));

}  // namespace
}  // namespace withy::test
