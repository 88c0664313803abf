#include "techniques/screen_spacing.h"

#include <algorithm>
#include <vector>

#include "core/order.h"

namespace sfumato {

float widest_disc_px(const ScreenSpacing& spacing, int height) {
  constexpr float closes = 2;   // spacings: no gap of a random sample is wider
  constexpr float near_px = 8;  // at 720 lines or fewer
  return std::max({near_px, near_px * float(height) / 720, closes * spacing.median_px});
}

EvidenceReach evidence_reach(const ScreenSpacing& spacing, int height) {
  // Covers of 8, 11, 12, 16 and 24 px between points leave at most 0, 1, 1.4, 4 and 9 % of what eight public
  // scans cover farther than 8 px from all points.
  constexpr float between = 11.0f / 8;
  // An empty disc of so many spacings is no chance in a random sample (exp(-pi 2.2^2) = 2.5e-7); of 1.7 it is
  // (1e-4), and as all of it is open, .4 % of a random wall would be.
  constexpr float widest_gap = 2.2f;
  // The cell of a point on an outline ends half a spacing outside, 1 px or more, of 720 lines. What is in no
  // triangle is as wide as what stands for a point there: 4 px or more.
  constexpr float of_cell = 0.5f, least_beside = 1.0f / 8, least_around = 0.5f;
  const float widest = widest_disc_px({}, height), cell = of_cell * spacing.median_px;
  return {.between = std::max(between * widest, widest_gap * spacing.median_px),
          .beside = std::min(widest, std::max(least_beside * widest, cell)),
          .around = std::min(widest, std::max(least_around * widest, cell))};
}

float ScreenSpacings::widest_disc_px(const Frame& frame) {
  return sfumato::widest_disc_px(measure(frame.cloud, frame.views), frame.camera.whole_height());
}

namespace {

/// Of its places: none of its parts has the batches of the whole.
ScreenSpacing spacing_of(const WholeCloud& whole, std::span<const Camera> views) {
  std::vector<float> px, pixels;
  for (const Camera& camera : views) {
    const View view(camera, whole.origin);
    for (std::size_t k = 0; k < whole.dots.places.size(); ++k) {
      const vec3& place = whole.dots.places[k];
      if (!view.may_see(place, place)) continue;
      const double depth = std::max(-(view.eye_from_cloud() * glm::dvec4(place, 1)).z, camera.near_plane);
      pixels.push_back(float((camera.orthographic() ? 1 : depth) / camera.pixels_per_unit()));
      px.push_back(whole.dots.dots[k].x / pixels.back());
    }
  }
  if (px.empty()) return {};
  return {median(px), *std::max_element(px.begin(), px.end()), median(pixels)};
}

}  // namespace

ScreenSpacing ScreenSpacings::measure(const GpuCloud& cloud, std::span<const Camera> views) {
  const PreparedCloud& prepared = cloud.prepared();
  if (const WholeCloud* whole = prepared.whole.get()) return spacing_of(*whole, views);
  const Bounds& box = most_.at(cloud.serial(), [&] { return robust_bounds(prepared.cloud); });
  const vec3 least = vec3(box.min - prepared.cloud.origin), most = vec3(box.max - prepared.cloud.origin);
  std::vector<float> px, pixels;
  // Who looks at strays alone sees their batches as they are.
  for (const bool is_cut : {true, false})
    for (const Camera& camera : views) {
      if (!px.empty() && !is_cut) break;
      const View view(camera, prepared.cloud.origin);
      for (const Batch& batch : prepared.batches) {
        const vec3 low = is_cut ? glm::max(batch.box_min, least) : batch.box_min,
                   high = is_cut ? glm::min(batch.box_max, most) : batch.box_max;
        if (glm::any(glm::greaterThan(low, high)) || !view.may_see(low, high)) continue;
        const glm::dvec4 center(0.5 * (dvec3(low) + dvec3(high)), 1);
        const double depth = std::max(-(view.eye_from_cloud() * center).z, camera.near_plane);
        pixels.push_back(float((camera.orthographic() ? 1 : depth) / camera.pixels_per_unit()));
        px.push_back(batch.spacing / pixels.back());
      }
    }
  if (px.empty()) return {};
  return {median(px), *std::max_element(px.begin(), px.end()), median(pixels)};
}

const gl::Texture* DiscEvidence::find(Frame& frame, const Camera& camera, ScreenSpacings& spacings,
                                      float radius_scale) {
  const std::optional<EvidenceReach> reach = reach_of(frame, spacings, radius_scale);
  if (!reach) return nullptr;
  if (frame.merged) return &evidence_.find(frame.merged->vouching, camera.width, camera.height, *reach);
  return &evidence_.find(frame.cloud, camera, frame.cloud.prepared().cloud.origin, *reach, frame.timers);
}

std::optional<EvidenceReach> DiscEvidence::reach_of(const Frame& frame, ScreenSpacings& spacings,
                                                    float radius_scale) {
  constexpr float usual_spacings = 1.7f;  // radius of a usual disc
  const float scale = std::max(1.0f, radius_scale / usual_scale);
  const ScreenSpacing spacing = spacings.measure(frame.cloud, frame.views);
  EvidenceReach reach = evidence_reach(spacing, frame.camera.whole_height());
  reach.between *= scale, reach.beside *= scale, reach.around *= scale;
  if (!reach.limits(spacing.largest_px * usual_spacings * scale)) return std::nullopt;
  return reach;
}

Image<std::uint32_t> DiscEvidence::points(Frame& frame, const Camera& camera, ScreenSpacings& spacings,
                                          float radius_scale) {
  const std::optional<EvidenceReach> reach = reach_of(frame, spacings, radius_scale);
  if (!reach) return {};
  return evidence_.draw_points(frame.cloud, camera, frame.cloud.prepared().cloud.origin, *reach)
      .download<std::uint32_t>();
}

void DiscEvidence::apply(Frame& frame, ScreenSpacings& spacings, float radius_scale, gl::Texture& albedo) {
  if (find(frame, frame.camera, spacings, radius_scale))
    evidence_.apply(albedo, frame.target.depth, frame.target.normal);
}

}  // namespace sfumato
