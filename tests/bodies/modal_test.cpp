#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "withy/bodies/modal/sid_body.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/conformance/body_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream.is_open()) << file;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Public files: see tests/reference/sid/README.md.
std::string public_text(const std::string& name) { return text_of(std::string(WITHY_SID_FILES) + "/" + name); }
sid::Data car_roof() { return sid::read(public_text("cartopPragV32.SID_FEM")); }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

/// Both orders of two matrices; an absent first order is zero.
void expect_same(const char* name, const sid::Taylor& a, const sid::Taylor& b, double tolerance) {
  ASSERT_EQ(a.m0.size(), b.m0.size()) << name;
  EXPECT_LE(difference(a.m0, b.m0), tolerance) << name;
  for (std::size_t k = 0; k < std::max(a.m1.size(), b.m1.size()); ++k) {
    const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(a.m0.rows(), a.m0.cols());
    EXPECT_LE(difference(a.m1.empty() ? zero : a.m1[k], b.m1.empty() ? zero : b.m1[k]), tolerance)
        << name << ", mode " << k + 1;
  }
}

/// The files name their modes with frequencies of three decimals, some of them cut off rather than rounded.
TEST(Sid, public_files_have_the_frequencies_they_state) {
  for (const char* file : {"cartopPragV32.SID_FEM", "balken1m.SID_FEM"}) {
    const sid::Data data = sid::read(public_text(file));
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(data.Ke.m0, data.Me.m0);
    for (Eigen::Index k = 0; k < data.modes(); ++k) {
      const std::string& name = data.mode_names[static_cast<std::size_t>(k)];
      const double stated = std::stod(name.substr(name.find(':') + 1));
      EXPECT_NEAR(std::sqrt(eigen.eigenvalues()[k]) / (2 * std::numbers::pi), stated, 1e-3) << file << ": " << name;
    }
  }
}

/// Every integral that the equations of motion need, from the particles again. The file's numbers are of size 10 and
/// its modal masses 1: 1e-14 is some tens of roundings.
TEST(Sid, particles_have_the_integrals_of_the_file) {
  const sid::Data data = car_roof();
  SidReport report;
  const auto body = body_of(data, {}, report);
  sid::Data back;
  put_integrals(integrals_of(body->shape()), back);
  EXPECT_NEAR(back.mass, data.mass, 1e-14);
  expect_same("mdCM", data.mdCM, back.mdCM, 1e-14);
  expect_same("J", data.J, back.J, 2e-14);
  expect_same("Ct", data.Ct, back.Ct, 1e-14);
  expect_same("Cr", data.Cr, back.Cr, 1e-14);
  expect_same("Me", data.Me, back.Me, 1e-14);
  expect_same("Oe", data.Oe, back.Oe, 1e-14);
  EXPECT_LT(report.defect, 1e-14);
  expect_body_conforms(*body);
}

/// Gr and Ge of this file repeat what J, Oe and Cr say, the first to 1 %; its Ge is symmetric where 2∫Φ_l × Φ_k cannot
/// be, and of 0.9 % of the modal mass.
TEST(Sid, report_says_what_a_file_lacks_and_contradicts) {
  SidReport report;
  body_of(car_roof(), {}, report);
  EXPECT_THAT(report.missing, testing::ElementsAre(testing::HasSubstr("Ct has no first order"),
                                                   testing::HasSubstr("Gr has no first order")));
  EXPECT_GT(report.inconsistency, 1e-3);
  EXPECT_LT(report.inconsistency, 2e-2);
}

/// |Ct|² / mass is the least kinetic energy of a unit rate that any mass can have; in this file it is 2.2 times Me.
TEST(Sid, integrals_that_no_mass_has_are_refused) {
  SidReport report;
  try {
    body_of(sid::read(public_text("balken1m.SID_FEM")), {}, report);
    FAIL() << "accepted";
  } catch (const std::domain_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("no mass has these integrals"));
  }
}

TEST(Sid, nodes_are_stations) {
  SidReport report;
  const auto body = body_of(car_roof(), {"12", BodyDamping{.ratio = 0.02, .ratios = {}}}, report);
  const auto node = body->station(12.0);
  ASSERT_TRUE(node.has_value());
  EXPECT_EQ(node->X, Vector3(1.0, 1.3, 0));
  EXPECT_EQ(node->psi(1, 2), 2.22998286129);
  EXPECT_EQ(body->station(std::string("root"))->X, node->X);
  EXPECT_FALSE(body->station(12.5).has_value());
  const auto of_file = body_of(car_roof(), {{}, BodyDamping{.ratio = 0.02, .ratios = {}}}, report);
  EXPECT_NEAR(of_file->shape().damping(1, 1), 0.04 * std::sqrt(2.58144317827e2), 1e-10);
}

/// `root` is a station of every modal body: held there, it is held as where no root is named.
TEST(Sid, the_root_may_be_named_as_the_station_is) {
  SidReport report;
  const BodyDamping damping{.ratio = 0.02, .ratios = {}};
  const auto named = body_of(car_roof(), {"root", damping}, report), plain = body_of(car_roof(), {{}, damping}, report);
  EXPECT_EQ(named->station(std::string("root"))->X, Vector3::Zero());
  EXPECT_TRUE(named->station(std::string("root"))->phi.isZero(0));
  EXPECT_EQ(named->shape().length, plain->shape().length);
  EXPECT_EQ(named->shape().damping, plain->shape().damping);
}

/// A file's node by that name elsewhere could not be reached.
TEST(Sid, a_node_called_root_is_where_the_body_is_held) {
  SidReport report;
  sid::Data roof = car_roof();
  const auto node = std::find_if(roof.nodes.begin(), roof.nodes.end(), [](const auto& n) { return n.id == "12"; });
  ASSERT_NE(node, roof.nodes.end());
  node->id = "root";
  try {
    body_of(roof, {}, report);
    ADD_FAILURE() << "accepted";
  } catch (const std::domain_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("the file's node 'root' is not where the body is held"));
  }
  EXPECT_EQ(body_of(roof, {"root", {}}, report)->station(std::string("root"))->X, Vector3(1.0, 1.3, 0));
  const auto elsewhere =
      body_of(roof, {roof.nodes.front().id == "root" ? roof.nodes.back().id : roof.nodes.front().id, {}}, report);
  EXPECT_THAT(elsewhere->remarks(),
              testing::Contains(testing::HasSubstr("nothing can hang at the file's node 'root'")));
  // At the frame of the file, and moving with it, it is that place.
  node->origin.m0.setZero();
  node->phi.m0.setZero();
  node->phi.m1.clear();
  node->psi.m0.setZero();
  node->psi.m1.clear();
  EXPECT_EQ(body_of(roof, {}, report)->station(std::string("root"))->X, Vector3::Zero());
}

TEST(Sid, the_station_measured_is_the_node_that_gives_most_under_a_force) {
  SidReport report;
  const auto roof = body_of(car_roof(), {}, report);
  const std::string measured = roof->measured_station();
  const ModalShape& shape = roof->shape();
  const auto gives = [&](const std::string& id) {
    double sum = 0;  // by the modes of K: a unit force along each axis
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(shape.stiffness);
    const Eigen::MatrixXd phi = roof->station(id)->phi * modes.eigenvectors();
    for (Eigen::Index k = 0; k < phi.cols(); ++k) sum += phi.col(k).squaredNorm() / modes.eigenvalues()[k];
    return sum;
  };
  ASSERT_TRUE(roof->station(measured));
  EXPECT_NEAR(shape.compliance(*roof->station(measured)), gives(measured), 1e-9 * gives(measured));
  for (const sid::Node& node : car_roof().nodes) EXPECT_LE(gives(node.id), gives(measured) * (1 + 1e-12)) << node.id;
}

class SidOfBeam : public testing::Test {
 protected:
  SidOfBeam() {
    enroll_static_plugins(registry_);
    directory_ = std::filesystem::temp_directory_path() / ("withy-sid-" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_);
  }
  ~SidOfBeam() override { std::filesystem::remove_all(directory_); }

  static constexpr const char* slender =
      "{type: beam, length: 1.2, mass_per_length: 0.8, bending_y: {stiffness: 30, modes: 2}, bending_z: {stiffness: "
      "20, "
      "modes: 2}, damping_ratio: 0.01}";
  static constexpr const char* twisting =
      "{type: beam, length: 1.2, mass_per_length: 0.8, bending_y: {stiffness: 30, modes: 2, rotary_inertia: 0.001}, "
      "bending_z: {stiffness: 20, modes: 1}, torsion: {stiffness: 15, inertia: 0.002, modes: 1}}";

  /// A free base that carries the boom, which carries a body at its tip, in a field of gravity.
  Scene scene(const std::string& boom, const std::string& formulation) {
    const std::string text =
        "format: withy/1\ntime: {end: 1}\ngravity: [1, 2, -9.81]\nbodies:\n  base: {type: rigid, mass: 2, inertia: "
        "[0.1, "
        "0.2, 0.3, 0, 0, 0]}\n  boom: " +
        boom +
        "\n  bob: {type: rigid, mass: 0.5, inertia: [0.01, 0.02, 0.03, 0, 0, 0], center_of_mass: [0.1, 0.02, 0.03]}\n"
        "hinges:\n  float: {type: free, parent: world, child: base}\n  shoulder: {type: revolute, axis: [0, 1, 0.2], "
        "parent: base, child: boom}\n  wrist: {type: revolute, axis: [0.3, 0.2, 1], parent: boom.tip, child: bob}\n";
    return parse_scene(text, (directory_ / "scene.yaml").string(), registry_, {formulation, "", {}});
  }
  static std::pair<Eigen::MatrixXd, Eigen::VectorXd> equations(const Scene& scene, double size) {
    State state = scene.model->reference_state();
    const Layout& layout = scene.model->layout();
    for (std::size_t i = 0; i < state.y.size(); ++i)
      state.y[i] += 0.05 * size * std::sin(1.0 + 2.3 * static_cast<double>(i));
    for (std::size_t i = 0; i < layout.speeds; ++i) state.y[layout.positions + i] *= 20;
    const auto& hinge = scene.model->hinges();
    for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
      hinge[h].hinge->normalize(std::span(state.y).subspan(layout.hinges[h].position, layout.hinges[h].positions));
    }
    const DenseSystem s = scene.formulation->compile(scene.model)->system(0, state.y);
    const auto n = static_cast<Eigen::Index>(s.size);
    return {Eigen::Map<const Eigen::MatrixXd>(s.mass.data(), n, n).transpose(),
            Eigen::Map<const Eigen::VectorXd>(s.force.data(), n)};
  }
  sid::Data data_of(const std::string& boom) {
    const Scene s = scene(boom, "quadratic");
    return sid_of(*s.model->bodies()[1].body, {std::string("root"), std::string("tip"), 0.5});
  }
  /// Largest differences of M and f, relative to their largest elements.
  std::pair<double, double> differences(const std::string& boom, const sid::Data& data, const std::string& formulation,
                                        double size = 1) {
    std::ofstream(directory_ / "boom.SID_FEM") << sid::write(data);
    const auto [M, f] = equations(scene(boom, formulation), size);
    const auto [M_read, f_read] = equations(scene("{type: modal, file: boom.SID_FEM}", formulation), size);
    return {difference(M, M_read) / M.cwiseAbs().maxCoeff(), difference(f, f_read) / f.cwiseAbs().maxCoeff()};
  }

  Registry registry_;
  std::filesystem::path directory_;
};

/// To rounding in the formulations that need integrals to first order. A beam without rotary inertia keeps its linear
/// kinematics apart from the quadratic ones; with it, mass and rotation of sections are not told apart by the data.
TEST_F(SidOfBeam, read_back_has_the_equations_of_the_beam) {
  for (const char* boom : {slender, twisting}) {
    const sid::Data data = data_of(boom);
    for (const char* formulation : {"ruthless", "consistent"}) {
      const auto [M, f] = differences(boom, data, formulation);
      EXPECT_LT(M, 1e-12) << formulation;
      EXPECT_LT(f, 1e-12) << formulation;
    }
  }
  const auto [M, f] = differences(slender, data_of(slender), "inconsistent");
  EXPECT_LT(M, 1e-12);
  EXPECT_LT(f, 1e-12);
}

/// Without truncation integrals of third and fourth order enter, which the data do not have: Γ is then its own fit
/// linear over the mass. At deflections of some 8 % of the length (q₁ = 0.05 m, tip 0.1 m) M differs by half a percent,
/// and by the square of the amplitude.
TEST_F(SidOfBeam, untruncated_equations_differ_by_the_square_of_the_deflection) {
  const sid::Data data = data_of(slender);
  const auto [M, f] = differences(slender, data, "quadratic");
  const auto [M_half, f_half] = differences(slender, data, "quadratic", 0.5);
  EXPECT_LT(M, 1e-2);
  EXPECT_LT(f, 1e-2);
  EXPECT_GT(M / M_half, 3);
}

/// Without Gr's first order the directions of ∫ Φ_k·Φ_l are chosen, which strict truncation does not see; finding such
/// that some mass has them leaves errors of the Newton iteration, below 1e-12.
TEST_F(SidOfBeam, truncated_equations_do_not_depend_on_what_the_data_leave_open) {
  for (const char* boom : {slender, twisting}) {
    sid::Data data = data_of(boom);
    data.Gr.m1.clear();
    for (const char* formulation : {"ruthless", "consistent"}) {
      const auto [M, f] = differences(boom, data, formulation);
      EXPECT_LT(M, 1e-11) << formulation;
      EXPECT_LT(f, 1e-11) << formulation;
    }
  }
}

/// Without Oe's first order, too, the nodes tell the directions. Without nodes the search starts from modes that move
/// alike in all directions, which contradicts the gyroscopic coupling of the two bending planes. The moments sought lie
/// on the edge of those that a mass can have (the planes' first modes are equal): Newton's method ends at 1e-6 there.
TEST_F(SidOfBeam, modal_mass_and_gyroscopic_coupling_are_kept_where_directions_are_open) {
  sid::Data data = data_of(twisting);
  data.Gr.m1.clear();
  data.Oe.m1.clear();
  for (const double tolerance : {1e-13, 1e-5}) {
    SidReport report;
    const auto body = body_of(data, {}, report);
    sid::Data back;
    put_integrals(integrals_of(body->shape()), back);
    EXPECT_LE(report.defect, 0.1 * tolerance);
    expect_same("Me", data.Me, back.Me, tolerance);
    expect_same("Ge", data.Ge, back.Ge, tolerance);
    EXPECT_THAT(report.missing, testing::Contains(testing::HasSubstr("Oe has no first order")));
    data.nodes.clear();
  }
}

TEST_F(SidOfBeam, text_is_read_to_the_bit) {
  const sid::Data data = data_of(twisting);
  const std::string text = sid::write(data);
  const sid::Data again = sid::read(text);
  EXPECT_EQ(sid::write(again), text);
  EXPECT_EQ(again.Oe.m1[1], data.Oe.m1[1]);
  EXPECT_EQ(again.nodes[1].psi.m1[0], data.nodes[1].psi.m1[0]);
  EXPECT_EQ(again.title, data.title);
}

/// Some programs write m1(row, column, mode), an inertia of 3 by 3, or the columns of Gr and Ge by axis, then mode.
TEST_F(SidOfBeam, variants_of_the_format_are_told_apart) {
  const sid::Data data = data_of(slender);
  std::istringstream lines(sid::write(data));
  std::ostringstream swapped;
  for (std::string line; std::getline(lines, line); swapped << line << '\n') {
    int i = 0, j = 0, k = 0;
    const std::size_t at = line.find("m1(");
    if (at == std::string::npos) continue;
    ASSERT_EQ(std::sscanf(line.c_str() + at, "m1(%d,%d,%d)", &i, &j, &k), 3);
    line = "m1(" + std::to_string(i) + "," + std::to_string(k) + "," + std::to_string(j) + ") " +
           line.substr(line.find('='));
  }
  EXPECT_EQ(sid::write(sid::read(swapped.str())), sid::write(data));

  sid::Data by_axis = data;
  const auto reorder = [&](Eigen::MatrixXd& m, const Eigen::MatrixXd& from) {
    for (Eigen::Index k = 0; k < data.modes(); ++k) {
      for (Eigen::Index a = 0; a < 3; ++a) m.col(a * data.modes() + k) = from.col(3 * k + a);
    }
  };
  reorder(by_axis.Gr.m0, data.Gr.m0);
  reorder(by_axis.Ge.m0, data.Ge.m0);
  for (std::size_t k = 0; k < data.Gr.m1.size(); ++k) reorder(by_axis.Gr.m1[k], data.Gr.m1[k]);
  SidReport report;
  const auto body = body_of(by_axis, {}, report);
  EXPECT_LT(report.inconsistency, 1e-14);
  sid::Data back;
  put_integrals(integrals_of(body->shape()), back);
  expect_same("Gr", data.Gr, back.Gr, 1e-14);
}

struct Fault {
  const char *from, *to, *message;
};

TEST(Sid, bad_files_are_refused_with_line_and_reason) {
  const std::string good = public_text("balken1m.SID_FEM");
  const Fault faults[] = {
      {"nelastq                         =     1", "nelastq                         =     2",
       "line 6: nelastq is 2, but Me"},
      {"mass                            = 7.84999999999D-01", "mass = 1.0x", "line 5: got 'mass = 1.0x'"},
      {"mass                            = 7.84999999999D-01", "mass = -1", "need > 0 kg"},
      {"end refmod", "end of it", "got 'end of it'"},
      {"end part", "", "need 'end part'"},
      {"m0( 1, 1)             = 2.75894190618D+03", "m0( 1, 2)             = 2.75894190618D+03", "out of range"},
      {"m0( 1, 1)             = 2.75894190618D+03", "m0( 1, 1)             = nan", "need a finite number"},
      {"m1( 3, 1, 1)          =-1.53241416944D+00", "m1( 3, 9, 9)          = 1", "an index of m1 is out of range"},
      {"nqn                   =    0", "nqn                   =    2", "need a whole number from 0 to 0"},
  };
  for (const Fault& f : faults) {
    try {
      sid::read(replaced(good, f.from, f.to));
      ADD_FAILURE() << "accepted: " << f.to;
    } catch (const sid::FormatError& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(f.message));
    }
  }
  EXPECT_THROW(sid::read(""), sid::FormatError);
}

TEST(Modal, problems_are_reported_where_the_file_is_named) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto report = [&](std::vector<Value::Member> given) {
    Diagnostics diagnostics;
    EXPECT_EQ(make_plugin<Body>(registry, "modal", std::move(given), diagnostics), nullptr);
    return diagnostics.errors().empty() ? "" : diagnostics.errors()[0].message;
  };
  const std::string roof = std::string(WITHY_SID_FILES) + "/cartopPragV32.SID_FEM";
  EXPECT_THAT(report({{"file", Value(std::string("none.SID_FEM"))}}),
              testing::HasSubstr("there is no file 'none.SID_FEM'"));
  EXPECT_THAT(report({{"file", Value(roof)}, {"root", Value(std::string("77"))}}),
              testing::HasSubstr("there is no node '77'"));
}

}  // namespace
}  // namespace withy::test
