// A technique: cloud + camera -> image. One folder each; the registry is generated from the folders.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/param.h"
#include "core/prepared_cloud.h"
#include "passes/frame.h"

namespace sfumato {

enum class Transparency {
  none,
  haze,   ///< what it leaves as depth is that of its opaque points
  layers  ///< what it leaves as depth is that of the first layer
};

class Technique {
 public:
  virtual ~Technique() = default;

  /// Lists every parameter with its default, range, unit, help and paper symbol.
  virtual void describe(ParamList& params) = 0;
  /// Names and values of parameters, as Param::set takes them.
  using Values = std::vector<std::pair<std::string, std::string>>;
  /// What is drawn with, in place of what is set, where every millisecond of a picture in motion counts: the
  /// same look with less care. Empty where there is no such way.
  virtual Values in_motion() const { return {}; }
  /// What suits points that a rule of --draw selects for it, beside the `given` parameters of that rule.
  virtual Values of_selected(const Values& /*given*/) const { return {}; }
  /// Attributes the technique cannot do without; asked again after parameters changed.
  virtual Attributes needs() const { return {}; }
  /// How strong eye-dome lighting suits the technique by default (`edl = auto`), 0 where it does not: a
  /// little, where surfaces are closed and colours are no photographs.
  virtual float edl_strength(bool photographed) const { return photographed ? 0 : slight_edl; }
  static constexpr float slight_edl = 0.12f;
  /// Whether its depth is that of a surface between the points too, and not only of them: eye-dome lighting
  /// then leaves out what is finer than they are.
  virtual bool closes_depth() const { return true; }
  /// True where the technique's own edges are soft, so that smoothing outlines would only blur them.
  virtual bool has_soft_edges() const { return false; }
  /// Whether its colours are laid on white paper, unless another background is chosen.
  virtual bool is_on_paper() { return false; }
  /// Whether noise should not move what stands still in a sequence (analysis/still.h).
  virtual bool holds_still() const { return false; }
  /// Items of a scene that let through what lies behind them are drawn last, in the order of this list, with
  /// `Frame::behind` to blend over.
  virtual Transparency transparency() const { return Transparency::none; }
  /// False for a `shading` that has no meaning here: asking for it is then an error.
  virtual bool shows(Shading shading) const { return shading < Shading::occlusion; }
  /// How much of the light each point stops (techniques/casters.h), asked before shadows are found. Null: all
  /// of it, unless a technique draws points less than opaque, or not at all.
  virtual std::shared_ptr<const GpuCloud::Casters> casters(const GpuCloud&, Progress&) { return nullptr; }
  /// Whether parts of a cloud can be drawn by themselves and put together pixel by pixel (Frame::visible).
  virtual bool merges() const { return false; }
  /// In how many rounds: in each what the pixels of all parts show after the one before is known.
  virtual int rounds() const { return 1; }
  /// Draws into `frame.target`: linear premultiplied colour (coverage in alpha, no background), eye depth and
  /// world normal. Returns true when the image is final; false asks to be called again with the same frame.
  virtual bool render(Frame& frame) = 0;
  /// How far around itself a pixel of such a picture may see, px: tiles of it overlap by so much. The camera
  /// is that of the whole picture, fitted to the cloud. Nothing for what sees its own pixel only.
  virtual int reach_px(const GpuCloud&, const Camera&) const { return 0; }
  /// The largest picture that it can draw in one go, px; larger ones are drawn in tiles.
  virtual std::int64_t most_pixels() const { return std::numeric_limits<std::int64_t>::max(); }
  /// Lines worth telling the user after a render: automatic values, shares, overflow counts. May be empty.
  virtual std::vector<std::string> notes() const { return {}; }
  /// Points that the last render left out as outliers.
  virtual std::uint64_t outliers() const { return 0; }
};

/// What a length (scene units) of the points of each batch spans where they are nearest, px: the largest, at
/// most 1536. Tiles that overlap by more would take the memory of the largest picture.
int nearest_px(const GpuCloud& cloud, const Camera& camera,
               const std::function<double(const Batch&)>& length);

struct TechniqueInfo {
  std::string name;
  std::string summary;  ///< one line for `sfumato techniques`
  std::unique_ptr<Technique> (*create)();
};

/// Every technique of the house, in the order of the documentation.
const std::vector<TechniqueInfo>& all_techniques();
/// Draws whatever points there are at once: in place of one that is not chosen yet, or too slow to move.
inline constexpr const char* stand_in_technique = "points";
/// Throws Error(usage) naming the nearest technique when there is none of that name.
const TechniqueInfo& find_technique(std::string_view name);

}  // namespace sfumato
