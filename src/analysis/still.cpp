#include "analysis/still.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>

#include "analysis/morton.h"
#include "analysis/neighbors.h"

namespace sfumato::analysis {
namespace {

constexpr std::uint32_t no_place = std::numeric_limits<std::uint32_t>::max();

struct Pair {
  float distance2;
  std::uint32_t now, before;
  auto operator<=>(const Pair&) const = default;
};

/// Of each place the place before that it stands still at, or `no_place`: of all pairs nearer than half the
/// spacing around the place before, the nearest first.
std::vector<std::uint32_t> matches(const std::vector<vec3>& now, const NeighborTree& before,
                                   Progress& progress) {
  tbb::enumerable_thread_specific<std::vector<Pair>> found;
  constexpr std::size_t portion = 1 << 20;
  for (std::size_t first = 0; first < now.size(); first += portion) {
    progress.check();
    progress.update(double(first) / double(now.size()), "points that stand still");
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, std::min(now.size(), first + portion), 1024),
                      [&](const auto& range) {
                        std::vector<Pair>& mine = found.local();
                        KNearest few(4), eight(8);
                        for (std::size_t i = range.begin(); i != range.end(); ++i) {
                          few.start(no_place);
                          before.search(now[i], few);
                          for (const std::uint64_t key : few.heap()) {
                            const std::uint32_t j = id_of(key);
                            eight.start(j);
                            before.search(before.positions()[j], eight);
                            // The spacing is R_8 sqrt(pi / 8) (analysis/spacing.h).
                            const float r8_2 = eight.heap().empty() ? 0 : distance2_of(eight.heap().front());
                            if (distance2_of(key) <= 0.25f * 0.3927f * r8_2)
                              mine.push_back({distance2_of(key), std::uint32_t(i), j});
                          }
                        }
                      });
  }
  std::vector<Pair> pairs;
  for (const std::vector<Pair>& some : found) pairs.insert(pairs.end(), some.begin(), some.end());
  tbb::parallel_sort(pairs.begin(), pairs.end());
  std::vector<std::uint32_t> held(now.size(), no_place);
  std::vector<bool> taken(before.positions().size());
  for (const Pair& pair : pairs)
    if (held[pair.now] == no_place && !taken[pair.before])
      held[pair.now] = pair.before, taken[pair.before] = true;
  return held;
}

bool alike(const Rgba8& a, const Rgba8& b, float step) {
  const vec3 apart(float(a.r) - float(b.r), float(a.g) - float(b.g), float(a.b) - float(b.b));
  return glm::dot(apart, apart) < step * step;
}

}  // namespace

void StillPoints::hold(PointCloud& cloud, float color_step, Progress& progress) {
  constexpr float crease = 0.866f;  // 30 degrees, as in stroke_attributes.h
  const std::vector<std::uint32_t> order = morton_order(cloud, progress);
  if (!before_.empty() && !cloud.empty()) {
    std::vector<vec3> now(cloud.size());
    for (std::size_t i = 0; i < now.size(); ++i) now[i] = vec3(cloud.world(order[i]) - before_.origin);
    const std::vector<std::uint32_t> held = matches(now, NeighborTree(before_.positions), progress);
    if (std::any_of(held.begin(), held.end(), [](std::uint32_t j) { return j != no_place; })) {
      cloud.origin = before_.origin;  // so that places are the same in every bit
      for (std::size_t i = 0; i < now.size(); ++i) {
        const std::uint32_t at = order[i], j = held[i];
        cloud.positions[at] = j == no_place ? now[i] : before_.positions[j];
        if (j == no_place) continue;
        if (!cloud.colors.empty() && !before_.colors.empty() &&
            alike(cloud.colors[at], before_.colors[j], color_step))
          cloud.colors[at] = before_.colors[j];
        if (!cloud.normals.empty() && !before_.normals.empty() &&
            glm::dot(cloud.normals[at], before_.normals[j]) > crease)
          cloud.normals[at] = before_.normals[j];
      }
    }
  }
  before_ = PointCloud();
  before_.origin = cloud.origin;
  for (const std::uint32_t i : order) before_.positions.push_back(cloud.positions[i]);
  if (!cloud.colors.empty())
    for (const std::uint32_t i : order) before_.colors.push_back(cloud.colors[i]);
  if (!cloud.normals.empty())
    for (const std::uint32_t i : order) before_.normals.push_back(cloud.normals[i]);
}

}  // namespace sfumato::analysis
