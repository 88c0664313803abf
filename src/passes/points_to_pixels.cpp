#include "passes/points_to_pixels.h"

#include <algorithm>
#include <cmath>

#include "gl/commands.h"
#include "gl/context.h"
#include "gl/preferences.h"
#include "passes/bindings.h"

namespace sfumato {
namespace {

constexpr std::uint32_t nothing = 0xffffffffu;

}  // namespace

bool PointsToPixels::is_on_cpu() const {
  return visits_ == Visits::automatic && gl::limits().software &&
         gl::place_of_work(gl::preferences().points) == gl::Place::cpu;
}

const Image<std::uint32_t>* PointsToPixels::depth_here(GpuCloud& cloud, const View& view,
                                                       const Footprint& footprint) {
  if (!is_on_cpu()) return nullptr;
  here_.begin(view.width(), view.height());
  here_.visit(cloud, view, {.footprint = footprint});
  return &here_.depth_bits();
}

void PointsToPixels::visit(GpuCloud& cloud, const View& view, const Footprint& footprint,
                           gl::Texture* depth_bits, gl::Texture* index, const gl::Texture* reference,
                           float min_gap, const CasterRange* casters, bool lists) {
  const bool single = footprint.mode == SizeMode::pixels && footprint.size <= 1;
  const bool oriented = footprint.oriented && cloud.has_normals() && !single;
  const bool cut = !cloud.cut().empty();
  const bool dots = footprint.dot_share > 0 && footprint.mode == SizeMode::adaptive;
  const bool spacings = footprint.spacing_is_field && footprint.mode == SizeMode::adaptive && !dots;
  const bool both = !depth_bits;
  gl::Program& program =
      programs_[(index ? 1 : 0) + (single ? 2 : 0) + (reference ? 4 : 0) + (lists ? 8 : 0) +
                (casters ? 16 : 0) + (oriented ? 32 : 0) + (cut ? 64 : 0) + (dots ? 128 : 0) +
                (both ? 256 : 0) + (spacings ? 512 : 0)];
  if (!program) {
    gl::Defines defines;
    if (index) defines.push_back("WRITE_INDEX");
    if (both) defines.push_back("ONE_VISIT");
    if (single) defines.push_back("SINGLE_PIXEL");
    if (reference) defines.push_back("DEPTH_REFERENCE");
    if (casters) defines.push_back("CASTERS");
    if (oriented) defines.push_back("ORIENTED");
    if (cut) defines.push_back("CUT");
    if (dots) defines.push_back("DOTS");
    if (spacings) defines.push_back("SPACINGS");
    if (lists) defines.push_back("LIST_LENGTH " + std::to_string(list_length));
    program = gl::Program::compute("passes/points_to_pixels.comp", defines);
  }
  program.set("size_mode", int(footprint.mode)).set("point_size", footprint.size).set("min_gap", min_gap);
  program.set("single_px", footprint.single_px)
      .set("wide_px", footprint.wide_px)
      .set("max_footprint_px", footprint.most_px);
  program.set("largest_spacing", footprint.largest_medians * cloud.median_spacing());
  if (lists && !index) program.set("inverse_bin", inverse_bin_);
  if (dots)
    program.set("spacing_unit", cloud.prepared().spacing_unit())
        .set("dot_share", footprint.dot_share)
        .set("dot_limits_px", vec2(footprint.least_dot_px, footprint.most_dot_px))
        .set("usual_spacing", cloud.median_spacing())
        .set("sparse_px", footprint.sparse_px);
  if (oriented) program.set("least_px", 0.71f).set("dense_px", 1.5f);
  if (casters) program.set("caster_range", vec2(casters->from, casters->below));
  view.bind();
  if (depth_bits) depth_bits->bind_image(0, GL_READ_WRITE);
  if (both) nearest_.bind_storage(0);
  if (index) index->bind_image(1, GL_READ_WRITE);
  if (reference) reference->bind(binding::input);
  for (GpuCloud::Chunk& chunk : cloud.chunks()) {
    cloud.bind_geometry(chunk);
    if (oriented) cloud.bind_normals(chunk);
    if (dots || spacings) cloud.bind_field(chunk);
    if (casters) cloud.bind_casters(chunk);
    program.dispatch(chunk.groups_per_batch, chunk.visible_batches);
  }
  gl::barrier(both ? GL_SHADER_STORAGE_BARRIER_BIT
                   : GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

std::uint64_t PointsToPixels::draw_depth(GpuCloud& cloud, const View& view, const Footprint& footprint,
                                         gl::Texture& depth_bits, const gl::Texture* reference, float min_gap,
                                         const CasterRange* casters) {
  gl::ensure(depth_bits, "nearest depth bits", GL_R32UI, view.width(), view.height());
  if (is_on_cpu()) {
    here_.begin(view.width(), view.height());
    here_.visit(cloud, view, {footprint, reference, min_gap, casters});
    here_.end(depth_bits, nullptr);
    return cloud.cull(view);
  }
  depth_bits.clear_uint(nothing);
  return add_depth(cloud, view, footprint, depth_bits, reference, min_gap, casters);
}

std::uint64_t PointsToPixels::add_depth(GpuCloud& cloud, const View& view, const Footprint& footprint,
                                        gl::Texture& depth_bits, const gl::Texture* reference, float min_gap,
                                        const CasterRange* casters) {
  const std::uint64_t points = cloud.cull(view);
  if (is_on_cpu()) {
    here_.begin(depth_bits, nullptr);
    here_.visit(cloud, view, {footprint, reference, min_gap, casters});
    here_.end(depth_bits, nullptr);
    return points;
  }
  visit(cloud, view, footprint, &depth_bits, nullptr, reference, min_gap, casters);
  return points;
}

bool PointsToPixels::in_one_visit(const View& view) const {
  const gl::Limits& limits = gl::limits();
  const auto bytes = 8ll * view.width() * view.height();
  return limits.int64_atomics && bytes <= limits.max_storage_block_size &&
         (visits_ == Visits::one || (visits_ == Visits::automatic && !limits.software));
}

std::uint64_t PointsToPixels::draw(GpuCloud& cloud, const View& view, const Footprint& footprint,
                                   PixelLayer& layer, gl::Timers& timers, const gl::Texture* reference,
                                   float min_gap, const CasterRange* casters) {
  std::uint64_t points = 0;
  if (is_on_cpu()) {
    auto timing = timers.scope("depth");
    gl::ensure(layer.depth_bits, "nearest depth bits", GL_R32UI, view.width(), view.height());
    gl::ensure(layer.index, "nearest source index", GL_R32UI, view.width(), view.height());
    points = cloud.cull(view);
    here_.begin(view.width(), view.height());
    here_.visit(cloud, view, {footprint, reference, min_gap, casters});
    here_.end(layer.depth_bits, &layer.index);
    return points;
  }
  if (in_one_visit(view)) {
    {
      auto timing = timers.scope("depth");
      if (const std::size_t bytes = 8ul * view.width() * view.height(); nearest_.bytes() < bytes) {
        nearest_ = gl::Buffer("nearest points", bytes);
        nearest_is_empty_ = false;
      }
      // A clear takes NVIDIA's driver as long as 20M points: `pairs_apart_` empties what it reads.
      if (!nearest_is_empty_) nearest_.clear(nothing);
      nearest_is_empty_ = false;
      points = cloud.cull(view);
      visit(cloud, view, footprint, nullptr, nullptr, reference, min_gap, casters);
    }
    auto timing = timers.scope("index");
    if (!pairs_apart_) pairs_apart_ = ScreenPass("passes/pairs_apart.glsl", {GL_R32UI, GL_R32UI});
    gl::ensure(layer.depth_bits, "nearest depth bits", GL_R32UI, view.width(), view.height());
    gl::ensure(layer.index, "nearest source index", GL_R32UI, view.width(), view.height());
    pairs_apart_.set("columns", view.width()).run({}, {&layer.depth_bits, &layer.index});
    gl::barrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    nearest_is_empty_ = true;
    return points;
  }
  {
    auto timing = timers.scope("depth");
    points = draw_depth(cloud, view, footprint, layer.depth_bits, reference, min_gap, casters);
  }
  auto timing = timers.scope("index");
  gl::ensure(layer.index, "nearest source index", GL_R32UI, view.width(), view.height());
  layer.index.clear_uint(nothing);
  visit(cloud, view, footprint, &layer.depth_bits, &layer.index, reference, min_gap, casters);
  return points;
}

void PointsToPixels::draw_lists(GpuCloud& cloud, const View& view, const Footprint& footprint, float bin,
                                gl::Texture& depth_lists, gl::Texture& index_lists, gl::Timers& timers,
                                const gl::Texture* reference) {
  cloud.cull(view);
  inverse_bin_ = 1 / bin;
  if (is_on_cpu()) {
    auto timing = timers.scope("depth");
    here_.begin(depth_lists, &index_lists);
    here_.visit(cloud, view, {footprint, reference, 0, nullptr, list_length, inverse_bin_});
    here_.end(depth_lists, &index_lists);
    return;
  }
  {
    auto timing = timers.scope("depth");
    visit(cloud, view, footprint, &depth_lists, nullptr, reference, 0, nullptr, true);
  }
  auto timing = timers.scope("index");
  visit(cloud, view, footprint, &depth_lists, &index_lists, reference, 0, nullptr, true);
}

void PointsToPixels::resolve(GpuCloud& cloud, const View& view, PixelLayer& layer, gl::Timers& timers,
                             bool with_normals) {
  auto timing = timers.scope("resolve");
  gl::ensure(layer.albedo, "albedo", GL_RGBA32F, view.width(), view.height());
  gl::ensure(layer.depth, "eye depth", GL_R32F, view.width(), view.height());
  if (with_normals) gl::ensure(layer.normal, "normal", GL_RGBA32F, view.width(), view.height());
  if (is_on_cpu()) {
    resolve_points(cloud, view, layer.depth_bits, layer.index, layer.albedo, layer.depth,
                   with_normals ? &layer.normal : nullptr);
    return;
  }
  ScreenPass& pass = resolve_[with_normals * 1 + (with_normals && cloud.has_normals()) * 2 +
                              (with_normals && cloud.has_shadow()) * 4];
  if (!pass) {
    gl::Defines defines;
    std::vector<GLenum> formats{GL_RGBA32F, GL_R32F};
    if (with_normals) {
      defines.push_back("WRITE_NORMAL");
      formats.push_back(GL_RGBA32F);
      if (cloud.has_normals()) defines.push_back("HAS_NORMALS");
      if (cloud.has_shadow()) defines.push_back("HAS_SHADOW");
    }
    pass = ScreenPass("passes/points_resolve.glsl", formats, defines);
  }
  if (cloud.chunks().empty()) {
    layer.albedo.clear(vec4(0));
    layer.depth.clear(vec4(INFINITY));
    if (with_normals) layer.normal.clear(vec4(0, 0, 0, 1));
  }
  if (with_normals)
    for_each_chunk(cloud, view, layer, pass, {&layer.albedo, &layer.depth, &layer.normal}, true);
  else
    for_each_chunk(cloud, view, layer, pass, {&layer.albedo, &layer.depth});
}

void PointsToPixels::resolve_eye(GpuCloud& cloud, const View& view, PixelLayer& layer, gl::Texture& eye,
                                 float same_spacing, gl::Timers& timers) {
  auto timing = timers.scope("resolve");
  ScreenPass& pass = resolve_eye_[cloud.has_shadow()];
  if (!pass) {
    gl::Defines defines{"WRITE_EYE"};
    if (cloud.has_shadow()) defines.push_back("HAS_SHADOW");
    pass = ScreenPass("passes/points_resolve.glsl", {GL_RGBA16F, GL_RGBA32F}, defines);
  }
  gl::ensure(layer.shadowed, "color and shadow", GL_RGBA16F, view.width(), view.height());
  if (cloud.chunks().empty()) {
    layer.shadowed.clear(vec4(0, 0, 0, 1));
    eye.clear(vec4(0, 0, -3e38f, 0));
  }
  pass.set("same_spacing", same_spacing);
  for_each_chunk(cloud, view, layer, pass, {&layer.shadowed, &eye});
}

void PointsToPixels::for_each_chunk(GpuCloud& cloud, const View& view, const PixelLayer& layer,
                                    ScreenPass& pass, std::initializer_list<const gl::Texture*> targets,
                                    bool with_normals) {
  view.bind();
  cloud.for_each_place(pass, [&](GpuCloud::Chunk& chunk) {
    cloud.bind_geometry(chunk);
    cloud.bind_colors(chunk);
    if (with_normals && cloud.has_normals()) cloud.bind_normals(chunk);
    if (cloud.has_shadow()) cloud.bind_shadow(chunk);
    pass.set("batch_count", int(chunk.visible_batches));
    pass.run({&layer.depth_bits, &layer.index}, targets);
  });
}

}  // namespace sfumato
