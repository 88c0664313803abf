#include "techniques/soft/soft_points.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "analysis/quantiles.h"
#include "gl/commands.h"
#include "gl/context.h"
#include "gl/draw.h"
#include "passes/bindings.h"
#include "passes/shade.h"

namespace sfumato::soft {
namespace {

/// Unsigned numbers in the order of the floats.
std::uint32_t ascending(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

}  // namespace

std::vector<float> haze_radii(const PreparedCloud& prepared) {
  std::vector<float> radii = prepared.cloud.radii;
  const std::vector<float>& shrunk = prepared.shrunk;
  // No more than two medians: along a wire Eq. 20 has the size of the gaps, not of anything there.
  const float most = 2 * prepared.median_radius;
  for (std::size_t i = 0; i < shrunk.size(); ++i)
    radii[i] = std::max(radii[i], std::min(radii[i] / shrunk[i], most));
  return radii;
}

void SoftPoints::choose(GpuCloud& cloud, std::span<const float> field, float threshold,
                        const std::vector<float>* radii_of_all) {
  const PointCloud& points = cloud.prepared().cloud;
  const bool same_field = field_ && field_ == cloud.field();
  if (same_field && threshold == threshold_) return;
  if (!same_field) by_source_ = radix_order(points.source_index, {});
  cloud_ = &points;
  field_ = cloud.field();
  threshold_ = threshold;

  std::vector<std::uint32_t> slots(points.size());
  places_.clear();
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (field[i] > threshold) {
      slots[i] = std::uint32_t(places_.size());
      places_.push_back(i);
    }
  initial_.clear();
  for (std::uint32_t i : by_source_)
    if (field[i] > threshold) initial_.push_back(slots[i]);
  chosen_anew_ = true;
  sorted_ = false;
  axis_orders_ = {};
  if (!same_field) {
    radii_ = haze_radii(cloud.prepared());
    own_radii_ = cloud.prepared().shrunk.empty() ? nullptr : cloud.make_shapes({}, radii_);
  }
  std::vector<float> radii;
  if (radii_of_all)
    radii = *radii_of_all;
  else
    for (std::uint32_t i : places_) radii.push_back(radii_[i]);
  radius_limit_ = std::max(2 * analysis::quantile(radii, 0.5), analysis::quantile(radii, 0.9));

  gl::require(count() <= std::uint64_t(gl::limits().max_texture_buffer_size),
              std::to_string(count()) + " soft points",
              "larger texture buffers (or a higher field_threshold)");
  lists_.clear();
  auto first = places_.begin();
  for (const GpuCloud::Chunk& chunk : cloud.chunks()) {
    const auto last = std::lower_bound(first, places_.end(), chunk.first + chunk.count);
    std::vector<std::uint32_t> within(first, last);
    for (std::uint32_t& place : within) place -= chunk.first;
    lists_.emplace_back("soft points", GL_R32UI, std::span<const std::uint32_t>(within));
    first = last;
  }
  shapes_ = gl::TextureBuffer("soft shapes", GL_RGBA32F, count() * 16);
  looks_ = gl::TextureBuffer("soft looks", GL_RGBA32UI, count() * 16);
  boxes_ = gl::TextureBuffer("soft boxes", GL_RG32UI, count() * 8);
  keys_ = gl::Buffer("soft depths", count() * 4);
}

void SoftPoints::update(Frame& frame, const View& view, const Look& look, const gl::Texture& solid_t) {
  const vec3 sizes(look.shape.radius_scale, look.shape.radius_limit, look.antialias ? 1 : 0);
  if (sizes != sorted_sizes_) sorted_ = false;
  sorted_sizes_ = sizes;
  if (!fill_) fill_ = gl::Program::compute("techniques/soft/points.comp", {"SPLAT_SPHERE"});
  GpuCloud& cloud = frame.cloud;
  set_splat_uniforms(fill_, look.shape);
  set_light_uniforms(fill_, view, frame.settings, frame.light, cloud.prepared().cloud.origin);
  const Phong& phong = frame.settings.phong;
  fill_.set("phong", vec4(phong.ambient.value(), phong.diffuse.value(), 0, 1))
      .set("shading", int(frame.settings.shading));
  fill_.set("opacity", look.opacity).set("field_threshold", look.field_threshold);
  fill_.set("modulation_threshold", look.modulation_threshold)
      .set("modulation_opacity", look.modulation_opacity);
  fill_.set("smallest_px", look.antialias ? 1.0f : 0.0f);
  fill_.set("concentric_count", look.concentric_count)
      .set("concentric_spacing_px", look.concentric_spacing_px);
  view.bind();
  solid_t.bind(binding::input);
  shapes_.buffer().bind_storage(0);
  looks_.buffer().bind_storage(1);
  keys_.bind_storage(2);
  boxes_.buffer().bind_storage(3);
  std::uint32_t slot = 0;
  for (std::size_t c = 0; c < cloud.chunks().size(); ++c) {
    const std::uint32_t points = std::uint32_t(lists_[c].buffer().bytes() / 4);
    if (points == 0) continue;
    GpuCloud::Chunk& chunk = cloud.chunks()[c];
    cloud.bind_geometry(chunk);
    cloud.bind_normals(chunk);
    cloud.bind_radii(chunk);
    cloud.bind_colors(chunk);
    cloud.bind_shadow(chunk);
    cloud.bind_field(chunk);
    lists_[c].bind(binding::list);
    fill_.set("point_count", points).set("first_slot", slot);
    fill_.dispatch_rows((points + 127) / 128);
    slot += points;
  }
  gl::barrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

Order SoftPoints::far_to_near(const View& view) {
  // What another lens or another part of a picture sees was left out of the order.
  const dmat4 projection = view.camera().projection_matrix();
  if (!sorted_ || sorted_view_ != view.eye_from_cloud() || sorted_projection_ != projection) {
    depth_sort_.run(keys_, count(), initial_, chosen_anew_);
    chosen_anew_ = false;
    sorted_ = true;
    sorted_view_ = view.eye_from_cloud();
    sorted_projection_ = projection;
  }
  return {&depth_sort_.order(), 0, 1, depth_sort_.drawn()};
}

Order SoftPoints::along_axis(int axis, bool positive) {
  gl::TextureBuffer& order = axis_orders_[std::size_t(axis)];
  if (!order) {
    std::vector<std::uint32_t> keys(count());
    for (std::uint32_t slot = 0; slot < count(); ++slot)
      keys[slot] = ascending(cloud_->positions[places_[slot]][axis]);
    order = gl::TextureBuffer("order along an axis", GL_R32UI,
                              std::span<const std::uint32_t>(radix_order(keys, initial_)));
  }
  // Looking along +axis, far points have large coordinates: backwards.
  return positive ? Order{&order, int(count()) - 1, -1, count()} : Order{&order, 0, 1, count()};
}

void SoftPoints::draw(gl::Program& program, bool as_quads, const gl::Texture& solid_t, const gl::State& state,
                      const Order* order) {
  shapes_.bind(binding::input);
  looks_.bind(binding::input + 1);
  solid_t.bind(binding::input + 2);
  const std::uint32_t drawn = order ? order->count : count();
  if (order) {
    order->list->bind(binding::list);
    program.set("order_first", order->first).set("order_step", order->step);
  }
  state.apply();
  program.use();
  gl::draw_items(program, as_quads ? GL_TRIANGLES : GL_POINTS, 0, drawn, as_quads ? 6 : 1);
}

}  // namespace sfumato::soft
