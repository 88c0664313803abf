// Eye-dome lighting, ambient occlusion and radiance scaling, from the depth and normals of a finished
// picture: one pass for all that has a depth.
#pragma once

#include <cmath>
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

  static constexpr int levels = 6;  ///< squares of 2 to 64 px: whole in tiles, which begin at 64 px
  /// Distances over which ambient occlusion looks around, each twice the one before, in a picture so high.
  struct Octaves {
    int finest;      ///< level whose squares it is found for
    float first_px;  ///< of octave 0
    int first, end;  ///< which are looked over
    float square_px() const { return float(2 << finest); }
    float away_px(int octave) const { return std::exp2(float(octave)) * first_px; }
  };
  static Octaves octaves(const Options& options, int picture_height);
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
  /// Ambient occlusion of squares, with the noise of the depth in them.
  void find_openness(const View& view, const Octaves& octaves, const Options& options,
                     const gl::Texture& depth);

  gl::Texture pyramid_, openness_;
  std::vector<gl::Texture> views_;
  ScreenPass coarser_, occlusion_, relief_;
};

}  // namespace sfumato
