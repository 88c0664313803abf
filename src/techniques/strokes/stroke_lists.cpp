#include "techniques/strokes/stroke_lists.h"

#include <algorithm>

#include "core/error.h"
#include "gl/context.h"
#include "gl/state.h"
#include "passes/bindings.h"

namespace sfumato::strokes {
namespace {

constexpr std::uint64_t fragment_bytes = 16;
constexpr int all_steps = 1 << 20;

gl::Program& made(gl::Program& program, const char* pass, StrokeOrder order) {
  if (!program) {
    gl::Defines defines{pass};
    if (order == StrokeOrder::fragment) defines.push_back("FRAGMENT_ORDER");
    program = gl::Program::raster("techniques/strokes/stroke.vert", "techniques/strokes/stroke.frag", defines);
  }
  return program;
}

}  // namespace

void StrokeLists::count(const View& view, StrokeSet& strokes, const gl::Texture& brush, StrokeOrder order,
                        std::uint64_t most_bytes) {
  order_ = order;
  const int width = view.width(), height = view.height();
  gl::ensure(opaque_depth_, "nearest opaque stroke", GL_DEPTH_COMPONENT32F, width, height);
  gl::ensure(counts_, "fragments of pixels", GL_R32F, width, height);
  gl::ensure(offsets_, "places of fragments", GL_R32UI, width, height);
  gl::ensure(cursors_, "stored fragments", GL_R32UI, width, height);
  counts_.clear(vec4(0));
  view.bind();
  {
    gl::Framebuffer framebuffer({}, &opaque_depth_);
    framebuffer.bind();
    gl::State{.depth = gl::State::Depth::test_and_write}.apply();
    const float farthest = 1;
    glClearNamedFramebufferfv(framebuffer.id(), GL_DEPTH, 0, &farthest);
    strokes.draw(made(opaque_[int(order)], "STROKE_OPAQUE", order), brush);
  }
  if (order == StrokeOrder::stroke) strokes.hide(view, opaque_depth_);
  {
    gl::Framebuffer framebuffer({&counts_}, before_opaque());
    framebuffer.bind();
    before_opaque_state(gl::State::Blend::add).apply();
    opaque_depth_.bind(binding::input + 2);
    draw(strokes, made(count_[int(order)], "STROKE_COUNT", order), brush);
  }
  cut_bands(width, height, most_bytes);
  current_ = steps_done_ = 0;
  for (Sums& sums : sums_) {
    gl::ensure(sums.color, "sum of paint", GL_RGBA32F, width, height);
    gl::ensure(sums.normal, "sum of normals", GL_RGBA32F, width, height);
    gl::ensure(sums.rest, "sum of distances", GL_R32F, width, height);
  }
}

/// The depth test sorts out what lies behind opaque strokes; where fragments are ordered, their shader does.
const gl::Texture* StrokeLists::before_opaque() const {
  return order_ == StrokeOrder::stroke ? &opaque_depth_ : nullptr;
}
gl::State StrokeLists::before_opaque_state(gl::State::Blend blend) const {
  return {.depth = before_opaque() ? gl::State::Depth::test : gl::State::Depth::off, .depth_func = GL_LEQUAL, .blend = blend};
}

void StrokeLists::draw(const StrokeSet& strokes, gl::Program& program, const gl::Texture& brush) const {
  if (order_ == StrokeOrder::stroke) strokes.draw_visible(program, brush);
  else strokes.draw(program, brush);
}

void StrokeLists::cut_bands(int width, int height, std::uint64_t most_bytes) {
  if (!sum_rows_) {
    sum_rows_ = gl::Program::compute("techniques/strokes/scan_rows.comp", {"STAGE 0"});
    place_rows_ = gl::Program::compute("techniques/strokes/scan_rows.comp", {"STAGE 1"});
  }
  const std::size_t row_bytes = std::size_t(height) * 4;
  if (row_places_.bytes() != row_bytes) row_places_ = gl::Buffer("fragments of rows", row_bytes);
  counts_.bind(binding::input);
  row_places_.bind_storage(0);
  sum_rows_.set("size", ivec2(width, height)).dispatch(unsigned(height + 15) / 16);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<std::uint32_t> rows(static_cast<std::size_t>(height));
  row_places_.download(rows.data(), row_bytes);

  const std::uint64_t limit = std::min(most_bytes / fragment_bytes, std::uint64_t(gl::limits().max_texture_buffer_size));
  bands_.clear();
  fragment_count_ = 0;
  Band band{0, 0, 0};
  for (int y = 0; y < height; ++y) {
    const std::uint64_t here = rows[std::size_t(y)];
    if (band.fragments > 0 && band.fragments + here > limit) {
      bands_.push_back(band);
      band = {y, y, 0};
    }
    rows[std::size_t(y)] = std::uint32_t(band.fragments);
    band.last_row = y + 1;
    band.fragments += here;
    fragment_count_ += here;
  }
  bands_.push_back(band);
  std::uint64_t most = 1;
  for (const Band& each : bands_) most = std::max(most, each.fragments);
  if (most > std::uint64_t(gl::limits().max_texture_buffer_size))
    throw Error(ErrorCode::out_of_memory, "strokes: one row of this picture has " + std::to_string(most) +
                                              " fragments, more than a buffer of this driver holds; lower --coverage");
  if (fragments_.buffer().bytes() < most * fragment_bytes) {
    fragments_ = {};  // before the new one, so that both never exist at once
    fragments_ = gl::TextureBuffer("fragments", GL_RGBA32UI, most * fragment_bytes);
  }
  row_places_.upload(rows.data(), row_bytes);
  row_places_.bind_storage(0);
  counts_.bind(binding::input);
  glBindImageTexture(0, offsets_.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
  place_rows_.set("size", ivec2(width, height)).dispatch(unsigned(height + 15) / 16);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void StrokeLists::store(const View& view, const StrokeSet& strokes, const gl::Texture& brush, const Band& band) {
  cursors_.clear_uint(0);
  view.bind();
  gl::Framebuffer framebuffer({&counts_}, before_opaque());  // no colour is written
  framebuffer.bind();
  before_opaque_state(gl::State::Blend::off).apply();
  opaque_depth_.bind(binding::input + 2);
  offsets_.bind(binding::input + 3);
  glBindImageTexture(0, cursors_.id(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
  glBindImageTexture(1, fragments_.texture(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32UI);
  gl::Program& program = made(store_[int(order_)], "STROKE_STORE", order_);
  program.set("rows", ivec2(band.first_row, band.last_row)).set("fragment_room", unsigned(band.fragments));
  draw(strokes, program, brush);
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

bool StrokeLists::sort(const View& view, const StrokeSet& strokes, float relief, const Band& band, int first_step,
                       int steps) {
  if (!sort_) sort_ = ScreenPass("techniques/strokes/sort_blend.glsl", {GL_RGBA32F, GL_RGBA32F, GL_R32F});
  if (!unfinished_) unfinished_ = gl::Buffer("unfinished pixels", 4);
  unfinished_.clear(0);
  view.bind();
  unfinished_.bind_storage(0);
  glBindImageTexture(6, fragments_.texture(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32UI);
  strokes.records().bind(binding::input);
  const Sums& before = sums_[current_];
  Sums& after = sums_[1 - current_];
  offsets_.bind(binding::input + 1);
  cursors_.bind(binding::input + 2);
  sort_.set("first_step", first_step).set("steps", steps).set("relief", relief);
  sort_.set("rows", ivec2(band.first_row, band.last_row)).set("fragment_room", unsigned(band.fragments));
  before.color.bind(binding::input + 3);
  before.normal.bind(binding::input + 4);
  before.rest.bind(binding::input + 5);
  sort_.run({}, {&after.color, &after.normal, &after.rest});
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  std::uint32_t unfinished = 0;
  unfinished_.download(&unfinished, 4);
  return unfinished == 0;
}

void StrokeLists::sort_all(const View& view, const StrokeSet& strokes, const gl::Texture& brush, float relief) {
  for (const Band& band : bands_) {
    store(view, strokes, brush, band);
    sort(view, strokes, relief, band, 0, all_steps);
  }
  current_ = 1 - current_;
}

void StrokeLists::store_only_band(const View& view, const StrokeSet& strokes, const gl::Texture& brush) {
  store(view, strokes, brush, bands_.front());
}

void StrokeLists::bind_lists() const {
  offsets_.bind(binding::input + 1);
  cursors_.bind(binding::input + 2);
  fragments_.bind(binding::input + 3);
}

bool StrokeLists::sort_some(const View& view, const StrokeSet& strokes, float relief, int steps) {
  const bool done = sort(view, strokes, relief, bands_.front(), steps_done_, steps);
  steps_done_ += steps;
  current_ = 1 - current_;
  return done;
}

}  // namespace sfumato::strokes
