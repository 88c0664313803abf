#include "techniques/strokes/stroke_data.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "analysis/neighbors.h"
#include "analysis/normals.h"
#include "analysis/stroke_attributes.h"
#include "core/order.h"
#include "core/symmetric3.h"
#include "passes/bindings.h"

namespace sfumato::strokes {
namespace {

constexpr float largest_half = 65504;

std::uint64_t mix(std::uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

std::vector<vec3> widest_directions(const std::vector<vec3>& positions, Progress& progress) {
  std::vector<vec3> directions(positions.size(), vec3(0));
  const analysis::NeighborTree tree(positions);
  analysis::for_each_neighborhood(
      tree, 24,
      [&](std::uint32_t i, auto ids, auto) {
        directions[i] = analysis::widest_direction(positions, i, ids).value_or(vec3(0));
      },
      "directions of strokes", progress);
  return directions;
}

}  // namespace

std::uint32_t seed_of(const dvec3& world, double quantum) {
  std::uint64_t h = 0;
  for (int k = 0; k < 3; ++k) h = mix(h ^ std::uint64_t(std::llround(world[k] / quantum)));
  return std::uint32_t(h >> 32);
}

double seed_quantum(double median_spacing) { return std::exp2(std::round(std::log2(median_spacing / 16))); }

std::vector<std::uint32_t> dense_labels(const std::vector<float>& labels) {
  // By bits, so that a NaN is a label like another. Few are unlike the one before.
  std::vector<std::uint32_t> out(labels.size());
  std::unordered_map<std::uint32_t, std::uint32_t> names;
  std::uint32_t before = 0, name = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(labels[i]);
    if (i == 0 || bits != before) name = names.try_emplace(bits, std::uint32_t(names.size())).first->second;
    before = bits;
    out[i] = name;
  }
  return out;
}

std::vector<ClusterShape> cluster_shapes(const PointCloud& cloud, const std::vector<Rgba8>& colors,
                                         const std::vector<std::uint32_t>& labels,
                                         const std::vector<float>& sizes) {
  struct Sum {
    std::uint64_t points = 0, r = 0, g = 0, b = 0;  // whole numbers: the order of the points does not matter
    double area = 0;
    dvec3 p{0};
    glm::dmat3 pp{0};
  };
  std::vector<Sum> sums(labels.empty() ? 0
                                       : *std::max_element(labels.begin(), labels.end()) + std::size_t(1));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    Sum& sum = sums[labels[i]];
    const dvec3 p(cloud.positions[i]);
    ++sum.points;
    sum.r += colors[i].r, sum.g += colors[i].g, sum.b += colors[i].b;
    sum.area += 0.5 * double(sizes[i]) * sizes[i];  // a square grid of spacing h has s = sqrt(2) h
    sum.p += p;
    sum.pp += glm::outerProduct(p, p);
  }
  std::vector<ClusterShape> shapes(sums.size());
  for (std::size_t c = 0; c < sums.size(); ++c) {
    const Sum& sum = sums[c];
    if (sum.points == 0) continue;
    const double n = double(sum.points);
    shapes[c].mean = {std::uint8_t(sum.r / sum.points), std::uint8_t(sum.g / sum.points),
                      std::uint8_t(sum.b / sum.points), 255};
    shapes[c].extent =
        float(std::exp2(0.5 * std::round(2 * std::log2(std::max(std::sqrt(sum.area), 1e-30)))));
    const glm::dmat3 spread = sum.pp / n - glm::outerProduct(sum.p / n, sum.p / n);
    const dvec3 l =
        eigenvalues({spread[0][0], spread[0][1], spread[0][2], spread[1][1], spread[1][2], spread[2][2]});
    const double elongation = l.y > 0 ? std::sqrt(l.x / l.y) : 1;
    shapes[c].elongation = elongation > 5 ? 2 : elongation > 2.5 ? 1 : 0;
    shapes[c].mean.a = std::uint8_t(shapes[c].elongation);  // travels with the colour
  }
  return shapes;
}

void StrokeData::update(GpuCloud& cloud, Tangent tangent, double quantum, Progress& progress) {
  const Key key{cloud.serial(), cloud.look_serial(), tangent, quantum};
  if (key_ == key) return;
  const PointCloud& points = cloud.prepared().cloud;
  chunks_.clear();
  key_.reset();
  if (!points.empty()) {
    const std::vector<std::uint32_t> labels = dense_labels(points.scalar("cluster")->values);
    const std::vector<float>& sizes = points.scalar("stroke_size")->values;
    const std::vector<float>& rooms = points.scalar("stroke_room")->values;
    const std::vector<float>& axes = points.scalar("stroke_axis")->values;
    const std::vector<float>& details = points.scalar("stroke_detail")->values;
    const std::vector<ClusterShape> shapes = cluster_shapes(points, cloud.colors(), labels, sizes);
    const std::vector<vec3> wide =
        tangent == Tangent::covariance ? widest_directions(points.positions, progress) : std::vector<vec3>();
    // What has no support was capped (analysis/stroke_attributes.h). Sparse ends of a scan: eight times the
    // median still closes what is 64 times as sparse.
    const float most = 8 * median(std::vector<float>(sizes));
    std::vector<vec4> tangents;
    std::vector<glm::uvec4> traits;
    for (const GpuCloud::Chunk& chunk : cloud.chunks()) {
      progress.check();
      tangents.resize(chunk.count);
      traits.resize(chunk.count);
      for (std::uint32_t k = 0; k < chunk.count; ++k) {
        const std::size_t i = chunk.first + k;
        const vec3 n = points.normals[i];
        const auto axis = tangent == Tangent::automatic ? analysis::unpack_axis(axes[i]) : std::nullopt;
        const TangentFrame frame = axis ? frame_along(n, *axis)
                                   : tangent == Tangent::automatic || tangent == Tangent::householder
                                       ? householder_frame(n)
                                   : tangent == Tangent::eberly ? eberly_frame(n)
                                                                : frame_along(n, wide[i]);
        tangents[k] = vec4(frame.along, std::min(sizes[i], most));
        const ClusterShape& shape = shapes[labels[i]];
        traits[k] = {seed_of(points.world(i), quantum), std::bit_cast<std::uint32_t>(shape.mean),
                     std::bit_cast<std::uint32_t>(shape.extent),
                     glm::packHalf2x16(glm::min(vec2(rooms[i], details[i]) / tangents[k].w, largest_half))};
      }
      chunks_.push_back(
          {gl::TextureBuffer("stroke tangents", GL_RGBA32F, std::span<const vec4>(tangents)),
           gl::TextureBuffer("stroke traits", GL_RGBA32UI, std::span<const glm::uvec4>(traits))});
    }
  }
  key_ = key;
}

void StrokeData::bind(std::size_t chunk) const {
  chunks_[chunk].tangents.bind(binding::input);
  chunks_[chunk].traits.bind(binding::input + 1);
}

}  // namespace sfumato::strokes
