// All searches of these tests share out a time that counts evaluations: what they find is the same on any machine,
// busy or not.
#include "counted_time.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <thread>

#include "plugins.hpp"
#include "scenes.hpp"
#include "withy/study/walk.hpp"

namespace withy::study {
namespace {

class InPlaceOfTheProcessors final : public testing::Environment {
 public:
  void SetUp() override { in_place_.emplace(time_); }
  void TearDown() override { in_place_.reset(); }

 private:
  test::CountedTime time_;
  std::optional<SearchTimeInPlace> in_place_;
};

const testing::Environment* const counted = testing::AddGlobalTestEnvironment(new InPlaceOfTheProcessors);

TEST(SearchTime, IsWhatStepsHaveEvaluated) {
  const Prepared slew = prepare(short_slew(), test::plugins());
  const double began = search_time().now();
  const Walk w = walk(slew, *slew.scene.integrator, {[](const State&) { return true; }, {}, {}});
  EXPECT_GT(w.evaluations, 100U);
  const double expected = static_cast<double>(w.evaluations) * search_time().of_evaluation(slew);
  constexpr double rounding = 1e-12;  // of sums of hundreds of steps
  EXPECT_NEAR(w.seconds, expected, rounding * (began + expected));
  EXPECT_NEAR(search_time().now() - began, expected, rounding * (began + expected));
}

TEST(SearchTime, IsTheProcessorsAgainWhereNoOtherIsInPlace) {
  class Still final : public SearchTime {
    [[nodiscard]] double now() const override { return 7; }
    [[nodiscard]] double of_evaluation(const Prepared& /*model*/) const override { return 0; }
    void evaluated(const Prepared& /*model*/, std::size_t /*count*/) override {}
  } still;
  SearchTime* const before = &search_time();
  {
    const SearchTimeInPlace in_place(still);
    EXPECT_EQ(search_time().now(), 7);
  }
  EXPECT_EQ(&search_time(), before);
  double other = 7;
  std::thread([&] { other = search_time().now(); }).join();
  EXPECT_LT(other, 1) << "another thread has its own";
}

}  // namespace
}  // namespace withy::study
