/// \file
/// What the library that speaks to HDF5 offers to hdf5_recorder.cpp, by these names. Both throw what is said there.
#pragma once

#include "withy/results/hdf5_recorder.hpp"

extern "C" [[gnu::visibility("default")]] withy::Hdf5Recorder* withy_hdf5_make_recorder(
    const std::filesystem::path& path);
extern "C" [[gnu::visibility("default")]] void withy_hdf5_read(const std::filesystem::path& path,
                                                               withy::Recorder& recorder);
