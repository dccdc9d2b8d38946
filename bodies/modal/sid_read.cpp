#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <memory>

#include "sid.hpp"
#include "sid_text.hpp"

namespace withy::sid {
namespace {

constexpr int most_modes = 200;        ///< particles with Γ take 144 n³ bytes: 1.2 GB
constexpr double most_elements = 1e6;  ///< of one matrix; Gr of 200 modes has 4e5

struct Element {
  int line;
  std::array<int, 3> at;  ///< from 1
  double value;
};

/// A matrix as it stands in the file, before the layout of first orders is known.
struct Raw {
  int line = 0;
  std::string name;
  int order = 0, rows = 0, columns = 0, modes = 0, structure = 3;
  std::vector<Element> m0, m1;
  Taylor* target = nullptr;
};

class Reader {
 public:
  explicit Reader(std::string_view text) : lines_(text) {}

  Data read() {
    std::string_view title = lines_.raw();
    constexpr std::string_view label = "No. modes:";
    if (const std::size_t at = title.find(label); at != std::string_view::npos) title.remove_prefix(at + label.size());
    data_.title = std::string(trimmed(title));
    expect("part");
    const Line modal = lines_.next("new modal");
    if (modal.key != "new modal") unexpected(modal, "new modal");
    for (Line line = lines_.next("end modal"); line.key != "end modal"; line = lines_.next("end modal")) {
      if (line.key == "refmod") {
        refmod();
      } else if (line.key == "frame") {
        frame();
      } else {
        Taylor* target = integral(line.key);
        if (target == nullptr) {
          unexpected(line, "refmod, frame, mdCM, J, Ct, Cr, Me, Gr, Ge, Oe, ksigma, Ke, De or end modal");
        }
        matrix(line, target);
      }
    }
    expect("end part");
    fill();
    check();
    return std::move(data_);
  }

 private:
  [[noreturn]] static void unexpected(const Line& line, std::string_view expected) {
    throw FormatError(line.number, fmt::format("got '{}'; need {}", line.key, expected));
  }
  void expect(std::string_view key) {
    const Line line = lines_.next(key);
    if (line.key != key) unexpected(line, fmt::format("'{}'", key));
  }

  Taylor* integral(std::string_view name) {
    const std::array<std::pair<std::string_view, Taylor*>, 11> all = {{{"mdCM", &data_.mdCM},
                                                                       {"J", &data_.J},
                                                                       {"Ct", &data_.Ct},
                                                                       {"Cr", &data_.Cr},
                                                                       {"Me", &data_.Me},
                                                                       {"Gr", &data_.Gr},
                                                                       {"Ge", &data_.Ge},
                                                                       {"Oe", &data_.Oe},
                                                                       {"ksigma", &data_.ksigma},
                                                                       {"Ke", &data_.Ke},
                                                                       {"De", &data_.De}}};
    for (const auto& [key, target] : all) {
      if (key == name) return target;
    }
    return nullptr;
  }

  void refmod() {
    for (Line line = lines_.next("end refmod"); line.key != "end refmod"; line = lines_.next("end refmod")) {
      if (line.key == "mass") {
        data_.mass = number(line);
        if (data_.mass <= 0) throw FormatError(line.number, fmt::format("got mass {}; need > 0 kg", line.value));
      } else if (line.key == "nelastq") {
        nelastq_ = {line.number, whole(line, 0, most_modes)};
      } else if (line.key.starts_with("ielastq")) {
        data_.mode_names.emplace_back(line.value);
      } else {
        unexpected(line, "mass, nelastq, ielastq or end refmod");
      }
    }
  }

  void frame() {
    // Raw matrices point at their nodes, which must not move.
    for (Line line = lines_.next("end frame"); line.key != "end frame"; line = lines_.next("end frame")) {
      if (line.key != "new node") unexpected(line, "new node or end frame");
      nodes_.push_back(std::make_unique<Node>());
      node(*nodes_.back(), line);
    }
  }

  void node(Node& node, const Line& begin) {
    node.id = std::string(begin.value);
    if (node.id.empty()) throw FormatError(begin.number, "a node has no name");
    for (Line line = lines_.next("end node"); line.key != "end node"; line = lines_.next("end node")) {
      if (line.key == "rframe") continue;
      Taylor* target = line.key == "origin" ? &node.origin
                       : line.key == "phi"  ? &node.phi
                       : line.key == "psi"  ? &node.psi
                       : line.key == "AP"   ? &node.axes
                                            : nullptr;
      if (target == nullptr && line.key != "sigma") unexpected(line, "rframe, origin, phi, psi, AP, sigma or end node");
      matrix(line, target);
    }
  }

  /// Reads a matrix; one without a target (stresses) is passed over.
  void matrix(const Line& begin, Taylor* target) {
    Raw raw;
    raw.line = begin.number;
    raw.name = std::string(begin.key);
    raw.target = target;
    const std::string end = fmt::format("end {}", begin.key);
    for (Line line = lines_.next(end); line.key != end; line = lines_.next(end)) {
      const auto read = [&](std::string_view key, int& to, int least, int most) {
        if (line.key != key) return false;
        to = whole(line, least, most);
        return true;
      };
      int quadratic = 0;
      if (read("order", raw.order, 0, 1) || read("nrow", raw.rows, 1, 3 * most_modes) ||
          read("ncol", raw.columns, 1, 3 * most_modes) || read("nq", raw.modes, 0, most_modes) ||
          read("nqn", quadratic, 0, 0) || read("structure", raw.structure, 0, 4)) {
        continue;
      }
      const auto at = element(line.key);
      if (!at) unexpected(line, fmt::format("order, nrow, ncol, nq, nqn, structure, m0(i,j), m1(i,j,k) or {}", end));
      (at->first == 0 ? raw.m0 : raw.m1).push_back({line.number, at->second, number(line)});
    }
    if (raw.rows == 0 || raw.columns == 0) throw FormatError(raw.line, raw.name + " lacks nrow or ncol");
    if (static_cast<double>(raw.rows) * raw.columns * (raw.order * raw.modes + 1) > most_elements) {
      throw FormatError(raw.line, fmt::format("{} has {} by {} elements of {} modes; need at most {:g} in all",
                                              raw.name, raw.rows, raw.columns, raw.modes, most_elements));
    }
    if (target != nullptr) raws_.push_back(std::move(raw));
  }

  /// First element of all matrices that (row, mode, column), or (row, column, mode), does not fit.
  const Element* misfit(bool mode_last) const {
    for (const Raw& raw : raws_) {
      for (const Element& e : raw.m1) {
        const int mode = e.at[mode_last ? 2 : 1];
        const int column = e.at[mode_last ? 1 : 2];
        if (e.at[0] < 1 || e.at[0] > raw.rows || column < 1 || column > raw.columns || mode < 1 || mode > raw.modes) {
          return &e;
        }
      }
    }
    return nullptr;
  }

  void fill() {
    const Element* first = misfit(false);
    const bool mode_last = first != nullptr;
    if (mode_last && misfit(true) != nullptr) {
      throw FormatError(first->line,
                        "an index of m1 is out of range, whether its order is row, mode, column or row, "
                        "column, mode");
    }
    for (const Raw& raw : raws_) fill(raw, mode_last);
    for (auto& node : nodes_) data_.nodes.push_back(std::move(*node));
  }

  static void fill(const Raw& raw, bool mode_last) {
    Eigen::MatrixXd& m0 = raw.target->m0;
    if (m0.size() > 0) throw FormatError(raw.line, raw.name + " is there twice");
    m0 = Eigen::MatrixXd::Zero(raw.rows, raw.columns);
    if (raw.structure == 4) m0.setIdentity();
    const bool symmetric = raw.structure == 2;
    if (symmetric && raw.rows != raw.columns) throw FormatError(raw.line, raw.name + " is symmetric but not square");
    std::vector<std::uint8_t> given(static_cast<std::size_t>(m0.size()), 0);
    const auto put = [&](Eigen::MatrixXd& m, int row, int column, double value) {
      m(row - 1, column - 1) = value;
      given[static_cast<std::size_t>((row - 1) * raw.columns + column - 1)] = 1;
    };
    const auto mirror = [&](Eigen::MatrixXd& m) {
      for (int i = 0; symmetric && i < raw.rows; ++i) {
        for (int j = 0; j < raw.columns; ++j) {
          if (given[static_cast<std::size_t>(i * raw.columns + j)] == 0) m(i, j) = m(j, i);
        }
      }
    };
    for (const Element& e : raw.m0) {
      if (e.at[0] < 1 || e.at[0] > raw.rows || e.at[1] < 1 || e.at[1] > raw.columns) {
        throw FormatError(
            e.line, fmt::format("an index of m0 is out of range; {} is {} by {}", raw.name, raw.rows, raw.columns));
      }
      put(m0, e.at[0], e.at[1], e.value);
    }
    mirror(m0);
    if (raw.order == 0 && raw.m1.empty()) return;
    raw.target->m1.assign(static_cast<std::size_t>(raw.modes), Eigen::MatrixXd::Zero(raw.rows, raw.columns));
    std::vector<std::vector<const Element*>> by_mode(raw.target->m1.size());
    for (const Element& e : raw.m1) by_mode[static_cast<std::size_t>(e.at[mode_last ? 2 : 1] - 1)].push_back(&e);
    for (std::size_t k = 0; k < by_mode.size(); ++k) {
      std::fill(given.begin(), given.end(), 0);
      for (const Element* e : by_mode[k]) put(raw.target->m1[k], e->at[0], e->at[mode_last ? 1 : 2], e->value);
      mirror(raw.target->m1[k]);
    }
  }

  void check() {
    if (data_.mass <= 0) throw FormatError(0, "refmod has no mass");
    const auto need = [](const Taylor& t, const char* name) {
      if (t.absent()) throw FormatError(0, fmt::format("there is no {}", name));
    };
    need(data_.Me, "Me");
    const Eigen::Index n = data_.modes();
    if (nelastq_.second != n) {
      throw FormatError(nelastq_.first, fmt::format("nelastq is {}, but Me is {} by {}", nelastq_.second, n, n));
    }
    need(data_.Ke, "Ke");
    need(data_.mdCM, "mdCM");
    need(data_.J, "J");
    need(data_.Ct, "Ct");
    need(data_.Cr, "Cr");
    for (Eigen::MatrixXd* m : symmetric_inertias()) {
      Eigen::VectorXd six(6);
      six << (*m)(0, 0), (*m)(1, 1), (*m)(2, 2), (*m)(0, 1), (*m)(0, 2), (*m)(1, 2);
      *m = six;
    }
    const auto size = [n](const Taylor& t, const char* name, Eigen::Index rows, Eigen::Index columns) {
      if (t.absent()) return;
      if (t.m0.rows() != rows || t.m0.cols() != columns) {
        throw FormatError(0, fmt::format("{} is {} by {}; need {} by {} with {} modes", name, t.m0.rows(), t.m0.cols(),
                                         rows, columns, n));
      }
      if (!t.m1.empty() && static_cast<Eigen::Index>(t.m1.size()) != n) {
        throw FormatError(0, fmt::format("the first order of {} has {} modes; need {}", name, t.m1.size(), n));
      }
    };
    size(data_.Me, "Me", n, n);
    size(data_.Ke, "Ke", n, n);
    size(data_.De, "De", n, n);
    size(data_.mdCM, "mdCM", 3, 1);
    size(data_.J, "J", 6, 1);
    size(data_.Ct, "Ct", n, 3);
    size(data_.Cr, "Cr", n, 3);
    size(data_.Gr, "Gr", 3, 3 * n);
    size(data_.Ge, "Ge", n, 3 * n);
    size(data_.Oe, "Oe", n, 6);
    size(data_.ksigma, "ksigma", n, 1);
    for (Node& node : data_.nodes) {
      size(node.origin, "origin", 3, 1);
      size(node.phi, "phi", 3, n);
      size(node.psi, "psi", 3, n);
      size(node.axes, "AP", 3, 3);
      if (node.origin.absent() || node.phi.absent()) {
        throw FormatError(0, fmt::format("node {} lacks its origin or its phi", node.id));
      }
    }
    data_.mode_names.resize(static_cast<std::size_t>(n));
  }

  std::vector<Eigen::MatrixXd*> symmetric_inertias() {
    std::vector<Eigen::MatrixXd*> all;
    if (data_.J.m0.rows() != 3 || data_.J.m0.cols() != 3) return all;
    all.push_back(&data_.J.m0);
    for (Eigen::MatrixXd& m : data_.J.m1) all.push_back(&m);
    return all;
  }

  Lines lines_;
  Data data_;
  std::vector<std::unique_ptr<Node>> nodes_;
  std::vector<Raw> raws_;
  std::pair<int, int> nelastq_{0, 0};  ///< line, value
};

}  // namespace

Data read(std::string_view text) { return Reader(text).read(); }

}  // namespace withy::sid
