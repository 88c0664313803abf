#include "techniques/strokes/stroke_lists.h"

#include <algorithm>

#include "core/error.h"
#include "gl/commands.h"
#include "gl/context.h"
#include "gl/pace.h"
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
    program =
        gl::Program::raster("techniques/strokes/stroke.vert", "techniques/strokes/stroke.frag", defines);
  }
  return program;
}

}  // namespace

void StrokeLists::build(const View& view, StrokeSet& strokes, const BrushPicture& brush, StrokeOrder order,
                        std::uint64_t most_bytes) {
  order_ = order;
  current_ = steps_done_ = 0;
  const int width = view.width(), height = view.height();
  gl::ensure(heads_, "first fragments of pixels", GL_R32UI, width, height);
  for (Sums& sums : sums_) {
    gl::ensure(sums.color, "sum of paint", GL_RGBA32F, width, height);
    gl::ensure(sums.normal, "sum of normals", GL_RGBA32F, width, height);
    gl::ensure(sums.rest, "sum of distances", GL_R32F, width, height);
  }
  // The pictures agree but for rounding.
  on_cpu_ =
      order == StrokeOrder::stroke && gl::place_of_work(gl::preferences().stroke_lists) == gl::Place::cpu;
  if (on_cpu_)
    cpu_.begin(view, strokes, brush);
  else
    find_opaque(view, strokes, brush);

  const std::uint64_t largest = std::uint64_t(gl::limits().max_texture_buffer_size) - page_slack(height);
  const std::uint64_t limit = std::clamp<std::uint64_t>(most_bytes / fragment_bytes, 1, largest);
  if (fragment_count_ <= limit || on_cpu_) {
    // One pass into a buffer that is probably large enough, as the picture before had no more fragments than
    // that.
    const std::uint64_t most = limit + page_slack(height);
    if (room() > most || room() == 0)
      make_room(std::min(most, 3 * std::uint64_t(width) * std::uint64_t(height) + page_slack(height)));
    bands_.assign(1, {0, height});
    fragment_count_ = store(view, strokes, brush, bands_.front());
    const std::uint64_t needed = fragment_count_ + page_slack(height);
    if (fragment_count_ <= limit && needed > room()) {
      make_room(std::min(most, needed + needed / 3));
      store(view, strokes, brush, bands_.front());
    }
    if (fragment_count_ <= limit) return;
  }
  cut_bands(on_cpu_ ? cpu_.row_counts() : count(view, strokes, brush), limit);
  if (bands_.size() == 1) store(view, strokes, brush, bands_.front());
}

/// What unfilled pages may take.
std::uint64_t StrokeLists::page_slack(int height) const {
  return on_cpu_ ? FragmentsCpu::page *
                       std::uint64_t((height + FragmentsCpu::strip_rows - 1) / FragmentsCpu::strip_rows)
                 : 0;
}

void StrokeLists::make_room(std::uint64_t fragments) {
  fragments_ = {};  // before the new one, so that both never exist at once
  fragments_ = gl::TextureBuffer("fragments", GL_RGBA32UI, fragments * fragment_bytes);
}
std::uint64_t StrokeLists::room() const { return fragments_.buffer().bytes() / fragment_bytes; }

void StrokeLists::find_opaque(const View& view, StrokeSet& strokes, const BrushPicture& brush) {
  gl::ensure(opaque_depth_, "nearest opaque stroke", GL_DEPTH_COMPONENT32F, view.width(), view.height());
  view.bind();
  gl::Framebuffer framebuffer({}, &opaque_depth_);
  framebuffer.bind();
  gl::State{.depth = gl::State::Depth::test_and_write}.apply();
  gl::clear_depth(framebuffer);
  strokes.draw(made(opaque_[int(order_)], "STROKE_OPAQUE", order_), brush, opaque_alpha);
  if (order_ == StrokeOrder::stroke) strokes.hide(view, opaque_depth_);
}

/// For where one pass was too much: what the rows need, exactly.
std::vector<std::uint32_t> StrokeLists::count(const View& view, const StrokeSet& strokes,
                                              const BrushPicture& brush) {
  gl::ensure(counts_, "fragments of pixels", GL_R32F, view.width(), view.height());
  counts_.clear(vec4(0));
  view.bind();
  gl::Framebuffer framebuffer({&counts_}, before_opaque());
  framebuffer.bind();
  before_opaque_state(gl::State::Blend::add).apply();
  opaque_depth_.bind(binding::input + 2);
  draw(strokes, made(count_[int(order_)], "STROKE_COUNT", order_), brush);

  const int width = view.width(), height = view.height();
  if (!count_rows_) count_rows_ = gl::Program::compute("techniques/strokes/count_rows.comp");
  const std::size_t row_bytes = std::size_t(height) * 4;
  if (row_counts_.bytes() != row_bytes) row_counts_ = gl::Buffer("fragments of rows", row_bytes);
  counts_.bind(binding::input);
  row_counts_.bind_storage(0);
  count_rows_.set("size", ivec2(width, height)).dispatch(unsigned(height + 15) / 16);
  gl::barrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<std::uint32_t> rows(static_cast<std::size_t>(height));
  row_counts_.download(rows.data(), row_bytes);
  return rows;
}

/// The depth test sorts out what lies behind opaque strokes; where fragments are ordered, their shader does.
const gl::Texture* StrokeLists::before_opaque() const {
  return order_ == StrokeOrder::stroke ? &opaque_depth_ : nullptr;
}
gl::State StrokeLists::before_opaque_state(gl::State::Blend blend) const {
  return {.depth = before_opaque() ? gl::State::Depth::test : gl::State::Depth::off,
          .depth_func = GL_LEQUAL,
          .blend = blend};
}

void StrokeLists::draw(const StrokeSet& strokes, gl::Program& program, const BrushPicture& brush) const {
  if (order_ == StrokeOrder::stroke)
    strokes.draw_visible(program, brush, seen_alpha);
  else
    strokes.draw(program, brush, seen_alpha);
}

void StrokeLists::cut_bands(const std::vector<std::uint32_t>& rows, std::uint64_t limit) {
  const int height = int(rows.size());
  bands_.assign(1, {0, height});
  fragment_count_ = 0;
  std::uint64_t here = 0, most = 1;
  for (int y = 0; y < height; ++y) {
    const std::uint64_t row = rows[std::size_t(y)];
    fragment_count_ += row;
    if (here > 0 && here + row > limit) {
      bands_.back().last_row = y;
      bands_.push_back({y, height});
      here = 0;
    }
    here += row;
    most = std::max(most, here);
  }
  most += page_slack(height);
  if (most > std::uint64_t(gl::limits().max_texture_buffer_size))
    throw Error(ErrorCode::out_of_memory,
                "strokes: one row of this picture has " + std::to_string(most) +
                    " fragments, more than a buffer of this driver holds; lower --coverage");
  if (room() < most) make_room(most);
}

std::uint64_t StrokeLists::store(const View& view, const StrokeSet& strokes, const BrushPicture& brush,
                                 const Band& band) {
  if (on_cpu_) {
    std::uint64_t found = 0;
    {
      const gl::Mapped fragments(fragments_.buffer());
      gl::require(fragments.data() != nullptr, "strokes: listing fragments", "a buffer that can be mapped");
      found = cpu_.list(band.first_row, band.last_row, static_cast<glm::uvec4*>(fragments.data()), room());
    }
    heads_.upload(cpu_.heads());
    gl::end_stretch();
    return found;
  }
  if (!stored_) stored_ = gl::Buffer("number of fragments", 4);
  stored_.clear(0);
  stored_.bind_storage(0);
  heads_.clear_uint(no_fragment);
  view.bind();
  // Nothing is drawn; a framebuffer needs an attachment.
  const gl::Texture* depth = before_opaque();
  if (!depth) gl::ensure(counts_, "fragments of pixels", GL_R32F, view.width(), view.height());
  const gl::Framebuffer framebuffer = depth ? gl::Framebuffer({}, depth) : gl::Framebuffer({&counts_});
  framebuffer.bind();
  before_opaque_state(gl::State::Blend::off).apply();
  opaque_depth_.bind(binding::input + 2);
  heads_.bind_image(binding::fragment_cursor_image, GL_READ_WRITE);
  gl::bind_image(binding::fragment_image, fragments_, GL_WRITE_ONLY, GL_RGBA32UI);
  gl::Program& program = made(store_[int(order_)], "STROKE_STORE", order_);
  program.set("rows", ivec2(band.first_row, band.last_row)).set("fragment_room", unsigned(room()));
  draw(strokes, program, brush);
  gl::barrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
              GL_BUFFER_UPDATE_BARRIER_BIT);
  std::uint32_t stored = 0;
  stored_.download(&stored, 4);
  return stored;
}

bool StrokeLists::sort(const View& view, const StrokeSet& strokes, float relief, const Band& band,
                       int first_step, int steps) {
  if (!sort_) sort_ = ScreenPass("techniques/strokes/sort_blend.glsl", {GL_RGBA32F, GL_RGBA32F, GL_R32F});
  if (!unfinished_) unfinished_ = gl::Buffer("unfinished pixels", 4);
  unfinished_.clear(0);
  view.bind();
  unfinished_.bind_storage(0);
  heads_.bind_image(binding::fragment_cursor_image, GL_READ_WRITE);
  gl::bind_image(binding::fragment_image, fragments_, GL_READ_WRITE, GL_RGBA32UI);
  strokes.records().bind(binding::input);
  const Sums& before = sums_[current_];
  Sums& after = sums_[1 - current_];
  sort_.set("first_step", first_step).set("steps", steps).set("relief", relief);
  sort_.set("rows", ivec2(band.first_row, band.last_row));
  before.color.bind(binding::input + 3);
  before.normal.bind(binding::input + 4);
  before.rest.bind(binding::input + 5);
  sort_.run({}, {&after.color, &after.normal, &after.rest});
  gl::barrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
              GL_TEXTURE_FETCH_BARRIER_BIT);
  std::uint32_t unfinished = 0;
  unfinished_.download(&unfinished, 4);
  return unfinished == 0;
}

void StrokeLists::sort_all(const View& view, const StrokeSet& strokes, const BrushPicture& brush,
                           float relief) {
  for (const Band& band : bands_) {
    if (bands_.size() > 1) store(view, strokes, brush, band);
    sort(view, strokes, relief, band, 0, all_steps);
  }
  current_ = 1 - current_;
}

void StrokeLists::bind_lists() const {
  heads_.bind(binding::input + 1);
  fragments_.bind(binding::input + 2);
}

bool StrokeLists::sort_some(const View& view, const StrokeSet& strokes, float relief, int steps) {
  const bool done = sort(view, strokes, relief, bands_.front(), steps_done_, steps);
  steps_done_ += steps;
  current_ = 1 - current_;
  return done;
}

}  // namespace sfumato::strokes
