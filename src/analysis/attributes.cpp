#include "analysis/attributes.h"

#include <tbb/blocked_range.h>
#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "analysis/isolation.h"
#include "analysis/memory.h"
#include "analysis/neighbors.h"
#include "analysis/normals.h"
#include "analysis/quantiles.h"
#include "analysis/range_image.h"
#include "analysis/sides.h"
#include "analysis/sensor_view.h"
#include "analysis/stroke_attributes.h"
#include "analysis/support.h"
#include "analysis/vouched.h"
#include "analysis/wide_normals.h"
#include "analysis/wider_neighborhoods.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

/// Of a disc over what is vouched for (splats.cpp draws 1.5 radii): discs that are tilted against each other
/// by 30 degrees still meet where they would touch, 1.2 = 1 / cos 30 and a little.
constexpr float overlap = 0.8f;

/// In median radii: the largest disc where the neighbours do not clearly lie in a plane, whatever surrounds
/// them: a trunk of few points is no club. Sparse ground has larger discs.
constexpr float largest_unless_flat = 1.5f;
/// The smallest dot, of the radius of Eq. 20: on lines and at the end of a surface discs may be so much
/// smaller than in clutter. Of 24 neighbours such discs hide a sixth of what lies behind their ball.
constexpr float smallest_dot = 0.2f;
/// The share of surfaces among what surrounds a point, up to which it is foliage with branches, and from
/// which on it may be a wall or ground with trees: 0 to 0.3 around branches of forests, 0.9 on the ground
/// below them, on statues and in rooms; but 0.5 on a tower of few points.
constexpr float crown = 0.3f, grove = 0.5f;

/// An outpost has half to a quarter of the density of its neighbours, as sparse as what lies beside strips
/// that overlap (points_to_pixels.comp), and all of them beside it: their middle, in shares of the farthest
/// one's distance, is 0.42 away at a straight border, 0.6 at a corner.
constexpr float sparser = 1.41f, much_sparser = 2, at_border = 0.42f, at_corner = 0.6f;

/// Of a disc of Eq. 20, drawn 1.5 times as large (1.7 spacings): where it touches its neighbours' on a square
/// grid, and where such discs close it.
constexpr float discs_touch = 0.3f, discs_close = 0.42f;

/// Of points on sides, so that the sign of PreparedCloud::on_surface tells them.
constexpr float least_on_surface = 1e-3f;

bool missing(const vec3& normal) { return normal == vec3(0); }
bool missing(float radius) { return !(radius > 0); }

template <class T>
bool complete_for_all(const std::vector<T>& values) {
  using Range = tbb::blocked_range<std::size_t>;
  return !values.empty() && tbb::parallel_reduce(
                                Range(0, values.size(), 65'536), true,
                                [&](const Range& range, bool complete) {
                                  for (std::size_t i = range.begin(); complete && i < range.end(); ++i)
                                    complete = !missing(values[i]);
                                  return complete;
                                },
                                std::logical_and<>());
}

/// So many of the neighbours reach half as far as 24, and still tell a plane from a corner; not when they lie
/// on a line, as a scanner's may: then they are this much longer than wide (in variance; places by
/// chance 2.5).
constexpr std::size_t few_neighbors = 8;
constexpr float line_like = 8;
/// They are believed when they lie so much better in a plane, and when of the points around at least this
/// share has a neighbourhood of all that lies as much better: among leaves and in noise a few are flat by
/// chance.
constexpr float better = 4, flat_around = 0.2f, not_flat = 0.08f;
constexpr std::size_t around = 64;
/// How flat such a point is: on a surface, but not clearly in a plane where its disc is large.
constexpr float flat_nearby = 0.99f;

/// The normal of the nearest few where they lie in a plane, and all neighbours, with this `scatter`, do not.
std::optional<vec3> near_normal(std::span<const vec3> positions, std::uint32_t point,
                                std::span<const std::uint32_t> ids, std::span<const float> distances2,
                                float scatter) {
  constexpr std::size_t most = 64;
  if (scatter < not_flat || ids.size() < 2 * few_neighbors || ids.size() > most) return std::nullopt;
  std::array<std::uint64_t, most> keys;
  for (std::size_t k = 0; k < ids.size(); ++k) keys[k] = sort_key(distances2[k], ids[k]);
  std::nth_element(keys.begin(), keys.begin() + few_neighbors, keys.begin() + std::ptrdiff_t(ids.size()));
  std::array<std::uint32_t, few_neighbors> nearest;
  std::transform(keys.begin(), keys.begin() + few_neighbors, nearest.begin(), id_of);
  const auto frame = local_frame(positions, point, nearest);
  const bool tells = frame && is_flat(scatter_of(*frame)) && better * scatter_of(*frame) < scatter &&
                     line_like * frame->variance.y > frame->variance.z;
  return tells ? std::optional(frame->normal) : std::nullopt;
}

/// The median radius around every 64 points on the curve, of them and as many on either side: what is usual
/// there.
class UsualRadii {
 public:
  explicit UsualRadii(const std::vector<float>& radii) : usual_((radii.size() + around - 1) / around) {
    tbb::parallel_for(std::size_t(0), usual_.size(), [&](std::size_t block) {
      const std::size_t first = block == 0 ? 0 : (block - 1) * around,
                        last = std::min(radii.size(), (block + 2) * around);
      usual_[block] = median(
          std::vector<float>(radii.begin() + std::ptrdiff_t(first), radii.begin() + std::ptrdiff_t(last)));
    });
  }
  float near(std::size_t point) const { return usual_[point / around]; }

 private:
  std::vector<float> usual_;
};

/// How far each point is an outpost, from 0 to 1: farther from its neighbours than they are from theirs, and
/// all of them on one side of it. `spacings`: around each point, in any unit.
std::vector<float> outposts(const NeighborTree& tree, const std::vector<float>& spacings,
                            const std::vector<VoronoiCell>& cells, std::size_t neighbors,
                            Progress& progress) {
  constexpr float slack = 0.9f;  // of those equally far another may count
  const UsualRadii usual(spacings);
  const std::span<const vec3> positions = tree.positions();
  std::vector<float> alone(spacings.size(), 0.0f);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, spacings.size(), 4096), [&](const auto& range) {
    progress.check();
    KNearest nearest(neighbors);
    std::vector<float> theirs;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      // Nine of ten outposts are those among the points before and after them, too: few are asked.
      if (!(spacings[i] > sparser * usual.near(i)) || cells[i].aside < slack * at_border) continue;
      nearest.start(std::uint32_t(i));
      tree.search(positions[i], nearest);
      vec3 middle(0);
      theirs.clear();
      for (const std::uint64_t key : nearest.heap()) {
        middle += positions[id_of(key)] - positions[i];
        theirs.push_back(spacings[id_of(key)]);
      }
      if (theirs.empty() || !(nearest.limit() > 0))
        continue;  // of coincident points, or farther than floats reach
      const float aside = glm::length(middle) / (float(theirs.size()) * std::sqrt(nearest.limit()));
      alone[i] = glm::smoothstep(sparser, much_sparser, spacings[i] / median(std::span(theirs))) *
                 glm::smoothstep(at_border, at_corner, aside);
    }
  });
  return alone;
}

/// The same K neighbours for every point, in one array.
class KeptNeighbors {
 public:
  KeptNeighbors(std::size_t points, std::size_t each) : each_(each), ids_(points * each) {}
  void keep(std::uint32_t point, std::span<const std::uint32_t> ids) {
    std::copy(ids.begin(), ids.end(), ids_.begin() + std::ptrdiff_t(point * each_));
  }
  std::span<const std::uint32_t> of(std::size_t point) const { return {ids_.data() + point * each_, each_}; }

 private:
  std::size_t each_;
  std::vector<std::uint32_t> ids_;
};

/// Of the whole, where this is a part of it.
float median_radius(const PreparedCloud& prepared, const std::vector<float>& radii) {
  const WholeCloud* whole = prepared.whole.get();
  return whole && whole->median_radius > 0 ? whole->median_radius : quantile(radii, 0.5);
}

/// One call of `complete`. Works on copies until all is there, so that a cancelled call changes nothing.
class Completion {
 public:
  Completion(PreparedCloud& prepared, const PrepareOptions& options, const NeighborTree& tree,
             Progress& progress)
      : prepared_(prepared),
        cloud_(prepared.cloud),
        progress_(progress),
        tree_(tree),
        options_(options),
        k_(std::min(std::size_t(std::max(1, options.neighbors)), cloud_.size() - 1)) {}

  void run(bool normals, bool radii, bool uncertainty) {
    // Uncertainty is what the nearest neighbours disagree by: those of surfaces that are seen through their
    // noise agree. Normals that a call before this one computed are such.
    const bool find_normals = normals || (uncertainty && prepared_.computed.has(Attribute::normal));
    std::vector<vec3> nearest_normals;
    std::vector<float> new_radii;
    if (normals) nearest_normals = cloud_.normals;
    if (find_normals) nearest_normals.resize(cloud_.size(), vec3(0));
    if (radii) new_radii = cloud_.radii, new_radii.resize(cloud_.size(), 0.0f);
    const bool keep = uncertainty && cloud_.size() * k_ * sizeof(std::uint32_t) <= most_kept_bytes;
    KeptNeighbors kept(keep ? cloud_.size() : 0, k_);

    const Orientation orientation(cloud_);
    std::vector<float> scatter(find_normals || radii ? cloud_.size() : 0),
        thickness2(normals ? cloud_.size() : 0);
    tbb::concurrent_vector<NearNormal> near_normals;
    const bool shrink = radii && options_.clutter_radius < 1;
    std::optional<Sides> sides;
    if ((find_normals || radii) && may_have_sheets()) sides.emplace(tree_, known_sides(), progress_);
    const bool has_sides = sides && !sides->empty();
    std::vector<std::uint8_t> on_side(has_sides ? cloud_.size() : 0);
    std::vector<float> flatness(shrink ? cloud_.size() : 0, 1.0f);
    std::vector<VoronoiCell> cells(flatness.size());
    // A square grid of the cloud's spacing would have this radius (the limit of Eq. 20 for many neighbours).
    const float fallback_radius = 2 * std::numbers::inv_sqrtpi_v<float> * prepared_.median_spacing;
    const auto radius_in = [&](std::span<const std::uint32_t> ids, std::span<const float> distances2) {
      const float farthest = distances2.empty() ? 0 : std::sqrt(distances2.back());
      return farthest > 0 ? radius_of(farthest, ids.size()) : fallback_radius;
    };
    if (find_normals || radii || keep)
      for_each_neighborhood(
          tree_, int(k_), Sides::wider * int(k_),
          has_sides ? [&](std::uint32_t i) { return sides->is_near(i); }
                    : std::function<bool(std::uint32_t)>(),
          [&](std::uint32_t i, std::span<const std::uint32_t> ids, std::span<const float> distances2) {
            thread_local Sides::Own side;
            if (ids.size() > k_) {
              on_side[i] = sides->find(i, ids, distances2, k_, side);
              ids = side.ids, distances2 = side.distances2;
            }
            const auto facing = [&](const vec3& normal) {
              if (!has_sides || !on_side[i]) return orientation.facing(i, normal);
              return glm::dot(normal, side.outward) < 0 ? -normal : normal;
            };
            const bool own_normal = find_normals && missing(nearest_normals[i]),
                       own_radius = radii && missing(new_radii[i]);
            const auto frame =
                find_normals || (own_radius && shrink) ? local_frame(cloud_.positions, i, ids) : std::nullopt;
            std::optional<vec3> near;
            if (frame) {
              scatter[i] = scatter_of(*frame);
              near = near_normal(cloud_.positions, i, ids, distances2, scatter[i]);
              if (near) near_normals.push_back({i, own_normal ? facing(*near) : vec3(0)});
            }
            if (normals && frame) thickness2[i] = frame->variance.x;
            if (own_normal) nearest_normals[i] = frame ? facing(frame->normal) : orientation.fallback(i);
            if (own_radius) {
              new_radii[i] = radius_in(ids, distances2);
              if (shrink && frame) {
                flatness[i] = flatness_of(cloud_.positions, i, ids, *frame, std::sqrt(distances2.back()));
                cells[i] = cell_of(cloud_.positions, i, ids, *frame, near.value_or(frame->normal));
                if (has_sides && on_side[i]) cells[i].aside = 1;  // of its own side, not of all
              }
            }
            if (keep) kept.keep(i, ids);
          },
          find_normals ? "normals" : "radii", progress_);
    take_near_normals(near_normals, scatter, nearest_normals, flatness);
    std::vector<vec3> new_normals;
    float noise = 0;
    if (normals) {
      new_normals = nearest_normals;
      noise = widen(near_normals, on_side, scatter, thickness2, orientation, new_normals);
    }
    // Uncertainty and the median, which limits the largest, are of the radii that a surface would have.
    if (radii) prepared_.median_radius = median_radius(prepared_, new_radii);
    std::vector<float> shrunk;
    if (shrink) shrunk = shrink_to_vouched(flatness, cells, new_radii);
    for (std::size_t i = 0; i < on_side.size() && !shrunk.empty(); ++i)
      if (on_side[i]) prepared_.on_surface[i] = -std::max(prepared_.on_surface[i], least_on_surface);
    // A call before this one may have shrunk them for another technique: the same division brings them back.
    const Radii sized{radii ? new_radii : cloud_.radii, radii ? shrunk : prepared_.shrunk};
    if (uncertainty)
      cloud_.set_scalar(measure_uncertainty(find_normals ? nearest_normals : cloud_.normals, sized,
                                            keep ? &kept : nullptr));
    if (!shrunk.empty()) prepared_.shrunk = std::move(shrunk);
    if (normals) cloud_.normals = std::move(new_normals);
    if (!prepared_.whole) prepared_.noise = std::max(prepared_.noise, noise);
    if (radii) cloud_.radii = std::move(new_radii);
  }

 private:
  struct NearNormal {
    std::uint32_t point;
    vec3 normal;  ///< 0: the point has one
  };
  struct Radii {
    const std::vector<float>&drawn, &shrunk;  ///< as in PreparedCloud
    float on_surface(std::size_t i) const { return shrunk.empty() ? drawn[i] : drawn[i] / shrunk[i]; }
  };

  /// Where the nearest few lie in a plane and all neighbours do not, at an edge, on an ear thinner than those
  /// reach, the plane of all is none of the surface's: `found` is theirs. `scatter`: of all neighbours.
  static void take_near_normals(const tbb::concurrent_vector<NearNormal>& found,
                                const std::vector<float>& scatter, std::vector<vec3>& normals,
                                std::vector<float>& flatness) {
    for (const NearNormal& near : found) {
      const std::size_t first = near.point / around * around, end = std::min(first + around, scatter.size());
      const auto flat =
          std::count_if(scatter.begin() + std::ptrdiff_t(first), scatter.begin() + std::ptrdiff_t(end),
                        [&](float other) { return is_flat(other) && better * other < scatter[near.point]; });
      if (float(flat) < flat_around * float(end - first)) continue;
      if (!missing(near.normal)) normals[near.point] = near.normal;
      if (!flatness.empty()) flatness[near.point] = std::max(flatness[near.point], flat_nearby);
    }
  }

  /// Where a picture was taken from: it shows one side of all, and steps of its depths are no second one.
  std::optional<vec3> sensor_at_origin() const {
    constexpr std::size_t sample_size = 65'536;
    const PointCloud& all = prepared_.whole ? prepared_.whole->sample : cloud_;
    std::vector<dvec3> sample;
    for (std::size_t i = 0; i < all.size(); i += (all.size() + sample_size - 1) / sample_size)
      sample.push_back(all.world(i));
    if (!are_one_picture(sample, dvec3(0))) return std::nullopt;
    return vec3(-cloud_.origin);
  }

  /// Strips of a survey lie above one another and are no sheets: only normals or scanners tell some in LAS.
  bool may_have_sheets() const { return !cloud_.las || !cloud_.scanners.empty() || has_normals_of_file(); }
  /// Those that a call before this one computed say nothing new.
  bool has_normals_of_file() const {
    return !prepared_.computed.has(Attribute::normal) && !cloud_.normals.empty();
  }

  /// Which side of a sheet a point lies on: that which its normal, of the file, faces, or a scanner saw.
  KnownSide known_sides() const {
    const std::optional<vec3> eye = sensor_at_origin();
    return [this, scanner = cloud_.scalar("scanner"), eye](std::uint32_t i, const vec3& axis) {
      float side = 0;
      if (has_normals_of_file() && !missing(cloud_.normals[i]))
        side = glm::dot(cloud_.normals[i], axis);
      else if (const auto way = way_to_scanner(cloud_, scanner, i))
        side = glm::dot(vec3(*way), axis);
      else if (eye)
        side = glm::dot(*eye - cloud_.positions[i], axis);
      else if (cloud_.las)  // a point that neither tells, seen from above
        side = glm::dot(vec3(up_vector(cloud_.up)), axis);
      return side > 0 ? 1 : side < 0 ? -1 : 0;
    };
  }

  /// `widen_normals` of those that were computed, not from the nearest few, nor of one side of a thin sheet.
  /// `scatter` is lost.
  float widen(const tbb::concurrent_vector<NearNormal>& near_normals,
              const std::vector<std::uint8_t>& on_side, std::vector<float>& scatter,
              const std::vector<float>& thickness2, const Orientation& orientation,
              std::vector<vec3>& normals) {
    for (std::size_t i = 0; i < cloud_.normals.size(); ++i)
      if (!missing(cloud_.normals[i])) scatter[i] = 0;
    for (const NearNormal& near : near_normals)
      if (normals[near.point] == near.normal) scatter[near.point] = 0;
    for (std::size_t i = 0; i < on_side.size(); ++i)
      if (on_side[i]) scatter[i] = 0;
    if (prepared_.whole ? !prepared_.whole->is_rough : !need_widening(scatter)) return 0;
    const float noise = widen_normals(cloud_.positions, int(k_), scatter, thickness2, normals, progress_);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, normals.size(), 65'536), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        if (scatter[i] > 0) normals[i] = orientation.facing(std::uint32_t(i), normals[i]);
    });
    return noise;
  }

  /// Returns by how much: PreparedCloud::shrunk. A disc is as large as its neighbours vouch for, as far as
  /// they lie on a surface, and a dot elsewhere.
  std::vector<float> shrink_to_vouched(const std::vector<float>& flatness,
                                       const std::vector<VoronoiCell>& cells, std::vector<float>& radii) {
    if (!tells_clutter(prepared_.whole ? prepared_.whole->points : radii.size(), k_)) return {};
    const bool is_flat = std::all_of(flatness.begin(), flatness.end(), [](float f) { return f >= 1; });
    const std::vector<float> whole(is_flat ? radii.size() : 0, 1.0f);
    const SurfaceShares shares = is_flat ? SurfaceShares{whole, whole, whole}
                                         : surface_shares(cloud_.positions, flatness, int(k_), progress_);
    const UsualRadii usual(radii);
    // Where there are neighbours at all: at a border in half of the directions, at a corner in a quarter.
    std::vector<float> spacings = radii;
    for (std::size_t i = 0; i < radii.size(); ++i) {
      const float there = 1 - 0.5f * cells[i].widest_angle * std::numbers::inv_pi_v<float>;
      spacings[i] *= std::sqrt(cells[i].evenness * std::max(0.25f, there));
    }
    const std::vector<float> alone = outposts(tree_, spacings, cells, k_, progress_);
    const float medians = prepared_.median_radius;
    std::vector<float> ratio(radii.size(), 1.0f), on_surface = ratio;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, radii.size(), 65'536), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        if (!cells[i].is_measured()) continue;  // the file has its radius, or all neighbours are in one place
        // A disc that is much larger than usual belongs to a point that stands alone. What is usual differs
        // from place to place: where a dense scan meets a sparse one, the sparse one is no heap of strays.
        const float radius = radii[i], small = largest_unless_flat * medians / radius,
                    widest = largest_disc * std::max(medians, usual.near(i)) / radius,
                    dot = std::min(options_.clutter_radius, widest), least = std::min(smallest_dot, dot);
        // What is sparse and hangs above all that surrounds it, as wires above a field, is on no surface.
        // What stands alone before or beside it belongs to none, whatever the region is.
        const float own = shares.own[i] * (small < 1 ? shares.in_layer[i] : 1) * (1 - alone[i]);
        // Inside a surface as by Eq. 20, at its end no farther than its points are surrounded.
        const float end = overlap * vouched_radius(cells[i]) / radius,
                    inside = std::min(surrounded(cells[i]), enclosed(cells[i])),
                    disc = std::lerp(std::min(1.0f, end), 1.0f, inside);
        float most = std::min(1.0f, widest);
        if (flatness[i] < 1 || own < 1) most = std::min(most, small);
        // The few points of branches that a scanner saw between leaves are flat by chance, far apart, and
        // planks when drawn as large as that.
        if (small < 3)
          most = std::min(most, std::lerp(small / 3, 1.0f, glm::smoothstep(crown, grove, shares.around[i])));
        ratio[i] = std::max(least, std::min(most, std::lerp(dot, disc, own)));
        on_surface[i] =
            own * own * two_sided(cells[i]) * glm::smoothstep(discs_touch, discs_close, std::min(most, disc));
        radii[i] *= ratio[i];
      }
    });
    prepared_.radius_limit = std::max(largest_disc * medians, *std::max_element(radii.begin(), radii.end()));
    prepared_.on_surface = std::move(on_surface);
    return ratio;
  }

  ScalarField measure_uncertainty(const std::vector<vec3>& normals, const Radii& radii,
                                  const KeptNeighbors* kept) {
    ScalarField field{"uncertainty", 0, std::vector<float>(cloud_.size()), StoredType::float32};
    auto measure = [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
      field.values[i] = uncertainty_of(normals, radii.on_surface(i), i, ids);
    };
    if (kept)
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cloud_.size(), 65'536), [&](const auto& range) {
        progress_.check();
        for (std::size_t i = range.begin(); i < range.end(); ++i) measure(std::uint32_t(i), kept->of(i));
      });
    else
      for_each_neighborhood(
          tree_, int(k_), [&](std::uint32_t i, auto ids, auto) { measure(i, ids); }, "uncertainty",
          progress_);
    return field;
  }

  PreparedCloud& prepared_;
  PointCloud& cloud_;
  Progress& progress_;
  const NeighborTree& tree_;
  const PrepareOptions& options_;
  std::size_t k_;
};

}  // namespace

const ScalarField* whole_stored_uncertainty(const PointCloud& cloud) {
  const ScalarField* stored = cloud.scalar(stored_uncertainty);
  const auto lacks = [](float value) { return std::isnan(value); };
  return stored && std::none_of(stored->values.begin(), stored->values.end(), lacks) ? stored : nullptr;
}

Attributes attributes_of(const PointCloud& cloud) {
  Attributes found;
  if (complete_for_all(cloud.normals)) found = found | Attribute::normal;
  if (complete_for_all(cloud.radii)) found = found | Attribute::radius;
  if (whole_stored_uncertainty(cloud) || cloud.scalar("uncertainty")) found = found | Attribute::uncertainty;
  if (cloud.scalar("cluster") && cloud.scalar("stroke_size") && cloud.scalar("stroke_room") &&
      cloud.scalar("stroke_detail") && cloud.scalar("stroke_axis"))
    found = found | Attribute::cluster;
  return found;
}

float radius_of(float farthest, std::size_t neighbors) {
  return 2 * farthest / std::sqrt(float(neighbors));  // (Seemann 2018, Eq. 20)
}

float uncertainty_of(const std::vector<vec3>& normals, float radius, std::uint32_t point,
                     std::span<const std::uint32_t> neighbors) {
  if (neighbors.empty()) return radius;
  float sum = 0;
  for (std::uint32_t j : neighbors) {
    const float bend = 2 - std::min(1.0f, std::abs(glm::dot(normals[point], normals[j])));
    sum += bend * bend;
  }
  return radius * sum / float(neighbors.size());  // (Seemann 2018, Eq. 21)
}

void complete(PreparedCloud& prepared, Attributes needs, const PrepareOptions& options, Progress& progress) {
  complete(prepared, needs, options, nullptr, progress);
}

void complete(PreparedCloud& prepared, Attributes needs, const PrepareOptions& options,
              const NeighborTree* tree, Progress& progress) {
  PointCloud& cloud = prepared.cloud;
  prepared.neighbors = options.neighbors;
  if (cloud.empty()) {
    prepared.available = prepared.available | needs;
    if (prepared.whole && needs.has(Attribute::radius))
      prepared.median_radius = prepared.whole->median_radius;
    return;
  }
  const Attributes found = attributes_of(cloud);
  // Discs reach beyond the edges of faces: those of the far side of a solid would rim it.
  if (cloud.of_faces && found.has(Attribute::normal) && !prepared.computed.has(Attribute::normal) &&
      prepared.on_surface.empty())
    prepared.on_surface.assign(cloud.size(), -1.0f);
  const bool views = !prepared.views.grids.empty();
  if (views) {
    complete_from_views(cloud, prepared.views, needs, progress);
    if (!cloud.normals.empty() && !cloud.radii.empty()) prepared.views = {};
  }
  // First, because the normals of points without one come from their clusters.
  const bool clusters = needs.has(Attribute::cluster) && !found.has(Attribute::cluster);
  if (clusters) add_clusters(prepared, options.strokes, progress);
  const Attributes had = clusters || views ? attributes_of(cloud) : found;
  const bool uncertainty = needs.has(Attribute::uncertainty) && !had.has(Attribute::uncertainty);
  const bool normals = (uncertainty || needs.has(Attribute::normal)) && !had.has(Attribute::normal);
  const bool radii = (uncertainty || needs.has(Attribute::radius)) && !had.has(Attribute::radius);
  const bool support = needs.has(Attribute::support) && prepared.support.empty();
  std::optional<NeighborTree> own;
  if (!tree && (normals || radii || uncertainty || support)) tree = &own.emplace(cloud.positions);
  // First what may be cancelled and then leaves nothing behind.
  std::vector<float> new_support;
  if (support) new_support = support_of(prepared, *tree, progress);
  if (normals || radii || uncertainty)
    Completion(prepared, options, *tree, progress).run(normals, radii, uncertainty);
  if (support) prepared.support = std::move(new_support);
  const bool knows_surroundings = prepared.available.has(Attribute::surroundings);
  prepared.available = attributes_of(cloud);
  if (!prepared.support.empty()) prepared.available = prepared.available | Attribute::support;
  prepared.computed = prepared.computed | prepared.available.without(found);
  if (knows_surroundings) prepared.available = prepared.available | Attribute::surroundings;
  if (prepared.available.has(Attribute::radius) && !(prepared.median_radius > 0))
    prepared.median_radius = median_radius(prepared, cloud.radii);
  if (const ScalarField* values = cloud.scalar("uncertainty"))
    prepared.uncertainty_range = quantiles(values->values);
}

}  // namespace sfumato::analysis
