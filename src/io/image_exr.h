// Pictures as OpenEXR.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/image.h"

namespace sfumato::io {

/// Channels R G B A (linear, premultiplied), Z (eye depth, +inf where nothing) and N.X N.Y N.Z (world normal,
/// 0 where none), all 32-bit float; an empty image leaves its channels out. `command` is kept
/// in the header's comments. The file appears under its name only when it is complete; throws Error(io).
void write_exr(const std::filesystem::path& file, const Image<vec4>& color, const Image<float>& depth,
               const Image<vec3>& normal, const std::string& command = {});

/// The same from top to bottom, for pictures that are never in memory as a whole. Without `finish` nothing
/// appears.
class ExrRows {
 public:
  /// `with_*`: which of the images every call of `write` has.
  ExrRows(const std::filesystem::path& file, int width, int height, bool with_color, bool with_depth,
          bool with_normal, const std::string& command = {});
  ~ExrRows();
  ExrRows(const ExrRows&) = delete;
  ExrRows& operator=(const ExrRows&) = delete;
  void write(const Image<vec4>& color, const Image<float>& depth, const Image<vec3>& normal);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato::io
