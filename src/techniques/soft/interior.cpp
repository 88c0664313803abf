#include "techniques/soft/interior.h"

#include <bit>

#include "core/error.h"
#include "gl/commands.h"
#include "passes/bindings.h"

namespace sfumato::soft {

gl::Program& Interior::program(bool store, bool concentric, bool as_quads) {
  gl::Program& program = programs_[(store ? 1 : 0) + (concentric ? 2 : 0) + (as_quads ? 4 : 0)];
  if (!program) {
    gl::Defines defines{"SPLAT_SPHERE"};
    if (store) defines.push_back("STORE");
    if (concentric) defines.push_back("MODEL_CONCENTRIC");
    if (as_quads) defines.push_back("SPLAT_QUADS");
    program = gl::Program::raster("techniques/soft/sphere.vert", "techniques/soft/interior.frag", defines);
  }
  return program;
}

void Interior::draw(SoftPoints& points, const View& view, const gl::Texture& solid_t,
                    const gl::Texture& color, const gl::Texture& result, const InteriorSettings& settings,
                    bool as_quads, gl::Timers& timers) {
  const int shell_bits = settings.concentric ? std::bit_width(unsigned(settings.most_shells - 1)) : 0;
  if (std::uint64_t(points.count()) << shell_bits > std::uint64_t(1) << 32)
    throw Error(ErrorCode::usage, "model = concentric tells " + std::to_string(1ull << (32 - shell_bits)) +
                                      " soft points apart, here are " + std::to_string(points.count()) +
                                      "; raise field_threshold or lower concentric_count");
  const gl::State add{.blend = gl::State::Blend::add};
  list_.begin(view.width(), view.height());
  view.bind();
  {
    auto timing = timers.scope("count");
    gl::Framebuffer framebuffer({&list_.counts()});
    framebuffer.bind();
    gl::Program& count = program(false, settings.concentric, as_quads);
    count.set("normalization", int(settings.normalization));
    points.draw(count, as_quads, solid_t, add);
  }
  {
    auto timing = timers.scope("prefix sum");
    fragments_ = list_.allocate(settings.concentric ? "model = concentric" : "model = base");
  }
  {
    auto timing = timers.scope("store");
    list_.bind_store();
    gl::Program& store = program(true, settings.concentric, as_quads);
    store.set("shell_bits", shell_bits).set("normalization", int(settings.normalization));
    // The count that the fragments give once more goes nowhere: the counts are read no longer.
    gl::Framebuffer framebuffer({&list_.counts()});
    framebuffer.bind();
    points.draw(store, as_quads, solid_t, add);
    list_.finish_store();
  }
  auto timing = timers.scope("resolve");
  resolve(points, solid_t, color, result, settings, shell_bits);
}

ScreenPass& Interior::resolve_pass(const InteriorSettings& settings, bool long_lists) {
  const bool uniform = settings.density == Density::uniform && !settings.concentric;
  ScreenPass& pass = passes_[(settings.concentric ? 2 : uniform ? 1 : 0) + (long_lists ? 3 : 0)];
  if (!pass) {
    gl::Defines defines;
    if (uniform) defines.push_back("DENSITY_UNIFORM");
    if (long_lists) defines.push_back("LONG_LISTS");
    pass = ScreenPass(settings.concentric ? "techniques/soft/concentric.glsl" : "techniques/soft/base.glsl",
                      {GL_RGBA32F}, defines);
  }
  return pass;
}

void Interior::resolve(SoftPoints& points, const gl::Texture& solid_t, const gl::Texture& color,
                       const gl::Texture& result, const InteriorSettings& settings, int shell_bits) {
  if (!counts_) counts_ = gl::Buffer("counts of long lists", 8);
  counts_.clear(0);
  counts_.bind_storage(3);
  list_.bind_read();
  points.shapes().bind(binding::input);
  points.looks().bind(binding::input + 1);
  color.bind(binding::input + 2);
  solid_t.bind(binding::input + 3);
  std::uint32_t unfinished = 0;
  auto run = [&](bool long_lists) {
    ScreenPass& pass = resolve_pass(settings, long_lists);
    // Base goes through the open spheres, Concentric through a point's nested ones; the end of a loop is a
    // round.
    pass.set("normalization", int(settings.normalization))
        .set("shell_bits", shell_bits)
        .set("visit_rounds", settings.concentric ? settings.most_shells + 1 : 65);
    pass.run({}, {&result});
    gl::barrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    const std::uint32_t before = unfinished;
    counts_.download(&unfinished, sizeof unfinished);
    return unfinished > before;
  };
  if (!run(false)) return;
  gl::ensure(progress_, "progress in long lists", GL_R32UI, result.width(), result.height());
  progress_.clear_uint(0);
  progress_.bind_image(binding::progress_image, GL_READ_WRITE);
  while (run(true)) {
  }
}

std::uint32_t Interior::overflows() const {
  std::uint32_t count = 0;
  if (counts_) counts_.download(&count, sizeof count, 4);
  return count;
}

}  // namespace sfumato::soft
