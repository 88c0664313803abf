// Parts of a cloud drawn as a host draws them, with everything that is automatic: whoever puts them together,
// the picture is one.
#include "session/part_renderer.h"

#include <algorithm>
#include <numeric>

#include "analysis/regions.h"
#include "analysis/whole.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// One half in one colour, the other in very many, so that each half alone would be shaded in another way.
PointCloud two_halves() {
  PointCloud cloud = sphere_cloud(30'000);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].x < 0) cloud.colors[i] = {200, 180, 20, 255};
  return cloud;
}

struct Part {
  PointCloud cloud;
  std::unique_ptr<PartRenderer> renderer = std::make_unique<PartRenderer>();
};

/// Every part with what all of them know.
std::vector<Part> parts_of(const PointCloud& cloud, std::size_t count,
                           const std::function<std::size_t(std::uint32_t)>& part_of) {
  std::vector<std::vector<std::uint32_t>> members(count);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) members[part_of(i)].push_back(i);
  std::vector<Part> parts(count);
  analysis::CloudFacts facts;
  for (std::size_t k = 0; k < count; ++k) {
    parts[k].cloud = select(cloud, members[k]);
    parts[k].cloud.source_index = members[k];
    merge(facts, analysis::facts_of(parts[k].cloud));
  }
  analysis::NeighborhoodFacts around = neighborhood_facts_of(parts[0].cloud, facts);
  for (std::size_t k = 1; k < count; ++k) merge(around, neighborhood_facts_of(parts[k].cloud, facts));
  const auto whole = whole_of(facts, around, cloud.origin);
  ColorSettings coloring;
  coloring.color_by = "rgb", coloring.exposure = 1;
  for (Part& part : parts) part.renderer->set_part(std::move(part.cloud), whole, coloring);
  return parts;
}

/// The same, dealt out anew.
std::vector<Part> shares_of(const PointCloud& cloud, std::size_t count,
                            const std::string& technique = "splats") {
  PointCloud all = cloud;
  all.source_index.resize(all.size());
  std::iota(all.source_index.begin(), all.source_index.end(), 0u);
  const analysis::CloudFacts facts = analysis::facts_of(all);
  const auto whole = whole_of(facts, neighborhood_facts_of(all, facts), all.origin);
  ColorSettings coloring;
  coloring.color_by = "rgb", coloring.exposure = 1;
  std::vector<Part> parts(count);
  const auto regions = analysis::regions_of(whole->sample, count);
  for (std::size_t k = 0; k < count; ++k) {
    analysis::Share share =
        analysis::share_of({analysis::points_near(all, regions[k], analysis::reach_of(*whole))}, regions[k]);
    parts[k].renderer->set_part(std::move(share.own), whole, coloring,
                                PartRenderer::Around{std::move(share.around), technique});
  }
  return parts;
}

const Camera view = front_camera(160, 120, 3);

/// Put together by the part of that number.
Pictures picture(const std::vector<Part>& parts, std::size_t by, const std::string& technique = "points",
                 const Parameters& parameters = {}) {
  VisiblePoints merged;
  for (int round = 0; round < parts[by].renderer->rounds(technique, parameters); ++round) {
    const VisiblePoints* before = round > 0 ? &merged : nullptr;
    VisiblePoints all = parts[by].renderer->visible(technique, view, parameters, before);
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (k != by) merge(all, parts[k].renderer->visible(technique, view, parameters, before));
    merged.add_round(std::move(all));
  }
  return parts[by].renderer->picture(merged, technique, view, parameters);
}

TEST(PartRenderer, ThePictureIsOneWhoeverDrawsIt) {
  const PointCloud cloud = two_halves();
  const Pictures whole = picture(parts_of(cloud, 1, [](std::uint32_t) { return 0; }), 0);
  ASSERT_GT(std::ranges::count_if(whole.color, [](const Rgba8& c) { return c.a == 255; }), 5000);
  const std::vector<Part> halves =
      parts_of(cloud, 3, [&](std::uint32_t i) { return cloud.positions[i].x < 0; });
  for (std::size_t by = 0; by < 3; ++by) {  // the last has no points
    const Pictures parts = picture(halves, by);
    EXPECT_TRUE(std::ranges::equal(parts.color, whole.color)) << by;
    EXPECT_TRUE(std::ranges::equal(parts.depth, whole.depth)) << by;
  }
}

TEST(PartRenderer, SplatsAreOnePictureWhoeverDrawsIt) {
  const PointCloud cloud = two_halves();
  HeadlessRenderer one;
  one.set_whole(true);
  ColorSettings coloring;
  coloring.color_by = "rgb", coloring.exposure = 1;
  one.set_cloud(cloud, coloring);
  const Pictures whole = one.render("splats", view, {}, std::nullopt);
  const std::vector<Part> shares = shares_of(cloud, 3);
  const std::vector<Part> alone = parts_of(cloud, 1, [](std::uint32_t) { return 0; });
  EXPECT_TRUE(alone.front().renderer->lacks("splats", {}));
  EXPECT_FALSE(alone.front().renderer->lacks("points", {}));
  for (const Part& share : shares) EXPECT_FALSE(share.renderer->lacks("splats", {}));
  const Pictures first = picture(shares, 0, "splats");
  const auto differ = [](const Rgba8& a, const Rgba8& b) {
    return std::abs(a.r - b.r) > 1 || std::abs(a.g - b.g) > 1 || std::abs(a.b - b.b) > 1;
  };
  std::size_t different = 0;
  for (std::size_t i = 0; i < first.color.size(); ++i)
    different += differ(first.color.data()[i], whole.color.data()[i]);
  EXPECT_LT(different, first.color.size() / 1000);
  ASSERT_GT(std::ranges::count_if(first.color, [](const Rgba8& c) { return c.a == 255; }), 5000);
  // Sums of other orders: their rounding may be a step.
  const Pictures last = picture(shares, 2, "splats");
  for (std::size_t i = 0; i < first.color.size(); ++i)
    EXPECT_FALSE(differ(first.color.data()[i], last.color.data()[i])) << i;
}

TEST(PartRenderer, SoftPartsAreOnePictureWhoeverDrawsIt) {
  const PointCloud cloud = two_halves();
  const Parameters parameters{{"field", "distance"}};
  HeadlessRenderer one;
  one.set_whole(true);
  ColorSettings coloring;
  coloring.color_by = "rgb", coloring.exposure = 1;
  one.set_cloud(cloud, coloring);
  const Pictures whole = one.render("soft", view, parameters, std::nullopt);
  EXPECT_TRUE(shares_of(cloud, 3).front().renderer->lacks("soft", parameters));  // who is around
  const std::vector<Part> shares = shares_of(cloud, 3, "soft");
  for (const Part& share : shares) {
    EXPECT_FALSE(share.renderer->lacks("soft", parameters));
    EXPECT_FALSE(share.renderer->lacks("splats", {}));
  }
  for (const std::size_t by : {0, 2}) {
    const Pictures parts = picture(shares, by, "soft", parameters);
    EXPECT_EQ(parts.notes, whole.notes);
    std::size_t different = 0;
    for (std::size_t i = 0; i < parts.color.size(); ++i) {
      const Rgba8 a = parts.color.data()[i], b = whole.color.data()[i];
      different += std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}) > 1;
    }
    EXPECT_LT(different, parts.color.size() / 1000) << by;
    EXPECT_GT(std::ranges::count_if(parts.color, [](const Rgba8& c) { return c.a > 0 && c.a < 250; }), 2000);
  }
}

TEST(PartRenderer, LayersAreOnePictureWhoeverDrawsIt) {
  const PointCloud cloud = two_halves();
  const std::vector<Part> one = parts_of(cloud, 1, [](std::uint32_t) { return 0; });
  const std::vector<Part> halves =
      parts_of(cloud, 3, [&](std::uint32_t i) { return cloud.positions[i].x < 0; });
  // The normals are given, and who has no points needs none.
  for (const Part& half : halves) EXPECT_FALSE(half.renderer->lacks("layers", {}));
  for (const Parameters& parameters : {Parameters{}, Parameters{{"layers", "2"}, {"opacity", "0.4"}}}) {
    EXPECT_EQ(one.front().renderer->rounds("layers", parameters), parameters.empty() ? 4 : 2);
    const Pictures whole = picture(one, 0, "layers", parameters);
    ASSERT_GT(std::ranges::count_if(whole.color, [](const Rgba8& c) { return c.a > 100; }), 5000);
    for (std::size_t by = 0; by < 3; ++by) {
      const Pictures parts = picture(halves, by, "layers", parameters);
      EXPECT_TRUE(std::ranges::equal(parts.color, whole.color)) << by;
      EXPECT_TRUE(std::ranges::equal(parts.depth, whole.depth)) << by;
    }
  }
}

TEST(PartRenderer, SaysWhatItCannotMerge) {
  const std::vector<Part> parts = parts_of(two_halves(), 1, [](std::uint32_t) { return 0; });
  PartRenderer& part = *parts.front().renderer;
  EXPECT_TRUE(part.merges("points", view, {}));
  EXPECT_FALSE(part.merges("points", view, {{"shadows", "soft"}}));
  EXPECT_FALSE(part.merges("points", view, {{"samples", "4"}}));
  EXPECT_FALSE(part.merges("strokes", view, {}));
  EXPECT_TRUE(part.merges("soft", view, {}));
  EXPECT_FALSE(part.merges("soft", view, {{"model", "one_layer"}}));
  EXPECT_FALSE(part.merges("soft", view, {{"field", "sensor"}}));
  EXPECT_NE(part.resolve("auto"), "auto");
}

}  // namespace
