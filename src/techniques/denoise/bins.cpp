#include "techniques/denoise/bins.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "gl/commands.h"
#include "gl/context.h"
#include "passes/bindings.h"
#include "techniques/denoise/bins_cpu.h"

namespace sfumato::denoise {
namespace {

/// Texture buffers in units behind the textures of a screen pass.
void bind_after(int textures, const gl::TextureBuffer& buffer) { buffer.bind(binding::input + textures); }

void bind_image(int unit, const gl::TextureBuffer& buffer, GLenum format) {
  gl::bind_image(unit, buffer, GL_READ_WRITE, format);
}

void resize(gl::TextureBuffer& buffer, const char* label, GLenum format, std::size_t words) {
  gl::require(words <= std::size_t(gl::limits().max_texture_buffer_size),
              "denoise with " + std::to_string(words) + " table slots",
              "larger texture buffers; use a smaller --resolution, or fewer dense_bins");
  if (buffer.buffer().bytes() != 4 * words) buffer = gl::TextureBuffer(label, format, 4 * words);
}

/// Whoever read it before is done: loops have found the nearest hits since, or a picture was downloaded.
void clear(gl::TextureBuffer& buffer) {
  if (!SplatCpu::is_used()) {
    buffer.buffer().clear(0);
    return;
  }
  auto* words = static_cast<std::uint32_t*>(buffer.buffer().memory_to_write());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, buffer.buffer().bytes() / 4, 1 << 16),
                    [&](const auto& range) { std::fill(words + range.begin(), words + range.end(), 0u); });
}

/// The words of a buffer that has been cleared: its own where loops write them, else a copy. Null: there is
/// none.
struct Words {
  explicit Words(gl::TextureBuffer& of) : buffer(of) {
    if (!buffer) return;
    if (SplatCpu::is_used()) {
      all = static_cast<std::uint32_t*>(buffer.buffer().memory_to_write());
    } else {
      copy.resize(buffer.buffer().bytes() / sizeof(std::uint32_t));
      all = copy.data();
    }
  }
  void read() {
    if (!copy.empty()) buffer.buffer().download(all, buffer.buffer().bytes());
  }
  void write() {
    if (!copy.empty()) buffer.buffer().upload(all, buffer.buffer().bytes());
  }
  gl::TextureBuffer& buffer;
  std::vector<std::uint32_t> copy;
  std::uint32_t* all = nullptr;
};

/// Of a pixel: what texture buffers hold.
std::size_t most_slots(const View& view) {
  return std::size_t(gl::limits().max_texture_buffer_size) /
         (std::size_t(view.width()) * std::size_t(view.height()));
}

void finish_atomics() {
  gl::barrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
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
  if (options.fast != fast_) weights_ = {}, sums_ = {};  // same size, another format
  fast_ = options.fast;
  slots_ = options.layout == Layout::dense ? options.dense_bins : 1 << options.hash_bits;
  stride_ = shadow ? sums_of_pixel : sums_of_pixel - 1;
  resize(weights_, "bin weights", options.fast ? GL_R32F : GL_R32UI, pixels * std::size_t(slots_));
  clear(weights_);
  if (options.layout == Layout::hashed) {
    resize(keys_, "bin keys", GL_R32UI, pixels * std::size_t(slots_));
    clear(keys_);
  } else {
    keys_ = {};
  }
  resize(counters_, "bin counters", GL_R32UI, 2);
  counters_.buffer().clear(0);
  gl::ensure(first_bin_, "first bin", GL_R32UI, view.width(), view.height());
  first_bin_.clear_uint(0xffffffffu);
  gl::ensure(sink_, "no colour", GL_R8, view.width(), view.height());
  resize(sums_, "bin sums", options.fast ? GL_R32F : GL_R32UI, pixels * std::size_t(stride_));
  clear(sums_);
}

void BinTable::set_uniforms(gl::Program& program, const BinOptions& options, const View& view) const {
  program.set("bin_size", options.bin_size).set("anchor_grid", options.anchor == Anchor::grid);
  program.set("slots", slots_).set("hash_bits", options.hash_bits).set("image_width", view.width());
  program.set("weight_threshold", options.weight_threshold);
  program.set("covers", options.covers).set("surface_share", options.surface_share);
}

gl::Program& BinTable::small_program(std::map<int, gl::Program>& programs, int key, const char* file,
                                     gl::Defines list, const SplatShape& shape) const {
  gl::Program& program = programs[2 * key + (shape.prefilter_px > 0) + 64 * (shape.part != SplatPart::all)];
  if (!program) program = gl::Program::compute(file, splat_defines(std::move(list), shape));
  set_splat_uniforms(program, shape);
  return program;
}

void BinTable::add_weights(const Hits& hits, const BinOptions& options) {
  const auto& [cloud, view, shape, batches, nearest_t, asked, timers] = hits;
  auto timing = timers.scope("weights");
  if (SplatCpu::is_used() && !options.fast) {  // sums of the loop are no floats
    Image<std::uint32_t> first_bin(view.width(), view.height(), 0xffffffffu);
    const BinCounts counts =
        denoise::add_weights(cloud, view, shape, batches, nearest_t.peek<float>(), options,
                             {Words(weights_).all, Words(keys_).all, slots_, first_bin});
    first_bin_.upload(first_bin);
    counters_.buffer().upload(&counts, sizeof counts);
    return;
  }
  SplatRaster& raster = weight_raster_[variant(options)];
  if (!raster) raster = SplatRaster("techniques/denoise/weights.frag", defines(options));
  gl::Framebuffer framebuffer({&sink_});
  framebuffer.bind();
  nearest_t.bind(binding::input);
  bind_image(0, weights_, options.fast ? GL_R32F : GL_R32UI);
  if (keys_) bind_image(1, keys_, GL_R32UI);
  first_bin_.bind_image(2, GL_READ_WRITE);
  bind_image(3, counters_, GL_R32UI);
  auto set = [&](gl::Program& program) {
    set_uniforms(program, options, hits.view);
    program.set("reach", unsigned(options.peak_bins));
  };
  gl::Program& small = small_program(weight_small_, variant(options), "techniques/denoise/weights.comp",
                                     defines(options), shape);
  set(small);
  visit_small(cloud, view, batches, small);
  raster.draw(cloud, view, shape, batches, {}, set, false);
  finish_atomics();
}

void BinTable::agree(const Hits& hits, const BinOptions& options, float reach) {
  const View& view = hits.view;
  ScreenPass& agree = agree_[variant(options)];
  if (!agree) agree = ScreenPass("techniques/denoise/agree.glsl", {GL_RGBA32F}, defines(options));
  gl::ensure(agreed_, "agreed bin", GL_RGBA32F, view.width(), view.height());
  set_uniforms(agree.program(), options, view);
  agree.set("peak_bins", options.peak_bins);
  agree.set("splat_reach", reach).set("reach_least_px", std::max(hits.shape.prefilter_px, 1.0f));
  bind_after(2, weights_);
  if (keys_) bind_after(3, keys_);
  agree.run({&hits.nearest_t, &choice_}, {&agreed_});
  std::swap(choice_, agreed_);
}

void BinTable::add_attributes(const Hits& hits, const BinOptions& options) {
  const auto& [cloud, view, shape, batches, nearest_t, asked, timers] = hits;
  auto timing = timers.scope("attributes");
  if (SplatCpu::is_used() && !options.fast) {
    denoise::add_attributes(cloud, view, shape, batches, nearest_t.peek<float>(), choice_.peek<vec4>(),
                            options, {Words(sums_).all, stride_});
    return;
  }
  const bool shadow = cloud.has_shadow();
  SplatRaster& raster = attribute_raster_[variant(options) + (shadow ? 8 : 0)];
  if (!raster) {
    gl::Defines list = defines(options);
    list.push_back("SPLAT_COLOR");
    if (shadow) list.push_back("SPLAT_SHADOW");
    raster = SplatRaster("techniques/denoise/attributes.frag", list);
  }
  bind_image(0, sums_, options.fast ? GL_R32F : GL_R32UI);
  gl::Framebuffer framebuffer({&sink_});
  framebuffer.bind();
  nearest_t.bind(binding::input);
  choice_.bind(binding::input + 1);
  auto set = [&](gl::Program& program) {
    set_uniforms(program, options, hits.view);
    program.set("sum_stride", stride_);
  };
  gl::Defines list = defines(options);
  if (shadow) list.push_back("SPLAT_SHADOW");
  gl::Program& small = small_program(attribute_small_, variant(options) + (shadow ? 8 : 0),
                                     "techniques/denoise/attributes.comp", std::move(list), shape);
  set(small);
  small.set("splat_has_shadow", shadow);
  farthest_end_.bind(binding::input + 2);
  visit_small(cloud, view, batches, small, true);
  raster.draw(cloud, view, shape, batches, {}, set, false);
  finish_atomics();
}

/// After an overflow: the next larger table. False when all splats found room.
///
/// Which bins overflow depends on the order of the points; what a table without overflow says does not. A bin
/// further away than the memory reaches is the last resort: dense bins need no keys, and the last one takes
/// the rest.
bool BinTable::grow(BinOptions& options, const View& view) {
  if (options.layout == Layout::dense || counts().overflow == 0) return false;
  constexpr int most_bits = 8;
  const std::size_t most = most_slots(view);
  if (options.hash_bits < most_bits && (std::size_t(2) << options.hash_bits) <= most) {
    grown_bits_ = ++options.hash_bits;
    return true;
  }
  options.layout = Layout::dense;
  options.dense_bins = int(std::min<std::size_t>(most, 256));
  return true;
}

BinOptions BinTable::fill(const Hits& hits, bool shadow, const std::function<void(const BinOptions&)>& add) {
  const BinOptions& asked = hits.options;
  BinOptions options = asked;
  chosen_ = 0;
  if (asked_bits_ != asked.hash_bits) asked_bits_ = grown_bits_ = asked.hash_bits;
  options.hash_bits = grown_bits_;  // an orbit grows once
  // A small picture may have grown it beyond what a large one has room for.
  while (options.hash_bits > asked.hash_bits && (std::size_t(1) << options.hash_bits) > most_slots(hits.view))
    --options.hash_bits;
  do {
    {
      auto timing = hits.timers.scope("clear bins");
      allocate(hits.view, options, shadow);
    }
    add(options);
  } while (grow(options, hits.view));
  return options;
}

void BinTable::choose(const Hits& hits, const BinOptions& options) {
  const View& view = hits.view;
  view.bind();
  auto timing = hits.timers.scope("choose");
  gl::ensure(choice_, "chosen bin", GL_RGBA32F, view.width(), view.height());
  ScreenPass& choose = choose_[variant(options)];
  if (!choose) choose = ScreenPass("techniques/denoise/choose.glsl", {GL_RGBA32F}, defines(options));
  set_uniforms(choose.program(), options, view);
  choose.set("peak_share", options.peak_share).set("peak_bins", options.peak_bins);
  choose.set("heaviest_bin", options.heaviest_bin).set("last_bin", options.miss == Miss::last_bin);
  bind_after(2, weights_);
  if (keys_) bind_after(3, keys_);
  choose.run({&hits.nearest_t, &first_bin_}, {&choice_});
  for (int round = 0; round < options.agree_rounds; ++round) agree(hits, options, options.splat_reach);
  if (options.wide_reach > 0) agree(hits, options, options.wide_reach);
  if (!farthest_) farthest_ = ScreenPass("techniques/denoise/farthest.glsl", {GL_R32F});
  gl::ensure(farthest_end_, "farthest end of a bin", GL_R32F, (view.width() + 7) / 8,
             (view.height() + 7) / 8);
  farthest_.run({&choice_}, {&farthest_end_});
  view.bind();
}

void BinTable::resolve(const Hits& hits, const BinOptions& options, bool show_weight,
                       const SplatSurfaceTargets& targets) {
  const View& view = hits.view;
  auto timing = hits.timers.scope("resolve");
  view.bind();
  gl::ensure(targets.albedo, "albedo", GL_RGBA32F, view.width(), view.height());
  const bool shadow = stride_ == sums_of_pixel;
  ScreenPass& resolve = resolve_[variant(options) + (shadow ? 8 : 0)];
  if (!resolve) {
    gl::Defines list = defines(options);
    if (shadow) list.push_back("SPLAT_SHADOW");
    resolve = ScreenPass("techniques/denoise/resolve.glsl", {GL_RGBA32F, GL_R32F, GL_RGBA32F}, list);
  }
  set_uniforms(resolve.program(), options, view);
  resolve.set("show_weight", show_weight);
  resolve.set("sum_stride", stride_);
  bind_after(2, sums_);
  resolve.run({&hits.nearest_t, &choice_}, {&targets.albedo, &targets.depth, &targets.normal});
}

void BinTable::draw(const Hits& hits, bool show_weight, const SplatSurfaceTargets& targets) {
  const BinOptions options =
      fill(hits, hits.cloud.has_shadow(), [&](const BinOptions& table) { add_weights(hits, table); });
  choose(hits, options);
  add_attributes(hits, options);
  resolve(hits, options, show_weight, targets);
}

std::vector<VisiblePoints::Bin> BinTable::bins_of(const Hits& hits) {
  fill(hits, false, [&](const BinOptions& table) { add_weights(hits, table); });
  Words weights(weights_), keys(keys_);
  weights.read(), keys.read();
  const Image<float> nearest = hits.nearest_t.download<float>();
  std::vector<VisiblePoints::Bin> bins;
  for (std::size_t pixel = 0; pixel < nearest.size(); ++pixel) {
    if (std::isinf(nearest.data()[pixel])) continue;
    const std::size_t first = bins.size(), base = pixel * std::size_t(slots_);
    for (std::uint32_t slot = 0; slot < std::uint32_t(slots_); ++slot)
      if (const std::uint32_t weight = weights.all[base + slot])
        bins.push_back({std::uint32_t(pixel), keys.all ? keys.all[base + slot] - 1 : slot, weight});
    std::sort(bins.begin() + std::ptrdiff_t(first), bins.end(),
              [](const auto& a, const auto& b) { return a.number < b.number; });
  }
  return bins;
}

BinOptions BinTable::choose_of(const Hits& hits, const VisiblePoints& of_all) {
  if (of_all.bins_serial != 0 && chosen_ == of_all.bins_serial) return chosen_options_;
  chosen_options_ = fill(hits, false, [&](const BinOptions& options) {
    Words weights(weights_), keys(keys_);
    Image<std::uint32_t> first_bin(hits.view.width(), hits.view.height(), 0xffffffffu);
    const BinCounts counts = add_bins(of_all.bins, options, {weights.all, keys.all, slots_, first_bin});
    weights.write(), keys.write();
    first_bin_.upload(first_bin);
    counters_.buffer().upload(&counts, sizeof counts);
  });
  choose(hits, chosen_options_);
  chosen_ = of_all.bins_serial;
  return chosen_options_;
}

Image<VisiblePoints::BinSums> BinTable::sums_of(const Hits& hits, const VisiblePoints& of_all) {
  const BinOptions options = choose_of(hits, of_all);
  clear(sums_);  // of another part
  add_attributes(hits, options);
  Image<VisiblePoints::BinSums> sums(hits.view.width(), hits.view.height());
  sums_.buffer().download(sums.data(), sums_.buffer().bytes());
  return sums;
}

void BinTable::show(const Hits& hits, const VisiblePoints& of_all, bool show_weight,
                    const SplatSurfaceTargets& targets) {
  const BinOptions options = choose_of(hits, of_all);
  if (!of_all.bin_sums.empty()) sums_.buffer().upload(of_all.bin_sums.data(), sums_.buffer().bytes());
  resolve(hits, options, show_weight, targets);
}

BinCounts BinTable::counts() const {
  BinCounts counts;
  if (counters_) counters_.buffer().download(&counts, sizeof counts);
  return counts;
}

std::size_t BinTable::bytes() const {
  return weights_.buffer().bytes() + keys_.buffer().bytes() + sums_.buffer().bytes();
}

}  // namespace sfumato::denoise
