// How large the dots of `points` are.
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// The diameter of a dot in a picture of 720 rows that shows points of a square grid so many px apart, from
/// the area that 9 x 9 of them cover; where they overlap, of a disc of the area that each has left.
double diameter_px(double apart_px) {
  PointCloud cloud;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) cloud.positions.push_back({float(x - 19.5), float(y - 19.5), 0});
  Renderer renderer(context());
  const auto technique = find_technique("points").create();
  show(renderer, cloud, technique->needs());
  Camera camera = camera_at({0, 0, 100}, 720, 720);
  camera.projection = Projection::orthographic;
  camera.height_world = 720 / apart_px;
  RenderSettings settings;
  settings.transparent = true;
  const RenderOutput out = renderer.render(*technique, camera, settings, all_outputs());
  const int half = int(4.5 * apart_px);
  int covered = 0;
  for (int y = 360 - half; y < 360 + half; ++y)
    for (int x = 360 - half; x < 360 + half; ++x) covered += std::isfinite(out.depth.at(x, y));
  return 2 * std::sqrt(covered / 81.0 / std::acos(-1.0));
}

TEST(Points, DotsFarApartStayDots) {
  // Where all are so far apart dots are 0.32 of 2.5 spacings wide, 16 px at most. 8 of a grid are in a disc
  // of 1.41 steps, which is a spacing of 1.41 sqrt(pi / 8) = 0.886; 0.7: half a pixel each side.
  EXPECT_NEAR(diameter_px(20), 0.32 * 2.5 * 20 * 0.886, 0.7);
  EXPECT_NEAR(diameter_px(40), 16, 0.7);
  // What covers 9 x 9 places as a whole: nothing between them is open.
  EXPECT_NEAR(diameter_px(5), 5 * 2 / std::sqrt(std::acos(-1.0)), 0.7);
}

// Ground of points 8 px apart, four times as far as most. A disc of 2.5 spacings of 6.7 px (0.836 of the
// grid's steps, as above) would be drawn 9.6 px wide and close nothing; it is smaller by the root of 3 px
// over 6.7. 0.7: half a pixel each side.
TEST_F(GlTest, SparsePartsOfAScanRecede) {
  PointCloud cloud;
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 150; ++x) cloud.positions.push_back({float(x) - 170, float(y - 75), 0});
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) cloud.positions.push_back({4 * float(x), 4 * float(y - 20), 0});
  Renderer renderer(context());
  const auto technique = find_technique("points").create();
  show(renderer, cloud, technique->needs());
  Camera camera = camera_at({0, 0, 1000}, 720, 720);
  camera.projection = Projection::orthographic;
  camera.height_world = 360;
  RenderSettings settings;
  settings.transparent = true;
  const RenderOutput out = renderer.render(*technique, camera, settings, all_outputs());
  int covered = 0;
  for (int y = 320; y < 400; ++y)
    for (int x = 480; x < 560; ++x) covered += std::isfinite(out.depth.at(x, y));
  const double diameter = 2 * std::sqrt(covered / 100.0 / std::acos(-1.0));
  EXPECT_NEAR(diameter, 9.6 * std::sqrt(3.0 / 6.7), 0.7);
}

// A picture looks the same in every size, also where points are more than 64 px wide.
TEST_F(GlTest, TallPicturesHaveNoMoreHoles) {
  PointCloud cloud;
  for (int z = 0; z < 60; ++z)
    for (int x = 0; x < 60; ++x) cloud.positions.push_back({float(x) / 29.5f - 1, 0, float(z) / 29.5f - 1});
  auto technique = find_technique("points").create();
  Renderer renderer(context());
  show(renderer, cloud, technique->needs());
  const auto open_share = [&](int height) {
    const RenderOutput out = renderer.render(*technique, camera_at({0, -2.2, 0}, height / 8, height), [] {
      RenderSettings s;
      s.transparent = true;
      return s;
    }());
    std::size_t open = 0, all = 0;
    for (int y = 3 * height / 10; y < 7 * height / 10; ++y)
      for (int x = 0; x < height / 8; ++x, ++all) open += out.rgba8.at(x, y).a == 0;
    return double(open) / double(all);
  };
  const double usual = open_share(720);
  EXPECT_NEAR(open_share(1440), usual, 0.02);
  EXPECT_NEAR(open_share(7200), usual, 0.02);
}

}  // namespace
