#include <algorithm>
#include <sstream>

#include "withy/results/hdf5/hdf5_handle.hpp"
#include "withy/results/hdf5/hdf5_library.hpp"
#include "withy/results/results_error.hpp"

namespace withy {
namespace {

class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::filesystem::path& path) : name_(path.string()) {
    begin_hdf5();
    // A file whose writer still goes on, or was killed, opens as one that is shared alone.
    hid_t file = H5Fopen(name_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0) file = H5Fopen(name_.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, H5P_DEFAULT);
    file_ = {need(file), &H5Fclose};
    if (text(file_, "format") != "withy-results/1") throw ResultsError(name_ + " is no table of withy");
    std::istringstream names(text(file_, "columns"));
    for (std::string column; std::getline(names, column);) add(column);
  }

  void give(Recorder& recorder) const {
    recorder.begin(columns_);
    std::vector<double> numbers(columns_.size());
    std::vector<std::vector<double>> part(columns_.size());
    for (hsize_t first = 0; first < rows_; first += part_rows) {
      const hsize_t count = std::min(part_rows, rows_ - first);
      for (std::size_t c = 0; c < columns_.size(); ++c) read(c, first, count, part[c]);
      for (hsize_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < columns_.size(); ++c) numbers[c] = part[c][i];
        recorder.row(numbers);
      }
    }
  }

 private:
  static constexpr hsize_t part_rows = 4096;

  template <class Result>
  Result need(Result result) const {
    if (result < 0) throw ResultsError(name_ + " cannot be read as HDF5: " + hdf5_error());
    return result;
  }

  [[nodiscard]] std::string text(hid_t object, const char* name) const {
    if (need(H5Aexists(object, name)) == 0) return {};
    const Hdf5Handle attribute(need(H5Aopen(object, name, H5P_DEFAULT)), &H5Aclose);
    const Hdf5Handle type(need(H5Aget_type(attribute)), &H5Tclose);
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) return {};
    constexpr std::size_t most_bytes = std::size_t{256} << 20;
    if (H5Tget_size(type) > most_bytes) throw ResultsError(name_ + ": a text of more than 256 MiB");
    std::string out(H5Tget_size(type), '\0');
    need(H5Aread(attribute, type, out.data()));
    out.resize(out.find('\0') == std::string::npos ? out.size() : out.find('\0'));
    return out;
  }

  /// Columns whose writer was killed may differ in length by the rows of a flush: what all have is the table.
  void add(const std::string& column) {
    data_.emplace_back(need(H5Dopen2(file_, column.c_str(), H5P_DEFAULT)), &H5Dclose);
    const std::string unit = text(data_.back(), "unit");
    columns_.push_back({column, unit == "1" ? "" : unit});
    const Hdf5Handle space(need(H5Dget_space(data_.back())), &H5Sclose);
    if (need(H5Sget_simple_extent_ndims(space)) != 1) throw ResultsError(name_ + ": " + column + " is no column");
    hsize_t rows = 0;
    need(H5Sget_simple_extent_dims(space, &rows, nullptr));
    rows_ = columns_.size() == 1 ? rows : std::min(rows_, rows);
  }

  void read(std::size_t column, hsize_t first, hsize_t count, std::vector<double>& numbers) const {
    numbers.resize(count);
    const Hdf5Handle place(need(H5Dget_space(data_[column])), &H5Sclose);
    need(H5Sselect_hyperslab(place, H5S_SELECT_SET, &first, nullptr, &count, nullptr));
    const Hdf5Handle memory(need(H5Screate_simple(1, &count, nullptr)), &H5Sclose);
    need(H5Dread(data_[column], H5T_NATIVE_DOUBLE, memory, place, H5P_DEFAULT, numbers.data()));
  }

  std::string name_;
  Hdf5Handle file_;
  std::vector<Column> columns_;
  std::vector<Hdf5Handle> data_;
  hsize_t rows_ = 0;
};

}  // namespace
}  // namespace withy

void withy_hdf5_read(const std::filesystem::path& path, withy::Recorder& recorder) {
  withy::Hdf5Reader(path).give(recorder);
}
