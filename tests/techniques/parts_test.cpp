// Pictures of a cloud that lies in parts: each part is drawn by itself, what its pixels show is merged, and
// what looks at more than one pixel follows.
#include <algorithm>
#include <map>

#include "analysis/survey.h"
#include "analysis/whole.h"
#include "reference/gl_fixture.h"

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
  analysis::Surroundings around = surroundings_of(parts.clouds.front(), facts);
  for (std::size_t k = 1; k < parts.clouds.size(); ++k)
    merge(around, surroundings_of(parts.clouds[k], facts));
  parts.whole = whole_of(facts, around, cloud.origin);
  return parts;
}

class PartsTest : public GlTest {
 protected:
  PartsTest() { settings_.transparent = true; }

  /// `whole` null: a cloud of its own.
  void show_part(PointCloud part, std::shared_ptr<const WholeCloud> whole) {
    PreparedCloud prepared = analysis::prepare_by_shape(
        std::move(part), [](const auto&, const auto&) { return Attributes(); }, {}, no_progress(), whole);
    std::vector<Rgba8> colors = colors_of(prepared.cloud);
    renderer_.set_cloud(std::move(prepared), std::move(colors), 3000);
  }

  RenderOutput by_parts(const Parts& parts, const Members& members) {
    std::vector<VisiblePoints> visible;
    for (std::size_t k = 0; k < members.size(); ++k) {
      show_part(parts.clouds[k], parts.whole);
      visible.push_back(renderer_.visible(*technique(), camera_of_scene(), settings_));
      for (std::uint32_t& number : visible.back().number)
        if (number != VisiblePoints::nothing) number = members[k][number];
    }
    for (std::size_t k = 0; k + 1 < visible.size(); ++k) merge(visible.back(), visible[k]);
    // Whoever goes on, even if there are no points there.
    return renderer_.render_merged(visible.back(), *technique(), camera_of_scene(), settings_, all_outputs());
  }

  RenderOutput at_once(const PointCloud& cloud, std::shared_ptr<const WholeCloud> whole = nullptr) {
    show_part(cloud, whole);
    return renderer_.render(*technique(), camera_of_scene(), settings_, all_outputs());
  }

  Technique* technique() {
    std::unique_ptr<Technique>& technique = techniques_[{name_, parameters_}];
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
  std::map<std::pair<std::string, std::map<std::string, std::string>>, std::unique_ptr<Technique>>
      techniques_;

 protected:
  Renderer renderer_{context()};
};

void expect_same(const RenderOutput& a, const RenderOutput& b, const std::string& what) {
  EXPECT_TRUE(std::ranges::equal(a.rgba8, b.rgba8)) << what;
  EXPECT_TRUE(std::ranges::equal(a.color_linear, b.color_linear)) << what;
  EXPECT_TRUE(std::ranges::equal(a.depth, b.depth)) << what;
  EXPECT_TRUE(std::ranges::equal(a.normal, b.normal)) << what;
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

TEST_F(PartsTest, PointsOfASizeAreThoseOfThePictureAtOnce) {
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

TEST_F(PartsTest, WhatCannotBeMergedIsRefused) {
  show_part(scene(false), nullptr);
  name_ = "soft";
  EXPECT_THROW(renderer_.visible(*technique(), camera_of_scene(), settings_), Error);
  name_ = "points";
  settings_.shadows = Shadows::soft;
  EXPECT_THROW(renderer_.visible(*technique(), camera_of_scene(), settings_), Error);
}

TEST(VisiblePoints, MergeInAnyOrderAndGrouping) {
  std::mt19937 random(9);
  const auto any = [&] {
    VisiblePoints of{Image<std::uint32_t>(40, 30), Image<std::uint32_t>(40, 30), Image<vec4>(40, 30), {}};
    if (random() % 2) of.normals = Image<vec4>(40, 30);
    for (std::size_t i = 0; i < of.number.size(); ++i) {
      const bool is_open = random() % 3 == 0;
      of.depth_bits.data()[i] = is_open ? VisiblePoints::nothing : random() % 5;
      of.number.data()[i] = is_open ? VisiblePoints::nothing : random();
      of.colors.data()[i] = vec4(float(of.number.data()[i]));
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
    }
  }
}

}  // namespace
