/// \file
/// A table as an HDF5 file. What speaks to the HDF5 library is a library of its own, which is loaded with the first
/// use.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "withy/results/recorder.hpp"

namespace withy {

/// Writes each column as a dataset of its name (column_name) with the attribute `unit`; rows are compressed in parts of
/// up to 512, each with a checksum. From the first flush on the file is written for single-writer/multiple-reader
/// access: of a run that is killed the rows up to the last flush can be read, never others, and the attribute `status`
/// is "running". A flush comes as soon as a second and 5 % of the time since the beginning have passed since the last.
/// A table that has ended before is written at once, and not compressed where it is small.
/// Its functions throw std::system_error.
class Hdf5Recorder : public Recorder {
 public:
  /// Sets an attribute of the file, which `end()` writes where rows came before.
  virtual void describe(const std::string& name, const std::string& text) = 0;
  /// Sets the attribute `frame` of each column, where its text is not empty. After `begin`, before the first row.
  virtual void describe_frames(const std::vector<std::string>& frames) = 0;
};

/// Why this program can neither write nor read HDF5; empty where it can.
std::string hdf5_missing();
/// A file from its beginning, in the place of any other. \throws std::system_error; std::runtime_error where HDF5 is
/// missing
std::unique_ptr<Hdf5Recorder> make_hdf5_recorder(const std::filesystem::path& path);
/// Gives a recorder the rows of such a file, those of a run that was killed or still goes on too. It is not ended.
/// \throws ResultsError where it is no such file, or damaged; std::runtime_error where HDF5 is missing
void read_hdf5(const std::filesystem::path& path, Recorder& recorder);

}  // namespace withy
