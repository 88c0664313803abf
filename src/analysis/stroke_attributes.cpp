#include "analysis/stroke_attributes.h"

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "analysis/normals.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

float smooth(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// 0 where points are a surface, 1 where they fill space. Scanned stone stays below 0.3, creases reach 0.5.
float fills_space(float non_planarity) { return smooth(0.4f, 0.7f, non_planarity); }

/// r and eps_r of every cluster: mean and standard deviation over its points of their mean distances to K
/// neighbours (dos Anjos 2017, Sec. 3.2.1 and 3.2.2: "the estimated cluster resolution").
struct Resolution {
  double count = 0, sum = 0, squares = 0;
  float mean() const { return float(sum / count); }
  float deviation() const {
    return float(std::sqrt(std::max(squares / count - sum / count * (sum / count), 0.0)));
  }
};

/// The direction that the normals around a point leave alone, where they bend by 15 degrees or more about one
/// axis: along poles, edges, folds of cloth.
std::optional<vec3> fold_axis(const std::vector<vec3>& normals, std::uint32_t point,
                              std::span<const std::uint32_t> ids) {
  Eigen::Matrix3f sum = Eigen::Matrix3f::Zero();
  auto add = [&](std::uint32_t j) {
    const Eigen::Vector3f n(normals[j].x, normals[j].y, normals[j].z);
    sum += n * n.transpose();
  };
  add(point);
  for (std::uint32_t j : ids) add(j);
  sum /= float(ids.size() + 1);
  // The trace is 1, the largest eigenvalue at most 1 - bend: a cheap way out for flat surfaces.
  constexpr float bend = 0.067f;  // sin^2 of 15 degrees
  if (sum.squaredNorm() > (1 - bend) * (1 - bend) + bend * bend) return {};
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(sum);
  const auto& l = solver.eigenvalues();  // ascending
  if (l[1] < bend || l[0] > 0.25f * l[1]) return {};
  const Eigen::Vector3f axis = solver.eigenvectors().col(0);
  return vec3(axis.x(), axis.y(), axis.z());
}

constexpr float axis_steps = 4094;  // 24 bits for both coordinates: a float holds them

}  // namespace

float pack_axis(const vec3& axis) {
  vec3 a = (axis.z < 0 ? -axis : axis) / (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
  const vec2 code = glm::round((0.5f + 0.5f * vec2(a)) * axis_steps);
  return 1 + code.x + 4096 * code.y;
}

std::optional<vec3> unpack_axis(float code) {
  const double rest = double(code) - 1;
  if (!(rest >= 0) || rest >= 4096 * 4096) return {};
  const double y = std::floor(rest / 4096);
  const vec2 a = vec2(float(rest - 4096 * y), float(y)) / axis_steps * 2.0f - 1.0f;
  return glm::normalize(vec3(a, std::max(1 - std::abs(a.x) - std::abs(a.y), 0.0f)));
}

void StrokeOptions::describe(ParamList& p) {
  p.add("cluster_neighbors", clusters.neighbors)
      .range(4, 100)
      .help("strokes: neighbours of the graph that clusters grow along");
  p.add("cluster_color_step", clusters.point_threshold)
      .range(0, 442)
      .unit("8-bit levels, RGB distance")
      .help("strokes: neighbouring points this alike are of one cluster")
      .paper("Zhan 2009");
  p.add("cluster_merge_step", clusters.region_threshold)
      .range(0, 442)
      .unit("8-bit levels, RGB distance")
      .help("strokes: segments whose mean colours are this alike are merged")
      .paper("Zhan 2009");
  p.add("cluster_gap", cluster_gap)
      .at_least(0)
      .unit("scene units")
      .help("strokes: only segments this near are merged; 5 spacings");
  p.add("cluster_min_points", clusters.min_size)
      .range(1, 1e9)
      .help("strokes: smaller clusters join the nearest one");
  p.add("size_neighbors", size_neighbors)
      .range(1, 100)
      .help("strokes: neighbours that the local resolution r is measured by")
      .paper("dos Anjos 2017, K");
  p.add("size_spread", size_spread)
      .range(0, 10)
      .unit("standard deviations")
      .help("strokes: epsilon of s = r + epsilon")
      .paper("dos Anjos 2017, epsilon");
  p.add("size_of", size_of, {"point", "cluster"})
      .help("strokes: r and epsilon of each point, or those of its cluster");
}

float stroke_size(std::vector<float>& distances, int k, float spread) {
  const std::size_t n = std::min(std::size_t(std::max(k, 0)), distances.size());
  if (n == 0) return 0;
  std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(n - 1), distances.end());
  double mean = 0, variance = 0;
  for (std::size_t j = 0; j < n; ++j) mean += distances[j] / double(n);
  for (std::size_t j = 0; j < n; ++j) variance += (distances[j] - mean) * (distances[j] - mean) / double(n);
  return float(mean + spread * std::sqrt(variance));
}

void cap_sizes(const NeighborGraph& graph, std::span<const NeighborhoodShape> shapes,
               std::vector<float>& sizes) {
  if (sizes.empty()) return;
  std::vector<float> sorted = sizes;
  const float most_without_surface = 2 * median(sorted);
  std::vector<float> capped = sizes;
  tbb::enumerable_thread_specific<std::vector<float>> scratches;
  graph.for_each(
      [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
        if (ids.empty()) return;
        std::vector<float>& near = scratches.local();
        near.clear();
        for (std::uint32_t j : ids) near.push_back(sizes[j]);
        float s = std::min(sizes[i], 2 * median(near));
        if (s > most_without_surface)
          s = std::lerp(s, most_without_surface, fills_space(shapes[i].non_planarity));
        if (s > 0) capped[i] = s;
      },
      "support of strokes");
  sizes = std::move(capped);
}

std::vector<float> stroke_rooms(const NeighborGraph& graph, std::span<const float> labels,
                                std::span<const vec3> normals, std::span<const float> sizes,
                                std::span<const NeighborhoodShape> shapes, Progress& progress) {
  constexpr float most_sizes = 100, crease = 0.866f, open_rim = 0.35f;  // cosine of 30 degrees
  const std::span<const vec3> positions = graph.positions();
  std::vector<float> room(positions.size());
  for (std::size_t i = 0; i < room.size(); ++i) room[i] = most_sizes * sizes[i];
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (shapes[i].strip_width > 0) room[i] = std::min(room[i], 0.5f * shapes[i].strip_width);
  if (!graph.keeps()) return room;
  graph.for_each(
      [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
        vec3 sum(0);
        float farthest = 0;
        for (std::uint32_t j : ids) {
          const float distance = glm::distance(positions[i], positions[j]);
          if (labels[j] != labels[i] || std::abs(glm::dot(normals[i], normals[j])) < crease)
            room[i] = std::min(room[i], distance);
          sum += positions[j] - positions[i];
          farthest = std::max(farthest, distance);
        }
        // The points of half a disc have their centre 4/(3 pi) = 0.42 of the radius away from its middle.
        if (!ids.empty() && glm::length(sum) > open_rim * farthest * float(ids.size()))
          room[i] = std::min(room[i], 0.5f * sizes[i]);
      },
      "borders of strokes");
  // Distances spread along the graph until nothing gets shorter; the result does not depend on the order.
  std::vector<std::uint32_t> front, next;
  for (std::uint32_t i = 0; i < room.size(); ++i)
    if (room[i] < most_sizes * sizes[i]) front.push_back(i);
  while (!front.empty()) {
    progress.check();
    next.clear();
    for (std::uint32_t i : front)
      for (std::uint32_t j : graph.of(i)) {
        const float through = room[i] + glm::distance(positions[i], positions[j]);
        if (through < room[j]) {
          room[j] = through;
          next.push_back(j);
        }
      }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    std::swap(front, next);
  }
  return room;
}

namespace {

/// The given labels, or those that grow.
ScalarField labels_of(const PreparedCloud& prepared, const NeighborGraph& graph, const StrokeOptions& options,
                      Progress& progress) {
  const PointCloud& cloud = prepared.cloud;
  if (const ScalarField* given = cloud.scalar("cluster")) return *given;
  ClusterOptions growth = options.clusters;
  if (options.cluster_gap.user) growth.gap = *options.cluster_gap.user;
  ScalarField cluster{"cluster", 0, std::vector<float>(cloud.size()), StoredType::uint32};
  const Clusters found = grow_clusters(cloud, graph, prepared.median_spacing, growth, progress);
  std::copy(found.label.begin(), found.label.end(), cluster.values.begin());
  return cluster;
}

/// Points at one place come in the order of the file, which must not show. The place in `cloud` that each
/// point's colour, normal and label take while strokes are measured; empty: all their own.
std::vector<std::uint32_t> order_within_places(const PointCloud& cloud) {
  std::vector<std::uint32_t> order;
  const ScalarField* given = cloud.scalar("cluster");
  const auto look = [&](std::uint32_t i) {
    const Rgba8 c = cloud.colors.empty() ? Rgba8{} : cloud.colors[i];
    const vec3 n = cloud.normals.empty() ? vec3(0) : cloud.normals[i];
    // Any order will do, as long as NaNs have a place in it.
    const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
    return std::make_tuple(c.r, c.g, c.b, bits(n.x), bits(n.y), bits(n.z),
                           bits(given ? given->values[i] : 0));
  };
  const auto before = [&](std::uint32_t a, std::uint32_t b) { return look(a) < look(b); };
  for (std::uint32_t first = 0, end; first < cloud.size(); first = end) {
    for (end = first + 1; end < cloud.size() && cloud.positions[end] == cloud.positions[first];) ++end;
    if (end == first + 1) continue;
    if (order.empty()) order.resize(cloud.size()), std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin() + first, order.begin() + end, before);
  }
  return order;
}

template <class T>
void take(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  const std::vector<T> old = values;
  for (std::size_t i = 0; i < order.size(); ++i) values[i] = old[order[i]];
}

template <class T>
void give_back(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  const std::vector<T> mine = values;
  for (std::size_t i = 0; i < order.size(); ++i) values[order[i]] = mine[i];
}

/// Detail, evened out among neighbours so that no border of cells shows, and as small as a point where there
/// is no surface to paint along.
std::vector<float> even_details(const NeighborGraph& graph, const std::vector<float>& lengths,
                                std::span<const NeighborhoodShape> shapes, std::span<const float> sizes) {
  std::vector<float> out(lengths.size());
  graph.for_each(
      [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
        float sum = std::log(lengths[i]), volume = fills_space(shapes[i].non_planarity);
        for (std::uint32_t j : ids)
          sum += std::log(lengths[j]), volume += fills_space(shapes[j].non_planarity);
        const float n = float(ids.size()) + 1;
        out[i] = std::exp(std::lerp(sum / n, std::min(sum / n, std::log(1.5f * sizes[i])), volume / n));
      },
      "detail of strokes");
  return out;
}

void add_clusters_in_order(PreparedCloud& prepared, const StrokeOptions& options, Progress& progress) {
  PointCloud& cloud = prepared.cloud;
  const NeighborGraph graph(cloud.positions, options.clusters.neighbors, progress);
  ScalarField cluster = labels_of(prepared, graph, options, progress);
  const auto k = [&](std::size_t neighbors) {
    return std::min(std::size_t(options.size_neighbors), neighbors);
  };
  const float of_a_grid = std::sqrt(2.0f) * prepared.median_spacing;  // the s of a square grid

  ScalarField size{"stroke_size", 0, std::vector<float>(cloud.size()), StoredType::float32};
  std::vector<float> r(cloud.size());
  std::vector<NeighborhoodShape> shapes(cloud.size());
  tbb::enumerable_thread_specific<std::vector<float>> distances;
  graph.for_each(
      [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
        std::vector<float>& mine = distances.local();
        mine.clear();
        for (std::uint32_t j : ids) mine.push_back(glm::distance(cloud.positions[i], cloud.positions[j]));
        const float s = stroke_size(mine, options.size_neighbors, options.size_spread);
        size.values[i] = s > 0 ? s : of_a_grid;
        // stroke_size left the nearest in front.
        const std::size_t count = k(ids.size());
        r[i] = std::accumulate(mine.begin(), mine.begin() + std::ptrdiff_t(count), 0.0f) /
               float(std::max<std::size_t>(count, 1));
        shapes[i] = neighborhood_shape(cloud.positions, i, ids, r[i]);
      },
      "stroke sizes");
  if (options.size_of == SizeOf::cluster) {
    std::unordered_map<float, Resolution> resolutions;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      Resolution& c = resolutions[cluster.values[i]];
      c.count += 1, c.sum += r[i], c.squares += double(r[i]) * r[i];
    }
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Resolution& c = resolutions[cluster.values[i]];
      r[i] = c.mean();
      const float s = c.mean() + options.size_spread * c.deviation();
      size.values[i] = s > 0 ? s : of_a_grid;
    }
  } else {
    cap_sizes(graph, shapes, size.values);
  }

  std::vector<vec3> normals = cloud.normals;
  normals.resize(cloud.size(), vec3(0));
  const Orientation orientation(cloud);
  ScalarField axis{"stroke_axis", 0, std::vector<float>(cloud.size()), StoredType::uint32};
  auto find_axis = [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
    if (shapes[i].strip_width > 0)
      if (const auto along = widest_direction(cloud.positions, i, ids)) axis.values[i] = pack_axis(*along);
  };
  tbb::enumerable_thread_specific<std::vector<std::uint32_t>> nearby;
  graph.for_each(
      [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
        find_axis(i, ids);
        if (normals[i] != vec3(0)) return;
        std::vector<std::uint32_t>& near = nearby.local();
        near.clear();
        for (std::uint32_t j : ids)
          if (cluster.values[j] == cluster.values[i] &&
              glm::distance(cloud.positions[i], cloud.positions[j]) <= 3 * r[i])
            near.push_back(j);
        // Two neighbours span a plane; a point that is alone in its cluster takes what is around it.
        const auto normal = thinnest_direction(cloud.positions, i, near.size() >= 3 ? near : ids);
        normals[i] = normal ? orientation.facing(i, *normal) : orientation.fallback(i);
      },
      "normals of strokes");
  // Where the surface folds about one axis, strokes follow it.
  graph.for_each(
      [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
        if (axis.values[i] != 0) return;
        if (const auto along = fold_axis(normals, i, ids)) axis.values[i] = pack_axis(*along);
      },
      "folds");
  ScalarField room{"stroke_room", 0,
                   stroke_rooms(graph, cluster.values, normals, size.values, shapes, progress),
                   StoredType::float32};
  // As fine as the denser parts allow: a scanner sees near things at a tenth of the median spacing.
  const float dense = nth_value(std::vector<float>(size.values), size.values.size() / 10);
  const std::vector<float> lengths = detail_lengths(cloud.positions, cloud.colors, normals, cloud.origin,
                                                    dense / std::sqrt(2.0f), options.detail, progress);
  ScalarField detail{"stroke_detail", 0, even_details(graph, lengths, shapes, size.values),
                     StoredType::float32};
  cloud.normals = std::move(normals);
  cloud.set_scalar(std::move(detail));
  cloud.set_scalar(std::move(axis));
  cloud.set_scalar(std::move(room));
  cloud.set_scalar(std::move(cluster));
  cloud.set_scalar(std::move(size));
}

}  // namespace

void add_clusters(PreparedCloud& prepared, const StrokeOptions& options, Progress& progress) {
  const std::vector<std::uint32_t> order = order_within_places(prepared.cloud);
  if (order.empty()) return add_clusters_in_order(prepared, options, progress);
  PointCloud& cloud = prepared.cloud;
  const std::vector<Rgba8> colors = cloud.colors;
  const std::vector<vec3> normals = cloud.normals;
  const ScalarField* const given = cloud.scalar("cluster");
  const std::vector<float> labels = given ? given->values : std::vector<float>();
  take(cloud.colors, order);
  take(cloud.normals, order);
  if (given) take(cloud.scalar("cluster")->values, order);
  try {
    add_clusters_in_order(prepared, options, progress);
  } catch (...) {  // cancelled: as if nothing had been
    cloud.colors = colors, cloud.normals = normals;
    if (given) cloud.scalar("cluster")->values = labels;
    throw;
  }
  cloud.colors = colors;
  give_back(cloud.normals, order);
  for (const char* name : {"cluster", "stroke_size", "stroke_room", "stroke_detail", "stroke_axis"})
    give_back(cloud.scalar(name)->values, order);
}

}  // namespace sfumato::analysis
