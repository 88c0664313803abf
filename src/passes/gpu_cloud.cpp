#include "passes/gpu_cloud.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/room.h"
#include "passes/bindings.h"

namespace sfumato {

GpuCloud::GpuCloud(std::shared_ptr<const ResidentCloud> cloud, std::shared_ptr<const Colors> colors)
    : resident_(std::move(cloud)), colors_(std::move(colors)) {
  set_cut({});
  for (const ResidentCloud::Chunk& of : resident_->chunks()) {
    Chunk& chunk = chunks_.emplace_back(Chunk{of});
    chunk.batches = gl::TextureBuffer("batches", GL_RGBA32UI, chunk.batch_count * 32);
  }
}

GpuCloud::GpuCloud(const PreparedCloud& prepared, std::vector<Rgba8> colors, std::uint32_t max_chunk_points)
    : GpuCloud(
          std::make_shared<const ResidentCloud>(
              std::shared_ptr<const PreparedCloud>(std::shared_ptr<void>(), &prepared), max_chunk_points),
          std::make_shared<const Colors>(std::move(colors))) {}

void GpuCloud::show(std::shared_ptr<const ResidentCloud> cloud, Attributes needs) {
  if (cloud->serial() != serial()) look_serial_ = ResidentCloud::next_serial();
  resident_ = std::move(cloud);
  shown_ = needs;
}

bool GpuCloud::is_in_view(const Batch& batch, const View& view) {
  const vec3 reach(4 * batch.spacing);  // splats reach beyond the box of their centres
  return view.may_see(batch.box_min - reach, batch.box_max + reach);
}

std::uint64_t GpuCloud::points_in(const View& view) const {
  std::uint64_t points = 0;
  for (const Batch& batch : prepared().batches)
    if (is_in_view(batch, view)) points += batch.count;
  return points;
}

std::uint64_t GpuCloud::cull(const View& view) {
  std::uint64_t points = 0;
  std::vector<glm::uvec4> visible;
  for (Chunk& chunk : chunks_) {
    visible.clear();
    std::uint32_t largest = 0, batches = 0;
    for (std::uint32_t b = 0; b < chunk.batch_count; ++b) {
      const Batch& batch = prepared().batches[chunk.first_batch + b];
      if (!is_in_view(batch, view)) continue;
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
  positions(chunk).bind(binding::positions);
  source_index(chunk).bind(binding::source_index);
  chunk.batches.bind(binding::batches);
  cut_block_.bind_uniform(binding::cut);
}

void GpuCloud::set_cut(Cut cut) {
  if (cut_block_ && cut == cut_) return;
  if (cut_block_) look_serial_ = ResidentCloud::next_serial();
  cut_ = std::move(cut);
  struct Block {  // std140, as in shaders/cloud.glsl
    vec4 planes[6];
    vec4 u, v, up;
    int count, across;
    int padding[2];
    float heights[Ceiling::most_across * Ceiling::most_across];
  } block{};
  block.count = int(std::min(cut_.planes.size(), std::size(block.planes)));
  std::copy_n(cut_.planes.begin(), block.count, block.planes);
  block.u = cut_.u, block.v = cut_.v, block.up = vec4(cut_.up, 0), block.across = cut_.across;
  std::copy(cut_.heights.begin(), cut_.heights.end(), block.heights);
  cut_block_ = gl::Buffer("cut", sizeof block, &block);
}

const gl::TextureBuffer& GpuCloud::positions(const Chunk& chunk) const {
  return resident_->chunks()[place_of(chunk)].positions;
}

const gl::TextureBuffer& GpuCloud::source_index(const Chunk& chunk) const {
  return resident_->chunks()[place_of(chunk)].source_index;
}

const gl::TextureBuffer& GpuCloud::colors(const Chunk& chunk) const {
  return colors_->buffers(*resident_)[place_of(chunk)];
}

const gl::TextureBuffer& GpuCloud::normals(const Chunk& chunk) const {
  const Values& normals = shapes_ && !shapes_->normals.empty() ? shapes_->normals : resident_->normals();
  return normals[place_of(chunk)];
}

const gl::TextureBuffer& GpuCloud::radii(const Chunk& chunk) const {
  return (shapes_ ? shapes_->radii : resident_->radii())[place_of(chunk)];
}

const gl::TextureBuffer* GpuCloud::field(const Chunk& chunk) const {
  return field_ ? &(*field_)[place_of(chunk)] : nullptr;
}

const gl::TextureBuffer* GpuCloud::opacity(const Chunk& chunk) const {
  return casters_ ? &(*casters_->opacity)[place_of(chunk)] : nullptr;
}

const gl::TextureBuffer& GpuCloud::shadow(Chunk& chunk) {
  if (!chunk.shadow)
    chunk.shadow = gl::TextureBuffer("shadow factors", GL_R32F,
                                     std::span<const float>(std::vector<float>(chunk.count, 1.0f)));
  return chunk.shadow;
}

void GpuCloud::set_colors(std::shared_ptr<const Colors> colors) {
  colors_ = std::move(colors);
  look_serial_ = ResidentCloud::next_serial();
}

void GpuCloud::set_shadow(std::span<const float> values) {
  has_shadow_ = !values.empty();
  has_stored_shadow_ = false;
  for (Chunk& chunk : chunks_)
    chunk.shadow =
        has_shadow_ ? gl::TextureBuffer("shadow factors", GL_R32F, values.subspan(chunk.first, chunk.count))
                    : gl::TextureBuffer();
}

void GpuCloud::set_stored_shadow() {
  std::vector<float> factors(size(), 1.0f);
  if (const ScalarField* stored = prepared().cloud.scalar("shadow"))
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

}  // namespace sfumato
