// Point cloud shadow textures (Dobrev, Rosenthal, Linsen 2010, Sec. 4): a light map of the points, closed by
// the occluded-pixel filter, and a lit test for every point; averaged over samples of the light's disc. One
// value per point, so that every technique darkens through the shared shading pass. Casters that let light
// pass are peeled into layers in front of the light, as the camera peels them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "core/camera.h"
#include "core/progress.h"
#include "passes/fill.h"
#include "passes/flag.h"
#include "passes/gpu_cloud.h"
#include "passes/light.h"
#include "passes/points_to_pixels.h"

namespace sfumato {

/// The plane that catches shadows under a cloud: world, `normal` is up.
struct Ground {
  dvec3 point{0}, normal{0, 0, 1};
};

/// What shadows are measured by: the bounds of the points within one diagonal of most of them
/// (`robust_bounds` of all together), which are those of all in a scene without outliers. The clouds have one
/// origin.
Bounds bounds_without_strays(std::span<const PointCloud* const> clouds);

/// Gives automatic sizes of `settings` the values that they take for clouds of these bounds (without
/// outliers) and this median spacing.
void resolve_shadow_sizes(RenderSettings& settings, const Bounds& box, float median_spacing);

class ShadowMaps {
 public:
  /// Clouds of one origin that darken themselves and each other.
  using Clouds = std::span<GpuCloud* const>;
  /// Gives the clouds their shadow factors; keeps them while clouds, light and settings stay. With `ground`,
  /// also fills `ground_factor` (R32F, the view's size): the shadow factor of the ground seen by each pixel.
  void update(Clouds clouds, const RenderSettings& settings, const Light& light, gl::Timers& timers,
              Progress& progress, const View* ground_view = nullptr, const Ground& ground = {},
              gl::Texture* ground_factor = nullptr);
  /// Gives the clouds the factors that their points bring (the scalar `shadow`). Throws Error(usage) when
  /// none of them has any.
  void use_stored(Clouds clouds);
  /// Takes the factors off the clouds and gives the memory of the maps back.
  void clear(Clouds clouds);

  /// The least texel, `wanted` or larger, of which a map of the box has no more than the most a side.
  static double fitting_texel(const Light& light, const Bounds& box, double wanted);
  /// Cameras that see the whole box from the light: one, or six faces when it stands inside.
  static std::vector<Camera> light_cameras(const Light& light, const Bounds& box, double texel);
  /// Seeded positions of the light on its disc, perpendicular to its direction; sample 0 is the centre.
  static std::vector<Light> light_samples(const Light& light, const Bounds& box, double size, int count);
  /// Side of a texel of the light map: with 1.5 spacings a texel holds 2.25 points on average and is empty in
  /// exp(-2.25) = 11 % of the cases, which one pass of the filter closes.
  static constexpr double texel_spacings = 1.5;
  /// Another resolution, to measure what it does: side of a texel in spacings, passes of the filter.
  void set_resolution(double texel, int fills) { texel_ = texel, fills_ = fills; }
  /// Points that stop more than this of the light are solid; less than the other, and they cast nothing.
  static constexpr float solid_opacity = 0.999f, least_opacity = 0.001f;
  /// Layers of see-through casters that count, seen from the light.
  static constexpr int most_layers = 16;
  /// Light maps and layers that one visit of the points tests, and the bytes that they may take; a single
  /// map may take more.
  static constexpr std::size_t most_maps = 5, most_layers_a_visit = 4;
  static constexpr std::size_t most_map_bytes = std::size_t(192) << 20;

 private:
  struct Catcher {  ///< the ground that a view sees
    const View& view;
    Ground ground;
    dvec3 cloud_origin;
    gl::Texture& factor;
  };
  enum class LitTest { solid, see_through, behind_see_through };
  /// What the factors depend on; equal: they stay.
  struct Key {
    struct Cloud {
      std::uint64_t serial;
      std::shared_ptr<const GpuCloud::Casters> casters;
      bool has_normals;
      GpuCloud::Cut cut;  ///< cut points cast nothing
      bool operator==(const Cloud&) const = default;
    };
    std::vector<Cloud> clouds;
    Light::Kind kind = Light::Kind::headlight;  ///< which casts none: nothing yet
    dvec3 light{0};
    std::size_t samples = 0;
    double light_size = 0;
    Auto<float> d_min;
    bool operator==(const Key&) const = default;
  };
  /// How far behind a light map a point is dark, of a cloud with this median, among points of this spacing;
  /// the map's texels are those of `map_spacing`.
  static float d_min_of(const RenderSettings& settings, float median, float spacing, float map_spacing);
  /// Finds `without_strays_`, anew when the clouds are others.
  void measure(Clouds clouds);
  /// What the see-through points of `caster` let pass of one light sample, for every point of the clouds
  /// (`passed_`) and the ground. `is_first`: nothing has stopped any of it yet.
  void peel(GpuCloud& caster, Clouds clouds, const Camera& light_camera, float d_min, bool is_first,
            gl::Timers& timers, const Catcher* catcher);
  /// The closed light map of the solid points, `maps_[k]` and `farthest_[k]`; a point covers as many texels
  /// as the spacing around it asks at its distance from the light.
  void draw_map(Clouds clouds, const View& view, float d_min, std::size_t k, gl::Timers& timers);
  /// The farthest of each 4 x 4 texels of a light map into `farthest_[k]`.
  void find_farthest(const gl::Texture& map, std::size_t k);
  /// Tests every point of the cloud against all of `maps`, of which `farthest_` knows: one view each, or
  /// layers of one view with their opacities bound behind. A point is dark from `d_min` behind a map, or
  /// `spacings` of those around it if that is more. `is_first`: the points know nothing yet. `elsewhere`: of
  /// each view, light that falls on what its map does not hold.
  void test_points(GpuCloud& cloud, LitTest kind, std::span<const View> views,
                   std::span<const gl::Texture> maps, float d_min, float spacings, bool is_first,
                   std::span<const float> elsewhere = {}, float share = 0);
  /// `elsewhere`: light of the sample that falls on what the map does not hold.
  void test_ground(const Catcher& catcher, bool has_passed, float elsewhere, const View& light_view,
                   const gl::Texture& map, float d_min, float share);
  void test_ground_layer(const Catcher& catcher, const View& light_view, const gl::Texture& depth,
                         const gl::Texture& opacity, float d_min);
  void run_ground(const Catcher& catcher, ScreenPass& pass, const View& light_view, float d_min,
                  std::initializer_list<const gl::Texture*> inputs, gl::Texture& target);
  double texel_ = texel_spacings;
  int fills_ = 1;
  PointsToPixels to_pixels_;
  Fill fill_;
  ScreenPass decode_, farthest_pass_, layer_pass_, ground_pass_[2], ground_layer_;
  /// By kind, parallel light, maps at a time.
  std::map<std::tuple<LitTest, bool, std::size_t>, gl::Program> lit_tests_;
  gl::Texture bits_, closed_;
  std::vector<gl::Texture> maps_;      ///< of the light samples that one visit tests
  std::vector<gl::Texture> farthest_;  ///< of those, or of layers
  PixelLayer layer_;
  std::vector<gl::Texture> layer_depth_, opacity_;  ///< of the layers that one visit tests
  gl::Texture other_depth_, other_index_, state_, other_state_, ground_passed_;
  /// Of each chunk of a cloud: share of a light sample that reaches its points.
  std::map<const GpuCloud*, std::vector<gl::TextureBuffer>> passed_;
  Flag open_;
  Bounds without_strays_;
  std::vector<std::uint64_t> measured_;  ///< serials of the clouds that it is of
  std::optional<Key> key_;               ///< what the clouds' factors were computed for
};

}  // namespace sfumato
