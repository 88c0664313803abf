// A finished picture, with its depths, drawn into the OpenGL of another program.
#pragma once

#include <array>
#include <cstdint>

#include "core/image.h"
#include "gl/program.h"

namespace sfumato::gl {

/// All calls with the host's context current, always the same one or one that shares its objects.
class HostCanvas {
 public:
  HostCanvas() = default;
  /// Objects in the host's context are left behind unless `release` was called.
  ~HostCanvas();
  HostCanvas(const HostCanvas&) = delete;
  HostCanvas& operator=(const HostCanvas&) = delete;

  /// Throws Error(no_gl) where no context of OpenGL 4.5 is current.
  static void require_context();
  /// Blends `color` (sRGB, straight alpha, top row first) over `viewport` of `framebuffer` (0: the window's),
  /// where what is there is not nearer; `depth` is along the view axis, infinite where nothing. `projection`
  /// is the host's, column by column, as OpenGL takes it; it says what the host's depth buffer means,
  /// reversed ones as well. The host's state is the same after it. `serial` names the picture: one that is
  /// there already is not uploaded again. `opacity` is that of the whole picture.
  void draw(const Image<Rgba8>& color, const Image<float>& depth, std::uint64_t serial,
            const dmat4& projection, std::uint32_t framebuffer, const std::array<int, 4>& viewport,
            float opacity = 1);
  void release();

 private:
  void upload(const Image<Rgba8>& color, const Image<float>& depth);

  Program program_;
  GLuint textures_[2] = {0, 0};  ///< colour, depth
  int width_ = 0, height_ = 0;
  std::uint64_t serial_ = 0;
};

}  // namespace sfumato::gl
