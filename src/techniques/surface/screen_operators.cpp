#include "techniques/surface/screen_operators.h"

#include <cmath>

namespace sfumato::surface {

const gl::Texture& HiddenPoints::run(const NearestPyramid& pyramid, const Options& options) {
  const gl::Texture &points = pyramid.texture(), &coarse = pyramid.level(options.coarse_level);
  if (!choose_level_) choose_level_ = ScreenPass("techniques/surface/removal_level.glsl", {GL_R32F});
  gl::ensure(level_, "removal level", GL_R32F, coarse.width(), coarse.height());
  choose_level_.set("coarse_level", options.coarse_level).set("levels", NearestPyramid::levels);
  choose_level_.set("removal_scale", options.removal_scale);
  choose_level_.run({&points}, {&level_});

  const bool window = options.method == Removal::window;
  ScreenPass& pass = removal_[(window ? 1 : 0) + (options.count_fetches ? 2 : 0)];
  if (!pass) {
    gl::Defines defines;
    if (window) defines.push_back("WINDOW");
    if (options.count_fetches) defines.push_back("COUNT_FETCHES");
    pass = ScreenPass("techniques/surface/hidden_points.glsl",
                      options.count_fetches ? std::vector<GLenum>{GL_R32F, GL_R32F} : std::vector<GLenum>{GL_R32F},
                      defines);
  }
  pass.set("coarse_level", options.coarse_level).set("window_radius", options.window_radius);
  pass.set("disc_radius", options.disc_radius);
  pass.set("gap_level", std::log2(options.gap_scale / options.removal_scale));
  gl::ensure(mean_, "mean occlusion", GL_R32F, points.width(), points.height());
  if (options.count_fetches) {
    gl::ensure(fetches_, "fetches", GL_R32F, points.width(), points.height());
    pass.run({&points, &level_}, {&mean_, &fetches_});
  } else {
    pass.run({&points, &level_}, {&mean_});
  }
  return mean_;
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
