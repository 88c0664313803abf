#include "session/sweep.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "analysis/cloud_facts.h"
#include "analysis/sensor_view.h"
#include "core/order.h"

namespace sfumato {
namespace {

constexpr int width = 1280, height = 720;
static_assert(double(width) / height == FittedTo::width_over_height);

/// The place of the one sensor around which a sweep was measured: as the file says, else the origin.
std::optional<dvec3> center_of_sweep(const PointCloud& cloud, const Bounds& box) {
  constexpr double most = 0.5;  // public sweeps have .62 and more, what else holds the origin .49 at most
  const std::vector<dvec3> known = scanners_of(cloud);
  if (known.size() > 1 || !is_lying(box, cloud.up)) return std::nullopt;
  const bool holds_origin =
      glm::all(glm::lessThan(box.min, dvec3(0))) && glm::all(glm::greaterThan(box.max, dvec3(0)));
  if (known.empty() && (cloud.las || !holds_origin)) return std::nullopt;
  const dvec3 place = known.empty() ? dvec3(0) : known[0];
  const double share =
      analysis::turned_share(cloud.positions, vec3(place - cloud.origin), vec3(up_vector(cloud.up)));
  return share > most ? std::optional(place) : std::nullopt;
}

/// By hash, so that the first so many are some of all, the same ones whatever the order of the file.
Subject by_hash(const Subject& subject) {
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (std::size_t i = 0; i < subject.points.size(); ++i)
    order.emplace_back(analysis::hash_of(subject.points[i]), i);
  std::sort(order.begin(), order.end());
  Subject sorted{subject.box, {}, {}, {}, subject.share, subject.room};
  for (const auto& [hash, i] : order)
    sorted.points.push_back(subject.points[i]), sorted.framed.push_back(subject.is_framed(i));
  return sorted;
}

std::vector<dvec3> first_of(const std::vector<dvec3>& points, std::size_t most) {
  return {points.begin(), points.begin() + std::ptrdiff_t(std::min(most, points.size()))};
}

/// How evenly points are spread over a page: the entropy of the cell in which one is seen (as of faces,
/// Vazquez et al. 2001). Those beyond its margin and behind others are worth nothing.
double spread(const std::vector<dvec3>& points, const Camera& camera) {
  constexpr int columns = 128, rows = 72;  // cells of 10 px: dots side by side
  const dmat4 to_page = camera.projection_matrix() * camera.view();
  // In a cell, what is seen at 80 degrees from its normal is six widths deep.
  const double behind = 1 + 6 * 2 * std::tan(0.5 * camera.fov_y) / rows;
  struct Seen {
    std::size_t cell;
    double depth;
  };
  std::vector<Seen> on_page;
  std::vector<double> nearest(std::size_t(columns * rows), std::numeric_limits<double>::infinity());
  for (const dvec3& world : points) {
    const glm::dvec4 p = to_page * glm::dvec4(world, 1);  // w: the depth
    if (!(p.w > 0) || std::abs(p.x) >= filled_share * p.w || std::abs(p.y) >= filled_share * p.w) continue;
    const int x = int((p.x / p.w + 1) * columns / 2), y = int((p.y / p.w + 1) * rows / 2);
    on_page.push_back({std::size_t(y * columns + x), p.w});
    nearest[on_page.back().cell] = std::min(nearest[on_page.back().cell], p.w);
  }
  std::vector<double> counts(nearest.size(), 0);
  for (const Seen& seen : on_page) counts[seen.cell] += seen.depth < nearest[seen.cell] * behind;
  double entropy = 0;
  for (const double count : counts)
    if (count > 0) entropy -= count * std::log(count / double(points.size()));
  return entropy / double(points.size());
}

/// A few points at the rim of what a view is fitted to take as much of the page as many: where the camera
/// moves to so that the spread is greatest, uphill in ever smaller steps.
dvec3 best_move(const std::vector<dvec3>& points, const Camera& fitted) {
  const double page = 2 * std::tan(0.5 * fitted.fov_y);  // its height in distances
  const auto score_at = [&](const dvec3& move) {
    Camera camera = fitted;
    move_along_axes(camera, move);
    return spread(points, camera);
  };
  dvec3 move(0);
  double best = score_at(move);
  for (double step = page / 8; step > page / 128; step /= 2) {
    for (bool better = true; better;) {
      better = false;
      std::array<double, 6> scores;
      const auto neighbor = [&](std::size_t k) {
        dvec3 at = move;
        at[int(k / 2)] += k % 2 == 0 ? step : -step;
        return at;
      };
      tbb::parallel_for(std::size_t(0), scores.size(),
                        [&](std::size_t k) { scores[k] = score_at(neighbor(k)); });
      const auto top = std::max_element(scores.begin(), scores.end());
      if (*top > best) better = true, best = *top, move = neighbor(std::size_t(top - scores.begin()));
    }
  }
  return move;
}

}  // namespace

std::optional<SweepView> view_of_sweep(const PointCloud& cloud, const Subject& subject,
                                       const std::function<Camera()>& usual_view, bool of_sensor) {
  constexpr double halvings = 5, elevations_deg[] = {45, 30, 15};
  constexpr std::size_t counted = 32'768, fitted = 1024;
  const std::optional<dvec3> center = center_of_sweep(cloud, subject.box);
  if (!center || subject.points.empty()) return std::nullopt;
  const Camera usual = usual_view();
  std::vector<double> ranges;
  for (const dvec3& p : subject.points) ranges.push_back(glm::distance(p, *center));
  const double azimuth_deg = glm::degrees(Compass(cloud.up).azimuth(-usual.direction()));
  std::vector<SweepView> views;
  for (double k = 1; k <= halvings; ++k)  // the nearer half, three quarters, ...
    for (const double elevation_deg : elevations_deg)
      for (int turn = 0; turn < (of_sensor ? 1 : 12); ++turn)
        views.push_back({{std::remainder(azimuth_deg + 30 * turn, 360), elevation_deg},
                         {{*center, value_at_share(ranges, 1 - std::exp2(-k))}}});
  const Subject mixed = by_hash(subject);
  const std::vector<dvec3> points = first_of(mixed.points, counted);
  const auto camera_of = [&](const SweepView& view, std::size_t most) {
    const Subject near = within(mixed, view.around.reach);
    Camera camera = frame(near.box, cloud.up, width, height, glm::radians(view.from.azimuth_deg),
                          glm::radians(view.from.elevation_deg));
    fit(camera, first_of(near.points, most));
    return camera;
  };
  std::vector<double> scores(views.size());
  tbb::parallel_for(std::size_t(0), views.size(),
                    [&](std::size_t i) { scores[i] = spread(points, camera_of(views[i], fitted)); });
  const auto best = std::max_element(scores.begin(), scores.end());
  if (!(*best > spread(points, usual.resized(width, height)))) return std::nullopt;
  SweepView view = views[std::size_t(best - scores.begin())];
  view.around.move = best_move(points, camera_of(view, mixed.points.size()));
  return view;
}

}  // namespace sfumato
