/// \file
/// What a report tells of the rows of a run beside their columns.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

/// Computed of every row as it comes: from rows at intervals alone peaks would be lost, and whole turns of attitudes.
class DerivedColumns {
 public:
  /// A number that a limit of validity is set to.
  struct Measured {
    std::string body;
    std::size_t column;  ///< in columns()
  };
  /// \param columns of the rows, which ResultColumns has
  /// \param seen an observation of the model, for the rates of its bodies; null: there are none
  DerivedColumns(const std::vector<Column>& columns, const Model& model, std::unique_ptr<Observation> seen);

  /// Attitudes [deg] and drift of energy [J] first, then what is measured.
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// How many of them are attitudes and drift.
  [[nodiscard]] std::size_t shown() const { return shown_; }
  /// Of each flexible body its rate [rad/s], to be divided by its fundamental frequency.
  [[nodiscard]] const std::vector<Measured>& rates() const { return rates_; }
  /// Of each flexible body that has a tip its deflection over its length.
  [[nodiscard]] const std::vector<Measured>& deflections() const { return deflections_; }

  /// Appends the numbers of the next row.
  void append(std::span<const double> row, std::vector<double>& numbers);

 private:
  /// Four columns of a quaternion, and its angles about x and z in the row before, whole turns counted [deg].
  struct Attitude {
    std::array<std::size_t, 4> places;
    std::array<std::optional<double>, 2> before;
  };
  struct Bent {
    std::array<std::size_t, 3> places;
    double length;
  };
  void add_attitudes(const std::vector<Column>& columns);
  void add_validity(const Model& model);
  template <std::size_t count>
  [[nodiscard]] std::optional<std::array<std::size_t, count>> places(const std::array<std::string, count>& names) const;

  const Layout& layout_;
  std::unique_ptr<Observation> seen_;
  std::unordered_map<std::string, std::size_t> known_;  ///< places of the rows' columns, while this is made
  std::vector<Column> columns_;
  std::size_t shown_ = 0;
  std::vector<Attitude> attitudes_;
  std::optional<std::array<std::size_t, 3>> energies_;
  std::optional<double> first_energy_;
  std::vector<std::size_t> turning_;  ///< bodies
  std::vector<Bent> bent_;
  std::vector<Measured> rates_, deflections_;
};

}  // namespace withy
