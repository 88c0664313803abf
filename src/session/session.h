// From a scene that was read to pictures of it: analysis, colours and what is automatic, the same for every
// front end, so that the same request gives the same bytes everywhere.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/coloring.h"
#include "core/derived.h"
#include "scene/scene.h"
#include "session/choice.h"
#include "session/draw_rule.h"
#include "session/look.h"
#include "session/pose.h"
#include "techniques/choose.h"
#include "techniques/renderer.h"

namespace sfumato {

struct SessionOptions {
  analysis::PrepareOptions prepare;
  ColorSettings color;
  std::optional<vec3> background;  ///< sRGB; nothing: what contrasts with the colours
  /// The first that selects a point draws it; the others are drawn as the caller says.
  std::vector<DrawRule> draw = {};
};

/// One scene on one context. Use it on the thread of its context.
class Session {
 public:
  explicit Session(gl::Context& context) : renderer_(context) {}

  /// Makes a scene ready to be drawn by what was chosen, in the three steps below: `set_scene`, `suggest` for
  /// an `auto` in the choice, which is resolved in place, and `measure` of what its techniques need. Null:
  /// nothing is chosen yet. Without `measures` the first pictures measure what they need, as they do where
  /// nothing is chosen. Throws as the steps and Choice::resolve do. PartRenderer takes
  /// the steps itself: it knows the needs of a technique, and has no choice.
  void open(scene::Scene scene, Pose pose, const SessionOptions& options, Choice* choice,
            Progress& progress = no_progress(), bool measures = true);
  /// Sorts the points of a scene: `suggest` may then be asked, and until `measure` has been called there is
  /// nothing to draw (`empty`). Throws Error(usage) for rules that leave out every point, before anything of
  /// the last scene is gone, and Cancelled when `progress` asks for it.
  void set_scene(scene::Scene scene, Pose pose, const SessionOptions& options,
                 Progress& progress = no_progress());
  /// Computes what the techniques need that will be drawn, in one search of neighbours, and colours the
  /// points: once for each scene. Throws Error(usage) for a colour source that they do not have, or where no
  /// sorted points wait for it, and Cancelled. After either step threw half way, the session is empty until
  /// the next `set_scene`.
  void measure(Attributes needs, Progress& progress = no_progress());
  /// The scene of another session, as it is drawn there, in memory once (Renderer::share_clouds); colours and
  /// background may then become others here. Not while that one is in use.
  void share_scene(const Session& other);
  /// What suits the points that no rule draws (techniques/choose.h). Throws Error(usage) without a scene.
  TechniqueChoice suggest() const;
  /// Other colours for the same points. A background that contrasts with them is found anew.
  void set_color(const ColorSettings& color);
  void set_background(const std::optional<vec3>& background);

  Camera first_view(int width, int height) const { return sfumato::first_view(pose_, width, height); }
  /// Draws until the picture is final: points that no rule selects with `look`, the others by their rules in
  /// its light. What a technique needs and its points lack is computed and kept. `RenderOutput::settings` are
  /// those of the look, what is automatic resolved.
  RenderOutput render(const Look& look, const Camera& camera, const RenderWants& wants = {},
                      Progress& progress = no_progress());
  /// The same row by row (techniques/renderer.h), for pictures that are too large for the memory. The output
  /// that is returned has no images.
  RenderOutput render_rows(const Look& look, const Camera& camera, const RenderWants& wants,
                           const RowSink& sink, Progress& progress = no_progress());
  /// Of a scene that is part of a cloud (Scene::whole), pictures of which are made of those of all parts
  /// (Renderer::visible). Not by rules.
  bool merges(const Look& look, const Camera& camera) const;
  VisiblePoints visible(const Look& look, const Camera& camera, const VisiblePoints* merged = nullptr,
                        Progress& progress = no_progress());
  /// Whether the part has what the technique needs: computed without the others it would be wrong.
  bool has_needs(const Look& look) const { return !is_empty_ && renderer_.has_needs(*look.technique); }
  RenderOutput render_merged(const VisiblePoints& merged, const Look& look, const Camera& camera,
                             const RenderWants& wants = {}, Progress& progress = no_progress());
  /// Whether such a picture is drawn in tiles.
  bool is_tiled(const Camera& camera) const { return renderer_.is_tiled(camera); }
  /// Computes what `look` and the rules need of the points and they lack; `render` does so as well. For
  /// callers that cancel pictures more often than this takes.
  void complete(const Look& look, Progress& progress = no_progress());
  /// Computes attributes that nobody has asked for yet, of the points that no rule draws. False: nothing was
  /// computed, as all are there, or no such points.
  bool complete(Attributes attributes, Progress& progress);
  /// Programs are compiled anew from now on: files of shaders changed. The caller renews its own looks.
  void forget_programs();
  /// Everything around the camera's position (techniques/panorama.h).
  RenderOutput render_panorama(const Look& look, const Camera& camera, const RenderWants& wants = {},
                               Progress& progress = no_progress());

  /// Points that are drawn alike: first those of no rule, when there are any, then those of each group of
  /// rules.
  struct Part {
    std::vector<std::string> rules;  ///< as they were written; none: the points of no rule
    const DrawRule* rule = nullptr;  ///< the first of them
    std::unique_ptr<Look> look;      ///< by the rule
    std::size_t points = 0;
    /// Place in the scene of each of the part's points; null: as they come.
    std::shared_ptr<const std::vector<std::uint32_t>> source_index;
  };
  const std::vector<Part>& parts() const { return parts_; }
  const PreparedCloud& prepared(std::size_t part = 0) const { return renderer_.prepared(part); }
  const PointCloud& cloud(std::size_t part = 0) const { return prepared(part).cloud; }  ///< in prepared order
  std::size_t prepared_points() const;                                                  ///< of all parts
  std::uint64_t point_bytes() const;  ///< of their positions and attributes in memory
  /// The place in the scene's files of a point of `cloud(part)`.
  std::uint64_t source(std::size_t part, std::size_t i) const;
  const std::vector<Rgba8>& colors(std::size_t part = 0) const { return renderer_.colors(part); }
  /// Of all parts, world.
  Bounds box() const { return box_; }
  /// Lines on what the rules selected.
  const std::vector<std::string>& notes() const { return notes_; }
  const Coloring& coloring() const { return coloring_; }  ///< without `colors`
  const Pose& pose() const { return pose_; }
  vec3 background() const { return background_; }     ///< of the last picture
  std::size_t left_out() const { return left_out_; }  ///< points beyond those that one place holds
  bool empty() const { return is_empty_; }

 private:
  /// As `suggest`, of sorted points. Where every view reads points of its own, all have the choice of the
  /// whole.
  TechniqueChoice suggest(const PreparedCloud& sorted, const analysis::NeighborTree* tree) const;
  void complete(std::size_t part, Attributes needs, Progress& progress);
  /// Makes `parts_`, and a cloud for each, by the rule of each point.
  std::vector<PointCloud> cut(PointCloud cloud, const std::vector<std::uint32_t>& matches);
  /// Colours of all parts together, so that a value has one colour in the whole scene.
  std::vector<std::vector<Rgba8>> color(const std::vector<const PreparedCloud*>& clouds);
  /// Adds the settings. Notes say which technique is meant where there are several.
  RenderOutput finish(RenderOutput out, const Look& look, RenderSettings settings) const;
  /// Resolves in `settings`, those of the look, what follows from scene and technique together; returns what
  /// is drawn by them.
  std::vector<Item> resolve(const Look& look, RenderSettings& settings, const Camera& camera,
                            Progress& progress);

  /// A part between `set_scene` and `measure`.
  struct Unmeasured {
    analysis::SortedCloud sorted;
    PointCloud part;         ///< instead, where `around_` is known
    std::size_t points = 0;  ///< before those were left out that share a place
  };

  Renderer renderer_;
  std::vector<Unmeasured> unmeasured_;
  std::optional<PointCloud> around_;  ///< points of other parts of the cloud, until `measure`
  SessionOptions options_;
  std::vector<std::string> file_names_, notes_;
  std::shared_ptr<const WholeCloud> whole_;     ///< may be null
  std::shared_ptr<const PointCloud> overview_;  ///< may be null
  std::shared_ptr<const PointCloud> levels_;    ///< scene::Overview::levels
  // What was measured of an overview is kept while views of the same files follow each other.
  struct ColorOfOverview {
    std::shared_ptr<const PointCloud> overview;
    ColorSettings settings;
    bool operator==(const ColorOfOverview&) const = default;
  };
  mutable Derived<std::shared_ptr<const PointCloud>, TechniqueChoice> choice_of_overview_;
  Derived<ColorOfOverview, std::optional<Coloring>> color_of_overview_;
  std::vector<Part> parts_;
  Bounds box_;
  std::optional<Bounds> shadow_box_;  ///< without strays; found with the first shadow
  float spacing_ = 0;                 ///< median of the densest part
  Coloring coloring_;
  bool are_photographed_ = false;  ///< colours of the file, more than anybody would choose
  std::vector<vec3> palette_;      ///< linear colours of categories; empty: colours are no categories
  Pose pose_;
  vec3 background_{1}, contrasting_{1};  ///< contrasting: with the colours, where nobody asks for another
  std::size_t left_out_ = 0;
  bool is_empty_ = true;
};

}  // namespace sfumato
