// A linked program; uniforms by name. An active uniform that was never set is an error at the first use.
#pragma once

#include <epoxy/gl.h>

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/vec.h"
#include "gl/shader_source.h"

namespace sfumato::gl {

class Program {
 public:
  Program() = default;
  /// A compute program. Throws Error(no_gl) with file:line of the driver's message.
  static Program compute(const std::string& file, const Defines& defines = {}, const std::string& head = "");
  static Program raster(const std::string& vertex_file, const std::string& fragment_file,
                        const Defines& defines = {}, const std::string& fragment_head = "");
  ~Program();
  Program(Program&& other) noexcept { swap(other); }
  Program& operator=(Program&& other) noexcept {
    swap(other);
    return *this;
  }
  explicit operator bool() const { return id_ != 0; }

  Program& set(std::string_view name, int value);
  Program& set(std::string_view name, unsigned value);
  Program& set(std::string_view name, float value);
  Program& set(std::string_view name, const vec2& value);
  Program& set(std::string_view name, const vec3& value);
  Program& set(std::string_view name, const vec4& value);
  Program& set(std::string_view name, const ivec2& value);
  Program& set(std::string_view name, const mat4& value);
  /// The first elements of an array; none leaves it as it is.
  Program& set(std::string_view name, std::span<const vec3> values);
  Program& set(std::string_view name, bool value) { return set(name, int(value)); }
  /// True when the shader really uses that uniform (the compiler may have removed it).
  bool has(std::string_view name) const { return uniforms_.find(name) != uniforms_.end(); }

  /// Forgets the program without deleting it: its context is not current, or not there any more.
  void abandon() { id_ = 0; }
  GLuint id() const { return id_; }

  void use() const;
  /// Work groups along x and y; in slices of rows where the shader counts them by group_row()
  /// (work_groups.glsl), else at once.
  void dispatch(unsigned x, unsigned y = 1) const;
  /// `groups` work groups, in as many rows along y as their number asks for. Rows are of one length: there
  /// are at most as many groups too many as rows, and llvmpipe computes an empty one as well.
  void dispatch_rows(unsigned groups) const;

 private:
  struct Uniform {
    GLint location = -1;
    bool set = false;
  };
  GLint locate(std::string_view name);
  void link(const std::string& name);
  void swap(Program& other) {
    std::swap(id_, other.id_);
    std::swap(name_, other.name_);
    std::swap(group_rows_, other.group_rows_);
    std::swap(group_size_, other.group_size_);
    std::swap(uniforms_, other.uniforms_);
  }
  GLuint id_ = 0;
  std::string name_;
  GLint group_rows_ = -1;  ///< location of work_groups.glsl's uniform
  int group_size_ = 0;
  std::map<std::string, Uniform, std::less<>> uniforms_;
};

}  // namespace sfumato::gl
