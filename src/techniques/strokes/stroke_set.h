// The strokes of a view: chosen among the points, ready to be drawn, and the picture of their brush.
#pragma once

#include <vector>

#include "gl/program.h"
#include "gl/texture.h"
#include "passes/compaction.h"
#include "passes/depth_sort.h"
#include "passes/evidence.h"
#include "passes/gpu_cloud.h"
#include "passes/screen_pass.h"
#include "techniques/strokes/stroke_data.h"
#include "techniques/strokes/style.h"

namespace sfumato::strokes {

// As in the shaders of strokes: stroke_record.glsl, stroke.frag, paint.glsl.
constexpr std::size_t record_texels = 6;
constexpr float seen_alpha = 0.004f, opaque_alpha = 0.9951f;
constexpr std::uint32_t no_fragment = 0xffffffffu;  ///< ends a list

/// 8 x 8 variants of a brush, 64 px each, with levels. RGBA32F: alpha, height, slopes of the height along and
/// across.
class BrushPicture {
 public:
  static constexpr int tiles = 8, tile_size = 64, levels = 4;
  void update(const Brush& brush);
  const gl::Texture& texture() const { return picture_; }
  float share() const { return share_; }  ///< of the quad that is painted
  /// Half axes, of the quad's, of the box outside of which no variant reaches `alpha`; one for each level.
  struct Reach {
    vec4 along, across;
  };
  Reach reach(float alpha) const;
  /// The picture on this side.
  const Image<vec4>& level(int n) const { return images_[n]; }

 private:
  void measure();
  Brush made_;
  float share_ = 1;
  /// The most alpha of any variant by the distance from the middle of the quad, in texels of the level.
  std::vector<float> profiles_[levels][2];
  Image<vec4> images_[levels];
  gl::Texture plain_, picture_;
  ScreenPass paint_, slopes_;
};

class StrokeSet {
 public:
  /// Chooses and sets up the strokes that `view` sees. `strict`: in the colours of the cloud, whatever the
  /// look.
  void update(GpuCloud& cloud, const StrokeData& data, const View& view, const Look& look,
              const BrushPicture& brush, float noise_deg, bool two_layers, bool strict);
  /// How far the picture may be covered, by what `update` sets up from now on.
  void limit(const EvidenceReach& reach) { evidence_ = reach.limits() ? reach : anywhere; }
  std::uint32_t count() const { return count_; }
  const gl::TextureBuffer& records() const { return records_; }
  /// R32UI: strokes from near to far.
  const gl::TextureBuffer& order() const { return depth_sort_.order(); }
  /// Draws every stroke's quad, near ones first; `program` is of stroke.vert.
  /// Parts where no brush reaches `least_alpha` may be missing.
  void draw(gl::Program& program, const BrushPicture& brush, float least_alpha) const {
    draw(program, brush, least_alpha, elements_);
  }
  /// Finds the strokes that the opaque strokes hide. `opaque_depth`: window depths of whole strokes
  /// (stroke.vert).
  void hide(const View& view, const gl::Texture& opaque_depth);
  /// Draws those that `hide` left.
  void draw_visible(gl::Program& program, const BrushPicture& brush, float least_alpha) const {
    draw(program, brush, least_alpha, visible_elements_);
  }

 private:
  std::uint32_t select(GpuCloud& cloud, std::size_t chunk, const StrokeData& data, const View& view);
  void set_sizes(gl::Program& program) const;
  static constexpr EvidenceReach anywhere{1e9f, 0};
  EvidenceReach evidence_ = anywhere;
  void draw(gl::Program& program, const BrushPicture& brush, float least_alpha,
            const gl::Buffer& elements) const;
  gl::Program select_, setup_;
  Compaction chosen_;  ///< of a chunk
  gl::TextureBuffer records_;
  gl::Buffer keys_, elements_, visible_elements_;
  DepthSort depth_sort_;
  gl::Program arrange_, hide_;
  ScreenPass farthest_;
  gl::Texture farthest_depth_;
  std::uint32_t count_ = 0;
  Look look_;
  float share_ = 1;
  bool two_layers_ = true;
};

}  // namespace sfumato::strokes
