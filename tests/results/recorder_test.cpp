/// \file
/// Recorders: what they take is what they give, whole, and a table that goes on is the table it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "scratch.hpp"
#include "withy/results/csv_recorder.hpp"
#include "withy/results/results_error.hpp"

namespace withy {
namespace {

using test::Scratch;
using testing::HasSubstr;

const std::vector<Column> columns = {{"t", "s"}, {"shoulder", "rad"}, {"boom.bending_y[1]", ""}};

std::vector<double> row(int i) { return {0.1 * i, 1.0 / (i + 1), i == 2 ? std::nan("") : -1e-300 * i}; }

TEST(Recorder, CsvAndMemoryTakeTheSameTable) {
  const Scratch folder;
  CsvRecorder csv(folder / "t.csv");
  MemoryRecorder memory;
  for (Recorder* recorder : {static_cast<Recorder*>(&csv), static_cast<Recorder*>(&memory)}) {
    recorder->begin(columns);
    for (int i = 0; i < 3; ++i) recorder->row(row(i));
    EXPECT_EQ(recorder->mark().rows, 3U);
    recorder->end();
  }
  EXPECT_EQ(folder.read("t.csv"),
            "t[s],shoulder[rad],boom.bending_y.1[1]\n0,1,-0\n0.1,0.5,-1e-300\n0.2,0.3333333333333333,\n");
  EXPECT_EQ(memory.columns().size(), 3U);
  EXPECT_THAT(memory.column("shoulder"), testing::ElementsAre(1.0, 0.5, 1.0 / 3));
  EXPECT_TRUE(std::isnan(memory.rows()[2][2]));
  EXPECT_THROW(static_cast<void>(memory.column("elbow")), std::out_of_range);
}

TEST(Recorder, ATableThatGoesOnBehindAMarkIsTheWholeTable) {
  const Scratch folder;
  CsvRecorder whole(folder / "whole.csv");
  whole.begin(columns);
  for (int i = 0; i < 50; ++i) whole.row(row(i));
  whole.end();
  for (const int stop : {0, 1, 17, 49}) {
    RecordMark mark;
    {
      CsvRecorder first(folder / "t.csv");
      first.begin(columns);
      for (int i = 0; i < stop; ++i) first.row(row(i));
      mark = first.mark();
      EXPECT_EQ(first.mark().sha256, mark.sha256);
      first.row(row(7));  // after the mark: cut off
      first.end();
    }
    CsvRecorder second(folder / "t.csv", mark);
    second.begin(columns);
    for (int i = stop; i < 50; ++i) second.row(row(i));
    EXPECT_EQ(second.mark().rows, 50U);
    EXPECT_EQ(second.mark().sha256, sha256(folder.read("whole.csv")));
    second.end();
    EXPECT_EQ(folder.read("t.csv"), folder.read("whole.csv"));
  }
}

TEST(Recorder, AChangedTableIsNoticedBeforeItIsTouched) {
  const Scratch folder;
  CsvRecorder first(folder / "t.csv");
  first.begin(columns);
  for (int i = 0; i < 20; ++i) first.row(row(i));
  const RecordMark mark = first.mark();
  first.end();
  const std::string good = folder.read("t.csv");
  const auto why = [&](const std::string& bytes) {
    folder.write("t.csv", bytes);
    try {
      const CsvRecorder second(folder / "t.csv", mark);
    } catch (const ResultsError& e) {
      EXPECT_EQ(folder.read("t.csv"), bytes);
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(why(good), "");
  EXPECT_EQ(why(good + "more"), "");
  EXPECT_THAT(why(good.substr(0, good.size() - 1)), HasSubstr("is shorter than at its checkpoint"));
  for (const std::size_t at : {std::size_t{0}, good.size() / 2, good.size() - 1}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    EXPECT_THAT(why(bad), HasSubstr("is not what it was at its checkpoint")) << at;
  }
}

TEST(Recorder, WhatCannotBeWrittenIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full, a file that is always full";
  CsvRecorder csv("/dev/full");
  csv.begin(columns);
  EXPECT_THROW(csv.mark(), std::system_error);
  csv.row(row(1));
  EXPECT_THROW(csv.end(), std::system_error);
  EXPECT_THROW(CsvRecorder("/nowhere/t.csv"), std::system_error);
}

}  // namespace
}  // namespace withy
