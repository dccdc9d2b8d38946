#include <algorithm>
#include <cerrno>
#include <chrono>
#include <limits>
#include <map>
#include <new>
#include <system_error>

#include "withy/results/csv.hpp"
#include "withy/results/hdf5/hdf5_handle.hpp"
#include "withy/results/hdf5/hdf5_library.hpp"

namespace withy {
namespace {

constexpr hsize_t chunk = 512;  ///< rows that are compressed together
/// Up to so many columns others may read a file while it is written: the library goes over all of them again and again
/// for that. 2,000 took six times as long as they take without, and the time grows with the square.
constexpr std::size_t most_shared = 256;
/// Up to so many numbers, 4 MB, a table that is there whole is not compressed: each column is one part with a checksum.
/// Compressed it would be an eighth to a third smaller, and a short run takes a tenth longer for it.
constexpr hsize_t few = 1 << 19;
using Clock = std::chrono::steady_clock;

/// Texts of many columns, which are often those of their neighbours.
class ColumnTexts {
 public:
  void push_back(const std::string& text) {
    if (ends_.empty() || texts_.back() != text) {
      texts_.push_back(text);
      ends_.push_back(size_);
    }
    ends_.back() = ++size_;
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const std::string& operator[](std::size_t i) const {
    return texts_[static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), i) - ends_.begin())];
  }

 private:
  std::vector<std::string> texts_;
  std::vector<std::size_t> ends_;
  std::size_t size_ = 0;
};

class Hdf5Writer final : public Hdf5Recorder {
 public:
  explicit Hdf5Writer(const std::filesystem::path& path) : name_(path.string()) {
    expect_memory();
    begin_hdf5();
    const Hdf5Handle access = latest(), how = plain_when_small();
    file_ = {need(H5Fcreate(name_.c_str(), H5F_ACC_TRUNC, how, access)), &H5Fclose};
    write_text(file_, "format", "withy-results/1");
    write_text(file_, "status", "running");
  }

  void begin(const std::vector<Column>& columns) override {
    if (units_.size() > 0) return;  // the table goes on
    for (const Column& column : columns) {
      names_ += (names_.empty() ? "" : "\n") + column_name(column.name);
      name_ends_.push_back(names_.size());
      units_.push_back(column.unit);
    }
    wide_ = columns.size() > most_shared;
    if (wide_) describe_less_at_once();
  }

  void describe_frames(const std::vector<std::string>& frames) override {
    for (const std::string& frame : frames) frames_.push_back(frame);
  }

  void row(std::span<const double> numbers) override {
    waiting_.emplace_back(numbers.begin(), numbers.end());
    // A part that is written before it is full is written again later: the longer a run, the more seldom.
    const bool many = waiting_rows() >= chunk && waiting_rows() * units_.size() >= few;
    if (begun_ ? (rows_ + waiting_rows()) % chunk == 0 : many) write_waiting();
    const auto now = Clock::now();
    if (!wide_ && now - flushed_ > std::chrono::seconds(1) + (now - began_) / 20) flush();
  }

  RecordMark mark() override {
    if (!wide_) flush();  // a wide table is for nobody until it ends
    return {rows_ + waiting_rows(), 0, {}};
  }

  void end() override {
    if (ended_) return;
    // A run that is over before others could read it needs no room to grow, nor what lets them read meanwhile.
    if (!begun_) begin_datasets(waiting_rows());
    write_waiting();
    datasets_.clear();
    need(file_.close());
    // Attributes cannot be added while others may read. A file that is killed in this moment is refused by those that
    // open it, until h5clear; its rows are in it.
    if (!descriptions_.empty()) {
      const Hdf5Handle access = latest();
      file_ = {need(H5Fopen(name_.c_str(), H5F_ACC_RDWR, access)), &H5Fclose};
      for (const auto& [name, text] : descriptions_) write_text(file_, name, text);
      need(file_.close());
    }
    ended_ = true;
    H5garbage_collect();
  }

  void describe(const std::string& name, const std::string& text) override {
    if (shared_)
      descriptions_[name] = text;
    else
      write_text(file_, name, text);
  }

 private:
  [[nodiscard]] std::string column(std::size_t c) const {
    const std::size_t begin = c > 0 ? name_ends_[c - 1] + 1 : 0;
    return names_.substr(begin, name_ends_[c] - begin);
  }

  /// Checks what a call gave.
  template <class Result>
  Result need(Result result) const {
    if (result >= 0) return result;
    const int error = errno != 0 ? errno : EIO;
    const std::string why = hdf5_error();
    throw std::system_error(error, std::generic_category(), "cannot write " + name_ + (why.empty() ? "" : ": " + why));
  }

  /// The library does not outlive a lack of memory while it begins or creates a file. \throws std::bad_alloc where that
  /// is near
  static void expect_memory() {
    constexpr std::size_t of_a_file = std::size_t{4} << 20;
    ::operator delete(::operator new(of_a_file));
  }

  /// The form of files that knows single writers with many readers.
  [[nodiscard]] Hdf5Handle latest() const {
    Hdf5Handle access(need(H5Pcreate(H5P_FILE_ACCESS)), &H5Pclose);
    need(H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST));
    need(H5Pset_file_locking(access, 1, 1));  // file systems without locks are no reason to write nothing
    return access;
  }

  /// How files are kept: names of up to so many columns in a plain list, and all that is said of the whole. By itself
  /// the library makes trees of more than eight, which a short run waits for.
  [[nodiscard]] Hdf5Handle plain_when_small() const {
    constexpr unsigned most_listed = 64, least_in_trees = 48;
    Hdf5Handle how(need(H5Pcreate(H5P_FILE_CREATE)), &H5Pclose);
    need(H5Pset_link_phase_change(how, most_listed, least_in_trees));
    need(H5Pset_attr_phase_change(how, most_listed, least_in_trees));
    return how;
  }

  /// Descriptions of datasets stay in memory until they are written, by themselves up to 32 MB of them: of a wide table
  /// fewer, as each is touched a few times in a row and then no more. In memory they take several times what they are
  /// counted as.
  void describe_less_at_once() const {
    H5AC_cache_config_t cache{};
    cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
    need(H5Fget_mdc_config(file_, &cache));
    cache.set_initial_size = true;
    cache.initial_size = cache.max_size = cache.min_size = std::size_t{1} << 18;
    cache.incr_mode = H5C_incr__off;
    cache.flash_incr_mode = H5C_flash_incr__off;
    cache.decr_mode = H5C_decr__off;
    need(H5Fset_mdc_config(file_, &cache));
  }

  /// How datasets are kept, which have so many rows, or with 0 grow.
  [[nodiscard]] Hdf5Handle part_by_part(hsize_t rows) const {
    Hdf5Handle how(need(H5Pcreate(H5P_DATASET_CREATE)), &H5Pclose);
    if (rows > 0 && rows * units_.size() <= few) {
      // In their descriptions rows would be moved with each attribute, which takes longer than to write them.
      need(H5Pset_chunk(how, 1, &rows));
      need(H5Pset_fletcher32(how));
      return how;
    }
    const hsize_t part = rows > 0 ? std::min(rows, chunk) : chunk;
    need(H5Pset_chunk(how, 1, &part));
    need(H5Pset_shuffle(how));
    need(H5Pset_deflate(how, 1));
    need(H5Pset_fletcher32(how));
    // What was never written is no number.
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    need(H5Pset_fill_value(how, H5T_NATIVE_DOUBLE, &nothing));
    return how;
  }

  /// The datasets: with `rows` those of the rows that wait, all there will be; with 0 they grow.
  void begin_datasets(hsize_t rows) {
    const Hdf5Handle how = part_by_part(rows), cache = one_part();
    const hsize_t most = rows > 0 ? rows : H5S_UNLIMITED;
    const Hdf5Handle space(need(H5Screate_simple(1, &rows, &most)), &H5Sclose);
    for (std::size_t c = 0; c < units_.size(); ++c) {
      Hdf5Handle dataset(need(H5Dcreate2(file_, column(c).c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, how, cache)),
                         &H5Dclose);
      write_new_text(dataset, "unit", units_[c].empty() ? "1" : units_[c]);
      if (c < frames_.size() && !frames_[c].empty()) write_new_text(dataset, "frame", frames_[c]);
      if (rows > 0) write_column(dataset, c, H5S_ALL, H5S_ALL);
      if (wide_ || rows > 0)
        need(dataset.close());
      else
        datasets_.push_back(std::move(dataset));
    }
    write_text(file_, "columns", names_);  // in the order of the table, since a file lists them by the alphabet
    grows_ = rows == 0;
    begun_ = true;
    if (rows > 0) waiting_.clear();
    rows_ = rows;
  }

  /// A column of the rows that wait.
  void write_column(hid_t dataset, std::size_t c, hid_t memory, hid_t place) const {
    std::vector<double> numbers;
    numbers.reserve(waiting_.size());
    for (const std::vector<double>& row : waiting_) numbers.push_back(row[c]);
    need(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory, place, H5P_DEFAULT, numbers.data()));
  }

  /// Columns are written from end to end: room for the part that is not full.
  [[nodiscard]] Hdf5Handle one_part() const {
    Hdf5Handle access(need(H5Pcreate(H5P_DATASET_ACCESS)), &H5Pclose);
    need(H5Pset_chunk_cache(access, 1, chunk * sizeof(double), 1));
    return access;
  }

  /// A dataset that is open holds some 16 kB: of a wide table one is open at a time.
  template <class Use>
  void with_column(std::size_t c, hid_t cache, Use&& use) const {
    if (!wide_) return use(datasets_[c]);
    Hdf5Handle open(need(H5Dopen2(file_, column(c).c_str(), cache)), &H5Dclose);
    use(open);
    need(open.close());
  }

  void write_text(hid_t object, const std::string& name, const std::string& text) const {
    if (need(H5Aexists(object, name.c_str())) > 0) need(H5Adelete(object, name.c_str()));
    write_new_text(object, name, text);
  }

  void write_new_text(hid_t object, const std::string& name, const std::string& text) const {
    // Names and units are of few lengths: what describes them is made once.
    Hdf5Handle& type = text_types_[text.size()];
    if (!type.valid()) {
      type = {need(H5Tcopy(H5T_C_S1)), &H5Tclose};
      need(H5Tset_size(type, text.size() + 1));
      need(H5Tset_cset(type, H5T_CSET_UTF8));
    }
    if (!one_.valid()) one_ = {need(H5Screate(H5S_SCALAR)), &H5Sclose};
    const Hdf5Handle attribute(need(H5Acreate2(object, name.c_str(), type, one_, H5P_DEFAULT, H5P_DEFAULT)), &H5Aclose);
    need(H5Awrite(attribute, type, text.c_str()));
  }

  [[nodiscard]] hsize_t waiting_rows() const { return waiting_.size(); }

  void write_waiting() {
    share();
    const hsize_t count = waiting_rows(), first = rows_, size = rows_ + count;
    if (count == 0) return;
    const Hdf5Handle memory(need(H5Screate_simple(1, &count, nullptr)), &H5Sclose), cache = one_part();
    for (std::size_t c = 0; c < units_.size(); ++c) {
      with_column(c, cache, [&](hid_t column) {
        if (grows_) need(H5Dset_extent(column, &size));
        const Hdf5Handle place(need(H5Dget_space(column)), &H5Sclose);
        need(H5Sselect_hyperslab(place, H5S_SELECT_SET, &first, nullptr, &count, nullptr));
        write_column(column, c, memory, place);
      });
    }
    waiting_.clear();
    rows_ = size;
  }

  /// From here on datasets grow and nothing else changes: others may read. Before the first rows: it writes all there
  /// is.
  void share() {
    if (begun_) return;
    begin_datasets(0);
    if (wide_) return;
    need(H5Fflush(file_, H5F_SCOPE_LOCAL));
    need(H5Fstart_swmr_write(file_));
    shared_ = true;
  }

  void flush() {
    write_waiting();
    need(H5Fflush(file_, H5F_SCOPE_LOCAL));
    flushed_ = Clock::now();
  }

  std::string name_;
  Hdf5Handle file_;
  std::string names_;  ///< of the columns, a line each
  std::vector<std::size_t> name_ends_;
  ColumnTexts units_, frames_;
  std::vector<Hdf5Handle> datasets_;  ///< of the columns; none of a wide table, nor before the first are written
  std::vector<std::vector<double>> waiting_;  ///< the next rows
  std::map<std::string, std::string> descriptions_;
  mutable std::map<std::size_t, Hdf5Handle> text_types_;  ///< by length
  mutable Hdf5Handle one_;                                ///< the space of one text
  hsize_t rows_ = 0;                                      ///< that the library has been given
  bool wide_ = false;   ///< too many columns for others to read while they are written
  bool begun_ = false;  ///< there are datasets
  bool grows_ = false;  ///< they get longer
  bool shared_ = false, ended_ = false;
  Clock::time_point began_ = Clock::now(), flushed_ = began_;
};

}  // namespace
}  // namespace withy

withy::Hdf5Recorder* withy_hdf5_make_recorder(const std::filesystem::path& path) { return new withy::Hdf5Writer(path); }
