// The visible points as oriented discs: found and averaged on the screen, with nothing known beforehand.
#pragma once

#include <vector>

#include "gl/program.h"
#include "gl/texture.h"
#include "passes/pyramid.h"
#include "passes/screen_pass.h"
#include "passes/view.h"
#include "techniques/surface/screen_operators.h"

namespace sfumato::surface {

class Discs {
 public:
  struct Options {
    float normal_scale = 3;   ///< radius of the ball that a plane is fitted to, point spacings
    float noise = 0;          ///< of the points, scene units; 0: none, or it does not count
    float disc_scale = 1.6f;  ///< radius of a disc, point spacings
    float gap_scale = 5;      ///< how far apart points of one surface may be, point spacings
    float widest_px = 64;     ///< radius of the widest disc; tiles_in_reach.glsl looks as far as 64
    bool with_shadow = false;
  };
  /// Balls as wide as `normal_scale` leave normals off by a degree or two where noise is a tenth of a
  /// spacing, and by more with more of it (docs/measurements/surface.md). There they hold so many deviations
  /// of it, if that makes them at most so many times as wide, and may grow to so many times that.
  static constexpr float little_noise = 0.1f, deviations = 3, most_of_noise = 3, grown = 4;
  /// Radius of the widest ball where points are so far apart, scene units.
  static float widest_ball(float normal_scale, float spacing, float noise);

  /// Squares of 2x2 px and coarser ones: centroids of the visible points and how many they are, RGBA32F. The
  /// finest have those of hidden points where there are no others, and their number less than 0.
  static constexpr int levels = NearestPyramid::levels - 1;

  /// `squares` as HiddenPoints::run_squares leaves it, `shadowed` colours and shadow factors. The view of the
  /// pyramid is bound.
  void find(const NearestPyramid& pyramid, const HiddenPoints& squares, const gl::Texture& shadowed,
            const Options& options);
  /// Weighted sums of the discs over every pixel of `view`, which sees what the pyramid's does.
  void draw(const View& view, const Options& options);

  const gl::Texture& clusters(int l) const { return clusters_[std::size_t(l)]; }
  /// Of all levels, the finest on the left, all others below each other beside it.
  const gl::Texture& all_clusters() const { return all_clusters_; }
  /// RG32F: mean spacing, and 1 where points are hidden.
  const gl::Texture& about(int l) const { return about_[std::size_t(l)]; }
  const gl::Texture& orientations() const { return orientations_; }  ///< RGBA32F: eye normal, radius
  const gl::Texture& ends() const {
    return ends_;
  }  ///< RGBA32F: direction, distance in px, and the spacing where there is a plane, else less than 0
  const gl::Texture& colors() const { return colors_; }        ///< RGBA16F: colour, shadow factor
  const gl::Texture& nearest() const { return nearest_t_; }    ///< R32F: ray distance
  const gl::Texture& color_sum() const { return color_sum_; }  ///< RGBA32F: w rgb, w
  const gl::Texture& normal_sum() const {
    return normal_sum_;
  }  ///< RGBA32F: w n, twice that of discs without a plane, w t
  const gl::Texture& shadow_sum() const { return shadow_sum_; }  ///< RG32F: v m, v

 private:
  void allocate(int width, int height);
  std::vector<gl::Texture> clusters_, about_;
  gl::Texture all_clusters_, orientations_, colors_, ends_, nearest_t_, color_sum_, normal_sum_, shadow_sum_;
  ScreenPass first_, coarser_, planes_;
  gl::Program draw_nearest_, accumulate_[2];
};

}  // namespace sfumato::surface
