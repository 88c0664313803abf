// The numbers beside a colour bar.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "labels/legend.h"

namespace sfumato::labels {
namespace {

TEST(LegendTicks, AreFourToSixRoundNumbersInEveryRange) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1000, 1000), exponent(-4, 6);
  for (int n = 0; n < 20'000; ++n) {
    const double low = place(random), high = low + std::pow(10.0, exponent(random));
    int decimals = -1;
    const std::vector<double> ticks = legend_ticks(low, high, decimals);
    ASSERT_GE(ticks.size(), 4u) << low << ".." << high;
    ASSERT_LE(ticks.size(), 6u) << low << ".." << high;
    const double slack = 1e-6 * (high - low);
    EXPECT_GE(ticks.front(), low - slack);
    EXPECT_LE(ticks.back(), high + slack);
    // As many decimals as tell them exactly, and no more than the step needs.
    const double unit = std::pow(10.0, -decimals);
    for (const double tick : ticks)
      EXPECT_NEAR(std::remainder(tick, unit), 0, 1e-5 * unit + 1e-9 * std::abs(tick));
  }
}

TEST(LegendTicks, ArePlainWhereTheyCanBe) {
  int decimals = -1;
  EXPECT_EQ(legend_ticks(0, 10, decimals), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(decimals, 0);
  EXPECT_EQ(legend_ticks(406.9, 500.3, decimals), (std::vector<double>{420, 440, 460, 480, 500}));
  EXPECT_EQ(legend_ticks(5, 5, decimals), std::vector<double>{5});
}

}  // namespace
}  // namespace sfumato::labels
