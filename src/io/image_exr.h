// Pictures as OpenEXR.
#pragma once

#include <filesystem>
#include <string>

#include "core/image.h"

namespace sfumato::io {

/// Channels R G B A (linear, premultiplied), Z (eye depth, +inf where nothing) and N.X N.Y N.Z (world normal,
/// 0 where none), all 32-bit float; an empty image leaves its channels out. `command` is kept
/// in the header's comments. The file appears under its name only when it is complete; throws Error(io).
void write_exr(const std::filesystem::path& file, const Image<vec4>& color, const Image<float>& depth,
               const Image<vec3>& normal, const std::string& command = {});

}  // namespace sfumato::io
