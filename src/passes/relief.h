// Eye-dome lighting, ambient occlusion and radiance scaling, from the depth and normals of a finished
// picture: one pass for all that has a depth.
#pragma once

#include <vector>

#include "gl/texture.h"
#include "passes/screen_pass.h"
#include "passes/view.h"

namespace sfumato {

/// Darkens pixels that lie behind their neighbours (eye-dome lighting, Boucheny 2009) and those that what is
/// around them hides from the sky (ambient occlusion in octaves, Hoang and Low 2012), as far as both exceed
/// the noise of the depth, which is measured in the picture itself; lightens ridges and darkens valleys
/// (radiance scaling, Vergne et al. 2010). Background neighbours do not count.
class Relief {
 public:
  struct Options {
    float edl_strength = 0;   ///< 0: no lines
    float edl_radius = 1.4f;  ///< px of a picture 720 px high; of higher ones so much more
    bool coarse = false;      ///< ambient occlusion without its finest octaves
    float occlusion = 0;      ///< share of what ambient occlusion takes, 0 to 1
    /// Of the points between which a surface was closed, scene units: where they are far apart on the screen,
    /// lower steps are none of theirs; 0 where nothing was closed.
    float spacing = 0;
    float noise = 0;  ///< standard deviation of the points off their surfaces, scene units; 0: not measured
    /// Of points that one sensor saw: where it was, in eye space, and their noise over the distance to it
    /// squared, in place of `noise`; 0 of others.
    vec3 sensor{0};
    float sensor_noise = 0;
    float scaling = 0;         ///< strength of radiance scaling
    float median_spacing = 0;  ///< of the points, scene units: their normals show no finer shape
    bool any() const { return edl_strength > 0 || occlusion > 0 || scaling > 0; }
  };
  /// Reads all of `color` (premultiplied), `depth` and, for radiance scaling, `normal`; writes `out`.
  void run(const View& view, const Options& options, const gl::Texture& color, const gl::Texture& depth,
           const gl::Texture& normal, const gl::Texture& out);

  /// The first half of it: ambient occlusion alone, of squares.
  struct Openness {
    const gl::Texture& squares;  ///< RG32F: openness, and noise of the depth, scene units
    float square_px;
  };
  Openness find_openness(const View& view, const Options& options, const gl::Texture& depth);
  /// A distance to compare depths with where there is no eye: that of a camera of 45 degrees that sees as
  /// much.
  static float orthographic_distance(const View& view);
  /// Of eye-dome lighting in a picture so high.
  static float radius_px(const Options& options, int picture_height);
  /// Over which the normals of radiance scaling open, to both sides of a pixel: the k-th of seven distances,
  /// in half octaves. Of whole octaves each would end in a line beside an edge.
  static int scaling_px(int k, int picture_height);
  static constexpr int scaling_distances = 7;

  /// How far around itself a pixel sees, px.
  static int reach_px(const Options& options, int picture_height);

 private:
  static constexpr int levels = 6;  ///< squares of 2 to 64 px: whole in tiles, which begin at 64 px
  gl::Texture pyramid_, openness_;
  std::vector<gl::Texture> views_;
  ScreenPass coarser_, occlusion_, relief_;
};

}  // namespace sfumato
