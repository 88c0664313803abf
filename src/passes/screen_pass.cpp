#include "passes/screen_pass.h"

#include "core/error.h"
#include "gl/commands.h"
#include "gl/context.h"
#include "gl/draw.h"
#include "gl/state.h"
#include "passes/bindings.h"

namespace sfumato {
namespace {

struct Format {
  GLenum format;
  const char* glsl;
  bool integer;
};
constexpr Format known_formats[] = {
    {GL_RGBA32F, "rgba32f", false},  {GL_RGBA16F, "rgba16f", false}, {GL_RG32F, "rg32f", false},
    {GL_R32F, "r32f", false},        {GL_RG16F, "rg16f", false},     {GL_R16F, "r16f", false},
    {GL_RGBA8, "rgba8", false},      {GL_R8, "r8", false},           {GL_R32UI, "r32ui", true},
    {GL_RGBA32UI, "rgba32ui", true}, {GL_RG32UI, "rg32ui", true}};

const Format& describe(GLenum format) {
  for (const Format& known : known_formats)
    if (known.format == format) return known;
  throw Error(ErrorCode::no_gl, "a screen pass cannot write GL format " + std::to_string(format));
}

std::string output_declarations(const std::vector<GLenum>& formats, bool compute) {
  std::string text;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    const Format& f = describe(formats[i]);
    const std::string n = std::to_string(i), type = f.integer ? "uvec4" : "vec4";
    if (compute)
      text += type + " out_" + n + " = " + type + "(0);\nlayout(" + f.glsl + ", binding = " + n +
              ") writeonly uniform " + (f.integer ? "uimage2D" : "image2D") + " screen_image_" + n + ";\n";
    else
      text += "layout(location = " + n + ") out " + type + " out_" + n + ";\n";
  }
  return text;
}

/// `main` of the compute wrapper, and what it needs.
std::string compute_main(const std::vector<GLenum>& formats) {
  std::string elsewhere, otherwise, stores;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    const std::string n = std::to_string(i);
    if (!describe(formats[i]).integer) {  // tiles are for float formats only
      elsewhere += "uniform vec4 screen_elsewhere_" + n + ";\n";
      otherwise += " out_" + n + " = screen_elsewhere_" + n + ";";
    }
    stores += "  imageStore(screen_image_" + n + ", pixel, out_" + n + ");\n";
  }
  return "#include \"work_groups.glsl\"\nlayout(binding = " + std::to_string(binding::tiles) +
         ") uniform sampler2D screen_tiles;\n" +
         "uniform int screen_tile_size;\nuniform ivec2 screen_tile_offset;\n" + elsewhere +
         "layout(local_size_x = 16, local_size_y = 8) in;\nvoid main() {\n"
         "  ivec2 pixel = ivec2(gl_GlobalInvocationID.x, group_row() * 8u + gl_LocalInvocationID.y);\n"
         "  if (any(greaterThanEqual(pixel, imageSize(screen_image_0)))) return;\n"
         "  bool runs = screen_tile_size == 0;\n"
         "  if (!runs) runs = texelFetch(screen_tiles, (pixel + screen_tile_offset) / screen_tile_size, 0).x "
         "> 0.0;\n"
         "  if (!runs) {" +
         otherwise + " }\n  else if (!filter_pixel(pixel)) return;\n" + stores + "}\n";
}

}  // namespace

ScreenPassKind default_screen_pass_kind() {
  if (const ScreenPassKind kind = gl::preferences().screen_passes; kind != ScreenPassKind::automatic)
    return kind;
  return gl::limits().software ? ScreenPassKind::fragment : ScreenPassKind::compute;
}

ScreenPass::ScreenPass(const std::string& file, std::vector<GLenum> formats, const gl::Defines& defines,
                       ScreenPassKind kind) {
  if (kind == ScreenPassKind::automatic) kind = default_screen_pass_kind();
  compute_ = kind == ScreenPassKind::compute;
  const std::string head = output_declarations(formats, compute_) + "bool filter_pixel(ivec2 pixel);\n";
  if (compute_) {
    program_ = gl::Program::compute(file, defines, head + compute_main(formats));
  } else {
    const std::string main_text = "void main() { if (!filter_pixel(ivec2(gl_FragCoord.xy))) discard; }\n";
    program_ = gl::Program::raster("passes/screen_pass.vert", file, defines, head + main_text);
  }
}

void ScreenPass::run(std::initializer_list<const gl::Texture*> inputs,
                     std::initializer_list<const gl::Texture*> outputs) {
  draw(nullptr, inputs, outputs, {});
}

void ScreenPass::run(const Tiles& tiles, std::initializer_list<const gl::Texture*> inputs,
                     std::initializer_list<const gl::Texture*> outputs,
                     std::initializer_list<vec4> elsewhere) {
  draw(&tiles, inputs, outputs, elsewhere);
}

void ScreenPass::mark(PixelMask& mask, std::initializer_list<const gl::Texture*> inputs,
                      std::initializer_list<const gl::Texture*> outputs) {
  if (compute_) return run(inputs, outputs);
  const gl::Texture& first = **outputs.begin();
  gl::ensure(mask.depth, "pixels", GL_DEPTH_COMPONENT32F, first.width(), first.height());
  const gl::State state{gl::State::Depth::test_and_write, GL_ALWAYS};
  state.apply();  // clears heed it
  gl::clear_depth(gl::Framebuffer({}, &mask.depth));
  draw(nullptr, inputs, outputs, {}, &mask.depth, state);
}

void ScreenPass::run(const PixelMask& mask, std::initializer_list<const gl::Texture*> inputs,
                     std::initializer_list<const gl::Texture*> outputs) {
  if (compute_) return run(inputs, outputs);
  // The screen is drawn nearer than what the mask was cleared to, as it was where it was set.
  draw(nullptr, inputs, outputs, {}, &mask.depth, {gl::State::Depth::test, GL_GEQUAL});
}

void ScreenPass::draw(const Tiles* tiles, std::initializer_list<const gl::Texture*> inputs,
                      std::initializer_list<const gl::Texture*> outputs,
                      std::initializer_list<vec4> elsewhere, const gl::Texture* mask,
                      const gl::State& state) {
  if (compute_ && elsewhere.size() == 0) tiles = nullptr;
  int unit = binding::input;
  for (const gl::Texture* input : inputs) {
    input->bind(unit++);
    if (unit == binding::places) unit = binding::more_inputs;
  }
  if (tiles) tiles->on.bind(binding::tiles);
  program_.set("screen_tile_size", tiles ? tiles->size : 0);

  if (compute_) {
    program_.set("screen_tile_offset", tiles ? tiles->offset : ivec2(0));
    for (std::size_t k = 0; k < outputs.size(); ++k)
      program_.set("screen_elsewhere_" + std::to_string(k), tiles ? elsewhere.begin()[k] : vec4(0));
    int image = 0;
    for (const gl::Texture* output : outputs) output->bind_image(image++, GL_WRITE_ONLY);
    const gl::Texture& first = **outputs.begin();
    program_.dispatch(unsigned(first.width() + 15) / 16, unsigned(first.height() + 7) / 8);
    gl::barrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
    return;
  }

  gl::Framebuffer framebuffer(outputs, mask);
  framebuffer.bind();
  state.apply();
  program_.use();
  if (!tiles) {
    const gl::Texture& first = **outputs.begin();
    gl::draw_rectangles(program_, first.width(), first.height(), gl::draw_screen);
    return;
  }
  int attachment = 0;
  for (const vec4& value : elsewhere) gl::clear_color(attachment++, value);
  const int columns = tiles->on.width(), rows = tiles->on.height();
  gl::set_viewport(-tiles->offset, ivec2(columns, rows) * tiles->size);
  gl::draw_rows(program_, rows, columns, double(tiles->size) * tiles->size);
}

}  // namespace sfumato
