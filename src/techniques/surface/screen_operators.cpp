#include "techniques/surface/screen_operators.h"

#include <cmath>

#include "gl/commands.h"
#include "gl/context.h"

namespace sfumato::surface {

void HiddenPoints::run(const NearestPyramid& pyramid, const Options& options) {
  tile_level_ = 5;
  run(pyramid.texture(), pyramid.level(options.coarse_level), NearestPyramid::levels, options);
}

void HiddenPoints::run_squares(const NearestPyramid& pyramid, Options options) {
  // A square is two pixels: lengths in squares are half as many, levels one less.
  options.coarse_level = std::max(options.coarse_level, 1);
  const gl::Texture& coarse = pyramid.level(options.coarse_level);
  --options.coarse_level;
  options.removal_scale /= 2, options.gap_scale /= 2;
  options.window_radius = (options.window_radius + 1) / 2;
  options.disc_radius = 0;
  options.holes = false;
  tile_level_ = 4;
  run(pyramid.squares(), coarse, NearestPyramid::levels - 1, options);
}

void HiddenPoints::run(const gl::Texture& points, const gl::Texture& coarse, int levels,
                       const Options& options) {
  if (!choose_level_) choose_level_ = ScreenPass("techniques/surface/removal_level.glsl", {GL_R32F});
  gl::ensure(level_, "removal level", GL_R32F, coarse.width(), coarse.height());
  choose_level_.set("coarse_level", options.coarse_level).set("levels", levels);
  choose_level_.set("removal_scale", options.removal_scale);
  choose_level_.run({&points}, {&level_});

  const bool window = options.method == Removal::window;
  const float gap_level = std::log2(options.gap_scale / options.removal_scale);
  const int top_level = levels - 1;
  if (!find_tiles_) find_tiles_ = ScreenPass("techniques/surface/tiles_in_reach.glsl", {GL_R8});
  gl::ensure(tiles_, "tiles in reach", GL_R8, points.width() >> tile_level_, points.height() >> tile_level_);
  find_tiles_.set("tile_level", tile_level_)
      .set("coarse_level", options.coarse_level)
      .set("top_level", top_level);
  find_tiles_.set("gap_level", gap_level)
      .set("window_level", window ? std::log2(float(options.window_radius)) : 0);
  find_tiles_.run({&points, &level_}, {&tiles_});
  if (gl::limits().software) gl::finish();  // see Tiles::on

  ScreenPass& pass = removal_[(window ? 1 : 0) + (options.count_fetches ? 2 : 0) + (options.holes ? 4 : 0)];
  if (!pass) {
    gl::Defines defines;
    if (window) defines.push_back("WINDOW");
    if (options.holes) defines.push_back("HOLES");
    if (options.count_fetches) defines.push_back("COUNT_FETCHES");
    std::vector<GLenum> formats{GL_R32F, GL_RGBA32F};
    if (options.count_fetches) formats.push_back(GL_R32F);
    pass = ScreenPass("techniques/surface/hidden_points.glsl", formats, defines);
  }
  pass.set("coarse_level", options.coarse_level).set("top_level", top_level);
  pass.set("window_radius", options.window_radius).set("gap_level", gap_level);
  pass.set("disc_radius", options.disc_radius)
      .set("disc_level", options.disc_level)
      .set("threshold", options.point_threshold());
  gl::ensure(mean_, "mean occlusion", GL_R32F, points.width(), points.height());
  gl::ensure(visible_, "visible points", GL_RGBA32F, points.width(), points.height());
  if (options.count_fetches) {
    gl::ensure(fetches_, "fetches", GL_R32F, points.width(), points.height());
    pass.run(tiles(), {&points, &level_}, {&mean_, &visible_, &fetches_}, {vec4(2), vec4(0), vec4(0)});
  } else {
    pass.run(tiles(), {&points, &level_}, {&mean_, &visible_}, {vec4(2), vec4(0)});
  }
}

const gl::Texture& LevelNormals::run(const std::vector<PullPush::Level>& filled, int first, int last) {
  const int width = filled[0].a.width(), height = filled[0].a.height();
  if (!pass_) pass_ = ScreenPass("techniques/surface/level_normals.glsl", {GL_RGBA32F});
  if (!storage_ || storage_.width() != width || storage_.height() != height) {
    storage_ = gl::Texture("normals", GL_RGBA32F, width, height, NearestPyramid::levels);
    views_.clear();
    for (int l = 0; l < NearestPyramid::levels; ++l) views_.push_back(gl::Texture::view(storage_, l));
    storage_.set_trilinear_filter();
  }
  for (int l = first; l <= last; ++l) {
    pass_.set("level", l);
    pass_.run({&filled[std::size_t(l)].a}, {&views_[std::size_t(l)]});
  }
  return storage_;
}

}  // namespace sfumato::surface
