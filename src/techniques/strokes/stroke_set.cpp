#include "techniques/strokes/stroke_set.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "gl/commands.h"
#include "gl/context.h"
#include "gl/draw.h"
#include "passes/bindings.h"

namespace sfumato::strokes {
namespace {

constexpr unsigned group_size = Compaction::group_size;

/// Makes the batches whose strokes the view may see the chunk's visible ones; returns the groups of the
/// largest.
unsigned show_batches(GpuCloud& cloud, GpuCloud::Chunk& chunk, const View& view, float least_length) {
  std::vector<glm::uvec2> ranges;
  for (std::uint32_t b = 0; b < chunk.batch_count; ++b) {
    const Batch& batch = cloud.prepared().batches[chunk.first_batch + b];
    const vec3 middle = 0.5f * (batch.box_min + batch.box_max);
    const double away =
        -(view.eye_from_cloud() * glm::dvec4(middle, 1)).z + 0.5 * glm::length(batch.box_max - batch.box_min);
    const double pixel =
        (view.camera().orthographic() ? 1 : std::max(away, 0.0)) / view.camera().pixels_per_unit();
    const vec3 reach(std::max(16 * batch.spacing, float(2 * least_length * view.picture_height() * pixel)));
    if (!view.may_see(batch.box_min - reach, batch.box_max + reach)) continue;
    ranges.emplace_back(batch.first - chunk.first, batch.count);
  }
  return (GpuCloud::show(chunk, ranges) + group_size - 1) / group_size;
}

float least_half_length(const Look& look, float share) {
  // The painted part of the quad is about the root of its share long.
  return 0.5f * look.length_percent / 100 / std::sqrt(share);
}

}  // namespace

void BrushPicture::update(const Brush& brush) {
  if (picture_ && made_ == brush) return;
  constexpr int size = tiles * tile_size;
  if (!picture_) {
    plain_ = gl::Texture("plain brush", GL_RGBA32F, size, size);
    picture_ = gl::Texture("brush", GL_RGBA32F, size, size, levels);
    picture_.set_trilinear_filter();
    paint_ = ScreenPass("techniques/strokes/brush.glsl", {GL_RGBA32F}, {"STEP 0"});
    slopes_ = ScreenPass("techniques/strokes/brush.glsl", {GL_RGBA32F}, {"STEP 1"});
  }
  paint_.set("brush_kind", int(brush.kind)).set("brush_grid", ivec2(brush.columns, brush.rows));
  paint_.set("amplitude", brush.amplitude).set("center_separation", brush.center_separation);
  paint_.set("shape_exponent", brush.shape_exponent).set("sigma", vec2(brush.sigma_x, brush.sigma_y));
  paint_.set("noise", glm::radians(brush.noise_deg))
      .set("bristles", brush.bristles)
      .set("tile_size", tile_size);
  paint_.run({}, {&plain_});
  slopes_.run({&plain_}, {&picture_});
  gl::make_mipmap(picture_);
  measure();
  share_ = covered_share(brush);
  made_ = brush;
}

void BrushPicture::measure() {
  for (int level = 0; level < levels; ++level) {
    images_[level] = gl::Texture::view(picture_, level).download<vec4>();
    const Image<vec4>& image = images_[level];
    const int n = tile_size >> level;
    for (auto& profile : profiles_[level]) profile.assign(std::size_t(n / 2), 0);
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) {
        const int at[2] = {x % n, y % n};
        for (int axis = 0; axis < 2; ++axis) {
          float& most =
              profiles_[level][axis][std::size_t(at[axis] < n / 2 ? n / 2 - 1 - at[axis] : at[axis] - n / 2)];
          most = std::max(most, image.at(x, y).x);
        }
      }
  }
}

BrushPicture::Reach BrushPicture::reach(float alpha) const {
  Reach out;
  for (int level = 0; level < levels; ++level)
    for (int axis = 0; axis < 2; ++axis) {
      const std::vector<float>& most = profiles_[level][axis];
      std::size_t k = most.size();  // texels that reach it
      while (k > 0 && most[k - 1] < alpha) --k;
      float texels = float(most.size());
      // Linear between the middles of texels; a trace more for rounding.
      if (k == 0)
        texels = 0;
      else if (k < most.size())
        texels = float(k) - 0.45f + (most[k - 1] - alpha) / (most[k - 1] - most[k]);
      (axis == 0 ? out.along : out.across)[level] = texels / float(most.size());
    }
  return out;
}

void StrokeSet::set_sizes(gl::Program& program) const {
  program.set("stroke_aspect", look_.aspect).set("stroke_share", share_).set("coverage", look_.coverage);
  program.set("least_length", least_half_length(look_, share_))
      .set("two_layers", two_layers_)
      .set("detail", look_.detail)
      .set("evidence", vec2(evidence_.beside, evidence_.between));
}

std::uint32_t StrokeSet::select(GpuCloud& cloud, std::size_t c, const StrokeData& data, const View& view) {
  GpuCloud::Chunk& chunk = cloud.chunks()[c];
  const unsigned groups_per_batch = show_batches(cloud, chunk, view, least_half_length(look_, share_));
  if (chunk.visible_batches == 0) return 0;

  view.bind();
  cloud.bind_geometry(chunk);
  data.bind(c);
  if (!select_) select_ = gl::Program::compute("techniques/strokes/stroke_select.comp");
  set_sizes(select_);
  select_.set("slots_per_batch", groups_per_batch * group_size);
  chosen_.bind_flags(groups_per_batch, chunk.visible_batches, std::size_t(chunk.count) * 2);  // two layers
  select_.dispatch(groups_per_batch, chunk.visible_batches);
  chosen_.run();
  std::uint32_t count = 0;
  chosen_.command().download(&count, 4);
  return count;
}

void StrokeSet::update(GpuCloud& cloud, const StrokeData& data, const View& view, const Look& look,
                       const BrushPicture& brush, float noise_deg, bool two_layers, bool strict) {
  look_ = look;
  share_ = brush.share();
  two_layers_ = two_layers;
  count_ = 0;
  if (!setup_) setup_ = gl::Program::compute("techniques/strokes/stroke_setup.comp");
  for (std::size_t c = 0; c < cloud.chunks().size(); ++c) {
    const std::uint32_t count = select(cloud, c, data, view);
    if (count == 0) continue;
    const std::size_t bytes = (std::size_t(count_) + count) * record_texels * 16;
    gl::require(bytes / 16 <= std::size_t(gl::limits().max_texture_buffer_size),
                "strokes: " + std::to_string(count_ + count) + " strokes in this view",
                "larger texture buffers (or a larger --stroke-length, or --max-points)");
    if (records_.buffer().bytes() < bytes) {
      gl::TextureBuffer larger("strokes", GL_RGBA32UI, bytes + bytes / 3);
      if (count_ > 0) gl::copy(records_.buffer(), larger.buffer(), count_ * record_texels * 16);
      gl::Buffer more_keys("distances of strokes", larger.buffer().bytes() / (record_texels * 16) * 4);
      if (count_ > 0) gl::copy(keys_, more_keys, count_ * 4);
      records_ = std::move(larger);
      keys_ = std::move(more_keys);
    }
    GpuCloud::Chunk& chunk = cloud.chunks()[c];
    view.bind();
    cloud.bind_geometry(chunk);
    cloud.bind_normals(chunk);
    cloud.bind_colors(chunk);
    if (cloud.has_shadow()) cloud.bind_shadow(chunk);
    data.bind(c);
    chosen_.list().bind(binding::list);
    records_.buffer().bind_storage(0);
    keys_.bind_storage(1);
    set_sizes(setup_);
    setup_.set("stroke_count", int(count))
        .set("first_record", int(count_))
        .set("noise", glm::radians(noise_deg));
    setup_.set("opacity", look.opacity).set("variation", strict ? 0.0f : look.variation);
    setup_.set("saturation", strict ? 1.0f : look.saturation);
    setup_.set("flatten", strict ? 0.0f : look.flatten).set("second_lightness", strict ? 0.0f : 0.08f);
    setup_.set("divided_color", strict ? 0.0f : look.divided_color);
    setup_.set("has_shadow", cloud.has_shadow());
    setup_.set("is_one_place", !(cloud.bounds().diagonal() > 0));
    setup_.dispatch_rows((count + 63) / 64);
    gl::barrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    count_ += count;
  }
  if (count_ == 0) return;
  gl::grow(elements_, "corners of strokes", std::size_t(count_) * 24);
  depth_sort_.run(keys_, count_, {}, false);
  if (!arrange_) arrange_ = gl::Program::compute("techniques/strokes/stroke_elements.comp");
  depth_sort_.order().bind(binding::list);
  elements_.bind_storage(0);
  arrange_.set("stroke_count", int(count_)).dispatch_rows((count_ + 63) / 64);
  gl::barrier(GL_ELEMENT_ARRAY_BARRIER_BIT);
}

void StrokeSet::hide(const View& view, const gl::Texture& opaque_depth) {
  if (count_ == 0) return;
  if (!hide_) {
    hide_ = gl::Program::compute("techniques/strokes/stroke_elements.comp", {"HIDE"});
    farthest_ = ScreenPass("techniques/strokes/farthest_opaque.glsl", {GL_R32F});
  }
  gl::ensure(farthest_depth_, "farthest opaque stroke", GL_R32F, (view.width() + 7) / 8,
             (view.height() + 7) / 8);
  gl::grow(visible_elements_, "corners of visible strokes", std::size_t(count_) * 24);
  view.bind();
  farthest_.run({&opaque_depth}, {&farthest_depth_});
  records_.bind(binding::input);
  farthest_depth_.bind(binding::input + 1);
  depth_sort_.order().bind(binding::list);
  visible_elements_.bind_storage(0);
  hide_.set("stroke_count", int(count_)).dispatch_rows((count_ + 63) / 64);
  gl::barrier(GL_ELEMENT_ARRAY_BARRIER_BIT);
}

void StrokeSet::draw(gl::Program& program, const BrushPicture& brush, float least_alpha,
                     const gl::Buffer& elements) const {
  const BrushPicture::Reach reach = brush.reach(least_alpha / look_.opacity);
  if (count_ == 0 || reach.along == vec4(0)) return;
  records_.bind(binding::input);
  brush.texture().bind(binding::input + 1);
  program.set("reach_along", reach.along).set("reach_across", reach.across);
  program.use();
  gl::bind_elements(elements);
  gl::draw_indexed_items(program, GL_TRIANGLES, count_, 6);
}

}  // namespace sfumato::strokes
