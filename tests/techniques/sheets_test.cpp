// Thin sheets that were measured on both sides: which of them a picture shows.
#include <cmath>
#include <random>

#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class SheetsTest : public GlTest {};

constexpr int width = 320, height = 240;
constexpr Rgba8 near_side{255, 0, 0, 255}, far_side{0, 0, 255, 255};

/// Random points of both sides, one a square of spacing 1 on each, but for a disc of the near side.
PointCloud plate(float gap, bool with_normals, float open = 0) {
  constexpr float half = 40;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-half, half);
  PointCloud cloud;
  for (int side : {-1, 1})
    for (int i = 0; i < int(4 * half * half); ++i) {
      const vec3 p(place(random), 0.5f * float(side) * gap, place(random));
      if (side < 0 && std::hypot(p.x, p.z) < open) continue;
      cloud.positions.push_back(p);
      if (with_normals) cloud.normals.emplace_back(0, side, 0);
      cloud.colors.push_back(side < 0 ? near_side : far_side);
    }
  return cloud;
}

RenderOutput draw(Renderer& renderer, const PointCloud& cloud, const char* name, Camera& camera) {
  const auto technique = find_technique(name).create();
  camera = front_camera(width, height);
  camera.position = {0, -60, 0};
  show(renderer, cloud, technique->needs());
  RenderSettings settings;
  settings.transparent = true;
  settings.shading = Shading::albedo;
  settings.edl.user = false, settings.ambient_occlusion.user = 0;
  return renderer.render(*technique, camera, settings, all_outputs());
}

bool shows_far_side(const vec4& color) { return color.b > color.r; }

}  // namespace

TEST_F(SheetsTest, ShowTheNearSide) {
  Renderer renderer(context());
  for (const char* name : {"splats", "denoise", "soft"})
    for (const float gap : {1.0f, 2.0f, 3.0f})
      for (const bool with_normals : {true, false}) {
        SCOPED_TRACE(std::string(name) + " " + std::to_string(gap) + (with_normals ? " normals" : ""));
        Camera camera;
        const RenderOutput out = draw(renderer, plate(gap, with_normals), name, camera);
        int wrong = 0, open = 0;
        for (const vec4& color : out.color_linear) wrong += shows_far_side(color), open += color.a < 0.5f;
        // Where random points leave the near side open: docs/measurements/sheets.md has .02 % of larger
        // pictures.
        EXPECT_LE(wrong, width * height / 1000);
        EXPECT_LE(open, width * height / 1000);
      }
}

TEST_F(SheetsTest, TheFarSideFillsWhatTheNearOneLeavesOpen) {
  Renderer renderer(context());
  constexpr float gap = 1, open_radius = 3;
  for (const char* name : {"splats", "soft"}) {
    SCOPED_TRACE(name);
    Camera camera;
    const RenderOutput out = draw(renderer, plate(gap, true, open_radius), name, camera);
    int open = 0;
    for (const vec4& color : out.color_linear) open += color.a < 0.5f;
    EXPECT_LE(open, width * height / 1000);
    ASSERT_TRUE(shows_far_side(out.color_linear.at(width / 2, height / 2)));
    EXPECT_NEAR(out.depth.at(width / 2, height / 2), 60 + 0.5f * gap, 0.01f) << "where it was measured";
  }
}
