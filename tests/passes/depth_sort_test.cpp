// Prefix sums and the depth sort against the standard library.
#include "passes/depth_sort.h"

#include <algorithm>
#include <numeric>

#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class DepthSorting : public GlTest {
 protected:
  void SetUp() override {
    context();
    GlTest::SetUp();
  }
};

std::vector<std::uint32_t> random_words(std::size_t count, std::uint32_t most, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint32_t> words(count);
  for (std::uint32_t& word : words) word = std::uniform_int_distribution<std::uint32_t>(0, most)(random);
  return words;
}

TEST_F(DepthSorting, PrefixSumIsThatOfTheStandardLibrary) {
  PrefixSum sum;
  // Around the sizes of a block (2048) and of a round over the blocks (256 x 2048).
  for (std::uint32_t count : {1u, 2047u, 2048u, 2049u, 524288u, 600001u}) {
    const std::vector<std::uint32_t> words = random_words(count, 50, count);
    std::vector<std::uint32_t> expected(count), actual(count);
    std::exclusive_scan(words.begin(), words.end(), expected.begin(), 0u);
    gl::Buffer buffer("words", count * 4, words.data());
    sum.run(buffer, count);
    buffer.download(actual.data(), count * 4);
    ASSERT_EQ(actual, expected) << count;
    EXPECT_EQ(sum.total(), expected.back() + words.back());
  }
}

TEST_F(DepthSorting, PrefixSumBeyond32BitsIsSeen) {
  const std::vector<std::uint32_t> words(5000, 0x00fffff0u);
  gl::Buffer buffer("words", words.size() * 4, words.data());
  PrefixSum sum;
  sum.run(buffer, 5000);
  EXPECT_EQ(sum.total(), 0xffffffffu);
}

TEST_F(DepthSorting, OrderIsThatOfAStableSort) {
  // Few values, so that ties matter; depths of a view; keys of all 32 bits.
  for (auto [least, most] : {std::pair{0u, 7u}, {0x40000000u, 0x40ffffffu}, {0u, 0xfffffffeu}})
    for (std::uint32_t count : {1u, 100u, 10000u}) {
      std::vector<std::uint32_t> keys = random_words(count, most - least, count), initial(count);
      for (std::uint32_t& key : keys) key += least;
      std::iota(initial.begin(), initial.end(), 0u);
      std::shuffle(initial.begin(), initial.end(), std::mt19937(3));
      std::vector<std::uint32_t> expected = initial;
      std::stable_sort(expected.begin(), expected.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
      const gl::Buffer buffer("keys", count * 4, keys.data());
      for (gl::Place place : {gl::Place::cpu, gl::Place::gpu}) {
        DepthSort sort;
        sort.run(buffer, count, initial, true, place);
        std::vector<std::uint32_t> order(count);
        sort.order().buffer().download(order.data(), count * 4);
        ASSERT_EQ(sort.drawn(), count);
        ASSERT_EQ(order, expected) << count << " keys up to " << most;
      }
    }
}

TEST(RadixOrder, LeavesOutWhatHasNoKey) {
  EXPECT_EQ(radix_order(std::vector<std::uint32_t>{5, no_depth_key, 3, no_depth_key, 4}, {}),
            (std::vector<std::uint32_t>{2, 4, 0}));
  EXPECT_TRUE(radix_order({}, {}).empty());
}

}  // namespace
