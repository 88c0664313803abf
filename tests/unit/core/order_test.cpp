#include "core/order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <span>
#include <vector>

namespace sfumato {
namespace {

TEST(Order, ValuesStandWhereSortingPutsThem) {
  std::mt19937 random(1);
  for (std::size_t n : {1u, 2u, 3u, 10u, 1001u}) {
    std::vector<int> values(n);
    for (int& value : values) value = int(random() % 50);
    std::vector<int> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t place = 0; place < n; place += 1 + n / 7)
      EXPECT_EQ(nth_value(values, place), sorted[place]);
    EXPECT_EQ(median(values), sorted[n / 2]);
    EXPECT_EQ(value_at_share(values, 0), sorted[0]);
    EXPECT_EQ(value_at_share(values, 1), sorted[n - 1]);
    std::sort(values.begin(), values.end());
    EXPECT_EQ(values, sorted);  // none is lost
  }
  EXPECT_EQ(median(std::vector<double>{3, 1, 2}), 2);
  std::array<float, 4> four{4, 1, 3, 2};
  EXPECT_EQ(median(std::span(four.data(), 2)), 4);  // of two the upper; the others stay
  EXPECT_EQ(four[2], 3);
}

}  // namespace
}  // namespace sfumato
