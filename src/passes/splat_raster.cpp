#include "passes/splat_raster.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "gl/commands.h"
#include "gl/context.h"
#include "gl/draw.h"
#include "gl/pace.h"
#include "passes/bindings.h"

namespace sfumato {
namespace {

/// Up to this width in pixels a compute loop finds the nearest hits as fast as the rasteriser; splats that
/// prove hidden then cost nothing more (docs/performance.md).
constexpr double small_splat_px = 32;

/// Largest width in pixels that a splat of this radius can have with its centre in the box; infinite when it
/// may reach the plane of the eye.
double largest_size_px(const View& view, const Batch& batch, double radius) {
  const Camera camera = view.camera().whole_picture();  // tiles draw what they share in the same order
  const double scale = std::max(camera.intrinsics().fx, camera.intrinsics().fy);
  if (camera.orthographic()) return 2 * radius * scale;
  double nearest = 1e300;
  for (const dvec3& p : batch.box().corners())
    nearest = std::min(nearest, -(view.eye_from_cloud() * glm::dvec4(p, 1)).z);
  // Discs that end before splat_near() are not drawn, whatever the box says.
  const double z = std::max(nearest, 1e-4 * camera.far_plane - radius);
  if (z <= 2 * radius) return 1e300;
  const Intrinsics k = camera.intrinsics();
  const double slope =
      std::max(std::max(k.cx, camera.width - k.cx) / k.fx, std::max(k.cy, camera.height - k.cy) / k.fy);
  // A splat seen on the border may have its centre beyond it. Slopes of the touching planes: notes on the
  // sphere.
  const double s = (slope * z + radius) / (z - radius);
  const double half = (s * radius * radius + radius * z * std::sqrt(1 + s * s)) / (z * z - radius * radius);
  return 2 * half * scale;
}

}  // namespace

float filter_reach(const View& view, const SplatShape& shape) {
  const Camera& camera = view.camera();
  return shape.prefilter_px *
         float((camera.orthographic() ? 1 : camera.far_plane) / camera.pixels_per_unit());
}

SplatBatches choose_batches(GpuCloud& cloud, const View& view, const SplatShape& shape, SplatPath path) {
  SplatBatches chosen;
  const std::vector<float>& radii = cloud.largest_radii();
  const std::vector<Batch>& batches = cloud.prepared().batches;
  for (const GpuCloud::Chunk& chunk : cloud.chunks()) {
    SplatBatches::OfChunk& ranges = chosen.chunks.emplace_back();
    for (std::uint32_t b = chunk.first_batch; b < chunk.first_batch + chunk.batch_count; ++b) {
      const Batch& batch = batches[b];
      const float radius = std::min(radii[b], shape.radius_limit) * shape.radius_scale;
      const vec3 reach(std::max(radius, filter_reach(view, shape)));
      if (!view.may_see(batch.box_min - reach, batch.box_max + reach)) continue;
      chosen.points_seen += batch.count;
      // A sprite that is cut at a narrow image may need twice its width (splat.vert).
      const double size_px = std::max(largest_size_px(view, batch, radius), 2.0 * shape.prefilter_px);
      const double units =
          std::max(std::min(size_px * size_px, double(view.width()) * view.height()), gl::splat_units);
      const bool automatic = path == SplatPath::automatic,
                 too_large = 2 * size_px + 2 > gl::limits().max_point_size;
      if (path == SplatPath::quads || (too_large && automatic)) {
        ranges.quads.add(6 * (batch.first - chunk.first), 6 * batch.count, units);
        chosen.fallbacks += batch.count;
      } else if (path == SplatPath::compute || (size_px <= small_splat_px && automatic)) {
        ranges.small.add(batch.first - chunk.first, batch.count, units);
      } else {
        ranges.points.add(batch.first - chunk.first, batch.count, units);
      }
    }
  }
  return chosen;
}

void set_splat_uniforms(gl::Program& program, const SplatShape& shape) {
  program.set("splat_radius_scale", shape.radius_scale).set("splat_radius_limit", shape.radius_limit);
  program.set("splat_widest_px", shape.widest_px).set("splat_dots", shape.dots);
  program.set("splat_behind", vec2(shape.behind, shape.behind_radii / shape.radius_scale));
  program.set("splat_prefilter_px", shape.prefilter_px).set("splat_field_threshold", shape.field_threshold);
  program.set("splat_field_above", shape.part == SplatPart::above);
}

void SplatShift::set(gl::Program& program, const SplatShape& shape) const {
  program.set("shift", least).set("shift_radii", radii / shape.radius_scale);
}

gl::Defines splat_defines(gl::Defines defines, const SplatShape& shape) {
  if (shape.prefilter_px > 0) defines.push_back("SPLAT_PREFILTER");
  if (shape.part != SplatPart::all &&
      std::find(defines.begin(), defines.end(), "SPLAT_FIELD") == defines.end())
    defines.push_back("SPLAT_FIELD");
  return defines;
}

SplatRaster::SplatRaster(std::string fragment_file, gl::Defines defines)
    : fragment_file_(std::move(fragment_file)), defines_(std::move(defines)) {}

void bind_splats(GpuCloud& cloud, GpuCloud::Chunk& chunk) {
  cloud.bind_geometry(chunk);
  cloud.bind_normals(chunk);
  cloud.bind_radii(chunk);
  cloud.bind_field(chunk);
}

gl::Program& SplatRaster::program(const GpuCloud& cloud, const SplatShape& shape, bool quads, bool list,
                                  const SetUniforms& set_uniforms) {
  const bool filter = shape.prefilter_px > 0, field = shape.part != SplatPart::all;
  gl::Program& chosen = programs_[(quads ? 1 : 0) + (filter ? 2 : 0) + (field ? 4 : 0) + (list ? 8 : 0)];
  if (!chosen) {
    gl::Defines defines = splat_defines(defines_, shape);
    if (quads) defines.push_back("SPLAT_QUADS");
    if (list) defines.push_back("SPLAT_LIST");
    chosen = gl::Program::raster("passes/splat.vert", fragment_file_, defines);
  }
  set_splat_uniforms(chosen, shape);
  chosen.set("splat_has_shadow", cloud.has_shadow());
  if (set_uniforms) set_uniforms(chosen);
  return chosen;
}

void SplatRaster::bind(GpuCloud& cloud, GpuCloud::Chunk& chunk) {
  bind_splats(cloud, chunk);
  if (std::find(defines_.begin(), defines_.end(), "SPLAT_COLOR") == defines_.end()) return;
  cloud.bind_colors(chunk);
  if (cloud.has_shadow()) cloud.bind_shadow(chunk);
}

void SplatRaster::draw(GpuCloud& cloud, const View& view, const SplatShape& shape,
                       const SplatBatches& batches, const gl::State& state, const SetUniforms& set_uniforms,
                       bool with_small) {
  view.bind();
  state.apply();
  for (std::size_t c = 0; c < batches.chunks.size(); ++c) {
    const SplatBatches::OfChunk& ranges = batches.chunks[c];
    bind(cloud, cloud.chunks()[c]);
    for (const SplatBatches::Ranges* of : {&ranges.small, &ranges.points, &ranges.quads}) {
      const SplatBatches::Ranges& list = *of;
      const bool quads = of == &ranges.quads;
      if (list.first.empty() || (of == &ranges.small && !with_small)) continue;
      gl::Program& used = program(cloud, shape, quads, false, set_uniforms);
      used.use();
      draw_ranges(used, list, quads);
    }
  }
}

void SplatRaster::draw_ranges(const gl::Program& program, const SplatBatches::Ranges& ranges, bool quads) {
  const int corners = quads ? 6 : 1;
  first_.clear();
  count_.clear();
  const auto submit = [&] {
    if (!first_.empty()) gl::draw_ranges(quads ? GL_TRIANGLES : GL_POINTS, first_, count_);
    first_.clear();
    count_.clear();
  };
  for (std::size_t r = 0; r < ranges.first.size(); ++r)
    for (int from = 0, points = ranges.count[r] / corners; from < points;) {
      const int n = int(gl::take_work(program.id(), std::uint64_t(points - from), ranges.units[r]));
      if (n > 0) {
        first_.push_back(ranges.first[r] + from * corners);
        count_.push_back(n * corners);
        from += n;
      } else {
        submit();
        gl::end_stretch();
      }
    }
  submit();
}

void SplatRaster::draw_list(GpuCloud& cloud, std::size_t chunk, const View& view, const SplatShape& shape,
                            const gl::TextureBuffer& list, GLint first, GLsizei count, bool as_quads,
                            const gl::State& state, const SetUniforms& set_uniforms) {
  view.bind();
  state.apply();
  bind(cloud, cloud.chunks()[chunk]);
  list.bind(binding::list);
  gl::Program& used = program(cloud, shape, as_quads, true, set_uniforms);
  used.use();
  gl::draw_items(used, as_quads ? GL_TRIANGLES : GL_POINTS, std::uint64_t(first), std::uint64_t(count),
                 as_quads ? 6 : 1);
}

void SplatRaster::draw_list(GpuCloud& cloud, std::size_t chunk, const View& view, const SplatShape& shape,
                            const gl::TextureBuffer& list, const gl::Buffer& command, const gl::State& state,
                            const SetUniforms& set_uniforms) {
  view.bind();
  state.apply();
  bind(cloud, cloud.chunks()[chunk]);
  list.bind(binding::list);
  gl::Program& used = program(cloud, shape, false, true, set_uniforms);
  used.use();
  if (gl::has_slices()) {
    std::uint32_t count = 0;  // by compute, for which software GL has waited already
    command.download(&count, sizeof count);
    gl::draw_items(used, GL_POINTS, 0, count, 1);
    return;
  }
  gl::draw_indirect(GL_POINTS, command);
}

}  // namespace sfumato
