// The one way from a prepared cloud to an image, for every front end.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/prepared_cloud.h"
#include "core/progress.h"
#include "core/room.h"
#include "gl/context.h"
#include "techniques/technique.h"

namespace sfumato {

struct PassTiming {
  std::string name;
  double ms = 0;
};

struct RenderWants {
  bool color = true;          ///< rgba8: finished 8-bit picture
  bool color_linear = false;  ///< float picture, for EXR and NPY
  bool depth = false, normal = false;
  bool timings = false;  ///< measure passes (costs a finish per pass on software GL)
};

struct RenderOutput {
  Image<Rgba8> rgba8;        ///< sRGB, straight alpha
  Image<vec4> color_linear;  ///< linear premultiplied; alpha is coverage when transparent, else 1
  Image<float> depth;        ///< eye depth, +inf where nothing
  Image<vec3> normal;        ///< world, facing the camera, 0 where none
  std::vector<PassTiming> timings;
  double total_ms = 0;             ///< clear to finished picture on the GPU, before reading back
  std::uint64_t points_drawn = 0;  ///< points of batches inside the view
  std::uint64_t outliers = 0;      ///< points left out as such, in view or not
  std::vector<std::string> notes;  ///< the technique's
  RenderSettings settings;         ///< of Session: those of the look, what is automatic resolved
};

/// One cloud of a scene, and how it is drawn. Each item has a technique of its own.
struct Item {
  std::size_t cloud = 0;  ///< in the order of `Renderer::set_clouds`
  Technique* technique = nullptr;
  const RenderSettings* settings = nullptr;  ///< shading and material; the rest is the scene's
};

/// That of the item which asks for most (Technique::edl_strength).
float edl_strength(std::span<const Item> items, bool photographed);

/// A cloud with its colours: one per point, in the prepared order, sRGB.
struct ColoredCloud {
  PreparedCloud cloud;
  std::vector<Rgba8> colors;
};

/// Takes rows of a picture from `first_row` on, as wide as the picture, from top to bottom. May take the
/// images.
using RowSink = std::function<void(RenderOutput& rows, int first_row)>;

class Renderer {
 public:
  explicit Renderer(gl::Context& context);
  ~Renderer();

  /// Takes the cloud; `colors` (one per point, in the prepared order, sRGB) are what techniques draw.
  /// The cloud may be completed later for another technique.
  /// `max_chunk_points` limits the points per GPU buffer (tests); 0 means the driver's limit.
  void set_cloud(PreparedCloud cloud, std::vector<Rgba8> colors, std::uint32_t max_chunk_points = 0);
  /// The clouds of a scene, of one origin. Throws Error(usage) when they have several.
  void set_clouds(std::vector<ColoredCloud> clouds, std::uint32_t max_chunk_points = 0);
  void set_colors(std::vector<Rgba8> colors, std::size_t cloud = 0);
  const std::vector<Rgba8>& colors(std::size_t cloud = 0) const;
  /// Until the next picture or the next that is completed.
  const PreparedCloud& prepared(std::size_t cloud = 0) const;
  /// The clouds, colours and room of another renderer on this context, or on one that shares objects with it
  /// (gl::Context): they stand in memory once, and what either measures later is there for both. Not while
  /// that one is in use.
  void share_clouds(const Renderer& other);
  /// Adds what a cloud still lacks (analysis::complete).
  void complete(std::size_t cloud, const std::function<bool(const PreparedCloud&)>& lacks,
                const std::function<void(PreparedCloud&)>& add);
  /// A room is drawn without the walls behind which the camera stands; nothing: all is drawn.
  void set_room(std::optional<Room> room);
  /// Programs are compiled anew from now on (their files changed); those of techniques are theirs.
  void forget_programs();

  /// Renders until the technique says the image is final. The camera's near and far planes are fitted here.
  RenderOutput render(Technique& technique, const Camera& camera, const RenderSettings& settings,
                      const RenderWants& wants = {}, Progress& progress = no_progress());
  /// The same of a cloud of which only a part is here (PreparedCloud::whole): what its points show of the
  /// picture. Merged with that of the other parts, it is drawn by `render_merged`, for which any part will
  /// do, be it without points. Both throw Error(usage) where `merges` is false, or the part has not what the
  /// technique needs. In a further round (Technique::rounds) `merged` is what all parts showed before.
  VisiblePoints visible(Technique& technique, const Camera& camera, const RenderSettings& settings,
                        const VisiblePoints* merged = nullptr, Progress& progress = no_progress());
  RenderOutput render_merged(const VisiblePoints& merged, Technique& technique, const Camera& camera,
                             const RenderSettings& settings, const RenderWants& wants = {},
                             Progress& progress = no_progress());
  bool has_needs(const Technique& technique) const;
  /// Not with shadows, which fall from one part on another, nor of several samples or in tiles.
  bool merges(const Technique& technique, const Camera& camera, const RenderSettings& settings) const;
  /// Several clouds in one picture: opaque items meet by depth, see-through ones are blended over them.
  /// Light, shadows, ground, eye-dome lighting, outlines, samples and background are those of `settings`;
  /// shadows fall from every item on every other. An item without points draws nothing.
  /// A picture that is larger than one canvas (`is_tiled`) is drawn in tiles.
  RenderOutput render(std::span<const Item> items, const Camera& camera, const RenderSettings& settings,
                      const RenderWants& wants = {}, Progress& progress = no_progress());
  /// Pictures that are put together (the faces of a panorama), in the order of `cameras`: techniques find
  /// what is automatic once for all of them, and depths are shown in one range, so that no seam shows.
  std::vector<RenderOutput> render_together(std::span<const Item> items, std::span<const Camera> cameras,
                                            const RenderSettings& settings, const RenderWants& wants = {},
                                            Progress& progress = no_progress());
  /// The same as `render`, row by row: of a picture in tiles no more is in memory than a row of tiles.
  /// Returns the rest of the output, without images.
  RenderOutput render_rows(std::span<const Item> items, const Camera& camera, const RenderSettings& settings,
                           const RenderWants& wants, const RowSink& sink, Progress& progress = no_progress());
  /// Whether any picture of this size is drawn in tiles: wider or higher than half of what the driver allows
  /// (filters draw past the border), or of more than `most_pixels`, of which each takes up to 250 bytes
  /// (surface). Preferences::tile_side decides first. Of techniques that hold less
  /// (Technique::most_pixels) smaller pictures are, too.
  bool is_tiled(const Camera& camera) const;
  /// Whether this one is.
  bool is_tiled(std::span<const Item> items, const Camera& camera) const;
  /// The largest side of a picture: beyond it floats no longer tell places of 1/128 px apart.
  static constexpr int largest_side = 65536;
  static constexpr std::int64_t most_pixels = std::int64_t(1) << 25;  ///< 7680 x 4320 in one go

 private:
  RenderOutput render_at_once(std::span<const Item> items, const Camera& camera,
                              const RenderSettings& settings, const RenderWants& wants, Progress& progress,
                              const VisiblePoints* merged = nullptr);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato
