// Outlines without stairs: pictures that average several places of every pixel (`samples`), and
// `smooth_outlines`.
#include <array>
#include <numeric>

#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class Outlines : public GlTest {
 protected:
  RenderOutput picture(const std::string& name, PointCloud cloud, const Camera& camera, int samples,
                       bool smooth_outlines = false, float point_px = 0) {
    Renderer renderer(context());
    const auto technique = find_technique(name).create();
    if (point_px > 0) {
      set_parameter(*technique, "size_mode", "pixels");
      set_parameter(*technique, "point_size", std::to_string(point_px));
    }
    show(renderer, std::move(cloud), technique->needs());
    RenderSettings settings;
    settings.transparent = true;
    settings.samples = samples;
    settings.smooth_outlines.user = smooth_outlines;
    return renderer.render(*technique, camera, settings, all_outputs());
  }
};

/// A dense white square grid that ends at a slanted line through the origin, seen from above, one unit a
/// pixel.
PointCloud half_plane(double slope) {
  PointCloud cloud;
  for (double y = -20; y < 20; y += 0.25)
    for (double x = -20; x < 20; x += 0.25)
      if (x < slope * y) {
        cloud.positions.push_back({float(x), float(y), 0});
        cloud.colors.push_back({255, 255, 255, 255});
      }
  return cloud;
}

TEST_F(Outlines, SamplesAverageThePicturesThroughTheRotatedGrid) {
  // (1/8, 5/8), (3/8, 1/8), (5/8, 7/8), (7/8, 3/8): the principal point moves by as much from the middle of
  // the pixel.
  const std::array<vec2, 4> places{vec2(-0.375f, 0.125f), vec2(-0.125f, -0.375f), vec2(0.125f, 0.375f),
                                   vec2(0.375f, -0.125f)};
  const Camera camera = front_camera(64, 48);
  for (const char* name : {"points", "splats", "surface"}) {
    const RenderOutput four = picture(name, sphere_cloud(4000), camera, 4);
    Image<vec4> mean(64, 48);
    for (const vec2& place : places) {
      Camera moved = camera;
      Intrinsics inside = camera.intrinsics();
      inside.cx += place.x, inside.cy += place.y;
      moved.custom_intrinsics = inside;
      const RenderOutput one = picture(name, sphere_cloud(4000), moved, 1);
      for (std::size_t i = 0; i < mean.size(); ++i) mean.begin()[i] += 0.25f * one.color_linear.begin()[i];
    }
    for (std::size_t i = 0; i < mean.size(); ++i)
      for (int k = 0; k < 4; ++k)  // sums of four floats below 1, in whatever order
        ASSERT_NEAR(four.color_linear.begin()[i][k], mean.begin()[i][k], 1e-6) << name << " pixel " << i;
  }
}

/// How far the ends of rows are from a straight line, whose offset is free since a point covers at least a
/// pixel: rms, px.
double unevenness(const Image<vec4>& image, double slope) {
  std::vector<double> off;
  for (int y = 8; y < 32; ++y) {
    double covered = 0;
    for (int x = 0; x < 40; ++x) covered += image.at(x, y).a;
    off.push_back(covered - slope * (20 - (y + 0.5)));  // rows count down, y of the world up
  }
  const double mean = std::accumulate(off.begin(), off.end(), 0.0) / double(off.size());
  double sum = 0;
  for (double each : off) sum += (each - mean) * (each - mean);
  return std::sqrt(sum / double(off.size()));
}

TEST_F(Outlines, FollowTheirLine) {
  // One sample rounds the end of a row to whole pixels, an error uniform in +-1/2 (rms 0.29); 16 samples to
  // sixteenths of one, and the grid of points, four a pixel, adds 1/4 / sqrt(12) = 0.07. From one sample the
  // line is drawn between the middles of its steps, which the grid of points moves by as much.
  const Camera camera = camera_above(10, 40, 40);
  for (const double slope : {0.1, 0.37, 0.9}) {
    EXPECT_GT(unevenness(picture("points", half_plane(slope), camera, 1).color_linear, slope), 0.2) << slope;
    EXPECT_LT(unevenness(picture("points", half_plane(slope), camera, 16).color_linear, slope), 0.1) << slope;
    // Near a diagonal every step is one pixel long, and where one is two its neighbours do not know: the line
    // is straight but for a bend there, up to half a pixel off, as without smoothing.
    const double smoothed =
        unevenness(picture("points", half_plane(slope), camera, 1, true).color_linear, slope);
    EXPECT_LT(smoothed, slope < 0.5 ? 0.15 : 0.29) << slope;
  }
}

TEST_F(Outlines, StepsInDepthAreSmoothed) {
  // A white half plane above a black floor: nothing is uncovered, and the edge is as smooth as against the
  // background.
  PointCloud cloud = half_plane(0.37);
  for (vec3& p : cloud.positions) p.z = 8;
  for (double y = -22; y < 22; y += 0.25)
    for (double x = -22; x < 22; x += 0.25) {
      cloud.positions.push_back({float(x), float(y), 0});
      cloud.colors.push_back({0, 0, 0, 255});
    }
  const Camera camera = camera_above(10, 40, 40);
  auto whiteness = [](Image<vec4> image) {
    for (vec4& c : image) c.a = c.g;
    return image;
  };
  const Image<vec4> plain = whiteness(picture("points", cloud, camera, 1).color_linear);
  const Image<vec4> smooth = whiteness(picture("points", cloud, camera, 1, true).color_linear);
  EXPECT_GT(unevenness(plain, 0.37), 0.2);
  EXPECT_LT(unevenness(smooth, 0.37), 0.15);  // as above
}

double coverage(const Image<vec4>& image) {
  double sum = 0;
  for (const vec4& c : image) sum += c.a;
  return sum;
}

TEST_F(Outlines, ThinThingsStay) {
  const Camera camera = camera_above(10, 80, 80);
  for (const bool before_floor : {false, true}) {
    // What a floor behind shows is black; there the whiteness counts.
    const auto drawn = [&](PointCloud cloud, bool smooth, float px) {
      cloud.colors.assign(cloud.size(), {255, 255, 255, 255});
      for (vec3& p : cloud.positions) p.z = 8;
      for (float y = -45; before_floor && y < 45; y += 0.5f)
        for (float x = -45; x < 45; x += 0.5f) {
          cloud.positions.push_back({x, y, 0});
          cloud.colors.push_back({0, 0, 0, 255});
        }
      Image<vec4> image = picture("points", std::move(cloud), camera, 1, smooth, px).color_linear;
      for (vec4& c : image) c.a = c.g;
      return image;
    };
    // Lone points, one and two pixels wide.
    PointCloud dust;
    for (int y = -30; y <= 30; y += 10)
      for (int x = -30; x <= 30; x += 10) dust.positions.push_back({float(x) + 0.01f, float(y) + 0.01f, 0});
    for (const float px : {1.0f, 2.0f}) {
      const double plain = coverage(drawn(dust, false, px));
      ASSERT_GE(plain, 49);
      EXPECT_NEAR(coverage(drawn(dust, true, px)), plain, 1e-3 * plain) << px << " px " << before_floor;
    }
    // Wires one pixel wide are as bright as they were. Depth tells a spike of one pixel before a surface from
    // a slope only where two of its pixels lie one above the other: these lose a corner there.
    for (const double degrees : {0.0, 5.0, 20.0, 45.0, 70.0, 90.0}) {
      const double across = std::cos(glm::radians(degrees)), up = std::sin(glm::radians(degrees));
      PointCloud wire;
      for (double t = -30; t < 30; t += 0.05)
        wire.positions.push_back({float(t * across) + 0.01f, float(t * up) + 0.01f, 0});
      const Image<vec4> plain = drawn(wire, false, 1), smooth = drawn(wire, true, 1);
      EXPECT_NEAR(coverage(smooth) / coverage(plain), 1, before_floor ? 0.12 : 0.02)
          << degrees << " degrees " << before_floor;
    }
  }
}

TEST_F(Outlines, HolesOfAPixelClose) {
  // A sheet that lacks every tenth pixel of every tenth row.
  PointCloud cloud;
  for (double y = -29.875; y < 30; y += 0.25)
    for (double x = -29.875; x < 30; x += 0.25)
      if (std::fmod(std::floor(x) + 35, 10) != 0 || std::fmod(std::floor(y) + 35, 10) != 0)
        cloud.positions.push_back({float(x), float(y), 0});
  const Camera camera = camera_above(10, 40, 40);
  const double plain = coverage(picture("points", cloud, camera, 1, false, 1).color_linear);
  EXPECT_EQ(plain, 1600 - 16);
  EXPECT_NEAR(coverage(picture("points", cloud, camera, 1, true, 1).color_linear), 1600, 0.1);
}

TEST_F(Outlines, WhatIsPaintedOnASurfaceStaysSharp) {
  PointCloud cloud = half_plane(0);  // x < 0
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (int(std::floor(cloud.positions[i].x)) % 2 != 0) cloud.colors[i] = {0, 0, 0, 255};
  // Steep enough to look like a step to one who does not know slopes: 3 units a pixel.
  for (vec3& p : cloud.positions) p.z = -3 * p.x;
  const Camera camera = camera_above(100, 40, 40);
  const RenderOutput plain = picture("points", cloud, camera, 1),
                     smooth = picture("points", cloud, camera, 1, true);
  for (int y = 2; y < 38; ++y)
    for (int x = 2; x < 18; ++x)
      ASSERT_EQ(plain.color_linear.at(x, y), smooth.color_linear.at(x, y)) << x << " " << y;
}

TEST_F(Outlines, SamplesLeaveDepthsAndNormalsAtPixelCentres) {
  const Camera camera = front_camera(64, 48);
  for (const char* name : {"splats", "surface"}) {
    const RenderOutput one = picture(name, sphere_cloud(4000), camera, 1);
    const RenderOutput four = picture(name, sphere_cloud(4000), camera, 4);
    for (std::size_t i = 0; i < one.depth.size(); ++i) {
      ASSERT_EQ(one.depth.begin()[i], four.depth.begin()[i]) << name;
      ASSERT_EQ(one.normal.begin()[i], four.normal.begin()[i]) << name;
    }
  }
}

}  // namespace
