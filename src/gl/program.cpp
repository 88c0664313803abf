#include "gl/program.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include "core/error.h"
#include "gl/context.h"
#include "gl/pace.h"

namespace sfumato::gl {
namespace {

/// Every variant that is compiled, for other compilers to look at.
void keep(GLenum stage, std::string name, const std::string& text) {
  const std::string& folder = preferences().kept_shaders;
  if (folder.empty()) return;
  std::replace(name.begin(), name.end(), '/', '.');
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const char* extension = stage == GL_COMPUTE_SHADER  ? ".comp"
                          : stage == GL_VERTEX_SHADER ? ".vert"
                                                      : ".frag";
  const std::filesystem::path path =
      std::filesystem::path(folder) /
      (name + "." + std::to_string(std::hash<std::string>()(text)) + extension);
  // Under a name of its own first: another process may write the same.
  const std::string own = path.string() + "." + std::to_string(::getpid());
  std::ofstream(own, std::ios::binary) << text;
  std::filesystem::rename(own, path, ignored);
}

GLuint compile(GLenum stage, const std::string& file, const Defines& defines, const std::string& head) {
  const ShaderSource source = load_shader(file, defines, head);
  keep(stage, file, source.text);
  const GLuint shader = glCreateShader(stage);
  const char* text = source.text.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = 0, length = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::string log(std::size_t(length), 0);
  glGetShaderInfoLog(shader, length, nullptr, log.data());
  glDeleteShader(shader);
  throw Error(ErrorCode::no_gl,
              "shader " + file + " does not compile on " + limits().renderer + ": " + source.map_log(log));
}

// Samplers and images are bound by layout(binding = n) and need no value.
bool is_opaque(GLenum type) {
  switch (type) {
    case GL_FLOAT:
    case GL_FLOAT_VEC2:
    case GL_FLOAT_VEC3:
    case GL_FLOAT_VEC4:
    case GL_INT:
    case GL_INT_VEC2:
    case GL_INT_VEC3:
    case GL_INT_VEC4:
    case GL_UNSIGNED_INT:
    case GL_UNSIGNED_INT_VEC2:
    case GL_UNSIGNED_INT_VEC3:
    case GL_UNSIGNED_INT_VEC4:
    case GL_BOOL:
    case GL_FLOAT_MAT3:
    case GL_FLOAT_MAT4: return false;
    default: return true;
  }
}

}  // namespace

void Program::link(const std::string& name) {
  name_ = name;
  glLinkProgram(id_);
  GLint ok = 0, length = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &ok);
  if (!ok) {
    glGetProgramiv(id_, GL_INFO_LOG_LENGTH, &length);
    std::string log(std::size_t(length), 0);
    glGetProgramInfoLog(id_, length, nullptr, log.data());
    throw Error(ErrorCode::no_gl, "shader " + name + " does not link on " + limits().renderer + ": " + log);
  }
  glObjectLabel(GL_PROGRAM, id_, GLsizei(name.size()), name.data());
  GLint count = 0;
  glGetProgramiv(id_, GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count; ++i) {
    char text[256];
    GLint size = 0;
    GLenum type = 0;
    glGetActiveUniform(id_, GLuint(i), sizeof text, nullptr, &size, &type, text);
    const GLint location = glGetUniformLocation(id_, text);
    if (location < 0 || is_opaque(type)) continue;  // in a block, or a sampler
    std::string uniform = text;
    if (uniform == "group_rows") {
      group_rows_ = location;
      continue;
    }
    if (uniform.ends_with("[0]")) uniform.resize(uniform.size() - 3);
    uniforms_[uniform] = {location, false};
  }
}

Program Program::compute(const std::string& file, const Defines& defines, const std::string& head) {
  Program program;
  const GLuint shader = compile(GL_COMPUTE_SHADER, file, defines, head);
  program.id_ = glCreateProgram();
  glAttachShader(program.id_, shader);
  glDeleteShader(shader);
  program.link(file);
  GLint size[3] = {1, 1, 1};
  glGetProgramiv(program.id_, GL_COMPUTE_WORK_GROUP_SIZE, size);
  program.group_size_ = size[0] * size[1] * size[2];
  return program;
}

Program Program::raster(const std::string& vertex_file, const std::string& fragment_file,
                        const Defines& defines, const std::string& fragment_head) {
  Program program;
  const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_file, defines, "");
  const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragment_file, defines, fragment_head);
  program.id_ = glCreateProgram();
  glAttachShader(program.id_, vertex);
  glAttachShader(program.id_, fragment);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  program.link(vertex_file + " + " + fragment_file);
  return program;
}

Program::~Program() {
  if (id_) glDeleteProgram(id_);
}

GLint Program::locate(std::string_view name) {
  const auto found = uniforms_.find(name);
  if (found == uniforms_.end()) return -1;  // removed by the compiler in this variant: setting it is harmless
  found->second.set = true;
  return found->second.location;
}

Program& Program::set(std::string_view name, int value) {
  glProgramUniform1i(id_, locate(name), value);
  return *this;
}
Program& Program::set(std::string_view name, unsigned value) {
  glProgramUniform1ui(id_, locate(name), value);
  return *this;
}
Program& Program::set(std::string_view name, float value) {
  glProgramUniform1f(id_, locate(name), value);
  return *this;
}
Program& Program::set(std::string_view name, const vec2& value) {
  glProgramUniform2fv(id_, locate(name), 1, &value.x);
  return *this;
}
Program& Program::set(std::string_view name, const vec3& value) {
  glProgramUniform3fv(id_, locate(name), 1, &value.x);
  return *this;
}
Program& Program::set(std::string_view name, const vec4& value) {
  glProgramUniform4fv(id_, locate(name), 1, &value.x);
  return *this;
}
Program& Program::set(std::string_view name, const ivec2& value) {
  glProgramUniform2iv(id_, locate(name), 1, &value.x);
  return *this;
}
Program& Program::set(std::string_view name, const mat4& value) {
  glProgramUniformMatrix4fv(id_, locate(name), 1, GL_FALSE, glm::value_ptr(value));
  return *this;
}
Program& Program::set(std::string_view name, std::span<const vec3> values) {
  glProgramUniform3fv(id_, locate(name), GLsizei(values.size()), values.empty() ? nullptr : &values[0].x);
  return *this;
}

void Program::use() const {
  for (const auto& [name, uniform] : uniforms_)
    if (!uniform.set)
      throw Error(ErrorCode::no_gl, "shader " + name_ + ": uniform " + name + " was never set");
  glUseProgram(id_);
}

void Program::dispatch(unsigned x, unsigned y) const {
  use();
  if (x == 0 || y == 0) return;
  const double units = double(x) * group_size_;
  if (group_rows_ < 0) return in_slices(id_, 1, units * y, [&](auto, auto) { glDispatchCompute(x, y, 1); });
  // Rows next to each other mostly draw next to each other, and find it in the cache.
  constexpr unsigned rows_a_block = 4;  // as in work_groups.glsl
  const unsigned blocks = y / rows_a_block;
  in_slices(id_, y, units, [&](std::uint64_t first, std::uint64_t count) {
    const std::uint64_t step = count == y ? 1 : spread_step(blocks);
    glProgramUniform3ui(id_, group_rows_, GLuint(first), GLuint(step), blocks);
    glDispatchCompute(x, GLuint(count), 1);
  });
}

void Program::dispatch_rows(unsigned groups) const {
  constexpr unsigned longest = 256, most_rows = 32768;  // GL has 65535 at least
  const unsigned rows = std::clamp((groups + longest - 1) / longest, 1u, most_rows);
  dispatch((groups + rows - 1) / rows, rows);
}

}  // namespace sfumato::gl
