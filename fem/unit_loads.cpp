#include "unit_loads.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <fstream>

#include "sections.hpp"
#include "text_lines.hpp"

namespace withy::fem {
namespace {

std::string stem_of(std::size_t load) { return fmt::format("unit-{:02}", load + 1); }
constexpr const char* senses[] = {"-plus", "-minus"};

/// Displacement of the clamped mesh under forces of size 1.
class Statics {
 public:
  Statics(const SparseMatrix& K, const std::vector<Eigen::Index>& free) : free_(free) {
    std::vector<Eigen::Index> place(static_cast<std::size_t>(K.rows()), -1);
    for (std::size_t i = 0; i < free.size(); ++i)
      place[static_cast<std::size_t>(free[i])] = static_cast<Eigen::Index>(i);
    std::vector<Eigen::Triplet<double>> triplets;
    for (Eigen::Index column = 0; column < K.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator it(K, column); it; ++it) {
        const auto i = place[static_cast<std::size_t>(it.row())], j = place[static_cast<std::size_t>(column)];
        if (i >= 0 && j >= 0) triplets.emplace_back(i, j, it.value());
      }
    }
    SparseMatrix part(static_cast<Eigen::Index>(free.size()), static_cast<Eigen::Index>(free.size()));
    part.setFromTriplets(triplets.begin(), triplets.end());
    factor_.compute(part);
  }
  [[nodiscard]] double greatest_displacement(const Eigen::VectorXd& force) const {
    Eigen::VectorXd part(factor_.rows());
    for (std::size_t i = 0; i < free_.size(); ++i) part[static_cast<Eigen::Index>(i)] = force[free_[i]];
    return factor_.solve(part).cwiseAbs().maxCoeff();
  }

 private:
  const std::vector<Eigen::Index>& free_;
  Eigen::SimplicialLDLT<SparseMatrix> factor_;
};

void save(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw std::system_error(errno, std::generic_category(), file.string());
}

std::string root_text(const ReductionOptions& options) {
  std::string text = "*BOUNDARY\n";
  for (const long node : options.root) text += fmt::format("{},1,3\n", node);
  return text;
}

}  // namespace

std::vector<UnitLoad> unit_loads(const Matrices& matrices, const Reduction& body, const ReductionOptions& options) {
  std::vector<UnitLoad> loads;
  const Eigen::Index count = body.X.cols();
  const char axis[] = {'x', 'y', 'z'};
  for (Eigen::Index i = 0; i < 3; ++i) {
    Eigen::VectorXd field = Eigen::VectorXd::Zero(3 * count);
    for (Eigen::Index a = 0; a < count; ++a) field[3 * a + i] = 1;
    loads.push_back({fmt::format("acceleration {}", axis[i]), matrices.M * field});
  }
  for (Eigen::Index j = 0; j < 3; ++j) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      Eigen::VectorXd field = Eigen::VectorXd::Zero(3 * count);
      for (Eigen::Index a = 0; a < count; ++a) field[3 * a + i] = body.X(j, a);
      loads.push_back({fmt::format("gradient {} of {}", axis[i], axis[j]), matrices.M * field});
    }
  }
  for (const Interface& interface : options.interfaces) {
    const Section section = section_of(interface.nodes, matrices);
    const auto add = [&](const char* what, Eigen::Index i, const auto& force_at) {
      UnitLoad load{fmt::format("{} {} at {}", what, axis[i], interface.name), Eigen::VectorXd::Zero(3 * count)};
      for (std::size_t s = 0; s < section.rows.size(); ++s)
        load.force.segment<3>(3 * section.rows[s]) = force_at(Vector3(section.arms.col(static_cast<Eigen::Index>(s))));
      loads.push_back(std::move(load));
    };
    for (Eigen::Index i = 0; i < 3; ++i) {
      add("force", i,
          [&](const Vector3&) { return Vector3(Vector3::Unit(i) / static_cast<double>(section.rows.size())); });
    }
    for (Eigen::Index i = 0; section.rigid() && i < 3; ++i) {
      add("moment", i, [&](const Vector3& arm) { return Vector3(section.twist_of_moment(i).cross(arm)); });
    }
  }
  const Statics statics(matrices.K, body.free);
  const double extent = body.X.colwise().norm().maxCoeff();
  for (UnitLoad& load : loads) {
    const double moved = statics.greatest_displacement(load.force);
    // Large enough for the digits of the files, small enough for what CalculiX adds of third order.
    load.factor = moved > 0 ? 1e-5 * extent / moved : 1;
  }
  return loads;
}

void write_decks(const std::filesystem::path& folder, const std::filesystem::path& model,
                 const std::vector<long>& nodes, const std::vector<UnitLoad>& loads, const ReductionOptions& options) {
  std::filesystem::create_directories(folder);
  save(folder / "model.inp", model_part(model));
  std::string list;
  for (std::size_t n = 0; n < loads.size(); ++n) {
    const UnitLoad& load = loads[n];
    const double least = 1e-14 * load.force.cwiseAbs().maxCoeff();
    for (const int sense : {0, 1}) {
      const double factor = sense == 0 ? load.factor : -load.factor;
      std::string deck = fmt::format(
          "** Unit load for withy import: {}, times {:.17g}\n*INCLUDE,INPUT=model.inp\n{}"
          "*STEP\n*STATIC\n*CLOAD\n",
          load.name, factor, root_text(options));
      for (Eigen::Index row = 0; row < load.force.size(); ++row) {
        if (std::abs(load.force[row]) <= least) continue;
        // CalculiX reads twenty characters of a field.
        deck += fmt::format("{},{},{:.11e}\n", nodes[static_cast<std::size_t>(row / 3)], row % 3 + 1,
                            factor * load.force[row]);
      }
      deck += "*END STEP\n*STEP,PERTURBATION\n*FREQUENCY,SOLVER=MATRIXSTORAGE\n*END STEP\n";
      save(folder / (stem_of(n) + senses[sense] + ".inp"), deck);
    }
    list += fmt::format("{} {:.17g} {}\n", stem_of(n), load.factor, load.name);
  }
  save(folder / "unit-loads.txt", list);
}

GeometricStiffness read_geometric_stiffness(const std::filesystem::path& folder, const Matrices& matrices,
                                            const Reduction& body, const std::vector<UnitLoad>& loads) {
  const std::filesystem::path list = folder / "unit-loads.txt";
  const std::string text = text_of(list);
  Lines lines(text);
  std::string_view line;
  GeometricStiffness reduced;
  // Clamped rows are missing in the results: the modes are zero there.
  for (std::size_t n = 0; n < loads.size(); ++n) {
    const auto wrong = [&](const std::string& why) {
      throw InputError(
          fmt::format("{}:{}: {}; write the decks anew for this root and these interfaces", list.string(), n + 1, why));
    };
    const std::string stem = stem_of(n);
    if (!lines.next(line)) wrong("there are fewer loads than this body needs");
    const auto fields = split(line, " ");
    const auto factor = fields.size() > 2 ? number_of<double>(fields[1]) : std::nullopt;
    if (!factor || line.substr(fields[0].size() + fields[1].size() + 2) != loads[n].name)
      wrong(fmt::format("got '{}'; need the load '{}'", line, loads[n].name));
    const auto stiffness_under = [&](int sense) {
      const std::string job = stem + senses[sense];
      const NamedMatrix stressed = read_calculix(folder / (job + ".sti"), folder / (job + ".dof"));
      if (stressed.rows.size() != body.free.size())
        throw InputError(fmt::format("{}: got {} rows; need the {} of the mesh clamped at its root",
                                     (folder / (job + ".dof")).string(), stressed.rows.size(), body.free.size()));
      return arranged(stressed, matrices.nodes);
    };
    // What is even in the load is no geometric stiffness: CalculiX measures strain with its square.
    const SparseMatrix difference = stiffness_under(0) - stiffness_under(1);
    const Eigen::MatrixXd K = body.modes.transpose() * (difference * body.modes);
    reduced.emplace_back(0.25 / *factor * (K + K.transpose()));
  }
  return reduced;
}

}  // namespace withy::fem
