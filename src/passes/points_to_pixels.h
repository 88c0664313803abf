// Points to pixels in compute: one depth visit (atomicMin), one index visit, and a resolve that reads
// attributes only for the points that survived. 4-6x faster than GL_POINTS on llvmpipe, and the only way that
// uses a data-centre GPU. GPUs with 64-bit atomics find depth and index in one visit, bit for bit the same.
// Ties go to the lowest source index: the order of the points does not matter. Where OpenGL is software,
// loops of the processor do the same (passes/points_cpu.h).
#pragma once

#include <cstdint>
#include <map>

#include "gl/buffer.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "gl/timer.h"
#include "passes/gpu_cloud.h"
#include "passes/points_cpu.h"
#include "passes/screen_pass.h"

namespace sfumato {

/// What survived, at the view's size. Also the input of the screen-space techniques.
struct PixelLayer {
  gl::Texture depth_bits;  ///< R32UI: eye depth as float bits, 0xffffffff where nothing
  gl::Texture index;       ///< R32UI: source index, 0xffffffff where nothing
  gl::Texture albedo;      ///< RGBA32F: linear colour, alpha 1 where covered
  gl::Texture depth;       ///< R32F: eye depth, +inf where nothing
  gl::Texture normal;      ///< RGBA32F: world normal facing the camera or 0; w = shadow factor
  gl::Texture shadowed;    ///< RGBA16F: linear colour, shadow factor; (0 0 0 1) where nothing
};

class PointsToPixels {
 public:
  /// How many visits `draw` takes.
  enum class Visits { automatic, one, two };
  /// One only where limits().int64_atomics, as automatic does on GPUs. One and two are by shaders.
  explicit PointsToPixels(Visits visits = Visits::automatic) : visits_(visits) {}
  /// Depth and index of the nearest point of every pixel; returns the number of points in visible batches.
  /// With `reference` (R32F, view-sized), only points at least `min_gap` behind it count
  /// (Dobrev 2010, Sec. 3).
  std::uint64_t draw(GpuCloud& cloud, const View& view, const Footprint& footprint, PixelLayer& layer,
                     gl::Timers& timers, const gl::Texture* reference = nullptr, float min_gap = 0,
                     const CasterRange* casters = nullptr);
  /// Only the depth visit, into `layer.depth_bits`: enough for light maps and culling.
  std::uint64_t draw_depth(GpuCloud& cloud, const View& view, const Footprint& footprint,
                           gl::Texture& depth_bits, const gl::Texture* reference = nullptr, float min_gap = 0,
                           const CasterRange* casters = nullptr);
  /// The same into bits that hold the points of other clouds already, of the view's size.
  std::uint64_t add_depth(GpuCloud& cloud, const View& view, const Footprint& footprint,
                          gl::Texture& depth_bits, const gl::Texture* reference = nullptr, float min_gap = 0,
                          const CasterRange* casters = nullptr);
  /// `draw_depth` without a texture, where the processor does it; null where shaders do.
  const Image<std::uint32_t>* depth_here(GpuCloud& cloud, const View& view, const Footprint& footprint);
  /// Gives back the memory that is kept from visit to visit.
  void forget() { here_ = {}, nearest_ = {}; }
  /// Entries of a list below.
  static constexpr int list_length = 4;
  /// The nearest depths in each of the `list_length` nearest bins that a pixel has points in, and the lowest
  /// source index of each, in one visit by a cascade of minima. `bin` is a power of two, scene units. Adds to
  /// R32UI textures of the view's width and `list_length` times its height (entry k of pixel (x, y) at
  /// (x, y + k height)), which the caller cleared to 0xffffffff.
  void draw_lists(GpuCloud& cloud, const View& view, const Footprint& footprint, float bin,
                  gl::Texture& depth_lists, gl::Texture& index_lists, gl::Timers& timers,
                  const gl::Texture* reference = nullptr);
  /// Attributes of the survivors into `layer.albedo`, `.depth`, `.normal` (made when missing). Without
  /// `with_normals` the normal texture is left alone: half the cost where nobody reads it.
  void resolve(GpuCloud& cloud, const View& view, PixelLayer& layer, gl::Timers& timers,
               bool with_normals = true);
  /// The survivors as screen operators want them: eye position and point spacing into `eye` (RGBA32F;
  /// z = -3e38, behind everything, and spacing 0 where nothing is), the rest into `layer.shadowed`. The
  /// spacing is that around the point (Batch::log2_spacing) unless `same_spacing` > 0 holds everywhere.
  void resolve_eye(GpuCloud& cloud, const View& view, PixelLayer& layer, gl::Texture& eye, float same_spacing,
                   gl::Timers& timers);

 private:
  /// Without `depth_bits` into `nearest_`.
  void visit(GpuCloud& cloud, const View& view, const Footprint& footprint, gl::Texture* depth_bits,
             gl::Texture* index, const gl::Texture* reference, float min_gap, const CasterRange* casters,
             bool lists = false);
  bool in_one_visit(const View& view) const;
  bool is_on_cpu() const;
  Visits visits_;
  PointsCpu here_;
  std::map<unsigned, gl::Program> programs_;
  gl::Buffer nearest_;  ///< of one visit: pairs of source index and depth bits
  bool nearest_is_empty_ = false;
  ScreenPass pairs_apart_;
  float inverse_bin_ = 0;
  /// Runs a resolve once for each chunk; binds its geometry and colours.
  void for_each_chunk(GpuCloud& cloud, const View& view, const PixelLayer& layer, ScreenPass& pass,
                      std::initializer_list<const gl::Texture*> targets, bool with_normals = false);
  ScreenPass resolve_[8], resolve_eye_[2];
};

}  // namespace sfumato
