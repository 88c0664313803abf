#include "depth_text.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"

namespace sfumato::publish {

std::string base64(std::string_view bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? unsigned(static_cast<unsigned char>(bytes[i + k])) : 0u;
    };
    const unsigned all = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (unsigned k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[all >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

PackedDepth packed(const Image<float>& depth) {
  float near = std::numeric_limits<float>::infinity(), far = 0;
  for (const float z : depth)
    if (std::isfinite(z)) near = std::min(near, z), far = std::max(far, z);
  if (!std::isfinite(near)) near = 0;
  PackedDepth out{near, far, {}};
  const double scale = far > near ? 65534 / (double(far) - double(near)) : 0;
  std::vector<unsigned char> planes(2 * depth.size());
  unsigned before = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float z = depth.data()[i];
    const unsigned value =
        std::isfinite(z) ? unsigned(1 + std::lround((double(z) - double(near)) * scale)) : 0u;
    const unsigned less = (value - before) & 0xffffu;
    before = value;
    planes[i] = static_cast<unsigned char>(less & 255),
    planes[depth.size() + i] = static_cast<unsigned char>(less >> 8);
  }
  uLongf size = compressBound(uLong(planes.size()));
  out.bytes = std::string(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.bytes.data()), &size, planes.data(), uLong(planes.size()), 6) !=
      Z_OK)
    throw Error(ErrorCode::out_of_memory, "there is no memory to pack the depth of a picture");
  out.bytes.resize(size);
  return out;
}

std::string depth_text(std::size_t view, const Image<float>& depth) {
  const PackedDepth all = packed(depth);
  return fmt::format(
      "takeDepth({},{{\"width\":{},\"height\":{},\"near\":{:.9g},\"far\":{:.9g},\"data\":\"{}\"}});\n", view,
      depth.width(), depth.height(), all.near, all.far, base64(all.bytes));
}

}  // namespace sfumato::publish
