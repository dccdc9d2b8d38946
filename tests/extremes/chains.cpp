/// \file
/// Chains of up to a hundred thousand links against an independent algorithm: maximal coordinates, the constraint
/// forces from a block tridiagonal system, in 113-bit numbers.
#include <pthread.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>

#include "campaign.hpp"
#include "withy/core/simulation/accuracy.hpp"

namespace withy::extremes {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;
using Matrix2 = Eigen::Matrix<Quad, 2, 2>;
using Vector2 = Eigen::Matrix<Quad, 2, 1>;

constexpr double mass = 1.5, centre = 0.2, across = 0.03, inertia = 0.04, length = 0.5, gravity = 9.81;

double angle(int i) { return 0.3 * std::sin(1.7 * i) + 0.1; }
double rate(int i) { return 0.2 * std::cos(0.9 * i); }

std::string chain(int n) {
  std::string bodies, hinges, states;
  for (int i = 0; i < n; ++i) {
    bodies += fmt::format(
        "  b{}: {{type: rigid, mass: {}, center_of_mass: [{}, {}, 0], inertia: [{}, {}, {}, 0, 0, 0], "
        "frames: {{e: {{position: [{}, 0, 0]}}}}}}\n",
        i, mass, centre, across, inertia, inertia, inertia, length);
    hinges += fmt::format("  h{}: {{type: revolute, axis: [0, 0, 1], parent: {}, child: b{}}}\n", i,
                          i == 0 ? "world" : fmt::format("b{}.e", i - 1), i);
    states += fmt::format("    h{}: {{position: [{:.17g}], rate: [{:.17g}]}}\n", i, angle(i), rate(i));
  }
  return fmt::format(
      "format: withy/1\ntime: {{end: 1}}\ngravity: [0, -{}, 0]\nbodies:\n{}hinges:\n{}initial:\n  hinges:\n{}", gravity,
      bodies, hinges, states);
}

/// Hinge accelerations: every link by itself with its place p and angle α, and at hinge i the force λᵢ that joins it to
/// link i−1. Newton and Euler give the links' accelerations from the forces; that the joined points accelerate alike is
/// block tridiagonal in λ, eliminated from the tip inwards.
std::vector<double> by_constraint_forces(int n) {
  const auto count = static_cast<std::size_t>(n);
  std::vector<Vector2> root(count), tip(count);  // from a link's centre of mass to its hinges, world axes
  std::vector<Quad> alpha(count), omega(count);
  Quad a = 0, w = 0;
  for (int i = 0; i < n; ++i) {
    a += Quad(angle(i));
    w += Quad(rate(i));
    const auto k = static_cast<std::size_t>(i);
    alpha[k] = a;
    omega[k] = w;
    const Quad c = cos(a), s = sin(a);
    const auto turned = [&](const Quad& x, const Quad& y) { return Vector2(c * x - s * y, s * x + c * y); };
    root[k] = turned(-Quad(centre), -Quad(across));
    tip[k] = turned(Quad(length) - Quad(centre), -Quad(across));
  }
  // Acceleration of the point d of a link under force f at e: f/m + (d⊥)(e⊥·f)/I, d⊥ = (−d_y, d_x).
  const auto normal = [](const Vector2& d) { return Vector2(-d[1], d[0]); };
  const auto response = [&](const Vector2& d, const Vector2& e) -> Matrix2 {
    return Matrix2::Identity() / Quad(mass) + normal(d) * normal(e).transpose() / Quad(inertia);
  };
  const Vector2 weight(0, -Quad(gravity));
  // Row i: a(root of i) − a(tip of i−1) = 0; λᵢ acts on i at its root, −λᵢ on i−1 at its tip.
  std::vector<Matrix2> diagonal(count), upper(count);
  std::vector<Vector2> right(count);
  for (std::size_t i = 0; i < count; ++i) {
    diagonal[i] = response(root[i], root[i]);
    right[i] = -(weight - omega[i] * omega[i] * root[i]);
    if (i + 1 < count) upper[i] = -response(root[i], tip[i]);
    if (i == 0) continue;
    diagonal[i] += response(tip[i - 1], tip[i - 1]);
    right[i] += weight - omega[i - 1] * omega[i - 1] * tip[i - 1];
  }
  // Symmetric: the lower block of row i is upper[i−1] transposed.
  std::vector<Vector2> force(count);
  for (std::size_t i = count; i-- > 1;) {
    const Matrix2 factor = upper[i - 1] * diagonal[i].inverse();
    diagonal[i - 1] -= factor * upper[i - 1].transpose();
    right[i - 1] -= factor * right[i];
  }
  for (std::size_t i = 0; i < count; ++i) {
    Vector2 r = right[i];
    if (i > 0) r -= upper[i - 1].transpose() * force[i - 1];
    force[i] = diagonal[i].inverse() * r;
  }
  std::vector<double> result;
  Quad before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Quad moment = normal(root[i]).dot(force[i]);
    if (i + 1 < count) moment -= normal(tip[i]).dot(force[i + 1]);
    const Quad turning = moment / Quad(inertia);
    result.push_back(static_cast<double>(turning - before));
    before = turning;
  }
  return result;
}

/// The chain without its text, of which the reader takes no more than a million values.
struct LongChain {
  std::shared_ptr<Model> model;
  std::unique_ptr<EquationsOfMotion> equations;
  State state;
  explicit LongChain(int n) {
    const Made two(chain(2), "quadratic");
    std::vector<BodyNode> bodies;
    std::vector<HingeNode> hinges;
    for (int i = 0; i < n; ++i) {
      bodies.push_back(two.model().bodies()[static_cast<std::size_t>(std::min(i, 1))]);
      bodies.back().name = fmt::format("b{}", i);
      hinges.push_back(two.model().hinges()[static_cast<std::size_t>(std::min(i, 1))]);
      hinges.back().name = fmt::format("h{}", i);
      hinges.back().parent = i - 1;
      hinges.back().child = i;
    }
    model = std::make_shared<Model>(std::move(bodies), std::move(hinges), two.model().gravity());
    equations = two.scene.formulation->compile(model);
    state = model->reference_state();
    for (int i = 0; i < n; ++i) {
      const Slot& slot = *model->layout().hinge(fmt::format("h{}", i));
      state.y[slot.position] = angle(i);
      state.y[model->layout().positions + slot.speed] = rate(i);
    }
  }
};

struct OnSmallStack {
  int links;
  std::vector<double> accelerations;
  std::size_t work = 0;
  std::string error;
  static void* start(void* self) {
    auto& job = *static_cast<OnSmallStack*>(self);
    try {
      const LongChain made(job.links);
      std::vector<double> y_dot(made.equations->size());
      Work work = made.equations->make_work();
      job.work = work.size();
      if (!made.equations->derivatives(0, made.state.y, y_dot, work).ok()) throw std::runtime_error("not evaluated");
      const auto first = y_dot.begin() + static_cast<std::ptrdiff_t>(made.model->layout().positions);
      job.accelerations.assign(first, first + job.links);
    } catch (const std::exception& e) {
      job.error = e.what();
    }
    return nullptr;
  }
  /// With 256 KiB of stack: a call for each link would need more from 1e4 links on.
  explicit OnSmallStack(int n) : links(n) {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, 256 * 1024);
    pthread_t thread{};
    if (pthread_create(&thread, &attributes, &start, this) != 0) throw std::runtime_error("no thread");
    pthread_join(thread, nullptr);
    pthread_attr_destroy(&attributes);
  }
};

}  // namespace

void chains(Campaign& campaign) {
  const std::vector<int> sizes =
      campaign.quick() ? std::vector<int>{10, 100, 1000} : std::vector<int>{10, 100, 1000, 10000, 100000};
  double last = 1, before_last = 1;
  std::size_t work_before = 0;
  for (const int n : sizes) {
    const OnSmallStack run(n);
    campaign.holds(fmt::format("{} links in 256 KiB of stack", n), "no recursion", "evaluated", run.error);
    if (!run.error.empty()) continue;
    const double error = difference(run.accelerations, by_constraint_forces(n));
    // κ of M in the engine's scaling; of chains that it does not look at as a whole, by the growth that it has shown.
    double condition = last * last / std::max(1.0, before_last);
    std::string how = "by the growth so far";
    if (n <= (campaign.quick() ? 100 : 1000)) {
      const Made made(chain(n), "quadratic");
      condition = attainable_accuracy(made.equations->system(0, made.scene.initial.y)).condition;
      how = "measured";
    }
    before_last = last;
    last = condition;
    campaign.row(fmt::format("{} links, accelerations", n), "constraint forces, block tridiagonal, 113 bits",
                 "≤ 10 κ·2⁻⁵²", fmt::format("{:.2g}; κ·2⁻⁵² = {:.2g} ({})", error, condition * 0x1p-52, how),
                 error <= 10 * condition * 0x1p-52);
    if (work_before > 0) {
      const double exponent = std::log10(static_cast<double>(run.work) / static_cast<double>(work_before));
      campaign.row(fmt::format("{} links, memory of an evaluation against a tenth of the links", n), "O(n)",
                   "exponent ≤ 1.01", fmt::format("{:.4f}, {} kB", exponent, run.work / 1024), exponent <= 1.01);
    }
    work_before = run.work;
  }
}

}  // namespace withy::extremes
