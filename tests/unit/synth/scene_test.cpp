#include "synth/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "synth/synth.h"

using namespace sfumato;
using namespace sfumato::synth;

namespace {

TEST(Scene, NestedToriHaveTheirAnalyticRoots) {
  const Scene scene = make_scene("tori");
  // Straight down through the ring circle: one layer per torus on the way in, one on the way out.
  const double angle = 0.7;
  const std::vector<Hit> through = scene.intersect_all({{std::cos(angle), std::sin(angle), 2}, {0, 0, -1}});
  ASSERT_EQ(through.size(), 6u);
  const double depths[] = {2 - 0.45, 2 - 0.30, 2 - 0.15, 2 + 0.15, 2 + 0.30, 2 + 0.45};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(through[i].t, depths[i], 1e-12);

  // In the plane of the ring, through its centre: both sides, twelve layers.
  const std::vector<Hit> in_plane = scene.intersect_all({{-2, 0, 0}, {1, 0, 0}});
  ASSERT_EQ(in_plane.size(), 12u);
  const double x[] = {-1.45, -1.30, -1.15, -0.85, -0.70, -0.55, 0.55, 0.70, 0.85, 1.15, 1.30, 1.45};
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_NEAR(in_plane[i].t, 2 + x[i], 1e-12);
    EXPECT_EQ(in_plane[i].surface, (std::array<std::uint32_t, 6>{0, 1, 2, 2, 1, 0})[i % 6]);
    // Outward normals alternate: towards the ray where it enters a tube, away where it leaves.
    EXPECT_NEAR(in_plane[i].normal.x, i % 6 < 3 ? -1 : 1, 1e-12);
  }
}

TEST(Scene, SearchStructureFindsWhatBruteForceFinds) {
  for (const char* name : {"courtyard", "room"}) {
    const Scene scene = make_scene(name);
    Random random(2, Stream::area, 0);
    std::size_t total = 0;
    for (int trial = 0; trial < 25; ++trial) {
      dvec3 from, to;
      for (int axis = 0; axis < 3; ++axis) {
        from[axis] = random.uniform(scene.box.min[axis], scene.box.max[axis]);
        to[axis] = random.uniform(scene.box.min[axis], scene.box.max[axis]);
      }
      const Ray ray{from, glm::normalize(to - from)};
      std::vector<double> brute;
      for (const Primitive& primitive : scene.primitives) {
        const Roots roots = crossings(primitive, ray);
        for (int i = 0; i < roots.count; ++i)
          if (roots.t[std::size_t(i)] > 0) brute.push_back(roots.t[std::size_t(i)]);
      }
      std::sort(brute.begin(), brute.end());
      const std::vector<Hit> hits = scene.intersect_all(ray);
      ASSERT_EQ(hits.size(), brute.size());
      for (std::size_t i = 0; i < hits.size(); ++i) EXPECT_EQ(hits[i].t, brute[i]);
      const auto first = scene.intersect(ray);
      ASSERT_EQ(first.has_value(), !brute.empty());
      if (first) EXPECT_EQ(first->t, brute.front());
      total += brute.size();
    }
    EXPECT_GT(total, 50u) << name;
  }
}

TEST(Scene, GateAndArchesCanBeWalkedThrough) {
  const Scene scene = make_scene("courtyard");
  // Along the axis of both gates, 2.5 m up (over the fountain's rim, under the vault): nothing in the way.
  EXPECT_TRUE(scene.intersect_all({{0, -20, 2.5}, {0, 1, 0}}).empty());
  // A wall's thickness beside the opening there is something.
  EXPECT_FALSE(scene.intersect_all({{1.6, -20, 2.5}, {0, 1, 0}}).empty());
}

TEST(Truth, PlaneHasItsAnalyticDepth) {
  const Scene scene = make_scene("plane");
  Camera camera = scene.cameras[0].resized(64, 48);
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    camera.projection = projection;
    camera.height_world = 1.5;
    const Truth image = truth(scene, camera);
    const Intrinsics k = camera.intrinsics();
    const dmat4 to_world = camera.inverse_view();
    int covered = 0;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const double right = (x + 0.5 - k.cx) / k.fx, up = -(y + 0.5 - k.cy) / k.fy;
        const float depth = image.depth.at(x, y);
        if (std::isinf(depth)) {
          EXPECT_EQ(image.normal.at(x, y), vec3(0));
          EXPECT_EQ(image.class_id.at(x, y), 0);
          continue;
        }
        ++covered;
        const double w = camera.orthographic() ? 1 : depth;
        const dvec3 p(to_world * glm::dvec4(right * w, up * w, -double(depth), 1));
        // Depth is rounded to float: 2.4e-7 at 3 units.
        EXPECT_NEAR(p.z, 0, 1e-6);
        EXPECT_LE(std::max(std::abs(p.x), std::abs(p.y)), 1 + 1e-6);
        EXPECT_EQ(image.normal.at(x, y), vec3(0, 0, 1));
        EXPECT_EQ(image.class_id.at(x, y), class_ground);
        EXPECT_GT(image.color.at(x, y).r, 0);
      }
    EXPECT_GT(covered, 500);
  }
  // From below the normal turns to the viewer.
  camera.position.z = -1.6;
  EXPECT_EQ(truth(scene, camera).normal.at(32, 24), vec3(0, 0, -1));
}

TEST(Truth, EveryPixelOfTheRoomIsCovered) {
  const Scene scene = make_scene("room");
  ASSERT_EQ(scene.cameras.size(), 10u);
  ASSERT_TRUE(scene.held_out.has_value());
  for (const Camera& camera : {scene.cameras[3], *scene.held_out}) {
    const Truth image = truth(scene, camera.resized(64, 48));
    for (std::size_t i = 0; i < image.depth.size(); ++i) {
      EXPECT_TRUE(std::isfinite(image.depth.data()[i]));
      EXPECT_GT(image.depth.data()[i], 0.2f);  // nobody holds a camera into a shelf
    }
  }
}

TEST(Truth, AlbedoVariesWithinItsRange) {
  for (const std::string& name : scene_names()) {
    if (name == "tori") continue;  // one colour per layer, on purpose
    const Scene scene = make_scene(name);
    const Camera camera = frame(scene.box, UpAxis::pos_z, 64, 48, glm::radians(-45.0), glm::radians(30.0));
    const Truth image = truth(scene, camera);
    double sum = 0, squares = 0;
    int covered = 0;
    for (std::size_t i = 0; i < image.color.size(); ++i) {
      if (std::isinf(image.depth.data()[i])) continue;
      const vec3 c = image.color.data()[i];
      for (int channel = 0; channel < 3; ++channel) {
        EXPECT_GE(c[channel], 0.003f);
        EXPECT_LE(c[channel], 0.97f);
      }
      ++covered;
      sum += luminance(c), squares += luminance(c) * luminance(c);
    }
    ASSERT_GT(covered, 300) << name;
    const double mean = sum / covered;
    EXPECT_GT(std::sqrt(squares / covered - mean * mean), 0.03) << name;  // not flat
  }
}

TEST(Scene, ForestHasTreesOverGroundOfKnownHeight) {
  Scene scene = make_scene("forest");
  // Straight down: one crossing of the terrain whatever stands on it, below everything else.
  Random random(3, Stream::area, 0);
  std::vector<std::optional<double>> ground;
  int under_trees = 0;
  const auto ray = [&] { return Ray{{random.uniform(-20, 20), random.uniform(-20, 20), 60}, {0, 0, -1}}; };
  std::vector<Ray> rays;
  for (int i = 0; i < 400; ++i) rays.push_back(ray());
  for (const Ray& down : rays) {
    const std::vector<Hit> hits = scene.intersect_all(down);
    int crossings = 0;
    for (const Hit& hit : hits) {
      if (scene.surface_class(hit.surface) != class_ground) continue;
      ++crossings;
      EXPECT_GT(hit.normal.z, 0.5);
      ground.push_back(hit.t);
    }
    EXPECT_EQ(crossings, 1);
    under_trees += scene.surface_class(hits.front().surface) == class_high_vegetation;
  }
  EXPECT_GT(under_trees, 200);  // a wood: most of the plot is under crowns ...
  EXPECT_LT(under_trees, 380);  // ... with a clearing
  // The terrain alone, for whoever needs the truth below the trees, is where it was.
  scene.primitives.clear();
  scene.build();
  for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(scene.intersect(rays[i])->t, ground[i]);
}

Mesh octahedron() {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

TEST(MeshScene, RaysAndNormals) {
  const Scene scene = make_mesh_scene(octahedron());
  const auto hit = scene.intersect({{0.2, 0.3, 5}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 5 - 0.5, 1e-12);
  // Vertex normals of an octahedron are its axes, so the interpolated one is the position, normalised.
  EXPECT_LT(glm::length(hit->normal - glm::normalize(dvec3(0.2, 0.3, 0.5))), 1e-6);
  EXPECT_EQ(scene.intersect_all({{0.2, 0.3, 5}, {0, 0, -1}}).size(), 2u);
}

TEST(MeshScene, DamagedOrEmptyMeshesAreErrors) {
  Mesh broken = octahedron();
  broken.triangles[2][1] = 77;
  EXPECT_THROW(make_mesh_scene(broken), Error);
  EXPECT_THROW(make_mesh_scene(Mesh{}), Error);
}

}  // namespace
