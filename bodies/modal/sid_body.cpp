#include "sid_body.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "withy/core/shape/held_section.hpp"
#include "withy/core/shape/section_fields.hpp"

namespace withy {
namespace {

/// Second-order fields from the first order of a partial velocity: their symmetric part. What is skew in ψ's is half
/// the product of two rotations, which the finite rotation exp(θ̂) brings along.
std::array<Eigen::MatrixXd, 3> second_order(const sid::Taylor& field, Eigen::Index n) {
  std::array<Eigen::MatrixXd, 3> all;
  all.fill(Eigen::MatrixXd::Zero(n, n));
  for (std::size_t l = 0; l < field.m1.size(); ++l) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto row = static_cast<Eigen::Index>(c);
      all[c].col(static_cast<Eigen::Index>(l)) = field.m1[l].row(row).transpose();
    }
  }
  for (Eigen::MatrixXd& m : all) m = 0.5 * (m + m.transpose()).eval();
  return all;
}

PointExpansion expansion_of(const sid::Node& node, Eigen::Index n) {
  PointExpansion e = PointExpansion::rigid(node.origin.m0, n);
  e.phi = node.phi.m0;
  e.gamma = second_order(node.phi, n);
  if (!node.psi.absent()) {
    e.psi = node.psi.m0;
    e.theta = second_order(node.psi, n);
  }
  return e;
}

/// Relative errors that files of 6 digits leave are none to speak of.
constexpr double worth_saying = 1e-5;

class SidBody final : public Body {
 public:
  SidBody(const sid::Data& data, const SidBodyOptions& options, SidReport& report) {
    const Eigen::Index n = data.modes();
    for (Eigen::Index k = 0; k < n; ++k) shape_.mode_names.push_back(fmt::format("mode[{}]", k + 1));
    for (const sid::Node& node : data.nodes) nodes_.emplace_back(node.id, expansion_of(node, n));
    root_ = PointExpansion::rigid(Vector3::Zero(), n);
    if (!options.root.empty()) {
      // A node by the name of the file's own frame goes before that.
      const auto root = options.root == "root" && !node("root") ? root_ : node(options.root);
      if (!root)
        throw std::domain_error(
            fmt::format("there is no node '{}' for a root; nodes are {}", options.root, stations()));
      root_ = *root;
    }
    // Who names no root may take the node for it, and hang there what then hangs at the frame of the file.
    if (options.root.empty() && hides_a_node())
      throw std::domain_error(
          "the file's node 'root' is not where the body is held, which is the place that 'root' names; hold it there "
          "by root: root, or give the node another name in the file");
    for (const auto& [id, at] : nodes_) shape_.length = std::max(shape_.length, (at.X - root_.X).norm());
    const bool weighted =
        std::any_of(data.nodes.begin(), data.nodes.end(), [](const sid::Node& node) { return !node.phi.m1.empty(); });
    if (n > 0 && !nodes_.empty() && !weighted) {
      report.missing.emplace_back("no node's phi has a first order: no geometric stiffness of what acts at nodes");
    }

    const MassIntegrals integrals = integrals_of(data, report);
    shape_.particles = particles_of(integrals, report.defect);
    shape_.stiffness = 0.5 * (data.Ke.m0 + data.Ke.m0.transpose());
    measured_station_ = node("tip") ? "tip" : shape_.most_compliant(nodes_);
    shape_.damping = Eigen::MatrixXd::Zero(n, n);
    if (options.damping) {
      // Held at its root: a node that modes turn takes the whole body with it.
      const HeldSection root{root_};
      shape_.damping = options.damping->matrix(shape_.stiffness, moved_by_modes(root_)
                                                                     ? modal_mass(shape_, root)
                                                                     : 0.5 * (data.Me.m0 + data.Me.m0.transpose()));
    } else if (!data.De.absent()) {
      shape_.damping = 0.5 * (data.De.m0 + data.De.m0.transpose());
    }
    remarks_ = report.missing;
    if (hides_a_node())
      remarks_.emplace_back(
          "nothing can hang at the file's node 'root': 'root' names the place where the body is held");
    if (options.damping) {
      for (std::string& remark : options.damping->remarks(n)) remarks_.push_back(std::move(remark));
    }
    if (report.inconsistency > worth_saying)
      remarks_.push_back(fmt::format("what the data say twice differs by {:.1g} of the largest", report.inconsistency));
    if (report.defect > worth_saying)
      remarks_.push_back(
          fmt::format("the particles miss the data's integrals by {:.1g} of the largest", report.defect));
  }

  const ModalShape& shape() const override { return shape_; }
  std::vector<std::string> remarks() const override { return remarks_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    if (const auto* text = std::get_if<std::string>(&name)) return *text == "root" ? root_ : node(*text);
    const double x = std::get<double>(name);
    return x == std::floor(x) && std::abs(x) < 1e15 ? node(fmt::format("{:.0f}", x)) : std::nullopt;
  }
  std::string stations() const override {
    std::string all = "root";
    for (const auto& [id, at] : nodes_) all += fmt::format(", {}", id);
    return all;
  }
  std::string measured_station() const override { return measured_station_; }

 private:
  /// Whether the file's node `root`, where it has one, is another place than the one where the body is held, which the
  /// name means: then it cannot be reached.
  bool hides_a_node() const {
    const auto other = node("root");
    if (!other) return false;
    const double size = std::max(other->X.norm(), root_.X.norm()), turn = std::max(largest(*other), largest(root_));
    return (other->X - root_.X).norm() > worth_saying * size || (other->phi - root_.phi).norm() > worth_saying * turn ||
           (other->psi - root_.psi).norm() > worth_saying * turn;
  }
  static double largest(const PointExpansion& at) { return std::max(at.phi.norm(), at.psi.norm()); }

  std::optional<PointExpansion> node(const std::string& id) const {
    for (const auto& [name, at] : nodes_) {
      if (name == id) return at;
    }
    return {};
  }

  ModalShape shape_;
  std::string measured_station_;
  std::vector<std::string> remarks_;
  PointExpansion root_;
  std::vector<std::pair<std::string, PointExpansion>> nodes_;
};

void refuse_what_bodies_lack(const sid::Data& data) {
  if (!data.ksigma.absent() && (!data.ksigma.m0.isZero(0) || data.ksigma.varies())) {
    throw std::domain_error("ksigma is not zero: bodies under initial stress are not supported");
  }
  if (data.Ke.varies())
    throw std::domain_error("Ke has a first order: bodies whose stiffness changes are not supported");
  if (data.De.varies()) {
    throw std::domain_error("De has a first order: bodies whose damping changes are not supported");
  }
  if (data.modes() > 0 && Eigen::LLT<Eigen::MatrixXd>(data.Me.m0).info() != Eigen::Success) {
    throw std::domain_error("Me is not positive definite");
  }
}

sid::Node node_of(const Body& body, const Body::StationName& name) {
  sid::Node node;
  const auto* text = std::get_if<std::string>(&name);
  node.id = text != nullptr ? *text : fmt::format("{}", std::get<double>(name));
  const auto at = body.station(name);
  if (!at) throw std::domain_error(fmt::format("there is no station '{}'; stations are {}", node.id, body.stations()));
  node.origin.m0 = at->X;
  node.phi.m0 = at->phi;
  node.psi.m0 = at->psi;
  node.axes.m0 = Matrix3::Identity();
  for (Eigen::Index l = 0; l < at->phi.cols(); ++l) {
    node.origin.m1.emplace_back(at->phi.col(l));
    const Vector3 turn = at->psi.col(l);
    Matrix3X phi(3, at->phi.cols()), psi(3, at->phi.cols());
    for (Eigen::Index k = 0; k < at->phi.cols(); ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        phi(static_cast<Eigen::Index>(c), k) = at->gamma[c](k, l);
        psi(static_cast<Eigen::Index>(c), k) = at->theta[c](k, l);
      }
      psi.col(k) += 0.5 * turn.cross(Vector3(at->psi.col(k)));
    }
    node.phi.m1.emplace_back(phi);
    node.psi.m1.emplace_back(psi);
    node.axes.m1.emplace_back(skew<double>(turn));
  }
  return node;
}

}  // namespace

std::unique_ptr<Body> body_of(const sid::Data& data, const SidBodyOptions& options, SidReport& report) {
  refuse_what_bodies_lack(data);
  return std::make_unique<SidBody>(data, options, report);
}

sid::Data sid_of(const Body& body, const std::vector<Body::StationName>& stations) {
  const ModalShape& shape = body.shape();
  sid::Data data;
  data.title = "written by withy";
  put_integrals(integrals_of(shape), data);
  data.mode_names = shape.mode_names;
  for (const Body::StationName& name : stations) data.nodes.push_back(node_of(body, name));
  data.ksigma.m0 = Eigen::MatrixXd::Zero(shape.modes(), 1);
  data.Ke.m0 = shape.stiffness;
  data.De.m0 = shape.damping;
  return data;
}

}  // namespace withy
