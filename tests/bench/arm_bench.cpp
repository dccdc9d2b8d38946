/// \file
/// The two-link arm with two modes a link: one evaluation of the equations of motion in every formulation, beside the
/// closed form that a computer-algebra system expands for this one system (with LU of its 6×6 matrix), in one run.
/// Before anything is timed the two must agree.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

extern "C" {
void full2(const double* x, const double* v, const double* p, double* o);
void ruth2(const double* x, const double* v, const double* p, double* o);
}

namespace {

constexpr int n = 6;

/// Parameters of the arm in the order of closed_form_arm.c; the last is 1 for consistent and 0 for inconsistent.
std::array<double, 64> parameters(bool consistent) {
  return {1.2247199279999998,
          0.55994195108159994,
          0.34134061337934335,
          0.95894560708128318,
          0.53144993821662023,
          0.63701879351665236,
          0.1016482634851472,
          2,
          -1.9999999999999858,
          3.0107294065468793,
          -10.456645691626642,
          1.2247199279996988,
          -9.9725620556628813e-14,
          1.2247199279999923,
          2.1039871213321408,
          -0.56564325956194583,
          11.581723509474946,
          1.461502838177406,
          -0.83998063336271556,
          7.9340110890989806,
          5.0828721770331819,
          -8.0707297349787996,
          35.452098674506679,
          1812.6823645115574,
          -6.3512850534408472e-09,
          71191.19328046788,
          0.61235996399999992,
          0.27997097554079997,
          0.17067030668967167,
          0.47947280354064159,
          0.26572496910831012,
          0.31850939675832618,
          0.050824131742573601,
          2,
          -1.9999999999999858,
          3.0107294065468793,
          -10.456645691626642,
          0.61235996399984938,
          -4.9862810278314407e-14,
          0.61235996399999615,
          1.0519935606660704,
          -0.28282162978097292,
          5.790861754737473,
          0.730751419088703,
          -0.41999031668135778,
          3.9670055445494903,
          5.0828721770331819,
          -8.0707297349787996,
          35.452098674506679,
          226.58610403198577,
          -7.9376935580022234e-10,
          8898.9309117904522,
          0.076200000000000004,
          0.076200000000000004,
          0.012699999999999999,
          0.050799999999999998,
          0.91439999999999999,
          0.91439999999999999,
          0.01,
          14,
          0.029999999999999999,
          2,
          0.01,
          consistent ? 1.0 : 0.0};
}

/// Gauss elimination with partial pivoting, the size known to the compiler: the rival at its best.
void solve(double* A, double* b) {
  for (int k = 0; k < n; ++k) {
    int p = k;
    for (int i = k + 1; i < n; ++i) {
      if (std::abs(A[i * n + k]) > std::abs(A[p * n + k])) p = i;
    }
    if (p != k) {
      for (int j = 0; j < n; ++j) std::swap(A[k * n + j], A[p * n + j]);
      std::swap(b[k], b[p]);
    }
    const double d = 1 / A[k * n + k];
    for (int i = k + 1; i < n; ++i) {
      const double m = A[i * n + k] * d;
      for (int j = k + 1; j < n; ++j) A[i * n + j] -= m * A[k * n + j];
      b[i] -= m * b[k];
    }
  }
  for (int i = n; i-- > 0;) {
    for (int j = i + 1; j < n; ++j) b[i] -= A[i * n + j] * b[j];
    b[i] /= A[i * n + i];
  }
}

using ClosedForm = void (*)(const double*, const double*, const double*, double*);
constexpr std::array<double, n> x = {.1, .01, .001, 2., .01, .002};
constexpr std::array<double, n> v = {.3, .1, .02, -.5, .1, .03};

void closed_form(benchmark::State& state, ClosedForm form) {
  const auto p = parameters(true);
  std::array<double, n * n + n> o{};
  std::array<double, n> at = x;
  double s = 0;
  for (auto _ : state) {
    at[0] = x[0] + 1e-9 * s;  // each evaluation waits for the one before, as in an integration
    form(at.data(), v.data(), p.data(), o.data());
    solve(o.data(), o.data() + n * n);
    s += o[n * n] * 1e-9;
  }
  benchmark::DoNotOptimize(s);
}

struct Ours {
  withy::Registry registry;
  withy::Scene scene;
  std::unique_ptr<withy::EquationsOfMotion> equations;
  std::vector<double> y, y_dot;

  explicit Ours(const std::string& formulation) {
    withy::enroll_static_plugins(registry);
    scene = withy::read_scene(std::string(REFERENCE_DATA) + "/arm-2.yaml", registry, {formulation, "", {"time.end=0"}});
    equations = scene.formulation->compile(scene.model);
    y.assign(equations->size(), 0.0);
    y_dot.assign(equations->size(), 0.0);
    std::copy(x.begin(), x.end(), y.begin());
    std::copy(v.begin(), v.end(), y.begin() + n);
  }
};

void sweep(benchmark::State& state, const std::string& formulation) {
  Ours ours(formulation);
  withy::Work work = ours.equations->make_work();
  double s = 0;
  for (auto _ : state) {
    ours.y[0] = x[0] + 1e-9 * s;
    ours.equations->derivatives(0, ours.y, ours.y_dot, work);
    s += ours.y_dot[n] * 1e-9;
  }
  benchmark::DoNotOptimize(s);
}

/// Both to 1e-8 of the largest acceleration: κ(M) is 6e5.
void agree(const std::string& formulation, ClosedForm form, bool consistent) {
  const auto p = parameters(consistent);
  std::array<double, n * n + n> o{};
  form(x.data(), v.data(), p.data(), o.data());
  solve(o.data(), o.data() + n * n);
  Ours ours(formulation);
  withy::Work work = ours.equations->make_work();
  ours.equations->derivatives(0, ours.y, ours.y_dot, work);
  double difference = 0;
  double size = 0;
  for (std::size_t i = 0; i < n; ++i) {
    difference = std::max(difference, std::abs(ours.y_dot[n + i] - o[n * n + i]));
    size = std::max(size, std::abs(o[n * n + i]));
  }
  std::printf("%s against the closed form: largest relative difference %.1e\n", formulation.c_str(), difference / size);
  if (!(difference < 1e-8 * size)) std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  agree("ruthless", &ruth2, true);
  agree("consistent", &full2, true);
  agree("inconsistent", &full2, false);
  benchmark::RegisterBenchmark("closed form ruthless", closed_form, &ruth2);
  benchmark::RegisterBenchmark("closed form consistent", closed_form, &full2);
  for (const char* formulation :
       {"ruthless", "inconsistent", "consistent", "symmetric", "quadratic", "linear", "exact"}) {
    benchmark::RegisterBenchmark(formulation, sweep, std::string(formulation));
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
