/// \file
/// results.h5: what is read is what was written, bit by bit; a writer that is killed leaves the rows up to a flush and
/// no others; damage is noticed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>
#include <thread>

#include "scratch.hpp"
#include "withy/results/hdf5_recorder.hpp"
#include "withy/results/results_error.hpp"

namespace withy {
namespace {

using test::Scratch;
using testing::HasSubstr;

const std::vector<Column> four_columns = {{"t", "s"}, {"shoulder", "rad"}, {"boom.bending_y[1]", ""}, {"tip.x", "m"}};

std::vector<double> row(std::size_t i) {
  const auto x = static_cast<double>(i);
  return {0.1 * x, std::sin(x), i == 2 ? std::nan("") : -1e-300 * x, 1 / (x + 1)};
}

/// NaN equals NaN.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

class Hdf5 : public testing::Test {
 protected:
  void SetUp() override {
    if (!WITHY_HAS_HDF5) GTEST_SKIP() << hdf5_missing();
    ASSERT_EQ(hdf5_missing(), "");
  }
  void write(std::size_t rows) const {
    const auto file = make_hdf5_recorder(path_);
    file->describe("scene", std::string(100'000, 's'));
    file->begin(four_columns);
    file->describe_frames({"", "F of hinge shoulder", "", "world"});
    for (std::size_t i = 0; i < rows; ++i) file->row(row(i));
    file->describe("status", "completed");
    file->describe("certificate", std::string(100'000, 'c'));
    file->end();
  }
  int refusals(std::size_t first, std::size_t last) const;
  /// Standard output of a command.
  static std::string said(const std::string& command) {
    std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    std::string text(1 << 20, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), pipe));
    ::pclose(pipe);
    return text;
  }

  Scratch folder_;
  std::filesystem::path path_ = folder_ / "results.h5";
};

TEST_F(Hdf5, WhatIsReadIsWhatWasWritten) {
  // Whole, more than a description holds, and growing.
  for (const std::size_t rows : {0U, 1U, 511U, 512U, 513U, 5000U, 8000U, 16'384U, 20'000U}) {
    write(rows);
    MemoryRecorder table;
    read_hdf5(path_, table);
    ASSERT_EQ(table.rows().size(), rows);
    for (std::size_t i = 0; i < rows; ++i) ASSERT_TRUE(same(table.rows()[i], row(i))) << i;
    ASSERT_EQ(table.columns().size(), four_columns.size());
    EXPECT_EQ(table.columns()[1].unit, "rad");
    EXPECT_EQ(table.columns()[2].name, "boom.bending_y.1") << "as in results.csv";
  }
}

/// Of which datasets are open one at a time, filled part by part and in between.
TEST_F(Hdf5, AWideTableIsReadAsItWasWritten) {
  std::vector<Column> columns;
  for (int c = 0; c < 300; ++c) columns.push_back({"c" + std::to_string(c), c % 2 == 0 ? "rad" : ""});
  const std::vector<std::string> frames(columns.size(), "world");
  const auto numbers = [&](std::size_t i) {
    std::vector<double> all;
    for (std::size_t c = 0; c < columns.size(); ++c)
      all.push_back(static_cast<double>(i) + 1e-3 * static_cast<double>(c));
    return all;
  };
  constexpr std::size_t rows = 1100;
  const auto file = make_hdf5_recorder(path_);
  file->begin(columns);
  file->describe_frames(frames);
  for (std::size_t i = 0; i < rows; ++i) {
    file->row(numbers(i));
    if (i % 400 == 399) {
      EXPECT_EQ(file->mark().rows, i + 1);
    }
  }
  file->end();
  MemoryRecorder table;
  read_hdf5(path_, table);
  ASSERT_EQ(table.rows().size(), rows);
  ASSERT_EQ(table.columns().size(), columns.size());
  EXPECT_EQ(table.columns()[298].name, "c298");
  EXPECT_EQ(table.columns()[298].unit, "rad");
  for (std::size_t i = 0; i < rows; ++i) ASSERT_TRUE(same(table.rows()[i], numbers(i))) << i;
}

TEST_F(Hdf5, OtherProgramsReadUnitsFramesAndWhatTheRunWas) {
  if (said("h5dump --version").find("Version") == std::string::npos) GTEST_SKIP() << "h5dump is not installed";
  write(3);
  std::string all = said("h5dump -w 0 " + path_.string());
  // Texts of two attributes are long.
  for (const char* long_text : {"sss", "ccc"}) {
    EXPECT_NE(all.find(std::string(100'000, long_text[0])), std::string::npos);
    all.erase(all.find(long_text), 100'000);
  }
  for (const char* part : {"\"F of hinge shoulder\"", "\"rad\"", "\"completed\"", "ATTRIBUTE \"certificate\"",
                           "DATASET \"tip.x\"", "boom.bending_y.1", "0, 0.841471, 0.909297"})
    EXPECT_THAT(all, HasSubstr(part));
}

/// A process of its own writes as fast as it can; it is killed at any moment, many times, and later where it had
/// written nothing yet, as on a busy machine.
TEST_F(Hdf5, AWriterThatIsKilledLeavesTheRowsUpToAFlushAndNoOthers) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> moment(20, 150);
  constexpr int kills = 12, most = 20 * kills;
  std::size_t some = 0;
  for (int kill = 0; kill < kills || (some < kills / 2 && kill < most); ++kill) {
    const pid_t writer = ::fork();
    if (writer == 0) {
      const auto file = make_hdf5_recorder(path_);
      file->begin(four_columns);
      for (std::size_t i = 0;; ++i) {
        file->row(row(i));
        if (i % 700 == 0) file->mark();
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds((1 + kill / kills) * moment(random)));
    ::kill(writer, SIGKILL);
    ::waitpid(writer, nullptr, 0);
    if (!std::filesystem::exists(path_)) continue;
    MemoryRecorder table;
    try {
      read_hdf5(path_, table);
    } catch (const ResultsError&) {
      continue;  // killed before anything was there: refused, not wrong
    }
    for (std::size_t i = 0; i < table.rows().size(); ++i) ASSERT_TRUE(same(table.rows()[i], row(i))) << i;
    some += table.rows().size() > 700 ? 1 : 0;
    std::filesystem::remove(path_);
  }
  EXPECT_GE(some, std::size_t{kills / 2}) << "kills that left rows";
}

/// Reads the file with 32 bytes turned over, 40 times, somewhere between two places. \return how often it was refused
int Hdf5::refusals(std::size_t first, std::size_t last) const {
  const std::string whole = folder_.read("results.h5");
  std::mt19937 random(3);
  std::uniform_int_distribution<std::size_t> place(first, std::min(last, whole.size() - 1));
  int refused = 0;
  for (int k = 0; k < 40; ++k) {
    std::string hurt = whole;
    const std::size_t at = place(random);
    for (std::size_t i = at; i < std::min(at + 32, hurt.size()); ++i) hurt[i] = static_cast<char>(~hurt[i]);
    folder_.write("results.h5", hurt);
    MemoryRecorder table;
    try {
      read_hdf5(path_, table);
      for (std::size_t i = 0; i < table.rows().size(); ++i) EXPECT_TRUE(same(table.rows()[i], row(i))) << i;
    } catch (const ResultsError& e) {
      EXPECT_THAT(e.what(), HasSubstr("results.h5"));
      ++refused;
    }
  }
  return refused;
}

TEST_F(Hdf5, DamageIsNoticed) {
  write(20'000);
  EXPECT_GE(refusals(0, std::string::npos), 5) << "a part of the file are texts";
}

TEST_F(Hdf5, DamageToNumbersThatAreNotCompressedIsNoticed) {
  write(300);
  std::string second(300 * sizeof(double), ' ');
  for (std::size_t i = 0; i < 300; ++i) {
    const double x = row(i)[1];
    std::memcpy(second.data() + i * sizeof x, &x, sizeof x);
  }
  const std::size_t at = folder_.read("results.h5").find(second);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(refusals(at, at + second.size() - 32), 40);
}

TEST_F(Hdf5, WhatIsNoTableOrCannotBeWrittenIsNamed) {
  folder_.write("text.h5", "no table");
  MemoryRecorder table;
  EXPECT_THROW(read_hdf5(folder_ / "text.h5", table), ResultsError);
  try {
    static_cast<void>(make_hdf5_recorder(folder_ / "no-folder/results.h5"));
    FAIL();
  } catch (const std::system_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("no-folder/results.h5"));
  }
}

}  // namespace
}  // namespace withy
