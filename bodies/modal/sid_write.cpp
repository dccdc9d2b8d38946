#include <fmt/format.h>

#include <algorithm>

#include "sid.hpp"

namespace withy::sid {
namespace {

/// A number as Fortran reads it: 17 significant digits, D for the exponent.
std::string number(double x) {
  std::string text = fmt::format("{:.16E}", x);
  std::replace(text.begin(), text.end(), 'E', 'D');
  return text;
}

class Writer {
 public:
  std::string text;

  void line(int depth, std::string_view content) { text += fmt::format("{:{}}{}\n", "", 5 * depth, content); }
  void assign(int depth, std::string_view key, std::string_view value) {
    line(depth, fmt::format("{:<{}}= {}", key, std::max(1, 48 - 5 * depth), value));
  }

  void matrix(int depth, std::string_view name, const Taylor& t, Eigen::Index modes) {
    if (t.absent()) return;
    line(depth, name);
    const bool zero = t.m0.isZero(0) && t.m1.empty();
    assign(depth + 1, "order", t.m1.empty() ? "0" : "1");
    assign(depth + 1, "nrow", std::to_string(t.m0.rows()));
    assign(depth + 1, "ncol", std::to_string(t.m0.cols()));
    assign(depth + 1, "nq", std::to_string(modes));
    assign(depth + 1, "nqn", "0");
    assign(depth + 1, "structure", zero ? "0" : "3");
    for (Eigen::Index i = 0; i < t.m0.rows(); ++i) {
      for (Eigen::Index j = 0; j < t.m0.cols(); ++j) {
        if (t.m0(i, j) != 0) assign(depth + 1, fmt::format("m0({:3},{:3})", i + 1, j + 1), number(t.m0(i, j)));
      }
    }
    for (std::size_t k = 0; k < t.m1.size(); ++k) {
      for (Eigen::Index i = 0; i < t.m1[k].rows(); ++i) {
        for (Eigen::Index j = 0; j < t.m1[k].cols(); ++j) {
          if (t.m1[k](i, j) == 0) continue;
          assign(depth + 1, fmt::format("m1({:3},{:3},{:3})", i + 1, k + 1, j + 1), number(t.m1[k](i, j)));
        }
      }
    }
    line(depth, fmt::format("end {}", name));
  }
};

}  // namespace

std::string write(const Data& data) {
  const Eigen::Index n = data.modes();
  Writer w;
  w.text = fmt::format("{:5} {:5}    :No. nodes, No. modes:{}\n", data.nodes.size(), n, data.title);
  w.line(0, "part");
  w.assign(1, "new modal", "");
  w.line(2, "refmod");
  w.assign(3, "mass", number(data.mass));
  w.assign(3, "nelastq", std::to_string(n));
  for (std::size_t k = 0; k < data.mode_names.size(); ++k) {
    w.assign(3, fmt::format("ielastq ({:4})", k + 1), data.mode_names[k]);
  }
  w.line(2, "end refmod");
  w.line(2, "frame");
  for (const Node& node : data.nodes) {
    w.assign(3, "new node", node.id);
    w.assign(4, "rframe", "body ref");
    w.matrix(4, "origin", node.origin, n);
    w.matrix(4, "phi", node.phi, n);
    w.matrix(4, "psi", node.psi, n);
    w.matrix(4, "AP", node.axes, n);
    w.line(3, "end node");
  }
  w.line(2, "end frame");
  w.matrix(2, "mdCM", data.mdCM, n);
  w.matrix(2, "J", data.J, n);
  w.matrix(2, "Ct", data.Ct, n);
  w.matrix(2, "Cr", data.Cr, n);
  w.matrix(2, "Me", data.Me, n);
  w.matrix(2, "Gr", data.Gr, n);
  w.matrix(2, "Ge", data.Ge, n);
  w.matrix(2, "Oe", data.Oe, n);
  w.matrix(2, "ksigma", data.ksigma, n);
  w.matrix(2, "Ke", data.Ke, n);
  w.matrix(2, "De", data.De, n);
  w.line(1, "end modal");
  w.line(0, "end part");
  return w.text;
}

}  // namespace withy::sid
