/// \file
/// Recorders: what they take is what they give, whole, and a table that goes on is the table it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "scratch.hpp"
#include "withy/results/csv_recorder.hpp"
#include "withy/results/number_text.hpp"
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

std::string written(double number) {
  std::array<char, room_of_number> text{};
  return {text.data(), write_number(text.data(), number)};
}

/// What the standard library writes, which takes three times as long.
std::string standard(double number) {
  const double size = std::abs(number);
  const bool fixed = size == 0 || (size >= 1e-4 && size < 1e16);
  std::array<char, 64> text{};
  const auto format = fixed ? std::chars_format::fixed : std::chars_format::scientific;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number, format).ptr};
}

TEST(NumberText, IsTheShortestThatReadsBack) {
  for (const double number : {0.0,
                              -0.0,
                              1.0,
                              -1.0,
                              10.0,
                              0.1,
                              9.995,
                              0.001,
                              1e-4,
                              9.999999999999999e-05,
                              1e15,
                              1e16,
                              9999999999999998.0,
                              123456789012345.0,
                              1234567890123456.0,
                              5e-324,
                              1.7976931348623157e308,
                              -2.2250738585072014e-308,
                              1e100,
                              1.5e-100,
                              1e22,
                              1e23}) {
    EXPECT_EQ(written(number), standard(number));
  }
  EXPECT_EQ(written(-1.2345678901234567e-308).size(), longest_number);
  std::mt19937_64 generator(1);
  std::uniform_int_distribution<int> powers(-90, 10);
  for (int i = 0; i < 200000; ++i) {
    const double any = std::bit_cast<double>(generator());
    if (std::isfinite(any)) {
      ASSERT_EQ(written(any), standard(any));
    }
    const double usual = std::ldexp(static_cast<double>(static_cast<std::int64_t>(generator())), powers(generator));
    ASSERT_EQ(written(usual), standard(usual));
    const double short_one = static_cast<double>(i) / std::pow(10, i % 23);
    ASSERT_EQ(written(short_one), standard(short_one));
  }
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
