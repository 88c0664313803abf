// Pictures of a cloud of which only a part is here, as on a rank of a cluster: each part says what it shows,
// those who have them merge that (passes/visible_points.h), and one of them draws the picture.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "passes/visible_points.h"
#include "sfumato/renderer.h"

namespace sfumato {

struct WholeCloud;

/// Works on a thread and in an OpenGL context of its own, for which callers wait: whatever context is current
/// where they call stays so, GLX's as well.
class PartRenderer {
 public:
  PartRenderer();
  ~PartRenderer();
  PartRenderer(const PartRenderer&) = delete;
  PartRenderer& operator=(const PartRenderer&) = delete;

  /// Points of other parts (analysis/regions.h), for the technique that needs attributes of surfaces.
  struct Around {
    PointCloud points;
    std::string technique;
  };
  /// `whole`: analysis::whole_of. The part may have no points; the whole has some. `part.source_index`,
  /// ascending, has the numbers of its points among all.
  void set_part(PointCloud part, std::shared_ptr<const WholeCloud> whole, const ColorSettings& coloring,
                std::optional<Around> around = std::nullopt);
  /// "auto" as the technique that suits the whole.
  std::string resolve(const std::string& technique) const;
  /// Whether such a picture can be drawn part by part (Renderer::merges).
  bool merges(const std::string& technique, const Camera& camera, const Parameters& parameters);
  /// Whether the part has not yet all that it needs: what that is found from lies around the part, too.
  bool lacks(const std::string& technique, const Parameters& parameters);
  /// So often parts are to be asked what they show, and that merged: Technique::rounds.
  int rounds(const std::string& technique, const Parameters& parameters);
  /// `merged`: of the rounds before.
  VisiblePoints visible(const std::string& technique, const Camera& camera, const Parameters& parameters,
                        const VisiblePoints* merged = nullptr);
  /// Colours, transparent where nothing is, and depths.
  Pictures picture(const VisiblePoints& merged, const std::string& technique, const Camera& camera,
                   const Parameters& parameters);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato
