#include "io/chunk_cache.h"

#include <gtest/gtest.h>

#include <thread>

namespace sfumato::io {
namespace {

std::vector<std::uint8_t> records(std::size_t size, std::uint8_t value) { return std::vector(size, value); }

TEST(ChunkCache, WhatWasAskedForLongestAgoMakesRoom) {
  ChunkCache cache(100);
  cache.keep({1, 10}, records(40, 1));
  cache.keep({1, 20}, records(40, 2));
  cache.begin_read();
  ASSERT_TRUE(cache.find({1, 10}));
  cache.keep({1, 30}, records(40, 3));
  EXPECT_FALSE(cache.find({1, 20}));
  ASSERT_TRUE(cache.find({1, 10}));
  EXPECT_EQ(cache.find({1, 10})->at(39), 1);
  EXPECT_EQ(cache.find({1, 30})->at(0), 3);
  EXPECT_EQ(cache.bytes(), 80u);
  cache.keep({1, 40}, records(101, 4));  // more than all the room
  EXPECT_FALSE(cache.find({1, 40}));
  EXPECT_EQ(cache.bytes(), 80u);
  cache.keep({1, 10}, records(40, 9));  // is there already
  EXPECT_EQ(cache.find({1, 10})->at(0), 1);
  EXPECT_EQ(cache.bytes(), 80u);
}

TEST(ChunkCache, AReadDoesNotPushOutItsOwnFirstChunks) {
  ChunkCache cache(100);
  for (int view = 0; view < 3; ++view) {
    cache.begin_read();
    for (std::uint64_t n = 0; n < 10; ++n) {
      const bool is_there = cache.find({0, n}) != nullptr;
      EXPECT_EQ(is_there, view > 0 && n < 5) << "chunk " << n << " of view " << view;
      if (!is_there) cache.keep({0, n}, records(20, 1));
    }
  }
  cache.begin_read();
  cache.keep({0, 20}, records(60, 1));  // of another place: room for what longest was not asked for
  EXPECT_TRUE(cache.find({0, 20}));
  EXPECT_EQ(cache.bytes(), 100u);
}

TEST(ChunkCache, RecordsLastAsLongAsSomebodyHasThem) {
  ChunkCache cache(10);
  cache.keep({0, 1}, records(10, 7));
  const ChunkCache::Records mine = cache.find({0, 1});
  cache.begin_read();
  cache.keep({0, 2}, records(10, 8));
  EXPECT_FALSE(cache.find({0, 1}));
  EXPECT_EQ(mine->at(9), 7);
}

TEST(ChunkCache, SeveralThreadsMayUseIt) {
  ChunkCache cache(5000);
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (std::uint64_t i = 0; i < 2000; ++i) {
        const ChunkCache::Key key{i % 3, (i * 7 + t) % 60};
        if (const auto found = cache.find(key))
          EXPECT_EQ(found->front(), std::uint8_t(key.byte));
        else
          cache.keep(key, records(50 + key.byte, std::uint8_t(key.byte)));
        if (i % 100 == 0) cache.begin_read();
      }
    });
  for (std::thread& each : threads) each.join();
  EXPECT_LE(cache.bytes(), 5000u);
}

}  // namespace
}  // namespace sfumato::io
