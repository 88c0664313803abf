// The soft points of a cloud, gathered over its chunks: spheres in eye space with their light, and their
// order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "passes/depth_sort.h"
#include "passes/frame.h"
#include "passes/splat_raster.h"

namespace sfumato::soft {

/// What all soft points share in a frame.
struct Look {
  float opacity = 0.15f;
  float field_threshold = 1, modulation_threshold = 1, modulation_opacity = 1;
  bool antialias = true;
  int concentric_count = 0;  ///< 0: by size on the screen
  float concentric_spacing_px = 4;
  SplatShape shape;  ///< radius scale and limit
};

/// An order of drawing: `count` slots of `list`, from `first` by `step` (1 or -1).
struct Order {
  const gl::TextureBuffer* list = nullptr;
  int first = 0, step = 1;
  std::uint32_t count = 0;
};

/// Of every point: what stands for haze is no plate, so what shrank in clutter is as large as Eq. 20 has it
/// again, up to two medians of the cloud.
std::vector<float> haze_radii(const PreparedCloud& prepared);

class SoftPoints {
 public:
  /// Chooses the points with field > threshold; nothing to do while field and threshold stay. `radii_of_all`:
  /// of the soft points of a whole, where these are some of them, with `haze_radii`.
  void choose(GpuCloud& cloud, std::span<const float> field, float threshold,
              const std::vector<float>* radii_of_all = nullptr);
  /// Number of soft points, each with a slot 0, 1 ... in the order of the prepared cloud.
  std::uint32_t count() const { return std::uint32_t(places_.size()); }
  /// Of every slot, its place in the prepared cloud.
  std::span<const std::uint32_t> places() const { return places_; }
  /// haze_radii of the prepared cloud.
  std::span<const float> radii() const { return radii_; }
  /// The same, uploaded; null where none differs from the cloud's.
  const std::shared_ptr<const GpuCloud::Shapes>& own_radii() const { return own_radii_; }
  /// Radius beyond which a soft point counts as isolated, scene units: twice the median of the soft points,
  /// or what nine in ten of them keep. Not that of all points: uncertain ones lie far apart.
  float radius_limit() const { return radius_limit_; }
  /// Spheres in eye space, shaded; those behind `solid_t` (R32F, ray distances) are left out. `view` and
  /// light are those of `frame`.
  void update(Frame& frame, const View& view, const Look& look, const gl::Texture& solid_t);

  /// Far to near by distance from the camera; kept while view and points stay.
  Order far_to_near(const View& view);
  /// Along an axis of the cloud, for a camera that looks in `sign` direction of it: far points first. Six
  /// orders from three arrays read both ways (Seemann 2018, Sec. 4).
  Order along_axis(int axis, bool positive);

  /// Draws every soft point with `fragment`, in its own order or in `order`. Binds `solid_t` for the
  /// fragments.
  void draw(gl::Program& program, bool as_quads, const gl::Texture& solid_t, const gl::State& state,
            const Order* order = nullptr);
  /// For screen passes that read the spheres: UNIT_INPUT and UNIT_INPUT + 1.
  const gl::TextureBuffer& shapes() const { return shapes_; }
  const gl::TextureBuffer& looks() const { return looks_; }
  /// RG32UI, of every slot: first and last pixel of its box, x in the low 16 bits, y in the high ones; the
  /// last before the first where there is nothing to draw.
  const gl::TextureBuffer& boxes() const { return boxes_; }

 private:
  const PointCloud* cloud_ = nullptr;
  std::shared_ptr<const GpuCloud::Values> field_;  ///< that was chosen from
  float threshold_ = 0, radius_limit_ = 0;
  std::vector<float> radii_;
  std::shared_ptr<const GpuCloud::Shapes> own_radii_;
  std::vector<std::uint32_t> by_source_;  ///< all places of the cloud by source index: what ties follow
  std::vector<std::uint32_t> places_;     ///< in the prepared cloud, ascending
  std::vector<std::uint32_t> initial_;    ///< slots by source index
  bool chosen_anew_ = true, sorted_ = false;
  dmat4 sorted_view_{0}, sorted_projection_{0};
  vec3 sorted_sizes_{0};  ///< radius scale, limit, antialiasing: what decides which spheres the view sees
  std::vector<gl::TextureBuffer> lists_;  ///< of each chunk: places within it
  gl::TextureBuffer shapes_, looks_, boxes_;
  gl::Buffer keys_;
  gl::Program fill_;
  DepthSort depth_sort_;
  std::array<gl::TextureBuffer, 3> axis_orders_;
};

}  // namespace sfumato::soft
