#include "copc/select.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <unordered_map>

namespace sfumato::copc {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::uint64_t all_points = ~std::uint64_t{0};

/// How wide lengths in a box are on the screen.
class Projector {
 public:
  Projector(const View& view, const SelectOptions& options)
      : view_(view),
        to_eye_(view.camera.view()),
        lens_(view.camera.intrinsics()),
        margin_(options.margin_px),
        outside_(options.outside) {}

  /// Pixels per scene unit at the nearest place of the box; 0 when it is out of view and that does not count.
  double scale(const Bounds& box) const {
    const Camera& camera = view_.camera;
    if (view_.panorama)  // a full turn of the widest row
      return camera.width / (2 * M_PI) / std::max(distance(box), std::numeric_limits<double>::min());
    const double weight = is_in_view(box) ? 1 : outside_;
    if (weight == 0) return 0;
    if (camera.orthographic()) return weight * lens_.fy;
    return weight * lens_.fy / std::max(distance(box), std::numeric_limits<double>::min());
  }

 private:
  double distance(const Bounds& box) const {
    const dvec3 nearest = glm::clamp(view_.camera.position, box.min, box.max);
    return glm::length(nearest - view_.camera.position);
  }

  /// Whether the box reaches into the picture and its margin: exact for boxes in front of the camera, for the
  /// others false only when all of the box lies beyond one side.
  bool is_in_view(const Bounds& box) const {
    const Camera& camera = view_.camera;
    const double margin = margin_ * camera.whole_height() / SelectOptions::height_of_margin;
    const glm::dvec2 low(-margin), high(camera.width + margin, camera.height + margin);
    // Projected below: pixel coordinates times depth, so that places behind need no care.
    std::array<dvec3, 8> corners = box.corners();
    std::array<int, 5> beyond{};
    bool is_all_in_front = true;
    for (dvec3& at : corners) {
      const dvec3 eye(to_eye_ * glm::dvec4(at, 1));
      const double w = camera.orthographic() ? 1 : -eye.z;
      at = dvec3(lens_.fx * eye.x + lens_.cx * w, -lens_.fy * eye.y + lens_.cy * w, w);
      beyond[0] += at.x < low.x * w;
      beyond[1] += at.x > high.x * w;
      beyond[2] += at.y < low.y * w;
      beyond[3] += at.y > high.y * w;
      beyond[4] += eye.z > 0;
      is_all_in_front = is_all_in_front && w > 0;
    }
    if (std::any_of(beyond.begin(), beyond.end(), [](int count) { return count == 8; })) return false;
    if (!is_all_in_front) return true;
    // What is left are outlines that pass a corner of the picture: one of their edges lies between.
    std::array<glm::dvec2, 8> seen;
    for (unsigned i = 0; i < 8; ++i) seen[i] = glm::dvec2(corners[i]) / corners[i].z;
    const std::array<glm::dvec2, 4> picture{low, glm::dvec2(high.x, low.y), high, glm::dvec2(low.x, high.y)};
    for (unsigned i = 0; i < 8; ++i)
      for (const unsigned axis : {1u, 2u, 4u})
        if (!(i & axis) && is_between(seen[i], seen[i | axis], seen, picture)) return false;
    return true;
  }

  /// Whether the line from a to b has all of `outline` on one side, and all of `picture` on the other.
  static bool is_between(const glm::dvec2& a, const glm::dvec2& b, std::span<const glm::dvec2> outline,
                         std::span<const glm::dvec2> picture) {
    const glm::dvec2 along = b - a;
    // Corners of the outline on the line count as on its side: a thousandth of a pixel of rounding.
    const double slack = 1e-3 * glm::length(along);
    const auto all = [&](std::span<const glm::dvec2> points, double sign, double least) {
      return std::all_of(points.begin(), points.end(), [&](const glm::dvec2& p) {
        return sign * (along.x * (p.y - a.y) - along.y * (p.x - a.x)) > least;
      });
    };
    return (all(outline, 1, -slack) && all(picture, -1, slack)) ||
           (all(outline, -1, -slack) && all(picture, 1, slack));
  }

  const View& view_;
  dmat4 to_eye_;
  Intrinsics lens_;
  double margin_, outside_;
};

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.min[axis] > b.max[axis] || a.max[axis] < b.min[axis]) return false;
  return true;
}

/// Nodes by their keys, with those on the way to them that hold no point.
class Places {
 public:
  explicit Places(const Tree& tree) {
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
      Key key = tree.nodes[i].key;
      numbers_[key] = i;
      while (key.level > 0) {
        key = key.parent();
        if (!numbers_.try_emplace(key, none).second) break;
      }
    }
  }
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  bool contains(const Key& key) const { return numbers_.contains(key); }
  /// `none` for a node without points.
  std::size_t operator[](const Key& key) const { return numbers_.at(key); }

 private:
  std::unordered_map<Key, std::size_t, KeyHash> numbers_;
};

struct Candidate {
  double px;  ///< of the spacing of the node's parent
  std::size_t tree;
  Key key;
  /// The widest first; the order of the files and of the octree settles the rest.
  bool operator<(const Candidate& other) const {
    if (px != other.px) return px < other.px;
    if (tree != other.tree) return tree > other.tree;
    return key > other.key;
  }
};

NodeSelection empty_selection(std::span<const Tree> trees) {
  NodeSelection selection;
  selection.nodes.resize(trees.size());
  selection.wanted.assign(trees.size(), all_points);
  for (const Tree& tree : trees) {
    selection.points_in_files += tree.points;
    selection.nodes_in_files += tree.nodes.size();
  }
  return selection;
}

}  // namespace

std::vector<View> views_of(std::span<const Camera> cameras, bool panorama) {
  std::vector<View> views;
  for (const Camera& camera : cameras) views.push_back({camera, panorama});
  return views;
}

NodeSelection select_nodes(std::span<const Tree> trees, std::span<const View> views,
                           const SelectOptions& options) {
  std::vector<Projector> projectors;
  for (const View& view : views) projectors.emplace_back(view, options);
  std::vector<Places> places;
  for (const Tree& tree : trees) places.emplace_back(tree);
  NodeSelection selection = empty_selection(trees);
  std::vector<double> share(trees.size(), 1);
  std::priority_queue<Candidate> queue;
  const auto consider = [&](std::size_t t, const Key& key) {
    const Bounds box = trees[t].box(key);
    if (options.box && !overlap(box, *options.box)) return;
    double scale = 0;
    for (const Projector& projector : projectors) scale = std::max(scale, projector.scale(box));
    const double px = scale * trees[t].spacing_of(key.level - 1);
    if (key.level > 0) {
      if (px >= options.least_px) queue.push({px, t, key});
      return;
    }
    // The root is read in any case: it tells where everything is, and costs little. Of many trees it does so
    // where it is in view, and of one that is a spot on the screen some points do.
    if (trees.size() > 1 && scale == 0) return;
    if (trees.size() > 1 && px < options.least_px)
      share[t] = (px / options.least_px) * (px / options.least_px);
    queue.push({infinite, t, key});
  };
  for (std::size_t t = 0; t < trees.size(); ++t)
    if (!trees[t].nodes.empty()) consider(t, Key{});
  bool is_full = false;
  while (!queue.empty()) {
    const Candidate next = queue.top();
    queue.pop();
    if (const std::size_t i = places[next.tree][next.key]; i != Places::none) {
      std::uint64_t count = trees[next.tree].nodes[i].points;
      if (share[next.tree] < 1) {
        count = std::max<std::uint64_t>(1, std::uint64_t(share[next.tree] * double(count)));
        selection.wanted[next.tree] = count;
      }
      selection.points_needed += count;
      ++selection.nodes_needed;
      // The first node is read whatever the budget. The first that does not fit ends the reading: what
      // follows would be finer detail of other places.
      if (!is_full && selection.points > 0 && selection.points + count > options.budget) {
        is_full = true;
        selection.widest_px = next.px;
      }
      if (!is_full) {
        selection.nodes[next.tree].push_back(i);
        selection.points += count;
        ++selection.nodes_read;
      }
    }
    for (unsigned octant = 0; octant < 8; ++octant)
      if (const Key child = next.key.child(octant); places[next.tree].contains(child))
        consider(next.tree, child);
  }
  for (auto& nodes : selection.nodes) std::sort(nodes.begin(), nodes.end());
  return selection;
}

NodeSelection select_overview(std::span<const Tree> trees, std::uint64_t budget,
                              const std::optional<Bounds>& box) {
  struct Level {
    double spacing;
    std::size_t tree, node;
  };
  std::vector<Level> all;
  for (std::size_t t = 0; t < trees.size(); ++t)
    for (std::size_t i = 0; i < trees[t].nodes.size(); ++i)
      if (!box || overlap(trees[t].box(trees[t].nodes[i].key), *box))
        all.push_back({trees[t].spacing_of(trees[t].nodes[i].key.level), t, i});
  std::stable_sort(all.begin(), all.end(),
                   [](const Level& a, const Level& b) { return a.spacing > b.spacing; });
  NodeSelection selection = empty_selection(trees);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    std::uint64_t points = 0;
    for (; end < all.size() && all[end].spacing == all[begin].spacing; ++end)
      points += trees[all[end].tree].nodes[all[end].node].points;
    if (selection.points > 0 && selection.points + points > budget) break;
    for (std::size_t i = begin; i < end; ++i) selection.nodes[all[i].tree].push_back(all[i].node);
    selection.points += points;
    selection.nodes_read += end - begin;
  }
  if (selection.points > budget && trees.size() > 1) {
    const double share = double(budget) / double(selection.points);
    selection.points = 0;
    for (std::size_t t = 0; t < trees.size(); ++t) {
      std::uint64_t points = 0;
      for (std::size_t i : selection.nodes[t]) points += trees[t].nodes[i].points;
      if (points == 0) continue;
      selection.wanted[t] = std::max<std::uint64_t>(1, std::uint64_t(share * double(points)));
      selection.points += selection.wanted[t];
    }
  }
  selection.points_needed = selection.points;
  selection.nodes_needed = selection.nodes_read;
  return selection;
}

}  // namespace sfumato::copc
