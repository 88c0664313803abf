// A screen filter: one GLSL function body, `bool filter_pixel(ivec2 pixel)`, wrapped as a fragment pass
// (faster on software GL) or as a compute pass (faster on data-centre GPUs). The context's preferences decide
// first.
//
// The body writes `out_0`, `out_1` ... (vec4, or uvec4 for integer formats) and returns false to leave the
// targets of this pixel as they were. It reads its inputs with texelFetch from units UNIT_INPUT + k,
// and from the ninth on UNIT_MORE_INPUTS + k - 8.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "gl/preferences.h"
#include "gl/program.h"
#include "gl/state.h"
#include "gl/texture.h"

namespace sfumato {

using gl::ScreenPassKind;
/// The kind in force: the preferred one, else fragment on software GL and compute elsewhere.
ScreenPassKind default_screen_pass_kind();

/// Squares of pixels, of an area that holds the image, and which of them a pass has something to do in.
struct Tiles {
  /// One texel a tile, above 0 where the pass runs. Vertex shaders read it, and those of llvmpipe (Mesa 22.3)
  /// do not wait for the fragment pass that draws it: software GL needs a glFinish in between.
  const gl::Texture& on;
  int size;                 ///< px of the image
  ivec2 offset = ivec2(0);  ///< of the image within the tiled area, px
};

/// Pixels that a pass returned true for. Passes of fragments that run where it is set spend nothing on groups
/// of pixels elsewhere: a depth that is tested before the shader, for on llvmpipe (Mesa 22.3) branches spare
/// no work.
struct PixelMask {
  gl::Texture depth;
};

class ScreenPass {
 public:
  ScreenPass() = default;
  /// `formats`: GL formats of the outputs, in order.
  ScreenPass(const std::string& file, std::vector<GLenum> formats, const gl::Defines& defines = {},
             ScreenPassKind kind = ScreenPassKind::automatic);

  explicit operator bool() const { return bool(program_); }
  gl::Program& program() { return program_; }
  /// Sets a uniform; chains.
  template <class T>
  ScreenPass& set(std::string_view name, const T& value) {
    program_.set(name, value);
    return *this;
  }
  /// Binds `inputs` to UNIT_INPUT + k and runs over every pixel of `outputs` (all of one size).
  void run(std::initializer_list<const gl::Texture*> inputs,
           std::initializer_list<const gl::Texture*> outputs);
  /// The same, only where a tile is on; everywhere else output k becomes `elsewhere[k]` (float formats only),
  /// or, where `elsewhere` is empty, stays what it was, which is what the pass would write there.
  void run(const Tiles& tiles, std::initializer_list<const gl::Texture*> inputs,
           std::initializer_list<const gl::Texture*> outputs, std::initializer_list<vec4> elsewhere);
  /// Over every pixel; sets the mask where the pass returns true.
  void mark(PixelMask& mask, std::initializer_list<const gl::Texture*> inputs,
            std::initializer_list<const gl::Texture*> outputs);
  /// Where the mask is set. The pass returns false elsewhere by itself: there may be no mask.
  void run(const PixelMask& mask, std::initializer_list<const gl::Texture*> inputs,
           std::initializer_list<const gl::Texture*> outputs);

 private:
  void draw(const Tiles* tiles, std::initializer_list<const gl::Texture*> inputs,
            std::initializer_list<const gl::Texture*> outputs, std::initializer_list<vec4> elsewhere,
            const gl::Texture* mask = nullptr, const gl::State& state = {});
  gl::Program program_;
  bool compute_ = false;
};

}  // namespace sfumato
