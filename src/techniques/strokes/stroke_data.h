// What strokes know about each point beyond the shared attributes: the tangent frame, a seed that stays with
// the place, and the cluster's colour, extent and elongation. Computed once a cloud on the CPU.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/progress.h"
#include "passes/gpu_cloud.h"
#include "techniques/strokes/tangent.h"

namespace sfumato::strokes {

/// Hash of a world position rounded to multiples of `quantum`: a point that did not move keeps its seed,
/// whatever else the file of the next frame holds.
std::uint32_t seed_of(const dvec3& world, double quantum);
/// A power of two near a sixteenth of the spacing, so that clouds of much the same spacing mostly have one.
double seed_quantum(double median_spacing);

/// Modifiers of a cluster (dos Anjos 2017, Sec. 3.1), in coarse steps, so that a little noise does not change
/// them.
struct ClusterShape {
  float extent = 0;    ///< scene units: side of a square of the cluster's area
  int elongation = 0;  ///< 0, 1, 2: strokes are 1, 1.25 or 1.6 times as long
  Rgba8 mean;          ///< mean colour
};
std::vector<ClusterShape> cluster_shapes(const PointCloud& cloud, const std::vector<Rgba8>& colors,
                                         const std::vector<std::uint32_t>& labels,
                                         const std::vector<float>& sizes);
/// Labels of any values, as a file brings them, numbered 0, 1, 2 ... as they appear.
std::vector<std::uint32_t> dense_labels(const std::vector<float>& labels);

class StrokeData {
 public:
  /// Computes and uploads unless that was done for this cloud, tangent and quantum of seeds. Needs
  /// Attribute::normal and cluster.
  void update(GpuCloud& cloud, Tangent tangent, double quantum, Progress& progress);
  /// Binds tangents and traits of a chunk to units `input` and `input` + 1.
  void bind(std::size_t chunk) const;

 private:
  struct Chunk {
    gl::TextureBuffer tangents;  // RGBA32F: t in the cloud's space, s
    gl::TextureBuffer
        traits;  // RGBA32UI: seed, mean colour and elongation, extent, halves of room / s and detail / s
  };
  std::vector<Chunk> chunks_;
  struct Key {
    std::uint64_t serial, look_serial;
    Tangent tangent;
    double quantum;
    bool operator==(const Key&) const = default;
  };
  std::optional<Key> key_;
};

}  // namespace sfumato::strokes
