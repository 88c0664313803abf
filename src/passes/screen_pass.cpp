#include "passes/screen_pass.h"

#include <cstdlib>
#include <string_view>

#include "core/error.h"
#include "gl/context.h"
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
    {GL_RGBA32F, "rgba32f", false}, {GL_RGBA16F, "rgba16f", false}, {GL_RG32F, "rg32f", false},
    {GL_R32F, "r32f", false},       {GL_RG16F, "rg16f", false},     {GL_R16F, "r16f", false},
    {GL_RGBA8, "rgba8", false},     {GL_R8, "r8", false},           {GL_R32UI, "r32ui", true},
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
      text += type + " out_" + n + " = " + type + "(0);\nlayout(" + f.glsl + ", binding = " + n + ") writeonly uniform " +
              (f.integer ? "uimage2D" : "image2D") + " image_" + n + ";\n";
    else
      text += "layout(location = " + n + ") out " + type + " out_" + n + ";\n";
  }
  return text;
}

}  // namespace

ScreenPassKind default_screen_pass_kind() {
  if (const char* text = std::getenv("SFUMATO_SCREEN_PASS")) {
    if (text == std::string_view("fragment")) return ScreenPassKind::fragment;
    if (text == std::string_view("compute")) return ScreenPassKind::compute;
    throw Error(ErrorCode::usage, "SFUMATO_SCREEN_PASS is '" + std::string(text) + "', not fragment or compute");
  }
  return gl::limits().software ? ScreenPassKind::fragment : ScreenPassKind::compute;
}

ScreenPass::ScreenPass(const std::string& file, std::vector<GLenum> formats, const gl::Defines& defines,
                       ScreenPassKind kind) {
  if (kind == ScreenPassKind::automatic) kind = default_screen_pass_kind();
  compute_ = kind == ScreenPassKind::compute;
  const std::string head = output_declarations(formats, compute_);
  if (compute_) {
    std::string tail = head + "bool filter_pixel(ivec2 pixel);\nlayout(local_size_x = 16, local_size_y = 8) in;\n"
                              "void main() {\n  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);\n"
                              "  if (any(greaterThanEqual(pixel, imageSize(image_0)))) return;\n"
                              "  if (!filter_pixel(pixel)) return;\n";
    for (std::size_t i = 0; i < formats.size(); ++i)
      tail += "  imageStore(image_" + std::to_string(i) + ", pixel, out_" + std::to_string(i) + ");\n";
    program_ = gl::Program::compute(file, defines, tail + "}\n");
  } else {
    const std::string main_text = head + "bool filter_pixel(ivec2 pixel);\n"
                                         "void main() { if (!filter_pixel(ivec2(gl_FragCoord.xy))) discard; }\n";
    program_ = gl::Program::raster("passes/whole_screen.vert", file, defines, main_text);
  }
}

void ScreenPass::run(std::initializer_list<const gl::Texture*> inputs,
                     std::initializer_list<const gl::Texture*> outputs) {
  int unit = binding::input;
  for (const gl::Texture* input : inputs) input->bind(unit++);
  if (compute_) {
    int index = 0;
    for (const gl::Texture* output : outputs) output->bind_image(index++, GL_WRITE_ONLY);
    const gl::Texture& first = **outputs.begin();
    program_.dispatch(unsigned(first.width() + 15) / 16, unsigned(first.height() + 7) / 8);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
                    GL_TEXTURE_UPDATE_BARRIER_BIT);
  } else {
    gl::Framebuffer framebuffer(outputs);
    framebuffer.bind();
    gl::State{}.apply();
    program_.use();
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
}

}  // namespace sfumato
