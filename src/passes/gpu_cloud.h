// A cloud as one view shows it: a resident cloud that others may share, and beside it what this view says of
// its points (colours, shadows, which batches are seen, what is cut away).
#pragma once

#include "passes/bindings.h"
#include "passes/resident_cloud.h"
#include "passes/view.h"

namespace sfumato {

class GpuCloud {
 public:
  struct Chunk : ResidentCloud::Range {
    std::uint32_t visible_batches = 0;   ///< set by cull()
    std::uint32_t groups_per_batch = 0;  ///< work groups of 128 that cover the largest visible batch
    gl::TextureBuffer shadow, batches;
  };
  /// One float for each point, of each chunk. It never changes, so its address says what it is: who keeps one
  /// knows it again.
  using Values = ResidentCloud::Values;
  using Shapes = ResidentCloud::Shapes;
  using Colors = ResidentCloud::Colors;
  /// How much of the light each point stops, 0 to 1.
  struct Casters {
    std::shared_ptr<const Values> opacity;
    /// Spacing of the points that let some of it pass, scene units, 0 when there are none.
    float see_through_spacing = 0;
  };

  GpuCloud(std::shared_ptr<const ResidentCloud> cloud, std::shared_ptr<const Colors> colors);
  /// Of its own; keeps a reference to `prepared`.
  explicit GpuCloud(const PreparedCloud& prepared, std::vector<Rgba8> colors,
                    std::uint32_t max_chunk_points = 0);

  const PreparedCloud& prepared() const { return resident_->prepared(); }
  std::size_t size() const { return resident_->size(); }
  /// ResidentCloud::serial.
  std::uint64_t serial() const { return resident_->serial(); }
  /// Of what is seen: another one after every change of the cloud, of colours or of what is cut away.
  std::uint64_t look_serial() const { return look_serial_; }
  const Bounds& bounds() const { return resident_->bounds(); }
  float median_spacing() const { return prepared().median_spacing; }
  /// Largest radius of each batch, scene units.
  const std::vector<float>& largest_radii() const {
    return shapes_ ? shapes_->largest_radii : resident_->largest_radii();
  }
  /// Of all points, scene units; infinite when nobody measured it, so that it limits nothing.
  float median_radius() const {
    return prepared().median_radius > 0 ? prepared().median_radius : std::numeric_limits<float>::infinity();
  }
  /// What no disc on a surface needs to exceed, scene units: four times the median radius, or more where
  /// radii were computed and a part is sparser than the rest; infinite when nobody measured it.
  float radius_limit() const {
    return prepared().radius_limit > 0 ? prepared().radius_limit : largest_disc * median_radius();
  }
  /// The points of `cloud`, which are those it has, perhaps with more attributes. What was computed for
  /// another technique is not there for one that does not ask for it, which so draws the same picture in any
  /// company.
  void show(std::shared_ptr<const ResidentCloud> cloud, Attributes needs);
  /// SharedCloud::complete of the cloud that it shows.
  template <class Lacks, class Add>
  void complete(SharedCloud& shared, bool is_alone, const Lacks& lacks, const Add& add) {
    shared.complete(resident_, is_alone, lacks, add);
    look_serial_ = ResidentCloud::next_serial();
  }
  bool has_normals() const {
    return prepared().available.without(prepared().computed.without(shown_)).has(Attribute::normal);
  }
  std::vector<Chunk>& chunks() { return chunks_; }

  /// Chooses the batches that the view may see, in every chunk; returns how many points they hold.
  std::uint64_t cull(const View& view);
  /// Whether it chooses this one.
  static bool is_in_view(const Batch& batch, const View& view);
  /// That number alone.
  std::uint64_t points_in(const View& view) const;
  /// Makes these ranges of points (first of the chunk's, count) its visible batches, of no spacing; returns
  /// the largest count.
  static std::uint32_t show(Chunk& chunk, std::span<const glm::uvec2> ranges);
  /// Binds positions, source index, batches; call for each chunk, then bind what the shader reads besides.
  void bind_geometry(const Chunk& chunk) const;
  void bind_colors(const Chunk& chunk) const { colors(chunk).bind(binding::colors); }
  void bind_normals(const Chunk& chunk) const { normals(chunk).bind(binding::normals); }
  void bind_radii(const Chunk& chunk) const { radii(chunk).bind(binding::radii); }
  void bind_field(const Chunk& chunk) const {
    if (field_) field(chunk)->bind(binding::field);
  }
  void bind_shadow(Chunk& chunk) { shadow(chunk).bind(binding::shadow); }
  /// What those bind.
  const gl::TextureBuffer& positions(const Chunk& chunk) const;
  const gl::TextureBuffer& source_index(const Chunk& chunk) const;
  const gl::TextureBuffer& colors(const Chunk& chunk) const;
  const gl::TextureBuffer& normals(const Chunk& chunk) const;
  const gl::TextureBuffer& radii(const Chunk& chunk) const;
  const gl::TextureBuffer* field(const Chunk& chunk) const;    ///< null: none
  const gl::TextureBuffer* opacity(const Chunk& chunk) const;  ///< of casters; null: none
  const gl::TextureBuffer& shadow(Chunk& chunk);               ///< shadow factors, or ones
  /// For passes that look points up by their source index (shaders/places.glsl): `run(chunk)` with what tells
  /// the pass which of them it may find, once for each chunk and part of the places.
  template <class Pass, class Run>
  void for_each_place(Pass& pass, const Run& run) {
    bool is_first = true;
    for (Chunk& chunk : chunks_)
      for (const ResidentCloud::Places& part : resident_->places()) {
        part.values.bind(binding::places);
        pass.set("places_first", part.first).set("places_count", part.count);
        pass.set("chunk_first", chunk.first).set("chunk_count", chunk.count);
        pass.set("write_background", is_first);
        run(chunk);
        is_first = false;
      }
  }

  /// Those, for loops of the processor.
  const std::vector<ResidentCloud::Places>& places() const { return resident_->places(); }

  const std::vector<Rgba8>& colors() const { return colors_->values(); }
  const std::shared_ptr<const Colors>& shared_colors() const { return colors_; }
  void set_colors(std::shared_ptr<const Colors> colors);
  std::shared_ptr<const Values> make_values(const std::string& name, std::span<const float> values) const {
    return resident_->make_values(name, values);
  }
  std::shared_ptr<const Values> make_values(const std::string& name, std::span<const vec2> values) const {
    return resident_->make_values(name, values);
  }
  template <class Make>
  std::shared_ptr<const Values> dots(const Make& make) const {
    return resident_->dots(make);
  }
  /// What shaders read as `point_field(i)`; of `make_values`.
  void set_field(std::shared_ptr<const Values> field) { field_ = std::move(field); }
  const std::shared_ptr<const Values>& field() const { return field_; }
  /// Nothing: every point stops all of the light.
  void set_casters(std::shared_ptr<const Casters> casters) { casters_ = std::move(casters); }
  const std::shared_ptr<const Casters>& casters() const { return casters_; }
  float see_through_spacing() const { return casters_ ? casters_->see_through_spacing : 0; }
  void bind_casters(const Chunk& chunk) const {
    if (casters_) opacity(chunk)->bind(binding::casters);
  }
  /// What is left out, in cloud space: half spaces, at most 6, where dot(xyz, p) + w > 0, and a ceiling
  /// (core/room.h).
  struct Cut {
    std::vector<vec4> planes;
    vec3 up{0};
    vec4 u{0}, v{0};
    int across = 0;
    std::vector<float> heights;
    bool empty() const { return planes.empty() && heights.empty(); }
    bool operator==(const Cut&) const = default;
  };
  /// Shadows and other things that follow from the cloud are made anew when it changes.
  void set_cut(Cut cut);
  const Cut& cut() const { return cut_; }
  /// One shadow factor per point (1 lit, 0 dark); empty = all lit.
  void set_shadow(std::span<const float> values);
  /// Makes room for shadow factors, which a pass then gives every point (image unit access to
  /// `Chunk::shadow`).
  void begin_shadow();
  bool has_shadow() const { return has_shadow_; }
  /// Shadow factors from the scalar `shadow`; points without it are lit.
  void set_stored_shadow();
  bool has_stored_shadow() const { return has_stored_shadow_; }
  /// Normals and radii for part of a picture.
  std::shared_ptr<const Shapes> make_shapes(std::span<const vec3> normals, std::span<const float> radii,
                                            std::span<const float> surface = {}) const {
    return resident_->make_shapes(normals, radii, surface);
  }
  /// While it lives the points have those instead of their own; null: their own.
  class WithShapes {
   public:
    WithShapes(GpuCloud& cloud, std::shared_ptr<const Shapes> shapes) : cloud_(cloud) {
      cloud_.shapes_ = std::move(shapes);
    }
    ~WithShapes() { cloud_.shapes_.reset(); }
    WithShapes(const WithShapes&) = delete;
    WithShapes& operator=(const WithShapes&) = delete;

   private:
    GpuCloud& cloud_;
  };

 private:
  std::size_t place_of(const Chunk& chunk) const { return std::size_t(&chunk - chunks_.data()); }

  std::shared_ptr<const ResidentCloud> resident_;
  std::shared_ptr<const Colors> colors_;
  std::vector<Chunk> chunks_;
  bool has_shadow_ = false, has_stored_shadow_ = false;
  std::shared_ptr<const Values> field_;
  std::shared_ptr<const Casters> casters_;
  std::shared_ptr<const Shapes> shapes_;
  std::uint64_t look_serial_ = ResidentCloud::next_serial();
  Attributes shown_ = Attribute::normal | Attribute::radius | Attribute::uncertainty | Attribute::cluster;
  Cut cut_;
  gl::Buffer cut_block_;
};

}  // namespace sfumato
