// Splats through the rasteriser, for every technique that draws discs or spheres.
//
// A technique brings its own fragment file, which includes shaders/splat_fragment.glsl (ray casting, weights,
// what the vertex stage hands over), and the targets and blending that go with it:
//
//   SplatRaster raster("techniques/mine/mine.frag", {"SPLAT_COLOR"});
//   SplatBatches batches = choose_batches(cloud, view, shape);       // once a frame
//   gl::Framebuffer framebuffer({&sums}); framebuffer.bind();
//   raster.draw(cloud, view, shape, batches, {.blend = gl::State::Blend::add},
//               [&](gl::Program& p) { p.set("mine", mine); });
//
// Definitions: SPLAT_COLOR (colour and shadow factor), SPLAT_FIELD (the scalar; set shape.part), SPLAT_SPHERE
// (the primitive covers the ball of that radius and not only the disc), KERNEL_GAUSSIAN, and whatever the
// fragment file itself looks at. Textures of the pass are bound to UNIT_INPUT + k, images to image units, by
// the caller.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gl/preferences.h"
#include "gl/program.h"
#include "gl/state.h"
#include "passes/gpu_cloud.h"

namespace sfumato {

enum class SplatKernel { wendland, gaussian };

/// Which points a pass draws: all, or those on one side of a threshold of the cloud's field.
enum class SplatPart { all, not_above, above };

struct SplatShape {
  float radius_scale = 1;
  float radius_limit = std::numeric_limits<float>::infinity();  ///< scene units, applied before the scale
  float widest_px = std::numeric_limits<float>::infinity();  ///< radius on the screen, beyond which a splat
                                                             ///< shrinks to a dot
  bool dots = false;       ///< what no neighbours vouch for is turned to the camera, and no wider than a dot
  float prefilter_px = 0;  ///< radius of the screen filter (antialiasing); 0 = off
  /// Hits of the far side of a thin sheet count so much farther along the ray, the larger of the two.
  float behind = 0;        ///< scene units
  float behind_radii = 0;  ///< of the splat, before the scale
  SplatPart part = SplatPart::all;
  float field_threshold = 0;  ///< of GpuCloud::set_field; needs the definition SPLAT_FIELD
};

/// How far behind the hit of a splat others still count as the same surface, where the visibility pass adds
/// it and not its readers (shaders/splat_shift.glsl).
struct SplatShift {
  float least = 0;  ///< scene units along the ray
  float radii = 0;  ///< radii of the splat that was hit, before the scale; the larger of the two counts
  void set(gl::Program& program, const SplatShape& shape) const;
};

/// How the splats of a batch reach the pixels. `automatic` chooses per batch by its size on the screen; the
/// rest are for tests. The context's preferences decide first.
using gl::SplatPath;

/// What counts as the surface of a pixel, and how much.
struct SplatBlend {
  float epsilon = 0;  ///< scene units along the ray: how far behind the nearest hit a splat still counts
  float epsilon_radii = 0;  ///< or so many radii of the splat that was hit there, where that is more
  SplatKernel kernel = SplatKernel::wendland;
  bool opaque = false;  ///< only the nearest hit of a pixel; epsilon and kernel do not count
};

/// The batches that a view may see, by the way they are drawn.
struct SplatBatches {
  struct Ranges {
    std::vector<GLint> first, count;
    std::vector<double> units;  ///< at most what a point costs, px
    void add(std::uint32_t range_first, std::uint32_t range_count, double units_each) {
      first.push_back(GLint(range_first));
      count.push_back(GLint(range_count));
      units.push_back(units_each);
    }
  };
  struct OfChunk {
    Ranges small;   ///< in points of the chunk: splats small enough for a compute loop
    Ranges points;  ///< in points of the chunk
    Ranges quads;   ///< in vertices: six a point
  };
  std::vector<OfChunk> chunks;
  std::uint64_t points_seen = 0;
  std::uint64_t fallbacks = 0;  ///< points drawn as quads because a sprite might exceed the driver's limit
};
/// Scene units that the screen filter makes of smaller discs: at most the size of a pixel on the far side.
float filter_reach(const View& view, const SplatShape& shape);
SplatBatches choose_batches(GpuCloud& cloud, const View& view, const SplatShape& shape,
                            SplatPath path = gl::preferences().splat_path);

class SplatRaster {
 public:
  SplatRaster() = default;
  explicit SplatRaster(std::string fragment_file, gl::Defines defines = {});
  explicit operator bool() const { return !fragment_file_.empty(); }

  using SetUniforms = std::function<void(gl::Program&)>;
  /// Draws into the bound framebuffer, batches in their order: the picture is the same every time. Without
  /// `with_small` the batches of small splats are left to another pass.
  void draw(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
            const gl::State& state, const SetUniforms& set_uniforms = {}, bool with_small = true);
  /// Draws points [first, first + count) of `list` (R32UI places within the one chunk) in that order, as
  /// sprites or quads. A sprite larger than the driver's limit is cut off: where `choose_batches` counts
  /// fallbacks, use quads.
  void draw_list(GpuCloud& cloud, std::size_t chunk, const View& view, const SplatShape& shape,
                 const gl::TextureBuffer& list, GLint first, GLsizei count, bool as_quads,
                 const gl::State& state, const SetUniforms& set_uniforms = {});
  /// The same as sprites, with the number of points read from `command` (see passes/compact.comp): by the
  /// GPU, or before the draw where that is cut into slices.
  void draw_list(GpuCloud& cloud, std::size_t chunk, const View& view, const SplatShape& shape,
                 const gl::TextureBuffer& list, const gl::Buffer& command, const gl::State& state,
                 const SetUniforms& set_uniforms = {});

 private:
  gl::Program& program(const GpuCloud& cloud, const SplatShape& shape, bool quads, bool list,
                       const SetUniforms& set_uniforms);
  void bind(GpuCloud& cloud, GpuCloud::Chunk& chunk);
  std::string fragment_file_;
  gl::Defines defines_;
  void draw_ranges(const gl::Program& program, const SplatBatches::Ranges& ranges, bool quads);
  gl::Program programs_[16];
  std::vector<GLint> first_;  // of what is drawn at once
  std::vector<GLsizei> count_;
};

/// Binds what shaders/splat_cloud.glsl reads.
void bind_splats(GpuCloud& cloud, GpuCloud::Chunk& chunk);
/// Sets the uniforms of shaders/splat_cloud.glsl, for compute passes over splats too.
void set_splat_uniforms(gl::Program& program, const SplatShape& shape);
/// Definitions that follow from the shape.
gl::Defines splat_defines(gl::Defines defines, const SplatShape& shape);

}  // namespace sfumato
