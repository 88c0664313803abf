#include "passes/relief.h"

#include <algorithm>
#include <cmath>

#include "gl/commands.h"
#include "gl/context.h"

namespace sfumato {
namespace {

/// Pictures higher than this have their relief so much wider, that they look alike.
constexpr float usual_height = 720;
/// Distances of the octaves at that height: 6 px to 96 px, an eighth of it.
constexpr float first_octave_px = 6;
constexpr int all_octaves = 5, fine_octaves = 2;
/// 1 to 8 px at that height.
constexpr float finest_scaling_px = 1;
/// Squares of 32 px: elsewhere nothing is covered.
constexpr int tile_level = 4;

float widened(int picture_height) { return std::max(1.0f, float(picture_height) / usual_height); }

/// The level whose squares are 2 px at the usual height, and about as wide a share of larger ones.
int finest_level(int picture_height, int levels) {
  return std::min(int(std::lround(std::log2(widened(picture_height)))), levels - 3);
}

}  // namespace

int Relief::reach_px(const Options& options, int picture_height) {
  const float farthest = std::exp2(float(all_octaves - 1)) * first_octave_px;
  // Squares, and those that noise is measured in.
  return int(std::ceil(widened(picture_height) * std::max(farthest, options.edl_radius))) + 2 * (2 << levels);
}

float Relief::radius_px(const Options& options, int picture_height) {
  return options.edl_radius * widened(picture_height);
}

int Relief::scaling_px(int k, int picture_height) {
  return int(std::floor(finest_scaling_px * widened(picture_height) * float(1 << k / 2) *
                            (k % 2 == 0 ? 1.0f : 1.41421356f) +
                        0.5f));
}

float Relief::orthographic_distance(const View& view) {
  return float(view.picture_height() / view.camera().pixels_per_unit() / (2 * std::tan(glm::radians(22.5))));
}

Relief::Octaves Relief::octaves(const Options& options, int picture_height) {
  return {finest_level(picture_height, levels), first_octave_px * widened(picture_height),
          options.coarse ? fine_octaves : 0, options.occlusion > 0 ? all_octaves : 0};
}

void Relief::find_openness(const View& view, const Octaves& octaves, const Options& options,
                           const gl::Texture& depth) {
  view.bind();
  const int last = 1 << levels, width = (depth.width() + last - 1) / last * last,
            height = (depth.height() + last - 1) / last * last;
  if (!pyramid_ || pyramid_.width() != width / 2 || pyramid_.height() != height / 2) {
    pyramid_ = gl::Texture("depth pyramid", GL_RGBA32F, width / 2, height / 2, levels);
    views_.clear();
    for (int l = 0; l < levels; ++l) views_.push_back(gl::Texture::view(pyramid_, l));
  }
  if (!coarser_) {
    coarser_ = ScreenPass("passes/relief_pyramid.glsl", {GL_RGBA32F});
    occlusion_ = ScreenPass("passes/relief_occlusion.glsl", {GL_RG32F});
  }
  for (int l = 0; l < levels; ++l) {
    coarser_.set("is_first", l == 0).set("width_px", float(2 << l));
    coarser_.run({l == 0 ? &depth : &views_[std::size_t(l - 1)]}, {&views_[std::size_t(l)]});
  }
  const gl::Texture& squares = views_[std::size_t(octaves.finest)];
  gl::ensure(openness_, "openness", GL_RG32F, squares.width(), squares.height());
  occlusion_.set("levels", levels)
      .set("finest", octaves.finest)
      .set("octaves", octaves.end)
      .set("first_octave", octaves.first);
  occlusion_.set("first_px", octaves.first_px).set("spacing", options.spacing);
  occlusion_.set("point_noise", options.noise).set("sensor", vec4(options.sensor, options.sensor_noise));
  if (gl::limits().software) gl::finish();  // see Tiles
  occlusion_.run({views_[tile_level], 1 << (tile_level - octaves.finest)}, {&pyramid_}, {&openness_},
                 {vec4(1, 0, 0, 0)});
}

void Relief::run(const View& view, const Options& options, const gl::Texture& color, const gl::Texture& depth,
                 const gl::Texture& normal, const gl::Texture& out) {
  const Octaves over = octaves(options, view.picture_height());
  find_openness(view, over, options, depth);
  if (!relief_) relief_ = ScreenPass("passes/relief.glsl", {GL_RGBA32F});
  relief_.set("square_px", over.square_px())
      .set("radius_px", radius_px(options, view.picture_height()))
      .set("strength", options.edl_strength)
      .set("occlusion", options.occlusion)
      .set("orthographic_distance", orthographic_distance(view))
      .set("spacing", options.spacing);
  relief_.set("scaling", options.scaling)
      .set("scaling_px", finest_scaling_px * widened(view.picture_height()))
      .set("scaling_distances", scaling_distances)
      .set("point_noise", options.noise)
      .set("sensor", vec4(options.sensor, options.sensor_noise))
      .set("median_spacing", options.median_spacing);
  gl::copy(color, ivec2(0), out, ivec2(0), ivec2(color.width(), color.height()));
  relief_.run({views_[tile_level], 2 << tile_level}, {&color, &depth, &openness_, &normal}, {&out}, {});
}

}  // namespace sfumato
