// Depth as text that a browser takes back without asking anybody: scripts are read from a disk where pictures
// must not be.
#pragma once

#include <string>
#include <string_view>

#include "core/image.h"

namespace sfumato::publish {

/// 16 bits a pixel, 0 where nothing is, else 1 at `near` to 65535 at `far`; each less than the pixel before
/// it (modulo 65536), all low bytes before all high ones, deflated.
struct PackedDepth {
  float near = 0, far = 0;
  std::string bytes;
};
PackedDepth packed(const Image<float>& depth);

/// `takeDepth(view, {...})` as JavaScript, with the bytes in base64.
std::string depth_text(std::size_t view, const Image<float>& depth);
std::string base64(std::string_view bytes);

}  // namespace sfumato::publish
