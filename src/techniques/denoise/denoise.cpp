// Noise and outliers disappear while you look: of the surfaces along a ray the nearest one with enough
// evidence is shown. Nothing is removed from the data; a slider brings everything back.
//
// "Hashed, binned A-buffer for on-the-fly outlier removal and noise reduction of point clouds", The Visual
// Computer 2023 (s00371-023-02888-w). Splats are sorted into bins along the ray, each bin sums the weights of
// its splats, and the nearest bin whose sum exceeds a threshold T is averaged and drawn.
//
// What we changed, and why: the table holds weights only and a second visit of the chosen bin brings the
// attributes (less memory, fewer atomics); sums are fixed point, so that a picture does not depend on the
// order of the points; distances are summed relative to their bin; T finds its own value per pixel, which the
// authors leave open.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "analysis/quantiles.h"
#include "analysis/survey.h"
#include "analysis/whole.h"
#include "core/derived.h"
#include "gl/context.h"
#include "passes/shade.h"
#include "passes/splat_cpu.h"
#include "techniques/casters.h"
#include "techniques/denoise/bins.h"
#include "techniques/denoise/worth.h"
#include "techniques/screen_spacing.h"
#include "techniques/technique.h"

namespace sfumato {
namespace {

using denoise::Anchor;
using denoise::Layout;
using denoise::Miss;

// The automatic threshold: weights are in units of what the surface they belong to needs (evidence.glsl), so
// that it is `strictness` everywhere. (Seemann 2018, Eq. 20) lets the splats of a surface cover it four
// times.
constexpr float radius_covers = 4;
//
// Where n = 9 splats meet at random (radius scale 1.5) their weight falls below a fifth of its mean in 7 % of
// places, and no share removes outliers without such dips. So the share decides alone only where the pixels
// around have nothing to say about a weak bin (agree.glsl).
constexpr float surface_share = 0.2f;  // of the mean weight of a surface that the nearest bin needs
constexpr float peak_share = 0.3f;  // of the largest weight within `peak_bins`: noise in front of its surface
constexpr int peak_bins = 3;
constexpr int far_side_bins = 2 * peak_bins;  // beyond `peak_bins` even where it lies as much in front
constexpr int agree_rounds = 2;               // a dip between dips is closed by the second
// Where a scan thins out discs are larger than usual, and so are dips between them: one more round asks as
// far away as those reach. Clouds of even density are within `uneven` and need none.
using analysis::large_share;     // of the discs are smaller
constexpr float uneven = 1.75f;  // in usual radii
// Points with less support are left out. Where no bin of the others is above the threshold (a sparse edge,
// the rim of a splat) the heaviest one is shown.
using denoise::least_support;

struct Parameters {
  Layout bins = Layout::hashed;
  int hash_bits = 4, dense_bins = 64;
  Auto<float> bin_size, weight_threshold;
  float strictness = 1;
  Auto<bool> prefilter;
  bool overlapping = false;
  Anchor anchor = Anchor::nearest;
  Miss miss = Miss::background;
  bool antialias = true;
  float radius_scale = 1.5f;  // as in splats: Eq 20 leaves 2 % of a random sampling open
  bool clamp_radius = true;

  void describe(ParamList& p) {
    p.add("weight_threshold", weight_threshold)
        .range(0, 1000)
        .help(
            "weight that the nearest surface must exceed; 0 shows every outlier, higher values remove more "
            "(auto: "
            "per pixel, from the density of the splats and the pixels around)")
        .paper("T");
    p.add("strictness", strictness)
        .range(0, 4)
        .unit("factor")
        .help(
            "evidence that the automatic weight_threshold asks of a surface; 0 shows every point, as "
            "splats do");
    p.add("prefilter", prefilter)
        .help(
            "leave out isolated points before anything is drawn (auto: with the automatic weight_threshold)");
    p.add("bin_size", bin_size)
        .at_least(1e-9)
        .unit("scene units")
        .help("thickness along the ray of what is averaged as one surface (auto: from noise and spacing)")
        .paper("Delta");
    p.add("bins", bins, {"hashed", "dense"})
        .help(
            "hashed: a small table a pixel, any depth; dense: the first dense_bins bins, the last one takes "
            "the rest");
    p.add("hash_bits", hash_bits)
        .range(1, 8)
        .help("2^hash_bits slots a pixel to begin with; a full table grows by itself")
        .paper("B");
    p.add("dense_bins", dense_bins).range(1, 256).help("bins a pixel of bins = dense").paper("D");
    p.add("overlapping", overlapping)
        .help("bins at half steps, so that no surface is split between two; twice the work");
    p.add("anchor", anchor, {"nearest", "grid"})
        .help(
            "bins begin at the nearest splat, or on a fixed grid along the ray, which outliers cannot move");
    p.add("miss", miss, {"background", "last_bin"}).help("what a pixel shows where no bin has enough weight");
    p.add("antialias", antialias).help("a splat covers at least a disc of 1 px radius on the screen");
    p.add("radius_scale", radius_scale).point_size().range(0.1, 10).unit("factor").help("size of all splats");
    p.add("clamp_radius", clamp_radius)
        .help("limit radii to four times their median, so that isolated points do not become big discs");
  }
};

class Denoise final : public Technique {
 public:
  void describe(ParamList& p) override { parameters_.describe(p); }

  Values in_motion() const override {
    // Splats of a pixel or two need no disc of a pixel around them, and a short row of bins no hashes.
    return {{"antialias", "false"}, {"bins", "dense"}, {"dense_bins", "16"}};
  }

  Attributes needs() const override {
    const Attributes disc = Attribute::normal | Attribute::radius;
    return shows_all() ? disc : disc | Attribute::support;
  }
  bool merges() const override { return !shows_all(); }
  int rounds() const override { return 3; }

  bool shows(Shading shading) const override {
    return shading < Shading::occlusion || shading == Shading::weight;
  }

  /// What is removed casts no shadow: points that are not enough evidence for a surface. `weight_threshold` 0
  /// shows them all.
  std::shared_ptr<const GpuCloud::Casters> casters(const GpuCloud& cloud, Progress&) override {
    if (shows_all()) return nullptr;
    return casters_.at(cloud.serial(), [&] {
      std::vector<float> opacity = cloud.prepared().support;
      for (float& each : opacity) each = each < least_support ? 0 : 1;
      return make_casters(cloud, opacity);
    });
  }

  int reach_px(const GpuCloud& cloud, const Camera& camera) const override {
    // agree.glsl looks two splats around in every round, and deeper_side.glsl two pixels.
    float radius = cloud.median_radius();
    if (!(radius < INFINITY)) radius = cloud.median_spacing();
    const float limit = parameters_.clamp_radius ? cloud.radius_limit() : INFINITY;
    const bool measured = is_measured(cloud) && measured_->radius_limit == limit;
    const float wide = measured ? wide_disc_ : wide_disc(cloud.prepared(), limit);
    const float rounds = 2.0f * agree_rounds * radius + 2 * wide;
    const double reach = double(rounds) * parameters_.radius_scale;
    return 4 + nearest_px(cloud, camera, [&](const Batch&) { return reach; });
  }

  /// Texture buffers hold the table.
  std::int64_t most_pixels() const override {
    const Parameters& p = parameters_;
    return gl::limits().max_texture_buffer_size /
           std::max(p.bins == Layout::dense ? p.dense_bins : 1 << p.hash_bits, denoise::sums_of_pixel);
  }

  bool render(Frame& frame) override {
    const View view(frame.camera, frame.cloud.prepared().cloud.origin);
    SplatShape shape;
    shape.radius_scale = parameters_.radius_scale;
    if (parameters_.clamp_radius) shape.radius_limit = frame.cloud.radius_limit();
    const bool prefilter = parameters_.prefilter.resolve(automatic());
    outliers_ = 0;
    const PreparedCloud& prepared = frame.cloud.prepared();
    measure(frame.cloud, shape.radius_limit, prefilter);
    if (parameters_.clamp_radius) shape.widest_px = spacings_.widest_disc_px(frame);
    shape.dots = parameters_.clamp_radius && shows_all();  // as splats
    if (parameters_.antialias) shape.prefilter_px = 1;
    if (automatic() || prefilter) shape.part = SplatPart::above;
    if (prefilter) {
      const float least = std::min(least_support * std::max(parameters_.strictness, 1.0f), 0.9f);
      shape.field_threshold = parameters_.miss == Miss::background ? least : 0;
      outliers_ = outliers_of_.at({*measured_, shape.field_threshold}, [&] {
        const std::vector<float> worth =
            denoise::splat_worth(prepared, prepared.support, least_support, shape.radius_limit);
        return std::uint64_t(std::count_if(worth.begin(), worth.end(),
                                           [&](float each) { return !(each > shape.field_threshold); }));
      });
    }
    points_ = prepared.whole ? prepared.whole->points : prepared.cloud.size();
    const denoise::BinOptions options = choose_options(frame, shape);
    if (shows_all() && options.anchor == Anchor::nearest && !options.overlapping &&
        frame.settings.shading != Shading::weight) {
      // The first bin is what splats show (paper, Sec. 5): their way to it needs no table.
      surface_.draw(frame.cloud, view, shape, {.epsilon = options.bin_size},
                    {albedo_, frame.target.depth, frame.target.normal}, frame.timers);
      shade(frame, view);
      return true;
    }

    shape.behind = far_side_bins * options.bin_size;
    const SplatBatches batches = choose_batches(frame.cloud, view, shape);
    if (frame.merged) {
      surface_.set_nearest(frame.merged->nearest);
    } else {
      auto timing = frame.timers.scope("nearest");  // t_min
      surface_.draw_nearest(frame.cloud, view, shape, batches);
    }
    const denoise::BinTable::Hits hits{frame.cloud,          view,    shape,       batches,
                                       surface_.nearest_t(), options, frame.timers};
    if (frame.visible) {
      show_part(frame, hits);
      return true;
    }
    const SplatSurfaceTargets targets{albedo_, frame.target.depth, frame.target.normal};
    const bool show_weight = frame.settings.shading == Shading::weight;
    if (frame.merged) {
      outliers_ = frame.merged->outliers;
      bins_.show(hits, *frame.merged, show_weight, targets);
    } else {
      bins_.draw(hits, show_weight, targets);
    }
    shade(frame, view);
    return true;
  }

  std::vector<std::string> notes() const override {
    std::vector<std::string> lines;
    if (outliers_ > 0) {
      char share[32];
      std::snprintf(share, sizeof share, "%.2g", 100.0 * double(outliers_) / double(points_));
      lines.push_back(std::to_string(outliers_) + " of " + std::to_string(points_) + " points (" + share +
                      " %) are left out as outliers; --prefilter false draws them");
    }
    const denoise::BinCounts counts = bins_.counts();
    if (counts.saturated)
      lines.push_back(std::to_string(counts.saturated) +
                      " splat hits were beyond the largest weight of a bin");
    return lines;
  }

  std::uint64_t outliers() const override { return outliers_; }

 private:
  bool automatic() const { return parameters_.weight_threshold.is_auto() && parameters_.strictness > 0; }
  bool shows_all() const {
    const Parameters& p = parameters_;
    if (p.prefilter.user.value_or(false)) return false;
    return p.weight_threshold.is_auto() ? p.strictness == 0 : p.weight_threshold.value() == 0;
  }

  /// The nearest hits of this part, what its hits add to the bins behind those of all parts, and what is in
  /// those that are chosen.
  void show_part(Frame& frame, const denoise::BinTable::Hits& hits) {
    VisiblePoints& visible = *frame.visible;
    if (!frame.merged) {
      visible.outliers = outliers_;
      visible.nearest = surface_.nearest_t().download<float>();
      if (parameters_.clamp_radius)
        visible.vouching = evidence_.points(frame, frame.camera, spacings_, parameters_.radius_scale);
    } else if (frame.merged->bins.empty()) {
      visible.bins = bins_.bins_of(hits);
    } else {
      visible.bin_sums = bins_.sums_of(hits, *frame.merged);
    }
  }

  void shade(Frame& frame, const View& view) {
    if (parameters_.clamp_radius) evidence_.apply(frame, spacings_, parameters_.radius_scale, albedo_);
    auto timing = frame.timers.scope("shade");
    shade_.run(view, frame.settings, frame.light, frame.cloud.prepared().cloud.origin,
               {albedo_, frame.target.depth, frame.target.normal}, frame.target.color);
  }

  /// Radius of the larger discs as they are drawn, scene units; 0 where they are hardly larger than usual.
  static float wide_disc(const PreparedCloud& prepared, float limit) {
    // Parts choose alike: from nothing that is theirs alone, as the limit is.
    if (const WholeCloud* whole = prepared.whole.get())
      return whole->large_radius > uneven * whole->median_radius ? whole->large_radius : 0;
    std::vector<float> radii = prepared.cloud.radii;
    if (radii.empty()) return 0;
    for (float& each : radii) each = std::min(each, limit);
    const float large = analysis::quantile(radii, large_share);
    return large > uneven * std::min(prepared.median_radius, limit) ? large : 0;
  }

  bool is_measured(const GpuCloud& cloud) const { return measured_ && measured_->serial == cloud.serial(); }

  /// Measures a cloud that was not seen before. `radius_limit`: scene units, infinite for none.
  void measure(GpuCloud& cloud, float radius_limit, bool prefilter) {
    const PreparedCloud& prepared = cloud.prepared();
    const Measured asked{cloud.serial(), radius_limit, prefilter};
    if (measured_ == asked) return cloud.set_field(worth_);
    if (!is_measured(cloud))
      residual_ =
          prepared.whole ? prepared.whole->residual : analysis::plane_residual(prepared.cloud.positions);
    const std::vector<float> all_alike(prefilter ? 0 : prepared.cloud.size(), 1.0f);
    measured_.reset();  // nothing is kept of what fails
    worth_ =
        cloud.make_values("worth", denoise::splat_worth(prepared, prefilter ? prepared.support : all_alike,
                                                        least_support, radius_limit));
    cloud.set_field(worth_);
    wide_disc_ = wide_disc(prepared, radius_limit);
    measured_ = asked;
  }

  denoise::BinOptions choose_options(const Frame& frame, const SplatShape& shape) {
    denoise::BinOptions options;
    options.layout = parameters_.bins;
    options.hash_bits = parameters_.hash_bits;
    options.dense_bins = parameters_.dense_bins;
    options.overlapping = parameters_.overlapping;
    options.anchor = parameters_.anchor;
    options.miss = parameters_.miss;
    // Sums of parts add up in any order; and native loops are faster still.
    options.fast = frame.settings.fast && gl::limits().float_atomics && !frame.visible && !frame.merged &&
                   !SplatCpu::is_used();
    // 4 sigma hold 95 % of a surface's points (notes on splitting); less than two spacings, or two pixels
    // where those are larger, would split what is tilted.
    const float pixel = spacings_.measure(frame.cloud, frame.views).pixel;
    const float spacing = std::max(frame.cloud.median_spacing(), shape.prefilter_px * pixel);
    options.bin_size = parameters_.bin_size.resolve(std::max(4 * residual_, 2 * spacing));
    // Strictness raises the threshold and leaves the weights alone: divided by it, they would overflow near
    // 0.
    options.weight_threshold =
        parameters_.weight_threshold.resolve(automatic() ? parameters_.strictness : 0.0f);
    if (automatic()) {
      options.covers = radius_covers * parameters_.radius_scale * parameters_.radius_scale;
      options.peak_share = std::min(peak_share * parameters_.strictness, 0.9f);
      options.peak_bins = peak_bins;
      options.heaviest_bin = true;
      options.surface_share = surface_share;
      options.agree_rounds = agree_rounds;
      options.splat_reach = shape.radius_scale * std::min(frame.cloud.median_radius(), shape.radius_limit);
      options.wide_reach = shape.radius_scale * wide_disc_;
    }
    return options;
  }

  Parameters parameters_;
  struct Measured {
    std::uint64_t serial;
    float radius_limit;
    bool prefilter;
    bool operator==(const Measured&) const = default;
  };
  std::optional<Measured> measured_;  ///< what the following belongs to
  std::shared_ptr<const GpuCloud::Values> worth_;
  float residual_ = 0, wide_disc_ = 0;
  std::uint64_t outliers_ = 0, points_ = 0;  ///< of the last picture
  struct Rejection {
    Measured cloud;
    float least;
    bool operator==(const Rejection&) const = default;
  };
  Derived<Rejection, std::uint64_t> outliers_of_;
  Derived<std::uint64_t, std::shared_ptr<const GpuCloud::Casters>> casters_;
  SplatSurface surface_;
  denoise::BinTable bins_;
  ScreenSpacings spacings_;
  DiscEvidence evidence_;
  gl::Texture albedo_;
  Shade shade_;
};

}  // namespace

TechniqueInfo denoise_technique() {
  return {"denoise", "outliers removed and noise averaged while rendering",
          [] { return std::unique_ptr<Technique>(new Denoise); }};
}

}  // namespace sfumato
