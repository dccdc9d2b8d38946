/// \file
/// What must not matter: where the world's origin is and how it is turned, a constant velocity, the order of siblings,
/// the end from which a chain is described, how a body is cut.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "campaign.hpp"

namespace withy::extremes {
namespace {

std::string set_vector(const std::string& key, const Eigen::VectorXd& v) {
  std::string text = key + "=[";
  for (Eigen::Index i = 0; i < v.size(); ++i) text += fmt::format("{}{:.17g}", i > 0 ? ", " : "", v[i]);
  return text + "]";
}

/// A moderate state: the scene's own with its flexible bodies bent and everything moving.
State moving(const Made& made) {
  State s = made.scene.initial;
  for (std::size_t i = 0; i < made.layout().speeds; ++i)
    s.y[made.layout().positions + i] += 0.3 * std::sin(1.0 + 2.0 * static_cast<double>(i));
  for (const Slot& slot : made.layout().bodies)
    for (std::size_t i = 0; i < slot.positions; ++i) s.y[slot.position + i] += 0.01 * std::cos(static_cast<double>(i));
  return s;
}

/// The spacecraft with its world hinge displaced and turned, gravity with it: coordinates in the hinge's frame stay.
void frames(Campaign& campaign) {
  for (const auto& [offset, gate] : {std::pair(0.0, 1e-12), {1e6, 1e-9}}) {
    double worst = 0;
    for (const std::string& formulation : formulations) {
      const Made plain(scene_text("spacecraft"), formulation);
      const Eigen::Quaterniond Q = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized();
      const Vector3 g = Q * plain.model().gravity();
      const Vector3 p = offset * Vector3(0.3, -0.8, 0.52);
      const Made turned(scene_text("spacecraft"), formulation,
                        {set_vector("gravity", g), set_vector("hinges.float.offset.position", p),
                         set_vector("hinges.float.offset.orientation", Eigen::Vector4d(Q.w(), Q.x(), Q.y(), Q.z()))});
      const State s = moving(plain);
      worst = std::max(worst, difference(turned.accelerations(s), plain.accelerations(s)));
    }
    campaign.at_most(fmt::format("spacecraft, world turned and moved by {:g} m", offset), "the accelerations before",
                     worst, gate);
  }
  // What is added to the velocity loses its digits in products with the rates of rotation.
  for (const auto& [speed, gate] : {std::pair(1.0, 1e-12), {1000.0, 1e-9}}) {
    double worst = 0;
    for (const std::string& formulation : formulations) {
      const Made made(scene_text("spacecraft"), formulation);
      const State s = moving(made);
      State fast = s;
      const std::size_t at = made.layout().positions + made.layout().hinge("float")->speed + 3;
      const double direction[] = {0.6, -0.48, 0.64};
      for (std::size_t i = 0; i < 3; ++i) fast.y[at + i] += speed * direction[i];
      worst = std::max(worst, difference(made.accelerations(fast), made.accelerations(s)));
    }
    campaign.at_most(fmt::format("spacecraft, {:g} m/s added (Galileo)", speed), "the accelerations before", worst,
                     gate);
  }
}

/// A bus with four booms and loads of different kinds, named in this order in the file.
std::string star(const std::vector<int>& order) {
  std::string bodies = "  bus: {type: rigid, mass: 7, inertia: [1, 2, 2.5, 0.1, 0, 0], frames: {";
  for (int k = 0; k < 5; ++k)
    bodies += fmt::format("p{}: {{position: [{}, {}, {}]}}, ", k, 0.3 * k - 0.5, 0.1 * k * k, 0.7 - 0.2 * k);
  bodies += "}}\n";
  std::string hinges = "  free: {type: free, parent: world, child: bus}\n";
  for (const int k : order) {
    bodies += k % 2 == 0 ? fmt::format(
                               "  b{}: {{type: beam, length: {}, mass_per_length: 0.7, bending_y: {{stiffness: 30, "
                               "modes: 2}}, bending_z: {{stiffness: 20, modes: 1}}, torsion: {{stiffness: 11, "
                               "inertia: 0.01, modes: 1}}}}\n",
                               k, 1.1 + 0.13 * k)
                         : fmt::format(
                               "  b{}: {{type: rigid, mass: {}, center_of_mass: [0.2, 0.03, 0.1], inertia: [0.1, "
                               "0.2, 0.15, 0, 0, 0.01]}}\n",
                               k, 1.3 + 0.17 * k);
    hinges +=
        fmt::format("  h{}: {{type: revolute, axis: [{}, 1, 0.3], parent: bus.p{}, child: b{}}}\n", k, 0.2 * k, k, k);
  }
  return "format: withy/1\ntime: {end: 1}\ngravity: [1, -9, 2]\nbodies:\n" + bodies + "hinges:\n" + hinges;
}

/// Accelerations by name.
std::vector<std::pair<std::string, double>> named(const Made& made, State s) {
  // A state by name too, whatever the order.
  const Layout& layout = made.layout();
  const auto value = [](const std::string& name) {
    double h = 1;
    for (const char c : name) h = std::fmod(1.37 * h + c, 1.9);
    return 0.4 * (h - 0.9);
  };
  for (std::size_t i = 0; i < layout.speeds; ++i) s.y[layout.positions + i] = value(layout.speed_names[i]);
  for (const Slot& h : layout.hinges)
    if (h.positions == 1) s.y[h.position] = value(h.name);
  for (const Slot& b : layout.bodies)
    for (std::size_t i = 0; i < b.positions; ++i) s.y[b.position + i] = 0.05 * value(layout.speed_names[b.speed + i]);
  const std::vector<double> a = made.accelerations(s);
  std::vector<std::pair<std::string, double>> result;
  for (std::size_t i = 0; i < a.size(); ++i) result.emplace_back(layout.speed_names[i], a[i]);
  std::sort(result.begin(), result.end());
  return result;
}

void siblings(Campaign& campaign) {
  for (const std::string& formulation : formulations) {
    const Made first(star({0, 1, 2, 3, 4}), formulation);
    const auto expected = named(first, first.scene.initial);
    std::vector<int> order = {0, 1, 2, 3, 4};
    double worst = 0;
    bool bitwise = true;
    for (int k = 0; std::next_permutation(order.begin(), order.end()); ++k) {
      if (k % 17 != 0) continue;
      const Made other(star(order), formulation);
      const auto found = named(other, other.scene.initial);
      double size = 0, most = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        bitwise = bitwise && found[i].second == expected[i].second;
        most = std::max(most, std::abs(found[i].second - expected[i].second));
        size = std::max(size, std::abs(expected[i].second));
      }
      worst = std::max(worst, most / size);
    }
    campaign.row(formulation + ", five siblings in eight orders of the file", "the same tree", "bitwise",
                 bitwise ? "bitwise" : fmt::format("{:.2g}", worst), bitwise);
  }
}

/// Three bodies b1 – b2 – b3; the hinges' axes are the same seen from either side.
void reversed(Campaign& campaign) {
  const auto bodies = [](const char* first, const char* second) {
    return fmt::format(
        "format: withy/1\ntime: {{end: 1}}\ngravity: [0, 0, -9]\nbodies:\n"
        "  b1: {{type: rigid, mass: 3, center_of_mass: [0.2, 0.1, 0], inertia: [0.3, 0.2, 0.25, 0, 0, 0], frames: {{e: "
        "{{position: [0.6, 0.1, -0.2]}}}}}}\n"
        "  b2: {{type: rigid, mass: 2, center_of_mass: [0.3, 0, 0.1], inertia: [0.1, 0.2, 0.15, 0.02, 0, 0], frames: "
        "{{e: {{position: [0.7, -0.1, 0.1]}}}}}}\n"
        "  b3: {{type: rigid, mass: 1, center_of_mass: [0.1, 0.2, 0], inertia: [0.1, 0.08, 0.09, 0, 0.01, 0]}}\n"
        "hinges:\n  free: {{type: free, parent: world, child: {}}}\n{}",
        first, second);
  };
  const char* axes[] = {"[0.3, 1, 0.2]", "[1, -0.4, 0.5]"};
  const Made forward(bodies("b1", fmt::format("  h2: {{type: revolute, axis: {}, parent: b1.e, child: b2}}\n"
                                              "  h3: {{type: revolute, axis: {}, parent: b2.e, child: b3}}\n",
                                              axes[0], axes[1])
                                      .c_str()));
  const Made backward(bodies("b3", fmt::format("  h3: {{type: revolute, axis: {}, parent: b3, child: b2.e}}\n"
                                               "  h2: {{type: revolute, axis: {}, parent: b2, child: b1.e}}\n",
                                               axes[1], axes[0])
                                       .c_str()));
  State s = forward.scene.initial;
  const auto index = [](const Made& m, const char* hinge, bool speed) {
    const Slot& slot = *m.layout().hinge(hinge);
    return speed ? m.layout().positions + slot.speed : slot.position;
  };
  const double x[] = {0.7, -0.4}, u[] = {1.3, -0.8}, w[] = {0.3, -0.5, 0.2, 0.6, -0.1, 0.4};
  s.y[index(forward, "h2", false)] = x[0];
  s.y[index(forward, "h3", false)] = x[1];
  s.y[index(forward, "h2", true)] = u[0];
  s.y[index(forward, "h3", true)] = u[1];
  for (std::size_t i = 0; i < 6; ++i) s.y[index(forward, "free", true) + i] = w[i];
  // The motion of b3 from that of b1, body by body.
  const auto pose = [&](int body) { return forward.equations->frame_pose(s.y, body, 0); };
  const auto place = [](const WorldPose& p) { return Vector3(p.position[0], p.position[1], p.position[2]); };
  const auto turn = [](const WorldPose& p) {
    return Matrix3(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(p.rotation.data()));
  };
  Vector3 omega(w[0], w[1], w[2]), v(w[3], w[4], w[5]);
  const Vector3 directions[] = {Vector3(0.3, 1, 0.2).normalized(), Vector3(1, -0.4, 0.5).normalized()};
  for (int b = 0; b < 2; ++b) {
    v += omega.cross(place(pose(b + 1)) - place(pose(b)));
    omega += turn(pose(b)) * directions[b] * u[b];
  }
  State r = backward.scene.initial;
  const Eigen::Quaterniond q(turn(pose(2)));
  const double free[] = {q.w(), q.x(), q.y(), q.z(), place(pose(2))[0], place(pose(2))[1], place(pose(2))[2]};
  for (std::size_t i = 0; i < 7; ++i) r.y[index(backward, "free", false) + i] = free[i];
  for (Eigen::Index i = 0; i < 3; ++i) {
    r.y[index(backward, "free", true) + static_cast<std::size_t>(i)] = omega[i];
    r.y[index(backward, "free", true) + 3 + static_cast<std::size_t>(i)] = v[i];
  }
  r.y[index(backward, "h2", false)] = -x[0];
  r.y[index(backward, "h3", false)] = -x[1];
  r.y[index(backward, "h2", true)] = -u[0];
  r.y[index(backward, "h3", true)] = -u[1];
  const std::vector<double> a = forward.rates(s), b = backward.rates(r);
  const std::vector<double> here = {a[index(forward, "h2", true)], a[index(forward, "h3", true)]};
  const std::vector<double> there = {-b[index(backward, "h2", true)], -b[index(backward, "h3", true)]};
  campaign.at_most("a free chain described from its other end, hinge accelerations", "the chain from this end",
                   difference(there, here), 1e-12);
}

void cut(Campaign& campaign) {
  // Without modes the segments are rigid and welded: the same body.
  const auto boom = [](int segments) {
    return fmt::format(
        "format: withy/1\ntime: {{end: 1}}\ngravity: [0, -9, 2]\nbodies:\n  hub: {{type: rigid, mass: 2, inertia: [1, "
        "1, 1, 0, "
        "0, 0]}}\n  boom: {{type: beam, length: 2, mass_per_length: 1.3, segments: {}}}\n  tip: {{type: rigid, mass: "
        "1, "
        "inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}\nhinges:\n  a: {{type: spherical, parent: world, child: hub}}\n  b: "
        "{{type: "
        "revolute, axis: [0, 0, 1], parent: hub, child: boom, offset: {{position: [0.3, 0, 0]}}}}\n"
        "  c: {{type: revolute, axis: [0, 1, 0], parent: boom.tip, child: tip, offset: {{position: [0.1, 0, 0.2]}}}}\n"
        "initial: {{hinges: {{a: {{rate: [0.3, -0.2, 0.5]}}, b: {{position: [0.4], rate: [1]}}, c: {{rate: "
        "[-1]}}}}}}\n",
        segments);
  };
  double worst = 0;
  const std::vector<double> whole = Made(boom(1)).accelerations();
  for (const int n : {2, 3, 7, 16}) worst = std::max(worst, difference(Made(boom(n)).accelerations(), whole));
  campaign.at_most("a rigid beam cut into 2, 3, 7, 16 welded segments", "the beam in one piece", worst, 1e-12);
}

}  // namespace

void invariance(Campaign& campaign) {
  frames(campaign);
  siblings(campaign);
  reversed(campaign);
  cut(campaign);
}

}  // namespace withy::extremes
