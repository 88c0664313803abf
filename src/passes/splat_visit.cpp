#include "passes/splat_visit.h"

#include <algorithm>

#include "gl/commands.h"
#include "passes/bindings.h"

namespace sfumato {
namespace {

constexpr unsigned group_size = Compaction::group_size;

/// Uploads the batches of small splats as the chunk's visible ones; returns the work groups that the largest
/// needs.
unsigned show_small(GpuCloud::Chunk& chunk, const SplatBatches::Ranges& small) {
  std::vector<glm::uvec2> ranges;
  for (std::size_t b = 0; b < small.first.size(); ++b)
    ranges.emplace_back(unsigned(small.first[b]), unsigned(small.count[b]));
  return (GpuCloud::show(chunk, ranges) + group_size - 1) / group_size;
}

}  // namespace

void visit_small(GpuCloud& cloud, const View& view, const SplatBatches& batches, gl::Program& program,
                 bool colors) {
  view.bind();
  for (std::size_t c = 0; c < batches.chunks.size(); ++c) {
    const SplatBatches::Ranges& small = batches.chunks[c].small;
    if (small.first.empty()) continue;
    GpuCloud::Chunk& chunk = cloud.chunks()[c];
    const unsigned groups = show_small(chunk, small);
    bind_splats(cloud, chunk);
    if (colors) {
      cloud.bind_colors(chunk);
      if (cloud.has_shadow()) cloud.bind_shadow(chunk);
    }
    program.dispatch(groups, unsigned(small.first.size()));
  }
}

gl::Program& SplatVisit::program(bool mark, const SplatShape& shape) {
  gl::Program& chosen =
      programs_[(mark ? 1 : 0) + (shape.prefilter_px > 0 ? 2 : 0) + (shape.part != SplatPart::all ? 4 : 0)];
  if (!chosen)
    chosen = gl::Program::compute("passes/splat_visit.comp",
                                  splat_defines({mark ? "VISIT_MARK" : "VISIT_NEAREST"}, shape));
  set_splat_uniforms(chosen, shape);
  return chosen;
}

void SplatVisit::draw_nearest(GpuCloud& cloud, const View& view, const SplatShape& shape,
                              const SplatBatches& batches, const SplatShift& shift,
                              const gl::Texture& nearest_t) {
  gl::bind_image(0, nearest_t, GL_READ_WRITE, GL_R32UI);
  gl::Program& nearest = program(false, shape);
  shift.set(nearest, shape);
  visit_small(cloud, view, batches, nearest);
  gl::barrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

void SplatVisit::measure_farthest(const View& view, const gl::Texture& nearest_t) {
  if (!farthest_) farthest_ = ScreenPass("passes/splat_farthest.glsl", {GL_R32F});
  gl::ensure(farthest_t_, "farthest visible distance", GL_R32F, (view.width() + 7) / 8,
             (view.height() + 7) / 8);
  farthest_.run({&nearest_t}, {&farthest_t_});
}

bool SplatVisit::list_survivors(GpuCloud& cloud, std::size_t c, const View& view, const SplatShape& shape,
                                const SplatBatches& batches, const gl::Texture& nearest_t, float epsilon) {
  const SplatBatches::Ranges& small = batches.chunks[c].small;
  if (small.first.empty()) return false;
  GpuCloud::Chunk& chunk = cloud.chunks()[c];
  const unsigned groups_per_batch = show_small(chunk, small), batch_count = unsigned(small.first.size());

  view.bind();
  bind_splats(cloud, chunk);
  farthest_t_.bind(binding::input);
  nearest_t.bind(binding::input + 1);
  survivors_.bind_flags(groups_per_batch, batch_count, chunk.count);
  gl::Program& mark = program(true, shape);
  mark.set("epsilon", epsilon).set("slots_per_batch", groups_per_batch * group_size);
  mark.dispatch(groups_per_batch, batch_count);
  survivors_.run();
  return true;
}

}  // namespace sfumato
