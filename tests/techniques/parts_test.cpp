// Pictures of a cloud that lies in parts: each part is drawn by itself, what its pixels show is merged, and
// what looks at more than one pixel follows.
#include <algorithm>
#include <map>
#include <numeric>

#include "analysis/attributes.h"
#include "analysis/prepare.h"
#include "analysis/quantiles.h"
#include "analysis/regions.h"
#include "analysis/spacing.h"
#include "analysis/survey.h"
#include "analysis/whole.h"
#include "passes/view.h"
#include "reference/gl_fixture.h"
#include "techniques/soft/haze_depth.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// A sphere in front of a sheet whose points lie on a grid, with points of equal depth and several in one
/// place, and a few strays.
PointCloud scene(bool with_normals) {
  PointCloud cloud = sphere_cloud(20'000, 0.6f);
  for (int i = 0; i < 120; ++i)
    for (int k = 0; k < 120; ++k) {
      cloud.positions.push_back({float(i - 60) / 40, 1, float(k - 60) / 40});
      cloud.normals.push_back({0, -1, 0});
      cloud.colors.push_back({std::uint8_t(2 * i), std::uint8_t(2 * k), 90, 255});
    }
  for (int i = 0; i < 300; ++i) {
    cloud.positions.push_back(cloud.positions[std::size_t(40 * i)]);
    cloud.normals.push_back(-cloud.normals[std::size_t(40 * i)]);
    cloud.colors.push_back({std::uint8_t(i), 255, 0, 255});
  }
  for (int i = 0; i < 20; ++i) {
    cloud.positions.push_back({float(i) - 10, 3, 4});
    cloud.normals.push_back({0, 0, 1});
    cloud.colors.push_back({255, 0, 0, 255});
  }
  cloud.origin = {5e5, 4e6, 100};
  if (!with_normals) cloud.normals.clear();
  return cloud;
}

Camera camera_of_scene() {
  Camera camera = front_camera(200, 150, 3.2);
  camera.position += dvec3(5e5, 4e6, 100), camera.target += dvec3(5e5, 4e6, 100);
  return camera;
}

/// Places in the whole, ascending.
using Members = std::vector<std::vector<std::uint32_t>>;

/// Which part has point i.
Members split(const PointCloud& cloud, std::size_t parts,
              const std::function<std::size_t(std::uint32_t)>& of) {
  Members members(parts);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) members[of(i)].push_back(i);
  return members;
}

struct Parts {
  std::vector<PointCloud> clouds;
  std::shared_ptr<const WholeCloud> whole;
};

std::vector<PointCloud> parts_of(const PointCloud& cloud, const Members& members) {
  std::vector<PointCloud> parts;
  for (const auto& each : members) {
    parts.push_back(select(cloud, each));
    parts.back().source_index.clear();
  }
  return parts;
}

Parts cut(const PointCloud& cloud, const Members& members) {
  Parts parts{parts_of(cloud, members), nullptr};
  analysis::CloudFacts facts;
  for (const PointCloud& part : parts.clouds) merge(facts, analysis::facts_of(part));
  analysis::NeighborhoodFacts around = neighborhood_facts_of(parts.clouds.front(), facts);
  for (std::size_t k = 1; k < parts.clouds.size(); ++k)
    merge(around, neighborhood_facts_of(parts.clouds[k], facts));
  parts.whole = whole_of(facts, around, cloud.origin);
  return parts;
}

class PartsTest : public GlTest {
 protected:
  PartsTest() {
    settings_.transparent = true;
    // As by default: what relief leaves out goes by spacing and noise of the whole.
    settings_.ambient_occlusion.user = 1.0f, settings_.radiance_scaling.user = 0.25f;
  }

  /// Facts of the whole are measured at some places, those of a cloud of its own at all.
  void leave_out_relief() { settings_.ambient_occlusion.user = settings_.radiance_scaling.user = 0.0f; }

  /// `whole` null: a cloud of its own.
  PreparedCloud prepare(PointCloud part, std::shared_ptr<const WholeCloud> whole) {
    auto [prepared, tree] = analysis::sort_cloud(std::move(part), {}, no_progress(), whole);
    analysis::complete(prepared, technique()->needs(), {}, tree.get(), no_progress());
    return std::move(prepared);
  }
  void show(const PreparedCloud& part) { renderer_.set_cloud(part, colors_of(part.cloud), 3000); }
  void show_part(PointCloud part, std::shared_ptr<const WholeCloud> whole) {
    show(prepare(std::move(part), std::move(whole)));
  }

  /// Round by round. `numbers`: in the whole; empty: those that the points have.
  RenderOutput drawn(const std::vector<PreparedCloud>& parts, const Members& numbers = {}) {
    VisiblePoints merged;
    for (int round = 0; round < technique()->rounds(); ++round) {
      std::vector<VisiblePoints> visible;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        show(parts[k]);
        visible.push_back(
            renderer_.visible(*technique(k), camera_of_scene(), settings_, round > 0 ? &merged : nullptr));
        for (std::uint32_t& number : visible.back().number)
          if (!numbers.empty() && number != VisiblePoints::nothing) number = numbers[k][number];
      }
      for (std::size_t k = 0; k + 1 < visible.size(); ++k) merge(visible.back(), visible[k]);
      merged.add_round(std::move(visible.back()));
    }
    // Whoever goes on, even if there are no points there.
    return renderer_.render_merged(merged, *technique(), camera_of_scene(), settings_, all_outputs());
  }

  /// Dealt out anew, in as many shares.
  RenderOutput by_shares(const PointCloud& cloud, const Members& members, bool know_the_whole = true) {
    return drawn(shares_of(cloud, members, know_the_whole));
  }
  std::vector<PreparedCloud> shares_of(const PointCloud& cloud, const Members& members,
                                       bool know_the_whole = true) {
    Parts parts = cut(cloud, members);
    for (std::size_t k = 0; k < members.size(); ++k) parts.clouds[k].source_index = members[k];
    std::vector<PreparedCloud> shares;
    for (const Bounds& region : analysis::regions_of(parts.whole->sample, members.size())) {
      std::vector<PointCloud> sent;
      for (const PointCloud& part : parts.clouds)
        sent.push_back(analysis::points_near(part, region, analysis::reach_of(*parts.whole)));
      analysis::Share share = analysis::share_of(sent, region);
      shares.push_back(analysis::prepare_part(std::move(share.own), share.around, technique()->needs(), {},
                                              no_progress(), know_the_whole ? parts.whole : nullptr));
    }
    return shares;
  }

  RenderOutput by_parts(const Parts& parts, const Members& members) {
    std::vector<PreparedCloud> all;
    for (const PointCloud& part : parts.clouds) all.push_back(prepare(part, parts.whole));
    return drawn(all, members);
  }

  RenderOutput drawn_alone(const std::vector<PreparedCloud>& parts, int in_round);

  /// What all splits of the cloud show, that of one part first.
  RenderOutput same_of_splits(const PointCloud& cloud);

  RenderOutput at_once(const PointCloud& cloud, std::shared_ptr<const WholeCloud> whole = nullptr) {
    show_part(cloud, whole);
    return renderer_.render(*technique(), camera_of_scene(), settings_, all_outputs());
  }

  /// Each part has its own, as processes do; the first draws the picture.
  Technique* technique(std::size_t part = 0) {
    std::unique_ptr<Technique>& technique = techniques_[{name_, parameters_, part}];
    if (!technique) {
      technique = find_technique(name_).create();
      for (const auto& [name, value] : parameters_) set_parameter(*technique, name, value);
    }
    return technique.get();
  }

  std::string name_ = "points";
  std::map<std::string, std::string> parameters_;
  RenderSettings settings_;

 private:
  using Key = std::tuple<std::string, std::map<std::string, std::string>, std::size_t>;
  std::map<Key, std::unique_ptr<Technique>> techniques_;

 protected:
  Renderer renderer_{context()};
};

void expect_equal(const RenderOutput& a, const RenderOutput& b, const std::string& what) {
  EXPECT_TRUE(std::ranges::equal(a.rgba8, b.rgba8)) << what;
  EXPECT_TRUE(std::ranges::equal(a.color_linear, b.color_linear)) << what;
  EXPECT_TRUE(std::ranges::equal(a.depth, b.depth)) << what;
  EXPECT_TRUE(std::ranges::equal(a.normal, b.normal)) << what;
}

void expect_same(const RenderOutput& a, const RenderOutput& b, const std::string& what) {
  expect_equal(a, b, what);
  std::size_t shown = 0;
  for (const float depth : a.depth) shown += std::isfinite(depth);
  EXPECT_GT(shown, a.depth.size() / 3) << what;
}

/// By tile, slab, turn and chance; one without points, one with a few.
std::vector<std::pair<std::string, Members>> splits(const PointCloud& cloud) {
  std::mt19937 random(3);
  std::vector<std::pair<std::string, Members>> all;
  const auto add = [&](const std::string& name, std::size_t parts, const auto& of) {
    all.emplace_back(name, split(cloud, parts, of));
  };
  const auto slab = [&](std::uint32_t i, int axis) {
    return std::size_t(std::clamp(2 + std::floor(cloud.positions[i][axis] / 0.3f), 0.0f, 3.0f));
  };
  add("one", 1, [](std::uint32_t) { return 0; });
  add("tiles", 4, [&](std::uint32_t i) { return slab(i, 0); });
  add("slabs", 4, [&](std::uint32_t i) { return slab(i, 2); });
  add("in turns", 2, [](std::uint32_t i) { return i % 2; });
  add("by chance", 4, [&](std::uint32_t) { return random() % 4; });
  add("the last without points", 3, [](std::uint32_t i) { return i % 2; });
  add("the first with few", 2, [](std::uint32_t i) { return i >= 100; });
  return all;
}

RenderOutput PartsTest::same_of_splits(const PointCloud& cloud) {
  std::optional<RenderOutput> of_one;
  for (const auto& [name, members] : splits(cloud)) {
    const RenderOutput parts = by_parts(cut(cloud, members), members);
    if (!of_one) of_one = parts;
    expect_same(parts, *of_one, name);
  }
  return *of_one;
}

TEST_F(PartsTest, PointsOfASizeAreThoseOfThePictureAtOnce) {
  leave_out_relief();
  for (const bool with_normals : {true, false}) {
    const PointCloud cloud = scene(with_normals);
    const auto of_all = cut(cloud, splits(cloud).front().second).whole;
    for (const auto& [mode, size] : {std::pair("pixels", "1"), {"pixels", "5"}, {"world", "0.03"}}) {
      parameters_ = {{"size_mode", mode}, {"point_size", size}};
      const RenderOutput whole = at_once(cloud);
      for (const auto& [name, members] : splits(cloud))
        expect_same(by_parts({parts_of(cloud, members), of_all}, members), whole, name + ", " + mode);
    }
  }
}

TEST_F(PartsTest, AdaptivePointsAreThoseOfThePictureAtOnce) {
  leave_out_relief();
  for (const bool with_normals : {true, false}) {
    const PointCloud cloud = scene(with_normals);
    const RenderOutput whole = at_once(cloud);
    for (const auto& [name, members] : splits(cloud))
      expect_same(by_parts(cut(cloud, members), members), whole, name);
  }
}

TEST_F(PartsTest, NoPartDecidesAlone) {
  const PointCloud cloud = scene(true);
  // As wrong as it should be where each part measures itself: the strays have another spacing than the rest.
  const Members members = split(cloud, 2, [&](std::uint32_t i) { return i + 20 < cloud.size(); });
  const RenderOutput whole = at_once(cloud, cut(cloud, members).whole);
  show_part(select(cloud, members[0]), nullptr);
  VisiblePoints visible = renderer_.visible(*technique(), camera_of_scene(), settings_);
  show_part(select(cloud, members[1]), nullptr);
  merge(visible, renderer_.visible(*technique(), camera_of_scene(), settings_));
  const RenderOutput alone =
      renderer_.render_merged(visible, *technique(), camera_of_scene(), settings_, all_outputs());
  EXPECT_FALSE(std::ranges::equal(alone.rgba8, whole.rgba8));
}

TEST_F(PartsTest, EveryShadingIsThatOfTheWhole) {
  const PointCloud cloud = scene(true);
  const Members members = split(cloud, 3, [](std::uint32_t i) { return i % 3; });
  const Parts parts = cut(cloud, members);
  for (const Shading shading : {Shading::albedo, Shading::normals, Shading::depth}) {
    settings_.shading = shading;
    expect_same(by_parts(parts, members), at_once(cloud, parts.whole), std::to_string(int(shading)));
  }
}

/// Share of the pixels that differ by more than so many of 255 steps.
double differing(const RenderOutput& a, const RenderOutput& b, int steps) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.rgba8.size(); ++i) {
    const Rgba8 p = a.rgba8.data()[i], q = b.rgba8.data()[i];
    count += std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b), std::abs(p.a - q.a)}) >
             steps;
  }
  return double(count) / double(a.rgba8.size());
}

/// What one process measures at all points (the median radius, which points of the curve tell clutter) many
/// measure at places or on their own stretch of the curve: here .03 % of the pixels differ, .02 % by more
/// than one step, none by more than eight.
void expect_alike(const RenderOutput& a, const RenderOutput& b, const std::string& what) {
  EXPECT_LT(differing(a, b, 1), 5e-4) << what;
  EXPECT_EQ(differing(a, b, 12), 0) << what;
  std::size_t shown = 0;
  for (const float depth : b.depth) shown += std::isfinite(depth);
  EXPECT_GT(shown, b.depth.size() / 3) << what;
}

TEST_F(PartsTest, SplatsAreLikeThoseOfThePictureAtOnce) {
  name_ = "splats";
  const PointCloud cloud = scene(false);
  const RenderOutput whole = at_once(cloud);
  std::map<std::size_t, RenderOutput> of_so_many;
  for (const auto& [name, members] : splits(cloud)) {
    const RenderOutput parts = by_shares(cloud, members);
    expect_alike(parts, whole, name);
    // However points were spread.
    const auto [first, is_first] = of_so_many.try_emplace(members.size(), parts);
    if (!is_first) expect_same(parts, first->second, name);
  }
}

TEST_F(PartsTest, SplatsOfEveryKindAreLikeThoseOfThePictureAtOnce) {
  name_ = "splats";
  const PointCloud cloud = scene(true);
  const Members members = split(cloud, 3, [](std::uint32_t i) { return i % 3; });
  for (const auto& [parameter, value] : {std::pair("kernel", "gaussian"),
                                         {"blend", "opaque"},
                                         {"clamp_radius", "false"},
                                         {"radius_scale", "3"},
                                         {"epsilon", "0.1"}}) {
    parameters_ = {{parameter, value}};
    expect_alike(by_shares(cloud, members), at_once(cloud), parameter);
  }
}

/// A wall before another one, with outliers around both.
PointCloud walls(float noise, int outliers = 600) {
  PointCloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-1.5f, 1.5f);
  std::normal_distribution<float> off(0, noise);
  const auto add = [&](const vec3& place, const Rgba8& color) {
    cloud.positions.push_back(place), cloud.colors.push_back(color);
  };
  for (int i = 0; i < 12'000; ++i) {
    const vec3 place(any(random), 0.6f + off(random), any(random));
    add(place, {std::uint8_t(150 + 40 * place.x), 120, 60, 255});
  }
  for (int i = 0; i < 8'000; ++i) {
    const vec3 place(0.5f * any(random), off(random), 0.5f * any(random));
    add(place, {60, 90, std::uint8_t(150 + 80 * place.z), 255});
  }
  for (int i = 0; i < outliers; ++i)
    add({any(random), -0.1f + 0.3f * any(random), any(random)}, {255, 0, 0, 255});
  cloud.origin = {5e5, 4e6, 100};
  return cloud;
}

TEST_F(PartsTest, DenoisedPartsAreOnePictureLikeThatAtOnce) {
  name_ = "denoise";
  // Normals of noise are averaged over groups of points that follow each other on the curve, which in a share
  // are others: as good, by 2 to 3 degrees different. Of the pixels 14 to 20 % differ by more than one step,
  // .1 to .2 % by more than 24. Without noise .05 to .13 % do by more than one, .02 % by more than 24.
  for (const auto& [noise, by_one, by_many] : {std::tuple(0.01f, 0.3, 4e-3), {0.001f, 2.5e-3, 5e-4}}) {
    const PointCloud cloud = walls(noise);
    const RenderOutput whole = at_once(cloud);
    EXPECT_NEAR(double(whole.outliers), 570, 20);
    std::map<std::size_t, RenderOutput> of_so_many;
    for (const auto& [name, members] : splits(cloud)) {
      const RenderOutput parts = by_shares(cloud, members);
      EXPECT_LT(differing(parts, whole, 1), by_one) << name;
      EXPECT_LT(differing(parts, whole, 24), by_many) << name;
      EXPECT_EQ(parts.outliers, whole.outliers) << name;
      ASSERT_EQ(parts.notes.size(), 1u);
      EXPECT_EQ(parts.notes, whole.notes);
      const auto [first, is_first] = of_so_many.try_emplace(members.size(), parts);
      if (!is_first) expect_same(parts, first->second, name);
    }
  }
}

TEST_F(PartsTest, DenoisedPartsOfEveryKindAreLikeThatAtOnce) {
  name_ = "denoise";
  const auto compare = [&](const PointCloud& cloud, const char* parameter, const char* value) {
    parameters_ = {{"bin_size", "0.06"}, {parameter, value}};
    const Members members = split(cloud, 3, [](std::uint32_t i) { return i % 3; });
    EXPECT_LT(differing(by_shares(cloud, members), at_once(cloud), 1), 1.5e-3) << parameter << value;
  };
  const PointCloud cloud = walls(0.001f), clean = walls(0.001f, 0);
  for (const auto& [parameter, value] : {std::pair("bin_size", "0.1"),
                                         {"bins", "dense"},
                                         {"hash_bits", "1"},
                                         {"overlapping", "true"},
                                         {"anchor", "grid"},
                                         {"clamp_radius", "false"}})
    compare(cloud, parameter, value);
  // Outliers that are drawn have normals like noise: without them.
  for (const auto& [parameter, value] :
       {std::pair("miss", "last_bin"), {"prefilter", "false"}, {"weight_threshold", "0.5"}})
    compare(clean, parameter, value);
}

TEST_F(PartsTest, NoShareTellsOutliersAlone) {
  name_ = "denoise";
  // A wall, and points anywhere beside it, which have nearly a share of their own.
  PointCloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(0, 1);
  for (int i = 0; i < 10'000; ++i) {
    const vec3 place(any(random), any(random), any(random));
    cloud.positions.push_back(i < 6000 ? vec3(-place.x, 0, place.z) : 3.0f * place);
    cloud.colors.push_back({200, 100, 50, 255});
  }
  cloud.origin = {5e5, 4e6, 100};
  const Members members = split(cloud, 2, [](std::uint32_t i) { return i % 2; });
  parameters_ = {{"clamp_radius", "false"}};  // whoever does not know the whole asks for other evidence
  const std::uint64_t at_once = this->at_once(cloud).outliers;
  EXPECT_GT(at_once, 2000u);
  EXPECT_NEAR(double(by_shares(cloud, members).outliers), double(at_once), 0.02 * double(at_once));
  EXPECT_LT(by_shares(cloud, members, false).outliers, at_once / 2);
}

/// A red sheet close before a blue one, both dense, in some of eight shares, before a sparse one: for the
/// whole they are one surface, and for themselves two.
PointCloud dense_sheets_before_a_sparse_one() {
  PointCloud cloud;
  const auto add_sheet = [&](float left, float step, int count, float depth, const Rgba8& color) {
    for (int i = 0; i < count; ++i)
      for (int k = 0; k < count; ++k) {
        cloud.positions.push_back({left + step * float(i), depth, 0.2f + step * float(k - count / 2)});
        cloud.colors.push_back(color);
      }
  };
  add_sheet(-4, 0.04f, 200, 1, {120, 120, 120, 255});
  add_sheet(0.2f, 0.005f, 80, 0, {255, 0, 0, 255});
  add_sheet(0.2f, 0.005f, 80, 0.06f, {0, 0, 255, 255});
  cloud.origin = {5e5, 4e6, 100};
  return cloud;
}

/// A wall, a sphere before it, and leaves beside it, all in the right half: nearly a fifth of the points.
/// Some are of class 5, and a scalar grows to the right.
PointCloud with_leaves(int leaves = 4'500) {
  PointCloud cloud;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-1, 1);
  const auto add = [&](const vec3& place, const Rgba8& color) {
    cloud.positions.push_back(place), cloud.colors.push_back(color);
  };
  for (int i = 0; i < 12'000; ++i)
    add({1.5f * any(random), 0.9f, 1.2f * any(random)}, {std::uint8_t(120 + i % 90), 120, 60, 255});
  for (int i = 0; i < 6'000; ++i) {
    vec3 way(any(random), any(random), any(random));
    while (glm::length(way) < 0.1f || glm::length(way) > 1) way = {any(random), any(random), any(random)};
    add(0.35f * glm::normalize(way) - vec3(0.6f, 0, 0), {60, 90, std::uint8_t(150 + i % 80), 255});
  }
  for (int i = 0; i < leaves; ++i)
    add(vec3(0.7f, 0, 0.1f) + 0.45f * vec3(any(random), any(random), any(random)), {40, 160, 40, 255});
  ScalarField classes{"classification", 0, {}}, height{"height", 0, {}};
  for (const vec3& place : cloud.positions) {
    classes.values.push_back(place.z > 0.7f ? 5 : 2);
    height.values.push_back(100 + 20 * place.x);
  }
  cloud.scalars = {classes, height};
  cloud.origin = {5e5, 4e6, 100};
  return cloud;
}

TEST_F(PartsTest, SoftPartsAreOnePictureLikeThatAtOnce) {
  name_ = "soft";
  const PointCloud cloud = with_leaves();
  const RenderOutput whole = at_once(cloud);
  ASSERT_EQ(whole.notes.size(), 1u);
  std::map<std::size_t, RenderOutput> of_so_many;
  for (const auto& [name, members] : splits(cloud)) {
    const RenderOutput parts = by_shares(cloud, members);
    // Discs of leaves have other normals than in one process, as those of noise have.
    EXPECT_LT(differing(parts, whole, 1), members.size() == 1 ? 5e-4 : 0.1) << name;
    EXPECT_LT(differing(parts, whole, 24), 0.01) << name;
    EXPECT_EQ(parts.notes, whole.notes) << name;
    const auto [first, is_first] = of_so_many.try_emplace(members.size(), parts);
    if (!is_first) expect_same(parts, first->second, name);
  }
}

TEST_F(PartsTest, SoftPartsOfEveryKindAreLikeThatAtOnce) {
  name_ = "soft";
  const PointCloud cloud = with_leaves(0);
  const Members members = split(cloud, 3, [](std::uint32_t i) { return i % 3; });
  for (const std::map<std::string, std::string>& parameters : std::vector<std::map<std::string, std::string>>{
           {{"model", "base"}},
           {{"model", "concentric"}},
           {{"order", "axis"}},
           {{"opacity", "0.5"}},
           {{"radius_scale", "3"}},
           {{"clamp_radius", "false"}},
           {{"antialias", "false"}},
           {{"field_threshold", "0.4"}},
           {{"field_threshold", "-1"}},
           {{"field_threshold", "1"}},
           {{"field_invert", "true"}},
           {{"field", "distance"}},
           {{"field", "distance"}, {"clamp_radius", "false"}},
           {{"field", "distance"}, {"field_distance", "box"}},
           {{"field", "class"}, {"field_classes", "5"}},
           {{"field", "uncertainty"}},
           {{"field", "uncertainty"}, {"field_threshold", "0.01"}},
           {{"field", "uncertainty"}, {"field_threshold", "0.05"}},
           {{"field", "height"}}}) {
    parameters_ = {{"field", "height"}};
    for (const auto& [name, value] : parameters) parameters_[name] = value;
    std::string what;
    for (const auto& [name, value] : parameters) what += name + " " + value + " ";
    const RenderOutput whole = at_once(cloud), parts = by_shares(cloud, members);
    EXPECT_LT(differing(parts, whole, 1), 1e-3) << what;
    EXPECT_LT(differing(parts, whole, 12), 2e-4) << what;
    EXPECT_EQ(parts.notes, whole.notes) << what;
    std::size_t shown = 0;
    for (const Rgba8& color : parts.rgba8) shown += color.a > 50;
    EXPECT_GT(shown, parts.rgba8.size() / 4) << what;
  }
}

TEST_F(PartsTest, SoftPointsAreDrawnInOneOrder) {
  name_ = "soft";
  // Two layers of points at the same depths, of two colours and all in one place each: blended in the order
  // of their numbers, whichever part has them.
  PointCloud cloud;
  for (const Rgba8& color : {Rgba8{255, 0, 0, 255}, {0, 0, 255, 255}, {0, 255, 0, 255}})
    for (int i = 0; i < 60; ++i)
      for (int k = 0; k < 60; ++k) {
        cloud.positions.push_back({float(i - 30) / 30, 0, float(k - 30) / 30});
        cloud.colors.push_back(color);
      }
  cloud.origin = {5e5, 4e6, 100};
  parameters_ = {{"field", "distance"}, {"field_threshold", "-1"}, {"opacity", "0.6"}};
  const RenderOutput whole = at_once(cloud);
  const auto expect_whole = [&](std::size_t parts, const auto& of) {
    const RenderOutput merged = by_shares(cloud, split(cloud, parts, of));
    EXPECT_TRUE(std::ranges::equal(merged.rgba8, whole.rgba8)) << parts;
  };
  expect_whole(2, [](std::uint32_t i) { return i % 2; });
  expect_whole(3, [](std::uint32_t i) { return 2 - i / 3600; });
}

TEST_F(PartsTest, ThresholdsOfManySoftPointsAreThoseOfASample) {
  name_ = "soft", parameters_ = {{"field", "height"}};
  PointCloud cloud;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> any(0, 1);
  ScalarField height{"height", 0, {}};
  for (int i = 0; i < 150'000; ++i) {
    cloud.positions.push_back({2 * any(random), 0, any(random)});
    height.values.push_back(cloud.positions.back().x * 0.5f);
  }
  cloud.colors.assign(cloud.size(), {200, 100, 50, 255}), cloud.scalars = {height};
  std::optional<VisiblePoints> first;
  for (const std::size_t count : {2, 3}) {
    const Members members = split(cloud, count, [&](std::uint32_t i) { return i % count; });
    VisiblePoints all;
    for (const PreparedCloud& share : shares_of(cloud, members)) {
      show(share);
      VisiblePoints own = renderer_.visible(*technique(), camera_of_scene(), settings_);
      if (all.values.empty())
        all = std::move(own);
      else
        merge(all, own);
    }
    ASSERT_EQ(all.values.size(), 1u);
    EXPECT_EQ(all.values[0].count, cloud.size());
    EXPECT_NEAR(double(all.values[0].sample.size()), 65'536, 800);  // four standard errors
    EXPECT_NEAR(analysis::quantile(all.values[0].sample, 0.85), 0.85, 0.006);
    if (!first) first = all;
    EXPECT_EQ(all.values[0].sample, first->values[0].sample);
  }
}

/// Moves a point a little, until nothing of a sample of so many would have it.
void leave_out_of_samples(const PointCloud& cloud, vec3& place, std::uint64_t points) {
  while (analysis::is_sampled(cloud.origin + dvec3(place), points)) place.x += 1e-5f;
}

TEST_F(PartsTest, FewSoftPointsOfManyAreAsLargeAsAtOnce) {
  name_ = "soft", parameters_ = {{"field", "height"}, {"field_threshold", "0.5"}};
  leave_out_relief();
  PointCloud cloud;
  cloud.origin = {5e5, 4e6, 100};
  std::mt19937 random(4);
  std::uniform_real_distribution<float> any(-1, 1);
  ScalarField height{"height", 0, {}};
  const auto add = [&](const vec3& place, const Rgba8& color, float value) {
    cloud.positions.push_back(place), cloud.colors.push_back(color), height.values.push_back(value);
  };
  constexpr int wall = 150'000, leaves = 60;
  for (int i = 0; i < wall; ++i) add({1.5f * any(random), 0.9f, 1.2f * any(random)}, {200, 100, 50, 255}, 0);
  for (int i = 0; i < leaves; ++i) {
    vec3 place = 0.1f * vec3(any(random), any(random), any(random));
    leave_out_of_samples(cloud, place, wall + leaves);
    add(place, {40, 40, 200, 255}, 1);
  }
  cloud.scalars = {height};
  const RenderOutput whole = at_once(cloud);
  parameters_["opacity"] = "0";
  const RenderOutput without = at_once(cloud);
  parameters_.erase("opacity");
  for (const std::size_t count : {1, 2, 3}) {
    const RenderOutput parts =
        by_shares(cloud, split(cloud, count, [&](std::uint32_t i) { return i % count; }));
    EXPECT_GT(differing(parts, without, 12), 0.002) << count;
    EXPECT_LT(differing(parts, whole, 1), 1e-3) << count;
  }
}

TEST_F(PartsTest, FewSolidPointsOfManyAreMeasuredTogether) {
  name_ = "soft",
  parameters_ = {
      {"field", "height"}, {"field_threshold", "0.5"}, {"opacity", "0.05"}, {"clamp_radius", "false"}};
  leave_out_relief();
  // Soft points far behind, and two dense sheets beside a sparse one: for the whole they are one surface.
  PointCloud cloud;
  cloud.origin = {5e5, 4e6, 100};
  std::mt19937 random(4);
  std::uniform_real_distribution<float> any(-1, 1);
  constexpr int soft = 150'000, dense = 30, sparse = 50, points = soft + 2 * dense * dense + sparse * sparse;
  ScalarField height{"height", 0, std::vector<float>(points)};
  for (int i = 0; i < soft; ++i) {
    cloud.positions.push_back({1.6f * any(random), 2, 1.2f * any(random)});
    cloud.colors.push_back({40, 160, 40, 255}), height.values[std::size_t(i)] = 1;
  }
  const auto add_sheet = [&](const vec3& at, float step, int count, const Rgba8& color) {
    for (int i = 0; i < count; ++i)
      for (int k = 0; k < count; ++k) {
        vec3 place = at + step * vec3(float(i), 0, float(k));
        leave_out_of_samples(cloud, place, points);
        cloud.positions.push_back(place), cloud.colors.push_back(color);
      }
  };
  add_sheet({-1.6f, 0, -0.9f}, 0.036f, sparse, {120, 120, 120, 255});
  add_sheet({0.9f, 0, 0.3f}, 0.006f, dense, {255, 0, 0, 255});
  add_sheet({0.9f, 0.03f, 0.3f}, 0.006f, dense, {0, 0, 255, 255});
  cloud.scalars = {height};
  const RenderOutput whole = at_once(cloud);
  for (const std::size_t count : {1, 2, 8}) {
    const RenderOutput parts =
        by_shares(cloud, split(cloud, count, [&](std::uint32_t i) { return i % count; }));
    EXPECT_LT(differing(parts, whole, 12), 5e-4) << count;
  }
}

TEST_F(PartsTest, HazeCountsWhereItIsSaidTo) {
  // Small ones too are spread over a cell of the view, a 32nd of its longer side, and count beyond its edge.
  const Camera camera = front_camera(200, 150, 3.2);
  const std::vector<float> radii{0.01f}, field{1};
  const std::vector<std::uint32_t> soft{0};
  std::size_t counted = 0, seen = 0;
  for (int i = -100; i <= 100; ++i)
    for (const vec3& way : {vec3(1, 0, 0), {0, 0, 1}, {0, 1, 0}}) {
      const std::vector<vec3> places{(0.05f * float(i)) * way};
      const double depth =
          soft::haze_depth({places, radii, soft, field}, std::span(&camera, 1), dvec3(0), {});
      EXPECT_EQ(soft::counts_in_depth(camera, camera.view(dvec3(0)), places[0], radii[0]), depth > 0) << i;
      counted += depth > 0,
          seen += View(camera, dvec3(0)).may_see(places[0] - radii[0], places[0] + radii[0]);
    }
  EXPECT_GT(counted, seen);
  EXPECT_LT(counted, 3 * 201u);
}

TEST_F(PartsTest, MoreSoftPointsThanAMessageHoldsAreRefused) {
  name_ = "soft";
  const PointCloud cloud = with_leaves();
  const PreparedCloud share = shares_of(cloud, split(cloud, 1, [](std::uint32_t) { return 0; })).front();
  show(share);
  VisiblePoints merged = renderer_.visible(*technique(), camera_of_scene(), settings_);
  merged.add_round(renderer_.visible(*technique(), camera_of_scene(), settings_, &merged));
  EXPECT_NO_THROW(renderer_.visible(*technique(), camera_of_scene(), settings_, &merged));
  merged.values.at(1).count = 60'000'000;
  try {
    renderer_.visible(*technique(), camera_of_scene(), settings_, &merged);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("field_threshold"), std::string::npos) << error.what();
  }
}

/// The picture where in one round each part goes on from what it said itself, and not from what all did.
RenderOutput PartsTest::drawn_alone(const std::vector<PreparedCloud>& parts, int in_round) {
  VisiblePoints of_all;
  std::vector<VisiblePoints> known(parts.size());
  for (int round = 0; round < technique()->rounds(); ++round) {
    std::vector<VisiblePoints> visible;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      show(parts[k]);
      visible.push_back(
          renderer_.visible(*technique(k), camera_of_scene(), settings_, round > 0 ? &known[k] : nullptr));
    }
    VisiblePoints merged = visible.front();
    for (std::size_t k = 1; k < parts.size(); ++k) merge(merged, visible[k]);
    for (std::size_t k = 0; k < parts.size(); ++k)
      known[k].add_round(round == in_round ? visible[k] : merged);
    of_all.add_round(std::move(merged));
  }
  return renderer_.render_merged(of_all, *technique(), camera_of_scene(), settings_, all_outputs());
}

TEST_F(PartsTest, NoPartOfSoftDecidesAloneWhichPointsAreSoft) {
  name_ = "soft";
  const PointCloud cloud = with_leaves();
  for (const char* field : {"uncertainty", "height"}) {
    parameters_ = {{"field", field}};
    // In the left one of two shares are no leaves, and it is lower.
    const std::vector<PreparedCloud> shares =
        shares_of(cloud, split(cloud, 2, [](std::uint32_t i) { return i % 2; }));
    EXPECT_GT(differing(drawn(shares), drawn_alone(shares, 0), 12), 0.02) << field;
  }
}

TEST_F(PartsTest, NoPartOfSoftDecidesAloneHowLargeItsSolidPointsAre) {
  name_ = "soft";
  const PointCloud cloud = dense_sheets_before_a_sparse_one();
  // What is far above or below is soft.
  parameters_ = {{"field", "distance"},
                 {"field_distance", "plane"},
                 {"field_origin", "500000,4000000,100"},
                 {"field_direction", "0,0,1"},
                 {"field_threshold", "0.5"}};
  const Members members = split(cloud, 8, [](std::uint32_t i) { return i % 8; });
  const RenderOutput whole = at_once(cloud);
  const std::vector<PreparedCloud> shares = shares_of(cloud, members);
  const double alone = differing(drawn_alone(shares, 1), whole, 12),
               together = differing(drawn(shares), whole, 12);
  EXPECT_GT(alone, 0.002);
  EXPECT_LT(together, 5e-4);
}

/// One process measures spacings at other places: the median of a hundred differs by 4 % from that of another
/// hundred. Here .01 % of the pixels differ by more than one step, of pull-push as many, where gaps as wide
/// as 30 spacings are closed .06 %: at outlines and gaps, which are there or not.
void expect_nearly_alike(const RenderOutput& a, const RenderOutput& b, const std::string& what) {
  EXPECT_LT(differing(a, b, 1), 1.5e-3) << what;
}

TEST_F(PartsTest, SurfacesAreOnePictureLikeThatAtOnce) {
  name_ = "surface";
  const PointCloud cloud = scene(false);
  const RenderOutput whole = at_once(cloud);
  expect_nearly_alike(same_of_splits(cloud), whole, "all");
}

TEST_F(PartsTest, SurfacesOfEveryKindAreLikeThoseAtOnce) {
  name_ = "surface";
  const PointCloud cloud = scene(true);
  const Members members = split(cloud, 3, [](std::uint32_t i) { return i % 3; }),
                all = splits(cloud).front().second;
  const Parts parts = cut(cloud, members), one = cut(cloud, all);
  for (const auto& [parameter, value] : {std::pair("filling", "pull_push"),
                                         {"hidden_point_removal", "none"},
                                         {"gap_scale", "30"},
                                         {"normal_scale", "9"}}) {
    parameters_ = {{parameter, value}};
    const RenderOutput merged = by_parts(parts, members);
    expect_same(merged, by_parts(one, all), parameter);
    expect_nearly_alike(merged, at_once(cloud), parameter);
  }
}

TEST_F(PartsTest, SurfacesOfAKnownSpacingAreThoseOfThePictureAtOnce) {
  leave_out_relief();
  name_ = "surface";
  const PointCloud cloud = scene(true);
  const Members members = split(cloud, 3, [](std::uint32_t i) { return i % 3; });
  for (const char* filling : {"discs", "pull_push"})
    for (const char* spacing : {"0.02", "0.1"}) {
      parameters_ = {{"point_spacing", spacing}, {"filling", filling}};
      expect_same(by_parts(cut(cloud, members), members), at_once(cloud), filling + std::string(spacing));
    }
}

TEST_F(PartsTest, NoPartOfASurfaceVouchesAlone) {
  name_ = "surface";
  // A dense sheet with a hole that no point vouches for, and strays in it that belong to one part.
  PointCloud cloud;
  std::mt19937 random(11);
  std::uniform_real_distribution<float> any(-2, 2);
  while (cloud.positions.size() < 4000) {
    const vec3 place(any(random), 0, any(random));
    if (glm::length(place) > 0.5f) cloud.positions.push_back(place);
  }
  for (int i = 0; i < 3; ++i) cloud.positions.push_back({0.25f * float(i - 1), 0, 0});
  cloud.colors.assign(cloud.size(), {200, 100, 50, 255});
  cloud.origin = {5e5, 4e6, 100};
  const Members members = split(cloud, 2, [](std::uint32_t i) { return i < 4000; });
  parameters_ = {{"point_spacing", "0.2"}};
  const RenderOutput whole = at_once(cloud), parts = by_parts(cut(cloud, members), members);
  expect_same(parts, whole, "all");
}

TEST_F(PartsTest, NoPartOfASurfaceDecidesAlone) {
  name_ = "surface";
  const PointCloud cloud = scene(false);
  const Members members = split(cloud, 4, [](std::uint32_t i) { return i % 4; });
  const Parts parts = cut(cloud, members);
  // With the spacings of one part in four, twice as large.
  const PointCloud& last = parts.clouds.back();
  auto own = std::make_shared<WholeCloud>(*parts.whole);
  own->spacing = cut(last, split(last, 1, [](std::uint32_t) { return 0; })).whole->spacing;
  EXPECT_GT(differing(by_parts({parts.clouds, own}, members), by_parts(parts, members), 12), 0.005);
}

TEST(WholeCloud, KnowsHowFarPointsScatterAboutTheirSurface) {
  PointCloud cloud = sphere_cloud(40'000);
  std::mt19937 random(2);
  std::normal_distribution<float> off(0, 0.02f);
  for (vec3& place : cloud.positions) place *= 1 + off(random);
  const auto whole = cut(cloud, split(cloud, 3, [](std::uint32_t i) { return i % 3; })).whole;
  // A median of 128 places beside one of 500: three standard errors are 4 %.
  EXPECT_NEAR(whole->residual / analysis::plane_residual(cloud.positions), 1, 0.04);
}

TEST_F(PartsTest, LayersAreOnePictureHoweverSpread) {
  name_ = "layers";
  const PointCloud cloud = scene(true);
  const Parts one = cut(cloud, splits(cloud).front().second);
  ASSERT_TRUE(one.whole->has_normals);
  const RenderOutput of_one = same_of_splits(cloud);
  // Colours and normals of points take another way to the pixels, which may round otherwise.
  expect_nearly_alike(of_one, at_once(cloud, one.whole), "of the same sizes");
  // One process has spacings of batches, whose stretches of the curve have other ends: discs are a little
  // larger or smaller, and another one is in front where several meet.
  const RenderOutput whole = at_once(cloud);
  EXPECT_LT(differing(of_one, whole, 24), 0.05);
}

TEST_F(PartsTest, LayersOfEveryKindAreOnePicture) {
  name_ = "layers";
  const PointCloud cloud = scene(true);
  const Members members = split(cloud, 3, [](std::uint32_t i) { return i % 3; }),
                all = splits(cloud).front().second;
  const Parts parts = cut(cloud, members), one = cut(cloud, all);
  for (const auto& [parameter, value] : {std::pair("opacity", "0.3"),
                                         {"opacity", "1"},
                                         {"layers", "9"},
                                         {"show_layer", "2"},
                                         {"scale_by_angle", "false"},
                                         {"point_shape", "round"},
                                         {"point_size", "1"},
                                         {"background_iterations", "0"}}) {
    parameters_ = {{parameter, value}};
    const std::string what = parameter + std::string(" ") + value;
    const RenderOutput merged = by_parts(parts, members), alone = by_parts(one, all);
    expect_equal(merged, alone, what);  // the second layer alone covers less than a third
    expect_nearly_alike(merged, at_once(cloud, one.whole), what);
  }
}

TEST_F(PartsTest, RoundLayersWithoutNormalsAreOnePicture) {
  name_ = "layers";
  parameters_ = {{"point_shape", "round"}};
  same_of_splits(scene(false));
}

TEST_F(PartsTest, LayersOfSharesAreOnePictureHoweverSpread) {
  name_ = "layers";
  const PointCloud cloud = scene(false);
  std::map<std::size_t, RenderOutput> of_so_many;
  for (const auto& [name, members] : splits(cloud)) {
    const RenderOutput parts = by_shares(cloud, members);
    const auto [first, is_first] = of_so_many.try_emplace(members.size(), parts);
    if (!is_first) expect_same(parts, first->second, name);
    // Normals at borders of shares know what lies beyond.
    expect_nearly_alike(parts, of_so_many.at(1), name);
  }
}

TEST_F(PartsTest, APartSeesOnlyTheLayersOfAll) {
  name_ = "layers";
  parameters_ = {{"layers", "3"}};
  const PointCloud cloud = scene(true);
  // A sphere and the sheet behind it, which is the third layer of both and the first of its part.
  const Members members = split(cloud, 2, [&](std::uint32_t i) { return cloud.positions[i].y > 0.9f; });
  const Parts parts = cut(cloud, members);
  const RenderOutput both = by_parts(parts, members);
  std::vector<VisiblePoints> rounds(3);
  for (std::size_t k = 0; k < 2; ++k) {
    show_part(parts.clouds[k], parts.whole);
    VisiblePoints own;
    for (std::size_t round = 0; round < 3; ++round) {
      VisiblePoints next =
          renderer_.visible(*technique(), camera_of_scene(), settings_, round > 0 ? &own : nullptr);
      if (k == 0)
        rounds[round] = next;
      else
        merge(rounds[round], next);
      own.add_round(std::move(next));
    }
  }
  VisiblePoints alone;
  for (VisiblePoints& round : rounds) alone.add_round(std::move(round));
  const RenderOutput wrong =
      renderer_.render_merged(alone, *technique(), camera_of_scene(), settings_, all_outputs());
  EXPECT_GT(differing(both, wrong, 12), 0.02);
}

bool are_equal(const VisiblePoints& a, const VisiblePoints& b) {
  return std::ranges::equal(a.depth_bits, b.depth_bits) && std::ranges::equal(a.number, b.number) &&
         std::ranges::equal(a.colors, b.colors) && std::ranges::equal(a.normals, b.normals);
}

TEST_F(PartsTest, ARoundOfLayersGoesOnFromTheOneBeforeInItsPicture) {
  name_ = "layers";
  const PointCloud cloud = scene(true);
  const Members members = split(cloud, 2, [&](std::uint32_t i) { return cloud.positions[i].y > 0.9f; });
  const Parts parts = cut(cloud, members);
  const auto visible = [&](Technique& by, const VisiblePoints* merged) {
    return renderer_.visible(by, camera_of_scene(), settings_, merged);
  };
  const auto fresh = [&] {
    auto technique = find_technique(name_).create();
    for (const auto& [name, value] : parameters_) set_parameter(*technique, name, value);
    return technique;
  };
  const auto anew = [&](const VisiblePoints& merged) { return visible(*fresh(), &merged); };
  // What is merged after each round of two pictures, of the sphere alone and of the sheet behind it alone.
  std::vector<VisiblePoints> sphere, sheet;
  for (std::size_t k = 0; k < 2; ++k) {
    show_part(parts.clouds[k], parts.whole);
    VisiblePoints merged;
    for (int round = 0; round < 3; ++round) {
      merged.add_round(visible(*technique(), round > 0 ? &merged : nullptr));
      (k == 0 ? sphere : sheet).push_back(merged);
    }
  }
  show_part(cloud, parts.whole);
  for (const char* opacity : {"auto", "0.5", "0.97", "1"}) {
    parameters_ = {{"opacity", opacity}};
    const auto kept = fresh();
    for (const VisiblePoints& merged : sphere)
      EXPECT_TRUE(are_equal(visible(*kept, &merged), anew(merged))) << opacity;
  }

  // It does not look at what lies before the last layer.
  parameters_ = {};
  const auto kept = fresh();
  VisiblePoints without_first = sphere[2];
  without_first.in_front.front().depth_bits = {};
  EXPECT_THROW(anew(without_first), Error);
  visible(*kept, &sphere[1]);
  EXPECT_TRUE(are_equal(visible(*kept, &without_first), anew(sphere[2])));

  // Where another picture was drawn in between, it starts afresh: behind the sheet of that one is nothing.
  const VisiblePoints behind_sphere = anew(sphere[1]);
  visible(*kept, &sphere[0]), visible(*kept, &sheet[0]);
  EXPECT_TRUE(are_equal(visible(*kept, &sphere[1]), behind_sphere));
  VisiblePoints mixed = sphere[1];
  mixed.in_front.front().serial = sheet[0].serial;
  visible(*kept, &sheet[0]);
  EXPECT_FALSE(are_equal(visible(*kept, &mixed), behind_sphere));

  // Two layers of .97 let nothing through, one of .5 and one of .97 do.
  parameters_ = {{"opacity", "0.5"}};
  const auto changed = fresh();
  visible(*changed, &sphere[0]);
  parameters_ = {{"opacity", "0.97"}};
  set_parameter(*changed, "opacity", "0.97");
  const VisiblePoints closed = anew(sphere[1]);
  EXPECT_FALSE(are_equal(closed, behind_sphere));
  EXPECT_TRUE(are_equal(visible(*changed, &sphere[1]), closed));
}

TEST_F(PartsTest, NoPartOfLayersDecidesAlone) {
  name_ = "layers";
  const PointCloud cloud = scene(true);
  const Members members = split(cloud, 4, [](std::uint32_t i) { return i % 4; });
  const Parts parts = cut(cloud, members);
  // With the spacings of one part in four, twice as large.
  const PointCloud& last = parts.clouds.back();
  const auto of_last = cut(last, split(last, 1, [](std::uint32_t) { return 0; })).whole;
  auto own = std::make_shared<WholeCloud>(*parts.whole);
  own->spacing = of_last->spacing, own->median_spacing = of_last->median_spacing;
  const RenderOutput together = by_parts(parts, members);
  EXPECT_GT(differing(by_parts({parts.clouds, own}, members), together, 12), 0.005);
  // Where all is noise, that of 20 spacings, there is one layer.
  *own = *parts.whole;
  for (float& deviation : own->placed_noise.deviations) deviation = 20 * own->median_spacing;
  EXPECT_GT(differing(by_parts({parts.clouds, own}, members), together, 12), 0.005);
  // So noisy that discs would lie behind one another.
  *own = *parts.whole;
  own->placed_noise.of_spacing = 1;
  EXPECT_GT(differing(by_parts({parts.clouds, own}, members), together, 12), 0.002);
}

TEST(PlacedSpacing, IsLikeThatOfBatches) {
  // Around a scanner: as many points in each octave of distances, and one far away.
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any;
  PointCloud cloud;
  for (int i = 0; i < 200'000; ++i) {
    const float distance = std::exp2(6 * any(random)), angle = 6.2831853f * any(random);
    cloud.positions.push_back({distance * std::cos(angle), distance * std::sin(angle), 0});
  }
  cloud.positions.push_back({1e5f, 0, 0});
  cloud.origin = {5e5, 4e6, 100};
  const auto whole = cut(cloud, split(cloud, 2, [](std::uint32_t i) { return i % 2; })).whole;
  const PreparedCloud prepared = analysis::prepare(cloud, {}, {});
  const std::vector<float> placed = analysis::spacings_at(prepared.cloud.positions, whole->spacing);
  std::vector<float> off;
  for (const Batch& batch : prepared.batches)
    for (std::uint32_t i = batch.first; i < batch.first + batch.count; ++i)
      off.push_back(std::abs(std::log2(placed[i] / batch.spacing_at(prepared.cloud.positions[i]))));
  std::sort(off.begin(), off.end());
  // Planes through the logarithms of 21 samples, which scatter by .26, and through 21 others: their level is
  // off by .08, at their ends by twice as much. Measured: .09 half of the time, .4 in one of 100. Over the
  // octaves of distances spacings differ by 6.
  EXPECT_LT(off[off.size() / 2], 0.15);
  EXPECT_LT(off[off.size() * 99 / 100], 0.6);
}

TEST_F(PartsTest, NoShareOfSplatsDecidesAlone) {
  name_ = "splats";
  const PointCloud cloud = dense_sheets_before_a_sparse_one();
  const Members members = split(cloud, 8, [](std::uint32_t i) { return i % 8; });
  const RenderOutput whole = at_once(cloud);
  EXPECT_GT(differing(by_shares(cloud, members, false), whole, 12), 0.005);
  expect_alike(by_shares(cloud, members), whole, "all");
}

/// Share of the points whose radius in a share of two is by a thousandth another one than in the whole.
double differing_radii(const PointCloud& cloud, bool know_what_is_around) {
  PointCloud all = cloud;
  all.source_index.resize(all.size());
  std::iota(all.source_index.begin(), all.source_index.end(), 0u);
  const analysis::CloudFacts facts = analysis::facts_of(all);
  const auto whole = whole_of(facts, neighborhood_facts_of(all, facts), all.origin);
  const Attributes needs = Attribute::normal | Attribute::radius;
  const PreparedCloud at_once = analysis::prepare(cloud, needs, {});
  std::vector<float> radii(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    radii[at_once.cloud.source_index[i]] = at_once.cloud.radii[i];
  std::size_t different = 0, count = 0;
  for (const Bounds& region : analysis::regions_of(whole->sample, 2)) {
    analysis::Share share =
        analysis::share_of({analysis::points_near(all, region, analysis::reach_of(*whole))}, region);
    if (!know_what_is_around) share.around = {};
    const PreparedCloud prepared =
        analysis::prepare_part(std::move(share.own), share.around, needs, {}, no_progress(), whole);
    for (std::size_t i = 0; i < prepared.cloud.size(); ++i, ++count) {
      const float own = radii[prepared.cloud.source_index[i]];
      different += std::abs(prepared.cloud.radii[i] - own) > 1e-3f * own;
    }
  }
  EXPECT_EQ(count, cloud.size());
  return double(different) / double(count);
}

TEST(Share, KnowsWhatIsAroundIt) {
  const PointCloud cloud = scene(false);
  EXPECT_LT(differing_radii(cloud, true), 1e-3);
  EXPECT_GT(differing_radii(cloud, false), 1e-2);
}

TEST(Regions, HaveEveryPointOnceAndAboutAsMany) {
  const PointCloud cloud = scene(false);
  for (const std::size_t count : {1, 2, 3, 7}) {
    const auto regions = analysis::regions_of(cloud, count);
    ASSERT_EQ(regions.size(), count);
    std::vector<int> seen(cloud.size());
    for (const Bounds& region : regions) {
      PointCloud numbered = cloud;
      numbered.source_index.resize(cloud.size());
      std::iota(numbered.source_index.begin(), numbered.source_index.end(), 0u);
      const analysis::Share share =
          analysis::share_of({analysis::points_near(numbered, region, 0.2)}, region);
      EXPECT_NEAR(double(share.own.size()), double(cloud.size() / count),
                  0.05 * double(cloud.size() / count));
      for (const std::uint32_t i : share.own.source_index) ++seen[i];
      // What is around it is no farther off than that, and all of it.
      std::vector<bool> has(cloud.size());
      for (const PointCloud* points : {&share.own, &share.around})
        for (const std::uint32_t i : points->source_index) has[i] = true;
      for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        const dvec3 place = cloud.world(i), away = place - glm::clamp(place, region.min, region.max);
        const double off = std::max({std::abs(away.x), std::abs(away.y), std::abs(away.z)});
        if (off < 0.19) EXPECT_TRUE(has[i]) << i;
        if (off > 0.21) EXPECT_FALSE(has[i]) << i;
      }
    }
    EXPECT_TRUE(std::ranges::all_of(seen, [](int times) { return times == 1; }));
  }
}

TEST_F(PartsTest, WhatCannotBeMergedIsRefused) {
  show_part(scene(false), nullptr);
  name_ = "strokes";
  EXPECT_THROW(renderer_.visible(*technique(), camera_of_scene(), settings_), Error);
  name_ = "points";
  // Of what is around nothing is known.
  show_part(scene(false), nullptr);
  name_ = "splats";
  EXPECT_THROW(renderer_.visible(*technique(), camera_of_scene(), settings_), Error);
  // Nor who is soft there, though attributes of its own are all there.
  name_ = "soft";
  const Members members = split(scene(false), 1, [](std::uint32_t) { return 0; });
  show_part(scene(false), cut(scene(false), members).whole);
  EXPECT_TRUE(renderer_.merges(*technique(), camera_of_scene(), settings_));
  EXPECT_THROW(renderer_.visible(*technique(), camera_of_scene(), settings_), Error);
  for (const auto& [parameter, value] : {std::pair("model", "one_layer"), {"field", "sensor"}}) {
    parameters_ = {{parameter, value}};
    EXPECT_FALSE(renderer_.merges(*technique(), camera_of_scene(), settings_)) << value;
  }
  // Which opacity a point has, no pixel says.
  name_ = "layers", parameters_ = {{"opacity", "0.3,0.6"}};
  EXPECT_FALSE(renderer_.merges(*technique(), camera_of_scene(), settings_));
  parameters_ = {{"opacity", "0.3"}};
  EXPECT_TRUE(renderer_.merges(*technique(), camera_of_scene(), settings_));
  name_ = "points", parameters_ = {};
  settings_.shadows = Shadows::soft;
  EXPECT_THROW(renderer_.visible(*technique(), camera_of_scene(), settings_), Error);
}

TEST(VisiblePoints, OfRoundsLieOneBehindAnother) {
  VisiblePoints all;
  for (std::uint32_t round = 0; round < 3; ++round) {
    VisiblePoints next{Image<std::uint32_t>(2, 1, round),
                       Image<std::uint32_t>(2, 1, 10 + round),
                       Image<vec4>(2, 1, vec4(float(round))),
                       {}};
    if (round == 0) next.vouching = Image<std::uint32_t>(4, 3, 7u);
    if (round < 2) next.normals = Image<vec4>(2, 1, vec4(float(round)));
    const std::uint64_t before = all.serial;
    all.add_round(std::move(next));
    EXPECT_NE(all.serial, before);
    if (round > 0) EXPECT_EQ(all.in_front.back().serial, before);
  }
  ASSERT_EQ(all.in_front.size(), 2u);
  for (std::uint32_t round = 0; round < 3; ++round) {
    const VisiblePoints& layer = round < 2 ? all.in_front[round] : all;
    EXPECT_EQ(layer.depth_bits.at(1, 0), round);
    EXPECT_EQ(layer.number.empty(), round < 2);
    EXPECT_EQ(layer.colors.at(1, 0), vec4(float(round)));
    EXPECT_EQ(layer.normals.empty(), round == 2);
  }
  EXPECT_EQ(all.vouching.at(0, 0), 7u);
  VisiblePoints other, once_more;
  other.add_round({}), once_more.add_round({});
  EXPECT_NE(other.serial, once_more.serial);
  merge(other, once_more);
  EXPECT_EQ(other.serial, 0u);
}

TEST(VisiblePoints, MergeInAnyOrderAndGrouping) {
  std::mt19937 random(9);
  const auto any = [&] {
    VisiblePoints of{Image<std::uint32_t>(40, 30), Image<std::uint32_t>(40, 30), Image<vec4>(40, 30), {}};
    of.nearest = Image<float>(40, 30), of.vouching = Image<std::uint32_t>(50, 40);
    of.color_sum = of.normal_sum = of.places = Image<vec4>(40, 30);
    of.values.resize(2);
    for (VisiblePoints::Values& kind : of.values) {
      kind.count = random() % 9;
      for (std::uint64_t i = 0; i < kind.count; ++i) kind.sample.push_back(float(random() % 5));
      std::sort(kind.sample.begin(), kind.sample.end());
      if (kind.count > 0) kind.least = kind.sample.front(), kind.most = kind.sample.back() + 1;
    }
    // Of few numbers, so that some have several points.
    for (int i = 0; i < 20; ++i)
      of.seen_through.push_back({std::uint32_t(random() % 30), vec3(float(random() % 2)), {}, 1, 0, {}});
    std::sort(of.seen_through.begin(), of.seen_through.end());
    for (float& distance : of.nearest) distance = random() % 3 ? float(random() % 99) : INFINITY;
    for (std::uint32_t& point : of.vouching) point = random() % 2 ? VisiblePoints::nothing : 0;
    // Whole numbers, whose sums are exact.
    for (vec4& sum : of.color_sum) sum = vec4(float(random() % 99));
    for (vec4& sum : of.normal_sum) sum = vec4(float(random() % 99));
    if (random() % 2) of.normals = Image<vec4>(40, 30);
    for (std::size_t i = 0; i < of.number.size(); ++i) {
      const bool is_open = random() % 3 == 0;
      of.depth_bits.data()[i] = is_open ? VisiblePoints::nothing : random() % 5;
      of.number.data()[i] = is_open ? VisiblePoints::nothing : random();
      of.colors.data()[i] = of.places.data()[i] = vec4(float(of.number.data()[i]));
      if (!of.normals.empty())
        of.normals.data()[i] = is_open ? vec4(0, 0, 0, 1) : vec4(float(of.number.data()[i] % 7));
    }
    return of;
  };
  for (int round = 0; round < 20; ++round) {
    const VisiblePoints a = any(), b = any(), c = any();
    VisiblePoints left = a, right = b, turned = c;
    merge(left, b), merge(left, c);
    merge(right, c);
    VisiblePoints grouped = a;
    merge(grouped, right);
    merge(turned, b), merge(turned, a);
    for (const VisiblePoints* other : {&grouped, &turned}) {
      EXPECT_TRUE(std::ranges::equal(left.depth_bits, other->depth_bits));
      EXPECT_TRUE(std::ranges::equal(left.number, other->number));
      EXPECT_TRUE(std::ranges::equal(left.colors, other->colors));
      EXPECT_TRUE(std::ranges::equal(left.normals, other->normals));
      EXPECT_TRUE(std::ranges::equal(left.places, other->places));
      EXPECT_TRUE(std::ranges::equal(left.nearest, other->nearest));
      EXPECT_TRUE(std::ranges::equal(left.vouching, other->vouching));
      EXPECT_TRUE(std::ranges::equal(left.color_sum, other->color_sum));
      EXPECT_TRUE(std::ranges::equal(left.normal_sum, other->normal_sum));
      for (std::size_t kind = 0; kind < 2; ++kind) {
        const VisiblePoints::Values &own = left.values[kind], &its = other->values[kind];
        EXPECT_EQ(own.sample, its.sample);
        EXPECT_EQ(std::tie(own.count, own.least, own.most), std::tie(its.count, its.least, its.most));
      }
      EXPECT_TRUE(std::ranges::equal(
          left.seen_through, other->seen_through,
          [](const auto& p, const auto& q) { return p.number == q.number && p.place == q.place; }));
    }
  }
}

}  // namespace
