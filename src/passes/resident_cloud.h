// A cloud on the GPU as all that look at it share it, on one context or on several that share their objects:
// chunks of buffers within the driver's limits, each holding many batches. Nothing that is in it changes,
// attributes may be added (ADR 203), uploaded on first use; what a view adds (colours, shadows, what is cut
// away) stands in its GpuCloud.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "core/made_once.h"
#include "core/prepared_cloud.h"
#include "gl/buffer.h"
#include "gl/commands.h"

namespace sfumato {

class ResidentCloud {
 public:
  struct Range {
    std::uint32_t first = 0, count = 0;  ///< points [first, first + count) of the prepared cloud
    std::uint32_t first_batch = 0, batch_count = 0;
  };
  struct Chunk : Range {
    gl::TextureBuffer positions, source_index;
  };
  /// A value for each point, of each chunk.
  using Values = std::vector<gl::TextureBuffer>;
  /// Place in the prepared cloud of the source indices from `first` on.
  struct Places {
    std::uint32_t first = 0, count = 0;
    gl::TextureBuffer values;
  };
  /// Normals and radii, uploaded; no normals: those of the cloud.
  struct Shapes {
    Values normals, radii;
    std::vector<float> largest_radii;  ///< of each batch, scene units
  };
  /// sRGB, one per point of the prepared cloud; uploaded on first use.
  class Colors {
   public:
    explicit Colors(std::vector<Rgba8> values) : values_(std::move(values)) {}
    const std::vector<Rgba8>& values() const { return values_; }
    const Values& buffers(const ResidentCloud& of) const;

   private:
    const std::vector<Rgba8> values_;
    mutable std::mutex mutex_;
    mutable Values buffers_;
  };

  /// `max_chunk_points` is for tests; 0 means the driver's limit.
  explicit ResidentCloud(std::shared_ptr<const PreparedCloud> prepared, std::uint32_t max_chunk_points = 0);
  /// The same points with more attributes: what was uploaded of their places is shared.
  ResidentCloud(std::shared_ptr<const PreparedCloud> completed, const ResidentCloud& of);

  const PreparedCloud& prepared() const { return *prepared_; }
  std::size_t size() const { return prepared_->cloud.size(); }
  /// Another number for every cloud and each set of its attributes, never 0: what techniques derive from the
  /// points is kept under it (core/derived.h).
  std::uint64_t serial() const { return serial_; }
  const Bounds& bounds() const { return geometry_->bounds; }  ///< world
  const std::vector<Chunk>& chunks() const { return geometry_->chunks; }
  /// Largest radius of each batch, scene units; measured on first use.
  const std::vector<float>& largest_radii() const;
  /// Normals, or buffers of "none" when the cloud has none.
  const Values& normals() const;
  const Values& radii() const;
  /// Of every source index, in parts of at most as many as a chunk may hold; shared by all chunks.
  const std::vector<Places>& places() const;

  /// One float per point, uploaded under that name.
  std::shared_ptr<const Values> make_values(const std::string& name, std::span<const float> values) const;
  /// Two, as halves.
  std::shared_ptr<const Values> make_values(const std::string& name, std::span<const vec2> values) const;
  /// `surface`: as PreparedCloud::on_surface.
  std::shared_ptr<const Shapes> make_shapes(std::span<const vec3> normals, std::span<const float> radii,
                                            std::span<const float> surface) const;
  /// Sizes of dots, which follow from places alone (analysis/dots.h): `make` gives the values, once for all
  /// views.
  template <class Make>
  std::shared_ptr<const Values> dots(const Make& make) const {
    return geometry_->dots.get([&] {
      auto values = make_values("dots", std::span<const vec2>(make()));
      gl::finish();  // for other contexts
      return values;
    });
  }

  /// For what changes with a view as well: the next number.
  static std::uint64_t next_serial();

 private:
  struct Geometry {
    Bounds bounds;
    std::vector<Chunk> chunks;
    std::uint32_t max_chunk_points = 0;
    std::mutex mutex;
    std::vector<Places> places;
    MadeOnce<std::shared_ptr<const Values>> dots;
  };
  Values upload_normals(std::span<const vec3> normals) const;

  std::shared_ptr<const PreparedCloud> prepared_;
  std::shared_ptr<Geometry> geometry_;
  const std::uint64_t serial_ = next_serial();
  mutable std::mutex mutex_;  ///< of what is made on first use
  mutable Values normals_, radii_;
  mutable std::vector<float> largest_radii_;
};

/// A cloud that several renderers draw. What one of them has measured of it is there for all.
class SharedCloud {
 public:
  explicit SharedCloud(PreparedCloud cloud, std::uint32_t max_chunk_points = 0);
  std::shared_ptr<const ResidentCloud> newest() const;
  /// Adds attributes: `add` gets the cloud where `lacks` is true of the newest. `own`, what the caller holds
  /// of it, becomes the newest. `is_alone`: no other renderer looks at this cloud, so that it is not copied:
  /// who holds an older set of attributes may ask for the newest meanwhile.
  template <class Lacks, class Add>
  void complete(std::shared_ptr<const ResidentCloud>& own, bool is_alone, const Lacks& lacks,
                const Add& add) {
    const std::lock_guard completing(completing_);
    if (lacks(newest()->prepared())) {
      Taken taken = take(is_alone);
      try {
        add(*taken.cloud);
      } catch (...) {
        put(taken);  // what was added before somebody stopped it is right
        own = newest();
        throw;
      }
      put(taken);
    }
    own = newest();
  }

 private:
  struct Taken {
    std::shared_ptr<PreparedCloud> cloud;
    Attributes had;
    std::size_t had_scalars;
  };
  Taken take(bool is_alone) const;
  void put(const Taken& taken);

  std::mutex completing_;
  mutable std::mutex mutex_;
  std::shared_ptr<PreparedCloud> cloud_;
  std::shared_ptr<const ResidentCloud> newest_;
};

/// Unit normal as two 16-bit octahedral coordinates; the zero vector becomes (0,0), which no unit normal
/// uses.
std::uint32_t encode_normal(const vec3& normal);

}  // namespace sfumato
