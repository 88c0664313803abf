// Region growing, stroke sizes and normals of clusters.
#include "analysis/clusters.h"

#include "analysis/stroke_attributes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <queue>
#include <random>
#include <set>

#include "analysis/prepare.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

Clusters grow(const PointCloud& cloud, const ClusterOptions& options = {}, float spacing = 1) {
  const NeighborGraph graph(cloud.positions, options.neighbors, no_progress());
  return grow_clusters(cloud, graph, spacing, options);
}

PointCloud painted_grid(int side, const std::function<Rgba8(int x, int y)>& paint) {
  PointCloud cloud = cloud_of(square_grid(side, 1));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) cloud.colors.push_back(paint(x, y));
  return cloud;
}

TEST(Clusters, TwoPatchesAreTwoClusters) {
  const PointCloud cloud = painted_grid(30, [](int x, int) {
    return x < 12 ? Rgba8{200, 40, 40} : Rgba8{40, 40, 200};
  });
  const Clusters found = grow(cloud);
  EXPECT_EQ(found.count, 2u);
  for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_EQ(found.label[i], i % 30 < 12 ? 0u : 1u) << i;
}

TEST(Clusters, AGradientBelowTheThresholdIsOne) {
  const PointCloud cloud = painted_grid(40, [](int x, int) { return Rgba8{std::uint8_t(4 * x), 90, 90}; });
  EXPECT_EQ(grow(cloud).count, 1u);
  // The same gradient in steps of 15 a column. 1.5 columns apart is the farthest of eight neighbours; growth
  // needs steps below the threshold, and means of neighbouring columns differ by 15 as well.
  const PointCloud steep = painted_grid(16, [](int x, int) { return Rgba8{std::uint8_t(15 * x), 90, 90}; });
  ClusterOptions options;
  options.neighbors = 8;
  options.min_size = 1;
  EXPECT_EQ(grow(steep, options).count, 16u);
}

TEST(Clusters, SpecksJoinTheNearestCluster) {
  ClusterOptions options;
  options.min_size = 20;
  const PointCloud cloud = painted_grid(40, [](int x, int y) {
    if (x / 2 == 5 && y / 2 == 5) return Rgba8{255, 255, 255};  // 4 points in the left patch
    return x < 20 ? Rgba8{200, 40, 40} : Rgba8{40, 40, 200};
  });
  EXPECT_EQ(grow(cloud, options).count, 2u);
  EXPECT_EQ(grow(cloud, options).label[10 * 40 + 10], grow(cloud, options).label[0]);
  options.min_size = 4;
  EXPECT_EQ(grow(cloud, options).count, 3u);
}

TEST(Clusters, LikeSegmentsMergeOnlyWhenNear) {
  // Two red squares, a gap of 10 between them.
  PointCloud cloud = painted_grid(12, [](int, int) { return Rgba8{200, 40, 40}; });
  PointCloud other = cloud;
  for (vec3& p : other.positions) p.x += 21;
  for (Rgba8& c : other.colors) c.r += 4;
  append(cloud, other);
  ClusterOptions options;
  options.neighbors = 143;      // reaches across: every point sees the nearest of the other square
  options.point_threshold = 3;  // the squares do not grow together, but their means are alike
  options.min_size = 1;
  options.gap = 9.5f;
  EXPECT_EQ(grow(cloud, options).count, 2u);
  options.gap = 10.5f;
  EXPECT_EQ(grow(cloud, options).count, 1u);
}

/// PCL's RegionGrowingRGB as its source reads, serial, with explicit queues and full distance tables.
std::vector<int> serial_partition(const PointCloud& cloud, const ClusterOptions& options) {
  const int n = int(cloud.size());
  auto color_distance2 = [](const std::array<int, 3>& a, const std::array<int, 3>& b) {
    int sum = 0;
    for (int k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
  };
  auto color = [&](int i) {
    return std::array<int, 3>{cloud.colors[i].r, cloud.colors[i].g, cloud.colors[i].b};
  };
  auto distance2 = [&](int i, int j) {
    const vec3 d = cloud.positions[i] - cloud.positions[j];
    return glm::dot(d, d);
  };
  std::vector<int> label(n, -1);
  int segments = 0;
  for (int seed = 0; seed < n; ++seed) {
    if (label[seed] >= 0) continue;
    std::queue<int> queue({seed});
    label[seed] = segments;
    while (!queue.empty()) {
      const int at = queue.front();
      queue.pop();
      for (int j = 0; j < n; ++j)  // complete graph
        if (label[j] < 0 &&
            color_distance2(color(at), color(j)) <= options.point_threshold * options.point_threshold)
          label[j] = segments, queue.push(j);
    }
    ++segments;
  }
  std::vector<std::array<int, 3>> mean(segments, {0, 0, 0});
  std::vector<int> size(segments, 0);
  for (int i = 0; i < n; ++i) {
    ++size[label[i]];
    for (int k = 0; k < 3; ++k) mean[label[i]][k] += color(i)[k];
  }
  for (int s = 0; s < segments; ++s)
    for (int k = 0; k < 3; ++k) mean[s][k] /= size[s];
  auto apart2 = [&](int a, int b) {
    float best = 1e30f;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (label[i] == a && label[j] == b) best = std::min(best, distance2(i, j));
    return best;
  };
  std::vector<int> region(segments, -1);
  int regions = 0;
  for (int s = 0; s < segments; ++s) {
    if (region[s] < 0) region[s] = regions++;
    for (int o = 0; o < segments; ++o)
      if (o != s && region[o] < 0 && apart2(s, o) <= *options.gap * *options.gap &&
          color_distance2(mean[s], mean[o]) < options.region_threshold * options.region_threshold)
        region[o] = region[s];
  }
  for (int r = 0; r < regions; ++r) {
    int points = 0, host = -1;
    for (int s = 0; s < segments; ++s) points += region[s] == r ? size[s] : 0;
    if (points == 0 || points >= int(options.min_size)) continue;
    float best = 1e30f;
    for (int s = 0; s < segments; ++s)
      for (int o = 0; o < segments; ++o)
        if (region[s] == r && region[o] != r && apart2(s, o) < best) best = apart2(s, o), host = region[o];
    if (host < 0) continue;
    for (int s = 0; s < segments; ++s)
      if (region[s] == r) region[s] = host;
  }
  for (int& l : label) l = region[l];
  return label;
}

// With as many neighbours as points the graph is complete, hence symmetric: the partitions must be the same.
TEST(Clusters, AgreesWithSerialGrowthOnSymmetricGraphs) {
  std::set<std::uint32_t> counts;
  for (unsigned seed = 0; seed < 40; ++seed) {
    PointCloud cloud = cloud_of(uniform_cube(30, seed + 50));
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud.colors.push_back(
          {std::uint8_t(random() % 30), std::uint8_t(random() % 30), std::uint8_t(100 * (random() % 2))});
    ClusterOptions options;
    options.gap = 0.3f;
    options.min_size = seed % 6;
    const Clusters found = grow(cloud, options);
    const std::vector<int> expected = serial_partition(cloud, options);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_EQ(found.label[i] == found.label[j], expected[i] == expected[j])
            << seed << ": " << i << "," << j;
    counts.insert(found.count);
  }
  EXPECT_GT(counts.size(), 5u);  // the fixtures differ
}

// On a grid every neighbourhood ends in a tie, colours waver about the threshold, and some places hold two
// points.
TEST(Clusters, TheOrderOfTheFileDoesNotMatter) {
  std::mt19937 random(5);
  PointCloud cloud = painted_grid(60, [&](int x, int y) {
    return Rgba8{std::uint8_t(40 * (x / 17) + random() % 9), std::uint8_t(30 * (y / 19)), 0};
  });
  const PointCloud once = cloud;
  for (std::size_t i = 0; i < once.size(); i += 7) {
    cloud.positions.push_back(once.positions[i]);
    cloud.colors.push_back(
        {std::uint8_t(once.colors[i].r + 11), once.colors[i].g, std::uint8_t(random() % 8)});
  }
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  PointCloud shuffled = select(cloud, order);
  shuffled.source_index.clear();  // a file of its own
  auto prepared = [&](const PointCloud& c) { return prepare(c, Attribute::cluster | Attribute::normal, {}); };
  const PreparedCloud a = prepared(cloud), b = prepared(shuffled);
  std::vector<std::uint32_t> place_in_b(cloud.size());
  for (std::uint32_t i = 0; i < cloud.size(); ++i) place_in_b[order[b.cloud.source_index[i]]] = i;
  std::set<float> labels;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t j = place_in_b[a.cloud.source_index[i]];
    ASSERT_EQ(a.cloud.colors[i], b.cloud.colors[j]);
    ASSERT_EQ(a.cloud.normals[i], b.cloud.normals[j]);
    for (const char* name : {"cluster", "stroke_size", "stroke_room", "stroke_detail", "stroke_axis"})
      ASSERT_EQ(a.cloud.scalar(name)->values[i], b.cloud.scalar(name)->values[j]) << name << " " << i;
    labels.insert(a.cloud.scalar("cluster")->values[i]);
  }
  EXPECT_GE(labels.size(), 4u);
}

TEST(Clusters, WithoutColoursFacesOfABoxAreClusters) {
  PointCloud cloud;
  for (int y = 0; y < 25; ++y)
    for (int x = 0; x < 25; ++x) {
      cloud.positions.push_back({x, y, 0});
      cloud.positions.push_back({x, 0, y + 1});
      cloud.positions.push_back({0, x + 1, y + 1});
    }
  const Clusters found = grow(cloud);
  // Away from the edges, where neighbourhoods bend, each face has one label of its own.
  std::set<std::uint32_t> labels[3];
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (cloud.positions[i][k] == 0 && cloud.positions[i][(k + 1) % 3] > 6 &&
          cloud.positions[i][(k + 2) % 3] > 6)
        labels[k].insert(found.label[i]);
  for (const auto& face : labels) EXPECT_EQ(face.size(), 1u);
  EXPECT_NE(labels[0], labels[1]);
  EXPECT_NE(labels[1], labels[2]);
  EXPECT_NE(labels[0], labels[2]);
  EXPECT_LE(found.count, 6u);  // the three edges may stay apart
}

TEST(StrokeSize, OnASquareGridIsTheSpacing) {
  // Four nearest of a grid point: all at h.
  std::vector<float> distances{0.5f, 0.5f, 0.7071f, 0.5f, 0.7071f, 0.5f, 1, 1};
  EXPECT_FLOAT_EQ(stroke_size(distances, 4), 0.5f);
  std::vector<float> none;
  EXPECT_EQ(stroke_size(none, 4), 0);
  // r = 2, eps = 1.
  std::vector<float> uneven{1, 3};
  EXPECT_FLOAT_EQ(stroke_size(uneven, 4), 3);
}

TEST(Clusters, PrepareAddsClustersSizesAndNormals) {
  // A red floor and a blue wall: at the edge each point's normal is that of its own colour.
  PointCloud cloud;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      cloud.positions.push_back({x, y, 0});
      cloud.colors.push_back({200, 30, 30});
      cloud.positions.push_back({x, 0, y + 0.5f});
      cloud.colors.push_back({30, 30, 200});
    }
  const PreparedCloud prepared = prepare(cloud, Attribute::cluster | Attribute::normal, {});
  EXPECT_TRUE(prepared.available.has(Attribute::cluster));
  EXPECT_TRUE(prepared.available.has(Attribute::normal));
  const PointCloud& out = prepared.cloud;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const vec3 expected = out.colors[i].r > 100 ? vec3(0, 0, 1) : vec3(0, 1, 0);
    ASSERT_GT(std::abs(glm::dot(out.normals[i], expected)), 0.999f) << glm::length(out.positions[i]);
    ASSERT_GT(out.scalar("stroke_size")->values[i], 0.8f);
    ASSERT_EQ(out.scalar("cluster")->values[i] == out.scalar("cluster")->values[0],
              out.colors[i] == out.colors[0]);
  }
}

TEST(Clusters, SurvivesDifficultClouds) {
  for (std::vector<vec3> points :
       {std::vector<vec3>{}, {vec3(1)}, std::vector<vec3>(40, vec3(2)), difficult_cloud()}) {
    const PreparedCloud prepared = prepare(cloud_of(points), Attribute::cluster, {});
    EXPECT_TRUE(prepared.available.has(Attribute::cluster));
    if (points.empty()) continue;
    for (float s : prepared.cloud.scalar("stroke_size")->values) ASSERT_TRUE(s > 0 && std::isfinite(s));
  }
}

}  // namespace
