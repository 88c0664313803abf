#include "passes/gpu_cloud.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "gl/context.h"
#include "passes/bindings.h"

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

gl::TextureBuffer upload_normals(const GpuCloud::Chunk& chunk, std::span<const vec3> normals) {
  std::vector<std::uint32_t> codes(chunk.count, 0);
  if (!normals.empty())
    for (std::uint32_t i = 0; i < chunk.count; ++i) codes[i] = encode_normal(normals[chunk.first + i]);
  return gl::TextureBuffer("normals", GL_RG16, std::span<const std::uint32_t>(codes));
}

std::vector<float> largest_of_batches(const PreparedCloud& prepared, std::span<const float> radii) {
  std::vector<float> largest;
  for (const Batch& batch : prepared.batches) {
    const auto first = radii.begin() + std::ptrdiff_t(batch.first);
    largest.push_back(radii.empty() ? 0 : std::max(0.0f, *std::max_element(first, first + batch.count)));
  }
  return largest;
}

}  // namespace

GpuCloud::GpuCloud(const PreparedCloud& prepared, std::vector<Rgba8> colors, std::uint32_t max_chunk_points)
    : prepared_(prepared), colors_(std::move(colors)), bounds_(sfumato::bounds(prepared.cloud)) {
  const PointCloud& cloud = prepared.cloud;
  if (max_chunk_points == 0) {
    // 3 GiB of positions is what llvmpipe was seen to accept in one buffer.
    const std::uint64_t bytes_limit = (std::uint64_t(3) << 30) / sizeof(vec3);
    max_chunk_points = std::uint32_t(
        std::min<std::uint64_t>(std::uint64_t(gl::limits().max_texture_buffer_size), bytes_limit));
  }
  set_cut({});
  Chunk chunk;
  auto close = [&] {
    if (chunk.count == 0) return;
    const std::string name = "points " + std::to_string(chunk.first);
    chunk.positions = gl::TextureBuffer("position of " + name, GL_RGB32F,
                                        std::span(cloud.positions).subspan(chunk.first, chunk.count));
    chunk.source_index = gl::TextureBuffer("source index of " + name, GL_R32UI,
                                           std::span(cloud.source_index).subspan(chunk.first, chunk.count));
    chunk.batches = gl::TextureBuffer("batches of " + name, GL_RGBA32UI, chunk.batch_count * 32);
    chunks_.push_back(std::move(chunk));
  };
  for (std::size_t b = 0; b < prepared.batches.size(); ++b) {
    const Batch& batch = prepared.batches[b];
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

std::uint64_t GpuCloud::cull(const View& view) {
  std::uint64_t points = 0;
  std::vector<glm::uvec4> visible;
  for (Chunk& chunk : chunks_) {
    visible.clear();
    std::uint32_t largest = 0, batches = 0;
    for (std::uint32_t b = 0; b < chunk.batch_count; ++b) {
      const Batch& batch = prepared_.batches[chunk.first_batch + b];
      // Splats reach beyond the box of their centres.
      const vec3 reach(4 * batch.spacing);
      if (!view.may_see(batch.box_min - reach, batch.box_max + reach)) continue;
      visible.emplace_back(batch.first - chunk.first, batch.count,
                           std::bit_cast<std::uint32_t>(batch.least_log2_spacing),
                           std::bit_cast<std::uint32_t>(batch.most_log2_spacing));
      visible.push_back(glm::floatBitsToUint(batch.log2_spacing));
      ++batches;
      largest = std::max(largest, batch.count);
      points += batch.count;
    }
    chunk.visible_batches = batches;
    chunk.groups_per_batch = (largest + 127) / 128;
    chunk.batches.buffer().upload(visible.data(), visible.size() * sizeof(glm::uvec4));
  }
  return points;
}

std::uint32_t GpuCloud::show(Chunk& chunk, std::span<const glm::uvec2> ranges) {
  std::vector<glm::uvec4> rows;
  std::uint32_t largest = 0;
  for (const glm::uvec2& range : ranges) {
    rows.emplace_back(range, 0u, 0u);
    rows.emplace_back(0u);
    largest = std::max(largest, range.y);
  }
  chunk.visible_batches = std::uint32_t(ranges.size());
  chunk.batches.buffer().upload(rows.data(), rows.size() * sizeof(glm::uvec4));
  return largest;
}

void GpuCloud::bind_geometry(const Chunk& chunk) const {
  chunk.positions.bind(binding::positions);
  chunk.source_index.bind(binding::source_index);
  chunk.batches.bind(binding::batches);
  cut_block_.bind_uniform(binding::cut);
}

void GpuCloud::set_cut(std::vector<vec4> planes) {
  struct Block {  // std140, as in shaders/cloud.glsl
    vec4 planes[6];
    int count;
    int padding[3];
  } block{};
  block.count = int(std::min(planes.size(), std::size(block.planes)));
  std::copy_n(planes.begin(), block.count, block.planes);
  if (cut_block_ && planes == cut_) return;
  if (cut_block_) look_serial_ = next_serial();
  cut_ = std::move(planes);
  cut_block_ = gl::Buffer("cut", sizeof block, &block);
}

void GpuCloud::bind_colors(Chunk& chunk) {
  if (!chunk.colors)
    chunk.colors = gl::TextureBuffer("colors", GL_RGBA8,
                                     std::span<const Rgba8>(colors_).subspan(chunk.first, chunk.count));
  chunk.colors.bind(binding::colors);
}

void GpuCloud::bind_normals(Chunk& chunk) {
  if (!chunk.normals) chunk.normals = upload_normals(chunk, prepared_.cloud.normals);
  chunk.normals.bind(binding::normals);
}

void GpuCloud::bind_radii(Chunk& chunk) {
  if (!chunk.radii)
    chunk.radii = gl::TextureBuffer(
        "radii", GL_R32F, std::span<const float>(prepared_.cloud.radii).subspan(chunk.first, chunk.count));
  chunk.radii.bind(binding::radii);
}

void GpuCloud::bind_field(const Chunk& chunk) const {
  if (field_) (*field_)[place_of(chunk)].bind(binding::field);
}

void GpuCloud::bind_shadow(Chunk& chunk) {
  if (!chunk.shadow)
    chunk.shadow = gl::TextureBuffer("shadow factors", GL_R32F,
                                     std::span<const float>(std::vector<float>(chunk.count, 1.0f)));
  chunk.shadow.bind(binding::shadow);
}

void GpuCloud::bind_places() {
  if (!places_) {
    const std::vector<std::uint32_t>& source = prepared_.cloud.source_index;
    const std::size_t count =
        source.empty() ? 0 : std::size_t(*std::max_element(source.begin(), source.end())) + 1;
    gl::require(count <= std::size_t(gl::limits().max_texture_buffer_size),
                "a cloud of " + std::to_string(count) + " points",
                "larger texture buffers (or --max-points)");
    std::vector<std::uint32_t> places(count, 0);
    for (std::size_t i = 0; i < source.size(); ++i) places[source[i]] = std::uint32_t(i);
    places_ = gl::TextureBuffer("places", GL_R32UI, std::span<const std::uint32_t>(places));
  }
  places_.bind(binding::places);
}

void GpuCloud::set_colors(std::vector<Rgba8> colors) {
  colors_ = std::move(colors);
  look_serial_ = next_serial();
  for (Chunk& chunk : chunks_) chunk.colors = {};
}

std::shared_ptr<const GpuCloud::Values> GpuCloud::make_values(const std::string& name,
                                                              std::span<const float> values) const {
  Values buffers;
  for (const Chunk& chunk : chunks_)
    buffers.emplace_back(name, GL_R32F, values.subspan(chunk.first, chunk.count));
  return std::make_shared<const Values>(std::move(buffers));
}

void GpuCloud::bind_casters(const Chunk& chunk) const {
  if (casters_) (*casters_->opacity)[place_of(chunk)].bind(binding::casters);
}

void GpuCloud::set_shadow(std::span<const float> values) {
  has_shadow_ = !values.empty();
  has_stored_shadow_ = false;
  for (Chunk& chunk : chunks_)
    chunk.shadow =
        has_shadow_ ? gl::TextureBuffer("shadow factors", GL_R32F, values.subspan(chunk.first, chunk.count))
                    : gl::TextureBuffer();
}

const std::vector<float>& GpuCloud::largest_radii() {
  if (largest_radii_.empty()) largest_radii_ = largest_of_batches(prepared_, prepared_.cloud.radii);
  return largest_radii_;
}

GpuCloud::Shapes GpuCloud::make_shapes(std::span<const vec3> normals, std::span<const float> radii) const {
  Shapes shapes;
  shapes.largest_radii = largest_of_batches(prepared_, radii);
  for (const Chunk& chunk : chunks_) {
    shapes.radii.emplace_back("radii of a part", GL_R32F, radii.subspan(chunk.first, chunk.count));
    if (!normals.empty()) shapes.normals.push_back(upload_normals(chunk, normals));
  }
  return shapes;
}

void GpuCloud::exchange(Shapes& shapes) {
  if (shapes.radii.empty()) return;
  std::swap(largest_radii_, shapes.largest_radii);
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    std::swap(chunks_[c].radii, shapes.radii[c]);
    if (!shapes.normals.empty()) std::swap(chunks_[c].normals, shapes.normals[c]);
  }
}

void GpuCloud::set_stored_shadow() {
  std::vector<float> factors(size(), 1.0f);
  if (const ScalarField* stored = prepared_.cloud.scalar("shadow"))
    for (std::size_t i = 0; i < factors.size(); ++i)
      if (const double value = stored->value(i); !std::isnan(value))
        factors[i] = float(std::clamp(value, 0.0, 1.0));
  set_shadow(factors);
  has_stored_shadow_ = true;
}

void GpuCloud::begin_shadow() {
  has_shadow_ = true, has_stored_shadow_ = false;
  for (Chunk& chunk : chunks_) gl::grow(chunk.shadow, "shadow factors", GL_R32F, chunk.count * sizeof(float));
}

std::uint64_t GpuCloud::next_serial() {
  static std::atomic<std::uint64_t> last =
      0;  // a process may have several contexts, each on a thread of its own
  return ++last;
}

void GpuCloud::attributes_changed() {
  serial_ = look_serial_ = next_serial();
  largest_radii_.clear();
  for (Chunk& chunk : chunks_) {
    chunk.normals = {};
    chunk.radii = {};
  }
}

}  // namespace sfumato
