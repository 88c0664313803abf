// How pictures are cut; that tiles make the picture of one go is a contract of every technique.
#include "techniques/tiles.h"

#include "core/error.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class Tiles : public GlTest {};

TEST_F(Tiles, CoverEveryPixelOnceAndBeginOnTheGrid) {
  for (int size : {1, 63, 64, 65, 1000, 4096, 20001})
    for (int side : {64, 192, 3072})
      for (int overlap : {0, 1, 64, 300}) {
        int next = 0;
        for (const TileSpan& span : tile_spans(size, side, overlap)) {
          EXPECT_EQ(span.first, next);
          EXPECT_GT(span.last, span.first);
          EXPECT_LE(span.last - span.first, side);
          EXPECT_EQ(span.drawn_first % tile_grid, 0);
          EXPECT_LE(span.drawn_first, std::max(0, span.first - overlap));
          EXPECT_GE(span.drawn_last, std::min(size, span.last + overlap));
          EXPECT_LE(span.drawn_last, size);
          next = span.last;
        }
        EXPECT_EQ(next, size);
      }
}

TEST_F(Tiles, NotesOfPartsSayThatTheyAre) {
  std::vector<std::string> notes;
  add_tile_notes(notes, {"15.0 % of the points are soft", "120 strokes"});
  add_tile_notes(notes, {"15.0 % of the points are soft", "99 strokes", "4 layers"});
  add_tile_notes(notes, {"15.0 % of the points are soft", "1300 strokes"});
  add_tile_notes(notes, {"15.0 % of the points are soft", "1300 strokes"});
  EXPECT_EQ(notes, (std::vector<std::string>{"15.0 % of the points are soft",
                                             "1300 strokes (in the busiest tile)", "4 layers"}));
}

// Rows of tiles as they are drawn, from top to bottom.
TEST_F(Tiles, RowsMakeThePicture) {
  Renderer renderer(context());
  show(renderer, sphere_cloud(5000), {});
  const auto technique = find_technique("points").create();
  const RenderSettings settings;
  const Item item{0, technique.get(), &settings};
  const Camera camera = front_camera(200, 150);
  const RenderOutput whole = renderer.render({&item, 1}, camera, settings, all_outputs());
  for (int side : {0, 64}) {
    const WithPreference tiles(&gl::Preferences::tile_side, side);
    std::vector<int> firsts;
    int next = 0;
    const RenderOutput rest = renderer.render_rows(
        {&item, 1}, camera, settings, all_outputs(), [&](RenderOutput& rows, int first_row) {
          firsts.push_back(first_row);
          ASSERT_EQ(first_row, next);
          ASSERT_EQ(rows.rgba8.width(), 200);
          for (int y = 0; y < rows.rgba8.height(); ++y)
            for (int x = 0; x < 200; ++x) {
              ASSERT_EQ(rows.rgba8.at(x, y), whole.rgba8.at(x, first_row + y));
              ASSERT_EQ(rows.depth.at(x, y), whole.depth.at(x, first_row + y));
            }
          next += rows.rgba8.height();
        });
    EXPECT_EQ(next, 150);
    EXPECT_EQ(firsts.size(), side == 0 ? 1u : 3u);
    EXPECT_TRUE(rest.rgba8.empty());
    EXPECT_EQ(rest.points_drawn, whole.points_drawn);
  }
}

// Where points lie dozens of pixels apart, pixels see that far.
TEST_F(Tiles, OverlapAsFarAsSparsePointsReach) {
  Renderer renderer(context());
  const auto technique = find_technique("surface").create();
  show(renderer, sphere_cloud(400), technique->needs());
  const Camera camera = front_camera(1200, 500);
  const RenderOutput whole = renderer.render(*technique, camera, {}, all_outputs());
  const WithPreference tiles(&gl::Preferences::tile_side, 256);
  const RenderOutput tiled = renderer.render(*technique, camera, {}, all_outputs());
  for (int y = 0; y < 500; ++y)
    for (int x = 0; x < 1200; ++x) ASSERT_EQ(whole.rgba8.at(x, y), tiled.rgba8.at(x, y)) << x << " " << y;
}

/// Its table of 256 bins for each pixel is more than the texture buffers of today's drivers hold.
std::unique_ptr<Technique> denoise_of_many_bins() {
  std::unique_ptr<Technique> technique = find_technique("denoise").create();
  set_parameter(*technique, "bins", "dense");
  set_parameter(*technique, "dense_bins", "256");
  return technique;
}

TEST_F(Tiles, ServeTechniquesThatCannotHoldThePicture) {
  Renderer renderer(context());
  const auto technique = denoise_of_many_bins();
  show(renderer, sphere_cloud(5000), technique->needs());
  const Camera camera = front_camera(900, 600);
  if (technique->most_pixels() >= 900 * 600) GTEST_SKIP() << "this driver holds it";
  ASSERT_FALSE(renderer.is_tiled(camera));
  const RenderOutput picture = renderer.render(*technique, camera, {}, all_outputs());
  const WithPreference tiles(&gl::Preferences::tile_side, 192);
  const RenderOutput tiled = renderer.render(*technique, camera, {}, all_outputs());
  for (int y = 0; y < 600; ++y)
    for (int x = 0; x < 900; ++x) {
      ASSERT_EQ(picture.rgba8.at(x, y), tiled.rgba8.at(x, y));
      ASSERT_EQ(picture.depth.at(x, y), tiled.depth.at(x, y));
    }
}

// Splats that reach across hundreds of pixels, of which a tile can hold no more beside what is kept of it.
TEST_F(Tiles, HoldWhatTechniquesCanWhereverPixelsSee) {
  Renderer renderer(context());
  const auto technique = denoise_of_many_bins();
  show(renderer, sphere_cloud(30), technique->needs());
  const Camera camera = front_camera(1200, 450);
  if (technique->most_pixels() >= 1200 * 450) GTEST_SKIP() << "this driver holds it";
  const RenderOutput picture = renderer.render(*technique, camera, {}, all_outputs());
  EXPECT_TRUE(std::isfinite(picture.depth.at(600, 225)));
  EXPECT_NE(std::find(picture.notes.begin(), picture.notes.end(),
                      "pixels see farther than tiles of this picture overlap: their borders may show"),
            picture.notes.end());
}

TEST_F(Tiles, RefuseMoreThanFloatsTellApart) {
  Renderer renderer(context());
  show(renderer, sphere_cloud(100), {});
  const auto technique = find_technique("points").create();
  const Camera camera = front_camera(Renderer::largest_side + 1, 1);
  const RenderSettings settings;
  const Item item{0, technique.get(), &settings};
  EXPECT_THROW(renderer.render_rows({&item, 1}, camera, settings, {}, [](RenderOutput&, int) {}), Error);
}

}  // namespace
