// The cloud on the GPU: chunks of attribute buffers within the driver's limits, each holding many batches.
// Attributes are uploaded on first use.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/prepared_cloud.h"
#include "gl/buffer.h"
#include "passes/view.h"

namespace sfumato {

class GpuCloud {
 public:
  struct Chunk {
    std::uint32_t first = 0, count = 0;  ///< points [first, first + count) of the prepared cloud
    std::uint32_t first_batch = 0, batch_count = 0;
    std::uint32_t visible_batches = 0;   ///< set by cull()
    std::uint32_t groups_per_batch = 0;  ///< work groups of 128 that cover the largest visible batch
    gl::TextureBuffer positions, source_index, colors, normals, radii, shadow, batches;
  };
  /// One float for each point, of each chunk. It never changes, so its address says what it is: who keeps one
  /// knows it again.
  using Values = std::vector<gl::TextureBuffer>;
  /// How much of the light each point stops, 0 to 1.
  struct Casters {
    std::shared_ptr<const Values> opacity;
    /// Spacing of the points that let some of it pass, scene units, 0 when there are none.
    float see_through_spacing = 0;
  };

  /// Keeps a reference to `prepared`. `max_chunk_points` is for tests; 0 means the driver's limit.
  explicit GpuCloud(const PreparedCloud& prepared, std::vector<Rgba8> colors,
                    std::uint32_t max_chunk_points = 0);

  const PreparedCloud& prepared() const { return prepared_; }
  std::size_t size() const { return prepared_.cloud.size(); }
  /// Another number for every cloud and after every change of its attributes, never 0: what techniques derive
  /// from the points is kept under it (core/derived.h).
  std::uint64_t serial() const { return serial_; }
  /// The same, and another one after every change of colours or of what is cut away: of what is seen.
  std::uint64_t look_serial() const { return look_serial_; }
  Bounds bounds() const { return bounds_; }  ///< world
  float median_spacing() const { return prepared_.median_spacing; }
  /// Largest radius of each batch, scene units; measured on first use.
  const std::vector<float>& largest_radii();
  /// Of all points, scene units; infinite when nobody measured it, so that it limits nothing.
  float median_radius() const {
    return prepared_.median_radius > 0 ? prepared_.median_radius : std::numeric_limits<float>::infinity();
  }
  /// What no disc on a surface needs to exceed, scene units: four times the median radius, or more where
  /// radii were computed and a part is sparser than the rest; infinite when nobody measured it.
  float radius_limit() const {
    return prepared_.radius_limit > 0 ? prepared_.radius_limit : largest_disc * median_radius();
  }
  /// What was computed for one technique is not there for another, which so draws the same picture in any
  /// company.
  void show_to(Attributes needs) { shown_ = needs; }
  bool has_normals() const {
    return prepared_.available.without(prepared_.computed.without(shown_)).has(Attribute::normal);
  }
  std::vector<Chunk>& chunks() { return chunks_; }

  /// Chooses the batches that the view may see, in every chunk; returns how many points they hold.
  std::uint64_t cull(const View& view);
  /// Makes these ranges of points (first of the chunk's, count) its visible batches, of no spacing; returns
  /// the largest count.
  static std::uint32_t show(Chunk& chunk, std::span<const glm::uvec2> ranges);
  /// Binds positions, source index, batches; call for each chunk, then bind what the shader reads besides.
  void bind_geometry(const Chunk& chunk) const;
  void bind_colors(Chunk& chunk);
  /// Normals, or a buffer of "none" when the cloud has none.
  void bind_normals(Chunk& chunk);
  void bind_radii(Chunk& chunk);
  void bind_field(const Chunk& chunk) const;
  /// Shadow factors, or a buffer of ones.
  void bind_shadow(Chunk& chunk);
  /// Place in the prepared cloud by source index; shared by all chunks.
  void bind_places();

  const std::vector<Rgba8>& colors() const { return colors_; }
  void set_colors(std::vector<Rgba8> colors);
  /// One float per point of the prepared cloud, uploaded under that name.
  std::shared_ptr<const Values> make_values(const std::string& name, std::span<const float> values) const;
  /// What shaders read as `point_field(i)`; of `make_values`.
  void set_field(std::shared_ptr<const Values> field) { field_ = std::move(field); }
  const std::shared_ptr<const Values>& field() const { return field_; }
  /// Nothing: every point stops all of the light.
  void set_casters(std::shared_ptr<const Casters> casters) { casters_ = std::move(casters); }
  const std::shared_ptr<const Casters>& casters() const { return casters_; }
  float see_through_spacing() const { return casters_ ? casters_->see_through_spacing : 0; }
  void bind_casters(const Chunk& chunk) const;
  /// Half spaces of cloud space, at most 6, whose points are left out: where dot(xyz, p) + w > 0. Shadows and
  /// other things that follow from the cloud are made anew when they change.
  void set_cut(std::vector<vec4> planes);
  const std::vector<vec4>& cut() const { return cut_; }
  /// One shadow factor per point (1 lit, 0 dark); empty = all lit.
  void set_shadow(std::span<const float> values);
  /// Makes room for shadow factors, which a pass then gives every point (image unit access to
  /// `Chunk::shadow`).
  void begin_shadow();
  bool has_shadow() const { return has_shadow_; }
  /// Shadow factors from the scalar `shadow`; points without it are lit.
  void set_stored_shadow();
  bool has_stored_shadow() const { return has_stored_shadow_; }
  /// Normals and radii for part of a picture, uploaded; no normals: the cloud's own.
  struct Shapes {
    std::vector<gl::TextureBuffer> normals, radii;  ///< of each chunk; empty: nothing to exchange
    std::vector<float> largest_radii;
  };
  /// One value for each point of the prepared cloud.
  Shapes make_shapes(std::span<const vec3> normals, std::span<const float> radii) const;
  /// Puts them in place of those the cloud has, which they then hold: the second time undoes the first.
  void exchange(Shapes& shapes);
  /// While it lives the cloud has those.
  class InPlace {
   public:
    InPlace(GpuCloud& cloud, Shapes& shapes) : cloud_(cloud), shapes_(shapes) { cloud_.exchange(shapes_); }
    ~InPlace() { cloud_.exchange(shapes_); }
    InPlace(const InPlace&) = delete;
    InPlace& operator=(const InPlace&) = delete;

   private:
    GpuCloud& cloud_;
    Shapes& shapes_;
  };
  /// Forgets uploaded normals and radii after the prepared cloud was completed or changed.
  void attributes_changed();

 private:
  const PreparedCloud& prepared_;
  std::vector<Rgba8> colors_;
  Bounds bounds_;
  std::vector<Chunk> chunks_;
  gl::TextureBuffer places_;
  bool has_shadow_ = false, has_stored_shadow_ = false;
  std::shared_ptr<const Values> field_;
  std::shared_ptr<const Casters> casters_;
  std::uint64_t serial_ = next_serial(), look_serial_ = serial_;
  Attributes shown_ = Attribute::normal | Attribute::radius | Attribute::uncertainty | Attribute::cluster;
  std::vector<vec4> cut_;
  gl::Buffer cut_block_;
  static std::uint64_t next_serial();
  std::size_t place_of(const Chunk& chunk) const { return std::size_t(&chunk - chunks_.data()); }
  std::vector<float> largest_radii_;
};

/// Unit normal as two 16-bit octahedral coordinates; the zero vector becomes (0,0), which no unit normal
/// uses.
std::uint32_t encode_normal(const vec3& normal);

}  // namespace sfumato
