#include "techniques/denoise/bins.h"

#include "gl/context.h"
#include "passes/bindings.h"

namespace sfumato::denoise {
namespace {

/// Texture buffers in units behind the textures of a screen pass.
void bind_after(int textures, const gl::TextureBuffer& buffer) { buffer.bind(binding::input + textures); }

void bind_image(int unit, const gl::TextureBuffer& buffer, GLenum format) {
  glBindImageTexture(GLuint(unit), buffer.texture(), 0, GL_FALSE, 0, GL_READ_WRITE, format);
}

void grow(gl::TextureBuffer& buffer, const char* label, GLenum format, std::size_t words) {
  gl::require(words <= std::size_t(gl::limits().max_texture_buffer_size),
              "denoise with " + std::to_string(words) + " table slots",
              "larger texture buffers; use fewer hash_bits (or dense_bins), or a smaller --resolution");
  if (buffer.buffer().bytes() != 4 * words) buffer = gl::TextureBuffer(label, format, 4 * words);
}

void finish_atomics() {
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace

gl::Defines BinTable::defines(const BinOptions& options) const {
  gl::Defines list;
  if (options.layout == Layout::dense) list.push_back("DENSE");
  if (options.overlapping) list.push_back("OVERLAPPING");
  if (options.fast) list.push_back("FAST");
  return list;
}

namespace {

int variant(const BinOptions& options) {
  return (options.layout == Layout::dense ? 1 : 0) + (options.overlapping ? 2 : 0) + (options.fast ? 4 : 0);
}

}  // namespace

void BinTable::allocate(const View& view, const BinOptions& options, bool shadow) {
  const std::size_t pixels = std::size_t(view.width()) * std::size_t(view.height());
  slots_ = options.layout == Layout::dense ? options.dense_bins : 1 << options.hash_bits;
  stride_ = options.fast ? 0 : shadow ? 9 : 8;
  grow(weights_, "bin weights", options.fast ? GL_R32F : GL_R32UI, pixels * std::size_t(slots_));
  weights_.buffer().clear(0);
  if (options.layout == Layout::hashed) {
    grow(keys_, "bin keys", GL_R32UI, pixels * std::size_t(slots_));
    keys_.buffer().clear(0);
  } else {
    keys_ = {};
  }
  grow(counters_, "bin counters", GL_R32UI, 2);
  counters_.buffer().clear(0);
  gl::ensure(first_bin_, "first bin", GL_R32UI, view.width(), view.height());
  first_bin_.clear_uint(0xffffffffu);
  gl::ensure(sink_, "no colour", GL_R8, view.width(), view.height());
  if (options.fast) {
    sums_ = {};
    gl::ensure(color_sum_, "sum of colours", GL_RGBA32F, view.width(), view.height());
    gl::ensure(normal_sum_, "sum of normals", GL_RGBA32F, view.width(), view.height());
    color_sum_.clear(vec4(0));
    normal_sum_.clear(vec4(0));
    if (shadow) {
      gl::ensure(shadow_sum_, "sum of shadow factors", GL_R32F, view.width(), view.height());
      shadow_sum_.clear(vec4(0));
    }
  } else {
    for (gl::Texture* texture : {&color_sum_, &normal_sum_, &shadow_sum_}) *texture = gl::Texture();
    grow(sums_, "bin sums", GL_R32UI, pixels * std::size_t(stride_));
    sums_.buffer().clear(0);
  }
}

void BinTable::set_uniforms(gl::Program& program, const BinOptions& options, const View& view) const {
  program.set("bin_size", options.bin_size).set("anchor_grid", options.anchor == Anchor::grid);
  program.set("slots", slots_).set("hash_bits", options.hash_bits).set("image_width", view.width());
  program.set("weight_threshold", options.weight_threshold).set("pixel_splats", options.pixel_splats);
}

void BinTable::add_weights(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                           const gl::Texture& nearest_t, const BinOptions& options) {
  SplatRaster& raster = weight_raster_[variant(options)];
  if (!raster) raster = SplatRaster("techniques/denoise/weights.frag", defines(options));
  SplatShape supported = shape;
  if (options.support) {  // makes the field known to the shader, and lets every splat pass
    supported.part = SplatPart::above;
    supported.field_threshold = -1;
  }
  gl::Framebuffer framebuffer({&sink_});
  framebuffer.bind();
  nearest_t.bind(binding::input);
  bind_image(0, weights_, options.fast ? GL_R32F : GL_R32UI);
  if (keys_) bind_image(1, keys_, GL_R32UI);
  first_bin_.bind_image(2, GL_READ_WRITE);
  bind_image(3, counters_, GL_R32UI);
  raster.draw(cloud, view, supported, batches, {}, [&](gl::Program& program) {
    set_uniforms(program, options, view);
    program.set("reach", unsigned(options.peak_bins));
  });
  finish_atomics();
}

void BinTable::add_attributes(GpuCloud& cloud, const View& view, const SplatShape& shape,
                              const SplatBatches& batches, const gl::Texture& nearest_t, const BinOptions& options) {
  const bool shadow = cloud.has_shadow();
  SplatRaster& raster = attribute_raster_[variant(options) + (shadow ? 8 : 0)];
  if (!raster) {
    gl::Defines list = defines(options);
    list.push_back("SPLAT_COLOR");
    if (shadow) list.push_back("SPLAT_SHADOW");
    raster = SplatRaster("techniques/denoise/attributes.frag", list);
  }
  auto draw_into = [&](const gl::Framebuffer& framebuffer, const gl::State& state) {
    framebuffer.bind();
    nearest_t.bind(binding::input);
    choice_.bind(binding::input + 1);
    raster.draw(cloud, view, shape, batches, state, [&](gl::Program& program) {
      set_uniforms(program, options, view);
      if (!options.fast) program.set("sum_stride", stride_);
    });
  };
  if (!options.fast) {
    bind_image(0, sums_, GL_R32UI);
    draw_into(gl::Framebuffer({&sink_}), {});
  } else if (shadow) {
    draw_into(gl::Framebuffer({&color_sum_, &normal_sum_, &shadow_sum_}), {.blend = gl::State::Blend::add});
  } else {
    draw_into(gl::Framebuffer({&color_sum_, &normal_sum_}), {.blend = gl::State::Blend::add});
  }
  finish_atomics();
}

void BinTable::draw(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                    const gl::Texture& nearest_t, const BinOptions& options, bool show_weight,
                    const SplatSurfaceTargets& targets, gl::Timers& timers) {
  const bool shadow = cloud.has_shadow();
  {
    auto timing = timers.scope("clear bins");
    allocate(view, options, shadow);
  }
  {
    auto timing = timers.scope("weights");
    add_weights(cloud, view, shape, batches, nearest_t, options);
  }
  view.bind();
  {
    auto timing = timers.scope("choose");
    gl::ensure(choice_, "chosen bin", GL_RGBA32F, view.width(), view.height());
    ScreenPass& choose = choose_[variant(options)];
    if (!choose) choose = ScreenPass("techniques/denoise/choose.glsl", {GL_RGBA32F}, defines(options));
    set_uniforms(choose.program(), options, view);
    choose.set("peak_share", options.peak_share).set("peak_bins", options.peak_bins);
    choose.set("heaviest_bin", options.heaviest_bin).set("last_bin", options.miss == Miss::last_bin);
    bind_after(2, weights_);
    if (keys_) bind_after(3, keys_);
    choose.run({&nearest_t, &first_bin_}, {&choice_});
  }
  {
    auto timing = timers.scope("attributes");
    add_attributes(cloud, view, shape, batches, nearest_t, options);
  }
  auto timing = timers.scope("resolve");
  view.bind();
  gl::ensure(targets.albedo, "albedo", GL_RGBA32F, view.width(), view.height());
  ScreenPass& resolve = resolve_[variant(options) + (shadow ? 8 : 0)];
  if (!resolve) {
    gl::Defines list = defines(options);
    if (shadow) list.push_back("SPLAT_SHADOW");
    resolve = ScreenPass("techniques/denoise/resolve.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F}, list);
  }
  set_uniforms(resolve.program(), options, view);
  resolve.set("show_weight", show_weight).set("least_support", options.least_support);
  if (options.fast) {
    resolve.run({&nearest_t, &choice_, &color_sum_, &normal_sum_, shadow ? &shadow_sum_ : &color_sum_},
                {&targets.albedo, &targets.depth, &targets.normal});
  } else {
    resolve.set("sum_stride", stride_);
    bind_after(2, sums_);
    resolve.run({&nearest_t, &choice_}, {&targets.albedo, &targets.depth, &targets.normal});
  }
}

BinCounts BinTable::counts() const {
  BinCounts counts;
  if (counters_) counters_.buffer().download(&counts, sizeof counts);
  return counts;
}

std::size_t BinTable::bytes() const {
  std::size_t sum = weights_.buffer().bytes() + keys_.buffer().bytes() + sums_.buffer().bytes();
  for (const gl::Texture* texture : {&color_sum_, &normal_sum_})
    if (*texture) sum += std::size_t(texture->width()) * std::size_t(texture->height()) * 16;
  return sum;
}

}  // namespace sfumato::denoise
