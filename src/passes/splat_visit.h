// Small splats by compute: nearest distance, and the list of those that may be seen at all, so that
// attributes are read and blended only for them.
#pragma once

#include <vector>

#include "gl/program.h"
#include "gl/texture.h"
#include "passes/compaction.h"
#include "passes/screen_pass.h"
#include "passes/splat_raster.h"

namespace sfumato {

/// Runs a compute program over the small splats of `batches`, one thread each, in work groups of 128: the
/// batch is `visible_batch(gl_WorkGroupID.y)`, the place in it gl_GlobalInvocationID.x. Uniforms, textures of
/// the pass and images are the caller's, as is the barrier afterwards. `colors`: binds colours and shadow
/// factors too.
void visit_small(GpuCloud& cloud, const View& view, const SplatBatches& batches, gl::Program& program,
                 bool colors = false);

class SplatVisit {
 public:
  /// Lowers `nearest_t` (R32F) to the nearest hit among the small splats of `batches`, each moved back by
  /// `shift`.
  void draw_nearest(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                    const SplatShift& shift, const gl::Texture& nearest_t);
  /// Lists the small splats of one chunk with a pixel within epsilon behind `nearest_t`, in the order of the
  /// cloud. False when the chunk has no small splats in view. `list()` and `command()` hold the result until
  /// the next call.
  bool list_survivors(GpuCloud& cloud, std::size_t chunk, const View& view, const SplatShape& shape,
                      const SplatBatches& batches, const gl::Texture& nearest_t, float epsilon);
  /// To be called once before `list_survivors`, when `nearest_t` is complete.
  void measure_farthest(const View& view, const gl::Texture& nearest_t);

  const gl::TextureBuffer& list() const { return survivors_.list(); }
  const gl::Buffer& command() const { return survivors_.command(); }  ///< an indirect draw of the list

 private:
  gl::Program& program(bool mark, const SplatShape& shape);
  gl::Program programs_[8];
  ScreenPass farthest_;
  gl::Texture farthest_t_;
  Compaction survivors_;
};

}  // namespace sfumato
