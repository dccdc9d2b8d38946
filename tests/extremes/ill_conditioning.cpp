/// \file
/// withy-ill-conditioning: the mass matrix along the slew of the two-link arm, in each formulation and mode family, as
/// pictures and tables for docs/ill-conditioning.md.
#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "campaign.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/results/svg_plot.hpp"

namespace {

using namespace withy;
using namespace withy::extremes;
using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The modes of both links. Those that know a load are given the body welded to the tip: elbow motor, payload.
struct Family {
  std::string name, link1, link2;
};
const Family families[] = {
    {"clamped-free", "clamped-free", "clamped-free"},
    {"clamped-loaded", "{name: clamped-loaded, tip_mass: 14, tip_inertia: 0.03, tip_offset: 0.0762}",
     "{name: clamped-loaded, tip_mass: 2, tip_inertia: 0.01, tip_offset: 0.0508}"},
    {"craig-bampton", "craig-bampton", "craig-bampton"},
    {"orthogonal-polynomials", "orthogonal-polynomials", "orthogonal-polynomials"}};

Made arm(const Family& family, const std::string& formulation, int modes1 = 2, int modes2 = 2, double speed = 1.2) {
  return Made(scene_text("two-link-slew"), formulation,
              {"bodies.link1.bending_y.family=" + family.link1, "bodies.link2.bending_y.family=" + family.link2,
               fmt::format("bodies.link1.bending_y.modes={}", modes1),
               fmt::format("bodies.link2.bending_y.modes={}", modes2), fmt::format("loads.slew.time_scale={}", speed)});
}

/// The mass matrix along a run, each coordinate in the unit in which its own inertia at the start is one.
struct Course {
  std::vector<double> time, determinant;      ///< det M over that at the start
  std::vector<std::vector<double>> singular;  ///< log10 of the singular values, greatest first
  double share = 1, condition_start = 0, condition_most = 0;
  RunSummary summary;
  std::string weakest;  ///< owners of the weakest direction at the end of the run
};

Course course(const Made& made) {
  Course c;
  Eigen::VectorXd scale;
  double first = 0;
  RunOptions options;
  options.end = *made.scene.end;
  options.output = options.end / 200;
  options.most_seconds = 60;
  c.summary =
      simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options, [&](const State& s) {
        const DenseSystem system = made.equations->system(s.time, s.y);
        const auto n = static_cast<Eigen::Index>(system.size);
        const Eigen::MatrixXd M = Eigen::Map<const DenseMatrix>(system.mass.data(), n, n);
        if (scale.size() == 0) scale = M.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal();
        const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(scaled).singularValues();
        const double determinant = scaled.determinant(), condition = values[0] / values[n - 1];
        if (c.time.empty()) {
          first = determinant;
          c.condition_start = condition;
          c.singular.resize(static_cast<std::size_t>(n));
        }
        c.condition_most = std::max(c.condition_most, condition);
        c.time.push_back(s.time);
        c.determinant.push_back(determinant / first);
        for (Eigen::Index i = 0; i < n; ++i) c.singular[static_cast<std::size_t>(i)].push_back(std::log10(values[i]));
        const Eigen::MatrixXd symmetric = 0.5 * (scaled + scaled.transpose());
        c.share = std::min(c.share, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues()[0]);
      });
  const auto massless = massless_directions(made.model(), made.equations->system(0, made.scene.initial.y), 0.05);
  if (!massless.empty())
    c.weakest = fmt::format("{} ({:.1g} of its inertia, {:.3g} rad/s)", massless.front().owners, massless.front().share,
                            massless.front().frequency);
  return c;
}

void write(const std::string& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out) throw std::runtime_error("cannot write " + file);
}

std::string first_words(const RunSummary& s) {
  if (s.status == RunStatus::completed) return "completed";
  return fmt::format("{} at {:.3g} s", name(s.status), s.final.time);
}

/// All, and those that keep the whole of the first order.
std::vector<std::string> compared_formulations() {
  std::vector<std::string> all = formulations;
  all.insert(all.end(), {"symmetric", "symmetric-linear"});
  return all;
}

std::string courses(const std::string& pictures) {
  const std::vector<std::string> compared = compared_formulations();
  std::string table =
      "| family | formulation | κ at the start | greatest κ | least eigenvalue of the symmetric part | run "
      "|\n|---|---|---|---|---|---|\n";
  std::vector<Panel> determinants;
  for (const Family& family : families) {
    std::vector<Panel> panels;
    Panel determinant{"", "det M, " + family.name, {-0.5, 2}, {}, 150};
    for (const std::string& formulation : compared) {
      const Course c = course(arm(family, formulation));
      const bool early = c.summary.status != RunStatus::completed;
      Panel panel{"", formulation, {-7, 1}, {}, 110};
      for (const auto& values : c.singular) panel.curves.push_back({c.time, values, early, false, {}});
      panels.push_back(std::move(panel));
      determinant.curves.push_back({c.time, c.determinant, early, false, {}});
      table += fmt::format("| {} | {} | {:.2g} | {:.2g} | {:.2g} | {} |\n", family.name, formulation, c.condition_start,
                           c.condition_most, c.share, first_words(c.summary));
      std::printf("%s %s: %s\n", family.name.c_str(), formulation.c_str(), c.weakest.c_str());
    }
    panels.back().x_label = "t [s]";
    write(pictures + "/singular-values-" + family.name + ".svg",
          svg_plot("Singular values of M (log₁₀), " + family.name + " modes", {"1", "2", "3", "4", "5", "6"}, panels));
    determinants.push_back(std::move(determinant));
  }
  determinants.back().x_label = "t [s]";
  write(pictures + "/determinant.svg", svg_plot("det M over det M at the start", compared, determinants));
  return table;
}

/// Every block of the first order of M switched on and off, at the state at which `consistent` becomes singular, each
/// coordinate in the unit in which its own inertia at the start is one.
std::string ablation() {
  const Made failing = arm(families[0], "consistent");
  RunOptions options;
  options.end = *failing.scene.end;
  options.output = options.end;
  const State state =
      simulate(failing.model(), *failing.equations, *failing.scene.integrator, failing.scene.initial, options, {})
          .final;
  const auto raw = [](const std::string& formulation, const State& at) -> Eigen::MatrixXd {
    const Made made = arm(families[0], formulation);
    const DenseSystem s = made.equations->system(at.time, at.y);
    const auto n = static_cast<Eigen::Index>(s.size);
    return Eigen::Map<const DenseMatrix>(s.mass.data(), n, n);
  };
  const Eigen::VectorXd scale = raw("quadratic", failing.scene.initial).diagonal().cwiseSqrt().cwiseInverse();
  const auto mass = [&](const std::string& formulation) -> Eigen::MatrixXd {
    return scale.asDiagonal() * raw(formulation, state) * scale.asDiagonal();
  };
  const Eigen::MatrixXd M0 = mass("ruthless"), M1 = mass("symmetric") - M0, M = mass("quadratic");
  Eigen::VectorXd hinges = Eigen::VectorXd::Zero(scale.size());
  for (const Slot& h : failing.model().layout().hinges)
    hinges.segment(static_cast<Eigen::Index>(h.speed), static_cast<Eigen::Index>(h.speeds)).setOnes();
  const Eigen::MatrixXd P = hinges.asDiagonal(), Q = Eigen::MatrixXd::Identity(P.rows(), P.cols()) - P;
  const Eigen::MatrixXd strict = M0 + M1 * P;
  std::string table =
      "| matrix | blocks of M₁: RR, ER, RE, EE | det M / det M₀ | least eigenvalue of the symmetric part |\n"
      "|---|---|---|---|\n";
  const auto row = [&](const char* what, const char* blocks, const Eigen::MatrixXd& A) {
    const Eigen::MatrixXd symmetric = 0.5 * (A + A.transpose());
    table += fmt::format("| {} | {} | {:.3g} | {:.2g} |\n", what, blocks, A.determinant() / M0.determinant(),
                         Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues()[0]);
  };
  row("M₀", "– – – –", M0);
  row("strict: M₀ + M₁P", "+ + – –", strict);
  row("strict and its missing RE", "+ + + –", strict + P * M1 * Q);
  row("strict and its missing EE", "+ + – +", strict + Q * M1 * Q);
  row("**symmetric: M₀ + M₁**", "+ + + +", M0 + M1);
  row("RR alone", "+ – – –", M0 + P * M1 * P);
  row("ER alone", "– + – –", M0 + Q * M1 * P);
  row("EE alone", "– – – +", M0 + Q * M1 * Q);
  row("strict and all of second order and beyond", "+ + – –, M − M₀ − M₁", strict + M - M0 - M1);
  row("quadratic", "M", M);
  return table;
}

/// Tip of the payload over time in a run of `quadratic`.
std::pair<std::vector<Vector3>, RunSummary> tip_of(const Made& made) {
  std::vector<Vector3> places;
  const FrameIndex tip = *made.model().find_frame("payload.tip");
  RunOptions options;
  options.end = *made.scene.end;
  options.output = options.end / 100;
  options.most_seconds = 120;
  RunSummary s = simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options,
                          [&](const State& state) {
                            const WorldPose p = made.equations->frame_pose(state.y, tip.body, tip.frame);
                            places.emplace_back(p.position[0], p.position[1], p.position[2]);
                          });
  return {std::move(places), std::move(s)};
}

/// What it costs to leave out the mode of the nearly massless direction, or to take modes that know their load.
std::string treatments() {
  struct Treatment {
    const char* what;
    int family, modes1, modes2;
  };
  const Treatment all[] = {{"clamped-free, 2 and 2 modes: as it is", 0, 2, 2},
                           {"bending_y[2] of link1 left out", 0, 1, 2},
                           {"bending_y[2] of link2 left out", 0, 2, 1},
                           {"both left out", 0, 1, 1},
                           {"clamped-loaded, 2 and 2", 1, 2, 2},
                           {"clamped-loaded, 1 and 1", 1, 1, 1},
                           {"craig-bampton, 2 and 2: static shapes of the tip", 2, 2, 2}};
  const auto reference = tip_of(arm(families[3], "quadratic", 5, 5));
  std::string table =
      "| treatment | κ at the start | fastest mode [rad/s] | evaluations | greatest error of the tip [mm] "
      "|\n|---|---|---|---|---|\n";
  for (const Treatment& t : all) {
    const Made made = arm(families[t.family], "quadratic", t.modes1, t.modes2);
    const auto run = tip_of(made);
    double error = 0;
    for (std::size_t i = 0; i < std::min(run.first.size(), reference.first.size()); ++i)
      error = std::max(error, (run.first[i] - reference.first[i]).norm());
    table += fmt::format("| {} | {:.2g} | {:.4g} | {} | {:.2g} |\n", t.what,
                         attainable_accuracy(made.equations->system(0, made.scene.initial.y)).condition,
                         run.second.fastest_mode, run.second.steps.evaluations, 1e3 * error);
  }
  return table;
}

void put(const std::string& document, const std::string& mark, const std::string& content) {
  const std::string text = text_of(document);
  const std::string first = "<!-- " + mark + ": begin -->\n", last = "<!-- " + mark + ": end -->\n";
  const std::size_t a = text.find(first), b = text.find(last);
  if (a == std::string::npos || b == std::string::npos)
    throw std::runtime_error(document + " has no marks for " + mark);
  write(document, text.substr(0, a) + first + "\n" + content + "\n" + text.substr(b));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr,
                 "usage: withy-ill-conditioning DOCUMENT PICTURES, as docs/ill-conditioning.md docs/pictures\n");
    return 2;
  }
  const std::string document = argv[1], pictures = argv[2];
  try {
    put(document, "courses", courses(pictures));
    put(document, "ablation", ablation());
    put(document, "treatments", treatments());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "withy-ill-conditioning: %s\n", e.what());
    return 1;
  }
  return 0;
}
