// The bins of every pixel: a table of weights along the ray, the choice of a bin, and the average of what is
// in it.
//
//   weights     every hit adds its weight to the bin of its distance; the nearest bin above the threshold is
//   tracked choose      the bin of every pixel, or none attributes  every hit inside the chosen bin adds
//   colour, normal and distance resolve     sums to albedo, depth and normal
//
// The paper keeps attributes in the table too; a second visit of the chosen bin reads them for few hits only,
// and the table shrinks to two words a slot.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "gl/program.h"
#include "gl/texture.h"
#include "gl/timer.h"
#include "passes/screen_pass.h"
#include "passes/splat_surface.h"
#include "passes/splat_visit.h"
#include "passes/visible_points.h"

namespace sfumato::denoise {

enum class Layout { hashed, dense };
enum class Anchor { nearest, grid };
enum class Miss { background, last_bin };

constexpr int sums_of_pixel = 9;  ///< words of colour, normal, distance, weight and, the last, shadow

struct BinOptions {
  Layout layout = Layout::hashed;
  int hash_bits = 4;         ///< hashed: 2^hash_bits slots a pixel to begin with
  int dense_bins = 64;       ///< dense: bins a pixel; what lies beyond goes to the last one
  bool overlapping = false;  ///< windows at half steps
  Anchor anchor = Anchor::nearest;
  Miss miss = Miss::background;
  bool fast = false;           ///< float atomics (needs limits().float_atomics): last bits vary
  float bin_size = 1;          ///< scene units along the ray
  float weight_threshold = 0;  ///< a bin counts when its weight is larger
  // Automatic threshold (denoise.cpp says why): weights are scaled by how well the splat is supported, and
  // bins shortly behind the first one may raise the threshold.
  float covers = 0;         ///< splats over every place of a surface (evidence.glsl); 0: weights as they are
  float surface_share = 1;  ///< of what those weigh, a weight of 1 in the table
  float peak_share = 0;     ///< a bin counts when it has this share of the largest weight within `peak_bins`
  int peak_bins = 0;
  bool heaviest_bin = false;  ///< where no bin counts the heaviest one does
  int agree_rounds = 0;       ///< weak bins count where the pixels around agree on them (agree.glsl)
  float splat_reach = 0;      ///< usual radius of a splat, scene units
  float wide_reach = 0;       ///< of a last round, scene units; 0: none
};

/// (Fibonacci hashing, Knuth): the first slot of bin `b` in a table of 2^bits, bits >= 1; as in bins.glsl.
constexpr std::uint32_t fibonacci_slot(std::uint32_t b, int bits) { return (b * 2654435769u) >> (32 - bits); }

struct BinCounts {
  std::uint32_t overflow = 0;   ///< hits that found no slot: 0 once the table has grown
  std::uint32_t saturated = 0;  ///< hits beyond the largest sum of a bin
};

class BinTable {
 public:
  /// What is sorted into bins. `nearest_t` must hold the nearest distances of the same view and shape.
  struct Hits {
    GpuCloud& cloud;
    const View& view;
    const SplatShape& shape;
    const SplatBatches& batches;
    const gl::Texture& nearest_t;
    const BinOptions& options;
    gl::Timers& timers;
  };
  /// Fills the targets. A hash table that is full grows, and what does not fit the memory becomes dense bins:
  /// the picture never depends on the order of the points.
  void draw(const Hits& hits, bool show_weight, const SplatSurfaceTargets& targets);
  /// Its three steps, for splats that lie in parts, whose `nearest_t` is that of all parts: the bins of
  /// these, the sums of what is in the bins that those of all parts choose, and the targets from the sums of
  /// all. Not fast, and without shadows.
  std::vector<VisiblePoints::Bin> bins_of(const Hits& hits);
  Image<VisiblePoints::BinSums> sums_of(const Hits& hits, const VisiblePoints& of_all);
  void show(const Hits& hits, const VisiblePoints& of_all, bool show_weight,
            const SplatSurfaceTargets& targets);

  /// Of the last draw; waits for it.
  BinCounts counts() const;
  /// Bytes of the table and of the sums.
  std::size_t bytes() const;
  /// Of the last draw, RGBA32F: chosen bin or -1, its weight in the table, threshold in force, ray
  /// distance where the bin ends or -1.
  const gl::Texture& choice() const { return choice_; }
  /// Of the last draw: `slots()` weights a pixel (2^-16, or float bits when fast), and keys (bin + 1, 0 =
  /// empty).
  const gl::TextureBuffer& weights() const { return weights_; }
  const gl::TextureBuffer& keys() const { return keys_; }
  int slots() const { return slots_; }

 private:
  void allocate(const View& view, const BinOptions& options, bool shadow);
  void set_uniforms(gl::Program& program, const BinOptions& options, const View& view) const;
  /// A table in which all that `add` adds found room: as large as its options say.
  BinOptions fill(const Hits& hits, bool shadow, const std::function<void(const BinOptions&)>& add);
  /// Fills it with the bins of all parts and chooses among them, but for those that were the last.
  BinOptions choose_of(const Hits& hits, const VisiblePoints& of_all);
  bool grow(BinOptions& options, const View& view);
  // With the options of the table.
  void add_weights(const Hits& hits, const BinOptions& options);
  void choose(const Hits& hits, const BinOptions& options);
  void agree(const Hits& hits, const BinOptions& options, float reach);
  void add_attributes(const Hits& hits, const BinOptions& options);
  void resolve(const Hits& hits, const BinOptions& options, bool show_weight,
               const SplatSurfaceTargets& targets);
  gl::Defines defines(const BinOptions& options) const;
  gl::Program& small_program(std::map<int, gl::Program>& programs, int key, const char* file,
                             gl::Defines list, const SplatShape& shape) const;

  int slots_ = 0, stride_ = 0;
  int asked_bits_ = 0, grown_bits_ = 0;  ///< of the hash table, what was asked for and what frames needed
  bool fast_ = false;
  std::uint64_t chosen_ = 0;  ///< VisiblePoints::bins_serial
  BinOptions chosen_options_;
  gl::TextureBuffer weights_, keys_, counters_, sums_;
  gl::Texture first_bin_, choice_, agreed_, sink_, farthest_end_;
  SplatRaster weight_raster_[8], attribute_raster_[16];
  std::map<int, gl::Program> weight_small_, attribute_small_;
  ScreenPass choose_[8], agree_[8], farthest_, resolve_[16];
};

}  // namespace sfumato::denoise
