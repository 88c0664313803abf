// A headless OpenGL 4.5 core context through EGL.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gl/pace.h"
#include "gl/preferences.h"

namespace sfumato::gl {

/// What the driver can do, read once.
struct Limits {
  std::string version, renderer, vendor;
  bool software = false;  ///< llvmpipe and friends: fragment passes win, timer queries do not work
  int max_texture_size = 0;
  long max_texture_buffer_size = 0;  ///< texels
  long max_storage_block_size = 0;   ///< bytes
  int max_work_groups = 0;           ///< per axis
  float max_point_size = 1;
  bool float_atomics = false;  ///< GL_NV_shader_atomic_float
  bool int64_atomics = false;  ///< GL_NV_shader_atomic_int64 and GL_ARB_gpu_shader_int64
};

class Context {
 public:
  /// On the first device that offers OpenGL 4.5, else the surfaceless platform. Where another context is
  /// current it stays so, else the new one is. Throws Error(no_gl) with what is missing and what to install.
  /// `shared`: a context on whose device this one is made and whose buffers and textures it can use, as it
  /// can use those of this one.
  static std::unique_ptr<Context> create_headless(Preferences preferences = Preferences::from_environment(),
                                                  const Context* shared = nullptr);
  /// What the context made goes with it: delete GL objects of yours before, inside a `Use`.
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// Makes a context current on this thread while it lives, and then what was current before, ours or not.
  /// Throws Error(no_gl) while another thread uses the context.
  class Use {
   public:
    explicit Use(Context& context);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    struct Outside;
    std::unique_ptr<Outside> outside_;  ///< nothing when it was current already
  };

  const Limits& limits() const { return limits_; }
  Preferences& preferences() { return preferences_; }
  /// High-severity debug messages since the last call; tests fail on any.
  std::vector<std::string> take_messages();

 private:
  Context() = default;
  struct Egl;
  std::unique_ptr<Egl> egl_;
  Limits limits_;
  Preferences preferences_;
  Pacing pacing_;
  std::vector<std::string> messages_;
};

/// Limits of the context that is current on this thread; of none, zeros.
const Limits& limits();
/// Throws Error(no_gl): who needs what, what the driver has, what to do.
void require(bool condition, const std::string& who, const std::string& needs);
/// Throws Error(out_of_memory) when the last allocation failed; `what` says what was allocated.
void check_memory(const std::string& what);

}  // namespace sfumato::gl
