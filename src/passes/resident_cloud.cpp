#include "passes/resident_cloud.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "gl/context.h"

namespace sfumato {

std::uint32_t encode_normal(const vec3& n) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0)) return 0;
  vec2 e = vec2(n.x, n.y) / sum;
  if (n.z < 0) {
    const vec2 folded = 1.0f - glm::abs(vec2(e.y, e.x));
    e = {std::copysign(folded.x, e.x), std::copysign(folded.y, e.y)};
  }
  auto code = [](float v) { return std::uint32_t(std::lround((v * 0.5f + 0.5f) * 65535)); };
  const std::uint32_t packed = code(e.x) | code(e.y) << 16;
  // (0,0) says "no normal"; it decodes to -z, which the other three corners of the square say as well.
  return packed ? packed : 0xffffffffu;
}

namespace {

std::vector<float> largest_of_batches(const PreparedCloud& prepared, std::span<const float> radii) {
  std::vector<float> largest;
  for (const Batch& batch : prepared.batches) {
    const auto first = radii.begin() + std::ptrdiff_t(batch.first);
    largest.push_back(radii.empty() ? 0 : std::max(0.0f, *std::max_element(first, first + batch.count)));
  }
  return largest;
}

/// With how far each point lies on a surface; empty: as far as can be.
ResidentCloud::Values upload_radii(const std::vector<ResidentCloud::Chunk>& chunks, const std::string& name,
                                   std::span<const float> radii, std::span<const float> surface) {
  ResidentCloud::Values buffers;
  std::vector<vec2> pairs;
  for (const ResidentCloud::Chunk& chunk : chunks) {
    pairs.resize(chunk.count);
    for (std::uint32_t i = 0; i < chunk.count; ++i)
      pairs[i] = {radii[chunk.first + i], surface.empty() ? 1 : surface[chunk.first + i]};
    buffers.emplace_back(name, GL_RG32F, std::span<const vec2>(pairs));
  }
  return buffers;
}

template <class T>
ResidentCloud::Values upload(const std::vector<ResidentCloud::Chunk>& chunks, const std::string& name,
                             GLenum format, std::span<const T> values) {
  ResidentCloud::Values buffers;
  for (const ResidentCloud::Chunk& chunk : chunks)
    buffers.emplace_back(name, format, values.subspan(chunk.first, chunk.count));
  return buffers;
}

/// Another context that shares the objects sees what is finished.
const ResidentCloud::Values& made_once(std::mutex& mutex, ResidentCloud::Values& values, std::size_t chunks,
                                       const auto& make) {
  const std::lock_guard lock(mutex);
  if (values.size() < chunks) {
    values = make();
    gl::finish();
  }
  return values;
}

}  // namespace

ResidentCloud::ResidentCloud(std::shared_ptr<const PreparedCloud> prepared, std::uint32_t max_chunk_points)
    : prepared_(std::move(prepared)), geometry_(std::make_shared<Geometry>()) {
  const PointCloud& cloud = prepared_->cloud;
  geometry_->bounds = prepared_->whole ? prepared_->whole->box : sfumato::bounds(cloud);
  if (max_chunk_points == 0) {
    // 3 GiB of positions is what llvmpipe was seen to accept in one buffer.
    const std::uint64_t bytes_limit = (std::uint64_t(3) << 30) / sizeof(vec3);
    max_chunk_points = std::uint32_t(
        std::min<std::uint64_t>(std::uint64_t(gl::limits().max_texture_buffer_size), bytes_limit));
  }
  geometry_->max_chunk_points = max_chunk_points;
  Chunk chunk;
  auto close = [&] {
    if (chunk.count == 0) return;
    const std::string name = "points " + std::to_string(chunk.first);
    chunk.positions = gl::TextureBuffer("position of " + name, GL_RGB32F,
                                        std::span(cloud.positions).subspan(chunk.first, chunk.count));
    chunk.source_index = gl::TextureBuffer("source index of " + name, GL_R32UI,
                                           std::span(cloud.source_index).subspan(chunk.first, chunk.count));
    geometry_->chunks.push_back(std::move(chunk));
  };
  for (std::size_t b = 0; b < prepared_->batches.size(); ++b) {
    const Batch& batch = prepared_->batches[b];
    if (chunk.count == 0 || chunk.count + batch.count > max_chunk_points) {
      close();
      chunk = Chunk{};
      chunk.first = batch.first;
      chunk.first_batch = std::uint32_t(b);
    }
    chunk.count += batch.count;
    ++chunk.batch_count;
  }
  close();
}

ResidentCloud::ResidentCloud(std::shared_ptr<const PreparedCloud> completed, const ResidentCloud& of)
    : prepared_(std::move(completed)), geometry_(of.geometry_) {}

const std::vector<float>& ResidentCloud::largest_radii() const {
  const std::lock_guard lock(mutex_);
  if (largest_radii_.empty()) largest_radii_ = largest_of_batches(*prepared_, prepared_->cloud.radii);
  return largest_radii_;
}

ResidentCloud::Values ResidentCloud::upload_normals(std::span<const vec3> normals) const {
  Values buffers;
  std::vector<std::uint32_t> codes;
  for (const Chunk& chunk : chunks()) {
    codes.assign(chunk.count, 0);
    if (!normals.empty())
      for (std::uint32_t i = 0; i < chunk.count; ++i) codes[i] = encode_normal(normals[chunk.first + i]);
    buffers.emplace_back("normals", GL_RG16, std::span<const std::uint32_t>(codes));
  }
  return buffers;
}

const ResidentCloud::Values& ResidentCloud::normals() const {
  return made_once(mutex_, normals_, chunks().size(),
                   [&] { return upload_normals(prepared_->cloud.normals); });
}

const ResidentCloud::Values& ResidentCloud::radii() const {
  return made_once(mutex_, radii_, chunks().size(), [&] {
    return upload_radii(chunks(), "radii", prepared_->cloud.radii, prepared_->on_surface);
  });
}

const std::vector<ResidentCloud::Places>& ResidentCloud::places() const {
  const std::lock_guard lock(geometry_->mutex);
  const std::vector<std::uint32_t>& source = prepared_->cloud.source_index;
  if (geometry_->places.empty() && !source.empty()) {
    const std::size_t count = std::size_t(*std::max_element(source.begin(), source.end())) + 1;
    std::vector<std::uint32_t> places(count, 0);
    for (std::size_t i = 0; i < source.size(); ++i) places[source[i]] = std::uint32_t(i);
    for (std::size_t first = 0; first < count; first += geometry_->max_chunk_points) {
      const auto part = std::span<const std::uint32_t>(places).subspan(first).first(
          std::min<std::size_t>(count - first, geometry_->max_chunk_points));
      geometry_->places.push_back({std::uint32_t(first), std::uint32_t(part.size()),
                                   gl::TextureBuffer("places " + std::to_string(first), GL_R32UI, part)});
    }
    gl::finish();
  }
  return geometry_->places;
}

const ResidentCloud::Values& ResidentCloud::Colors::buffers(const ResidentCloud& of) const {
  return made_once(mutex_, buffers_, of.chunks().size(),
                   [&] { return upload(of.chunks(), "colors", GL_RGBA8, std::span<const Rgba8>(values_)); });
}

std::shared_ptr<const ResidentCloud::Values> ResidentCloud::make_values(const std::string& name,
                                                                        std::span<const float> values) const {
  return std::make_shared<const Values>(upload(chunks(), name, GL_R32F, values));
}

std::shared_ptr<const ResidentCloud::Values> ResidentCloud::make_values(const std::string& name,
                                                                        std::span<const vec2> values) const {
  std::vector<std::uint32_t> halves(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) halves[i] = glm::packHalf2x16(values[i]);
  return std::make_shared<const Values>(
      upload(chunks(), name, GL_RG16F, std::span<const std::uint32_t>(halves)));
}

std::shared_ptr<const ResidentCloud::Shapes> ResidentCloud::make_shapes(
    std::span<const vec3> normals, std::span<const float> radii, std::span<const float> surface) const {
  Shapes shapes;
  if (!normals.empty()) shapes.normals = upload_normals(normals);
  shapes.radii = upload_radii(chunks(), "radii of a part", radii, surface);
  shapes.largest_radii = largest_of_batches(*prepared_, radii);
  return std::make_shared<const Shapes>(std::move(shapes));
}

std::uint64_t ResidentCloud::next_serial() {
  static std::atomic<std::uint64_t> last =
      0;  // a process may have several contexts, each on a thread of its own
  return ++last;
}

SharedCloud::SharedCloud(PreparedCloud cloud, std::uint32_t max_chunk_points)
    : cloud_(std::make_shared<PreparedCloud>(std::move(cloud))),
      newest_(std::make_shared<const ResidentCloud>(cloud_, max_chunk_points)) {
  gl::finish();  // for who shares it on another context
}

std::shared_ptr<const ResidentCloud> SharedCloud::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

SharedCloud::Taken SharedCloud::take(bool is_alone) const {
  const std::lock_guard lock(mutex_);
  return {is_alone ? cloud_ : std::make_shared<PreparedCloud>(*cloud_), cloud_->available,
          cloud_->cloud.scalars.size()};
}

void SharedCloud::put(const Taken& taken) {
  const std::lock_guard lock(mutex_);
  if (taken.cloud->available == taken.had && taken.cloud->cloud.scalars.size() == taken.had_scalars) return;
  cloud_ = taken.cloud;
  newest_ = std::make_shared<const ResidentCloud>(cloud_, *newest_);
}

}  // namespace sfumato
