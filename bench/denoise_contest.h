// Ways of drawing a scan against the truth, or against each other: what `eval_denoise` measures with.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/image.h"
#include "synth/synth.h"
#include "techniques/renderer.h"

namespace sfumato::bench {

struct Errors {
  double mae = 0, rmse = 0,
         missed = 0;          ///< in bin sizes; a miss counts 5, larger errors are clamped there; share
  double psnr = 0, ssim = 0;  ///< of the albedo, sRGB
  void add(const Errors& e, double share);
};

/// sRGB coded luma and channel of linear colours.
double luma(const vec3& linear);
double srgb(double linear);

Errors compare(const RenderOutput& out, const synth::Truth& truth, double bin_size);

/// Pixels with no depth edge, and nothing uncovered, within `margin` pixels of that: a step of five bins from
/// one pixel to the next is an edge. `margin`: px, at the pixels on both sides of each edge.
Image<std::uint8_t> interior(const Image<float>& depth, double bin_size, const Image<int>& margin);

/// Pixels of `among` that show something more than five bins behind `reference`, or nothing at all.
struct TooDeep {
  std::size_t count = 0, among = 0;
  Image<std::uint8_t> where;
  double percent(std::size_t n) const { return 100.0 * double(n) / double(among ? among : 1); }
  /// How many of them are none of the other's.
  std::size_t without(const TooDeep& other) const;
};
TooDeep too_deep(const Image<float>& depth, const Image<float>& reference, const Image<std::uint8_t>& among,
                 double bin_size);

/// Depth errors as colours: white 0, red in front of the truth and blue behind it from 5 bins on, black a
/// miss.
Image<Rgba8> error_map(const Image<float>& depth, const Image<float>& truth, double bin_size);

/// The techniques over one cloud; missed pixels are black. With `prefilter` isolated points are taken out of
/// the cloud before anything is drawn, whatever the technique.
class Contest {
 public:
  explicit Contest(gl::Context& context);
  /// As `--clutter-radius`; the default of the command otherwise.
  void set_clutter_radius(float ratio) { prepare_.clutter_radius = ratio; }
  void take(PointCloud cloud, const Camera& camera);
  double bin_size() const { return bin_size_; }
  /// Of a splat at the middle of the cloud.
  double radius_px(const Camera& camera);
  /// How far discs reach over the silhouettes of `depth`, a picture of `splats`, where both answers are
  /// right: a pixel more than the radius of the largest disc there, which a scan's farther parts have larger.
  /// px
  Image<int> rims(const Camera& camera, const Image<float>& depth);
  double left_out() const { return left_out_; }  ///< share of the points that the prefilter takes

  RenderOutput splats(const Camera& camera, bool opaque, bool prefilter = false);
  RenderOutput manual(const Camera& camera, double threshold, bool prefilter = false, bool last_bin = false);
  RenderOutput automatic(const Camera& camera);
  void set_denoise(const std::string& name, const std::string& value);

 private:
  Renderer& renderer(bool prefilter) { return prefilter ? filtered_ : whole_; }
  Renderer whole_, filtered_;
  RenderSettings settings_;
  RenderWants wants_;
  analysis::PrepareOptions prepare_;
  double bin_size_ = 1, left_out_ = 0;
  std::unique_ptr<Technique> splats_, denoise_;
};

}  // namespace sfumato::bench
