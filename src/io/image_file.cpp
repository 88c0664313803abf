#include "io/image_file.h"

#include <jpeglib.h>
#include <webp/encode.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/atomic_writer.h"

namespace sfumato::io {
namespace {

struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf jump;
};

[[noreturn]] void leave(j_common_ptr codec) {
  std::longjmp(reinterpret_cast<JpegErrors*>(codec->err)->jump, 1);
}

/// The part that libjpeg may leave by longjmp: no object with a destructor lives in here.
bool encode_jpeg(jpeg_compress_struct& codec, JpegErrors& errors, const Image<Rgba8>& image, int quality,
                 double dpi, JSAMPLE* row, unsigned char** bytes, unsigned long* size) {
  codec.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = leave;
  if (setjmp(errors.jump)) return false;
  jpeg_create_compress(&codec);
  jpeg_mem_dest(&codec, bytes, size);
  codec.image_width = JDIMENSION(image.width());
  codec.image_height = JDIMENSION(image.height());
  codec.input_components = 3;
  codec.in_color_space = JCS_RGB;
  jpeg_set_defaults(&codec);
  jpeg_set_quality(&codec, quality, TRUE);
  if (dpi > 0) {
    codec.density_unit = 1;  // inch
    codec.X_density = codec.Y_density = UINT16(std::lround(dpi));
  }
  if (quality >= 90)  // thin coloured points keep their colour
    codec.comp_info[0].h_samp_factor = codec.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&codec, TRUE);
  for (int y = 0; y < image.height(); ++y) {
    JSAMPLE* out = row;
    for (int x = 0; x < image.width(); ++x) {
      const Rgba8& c = image.at(x, y);
      *out++ = c.r, *out++ = c.g, *out++ = c.b;
    }
    jpeg_write_scanlines(&codec, &row, 1);
  }
  jpeg_finish_compress(&codec);
  return true;
}

void refuse_size(const std::filesystem::path& file, const Image<Rgba8>& image, int limit,
                 const char* format) {
  if (image.width() > limit || image.height() > limit)
    throw Error(ErrorCode::usage, file.string() + ": " + format + " holds at most " + std::to_string(limit) +
                                      " pixels a side; write a .png");
}

std::string print(float value) {
  char buffer[48];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string encoded_jpeg(const std::filesystem::path& file, const Image<Rgba8>& image, int quality,
                         double dpi) {
  refuse_size(file, image, 65500, "JPEG");
  std::vector<JSAMPLE> row(std::size_t(image.width()) * 3);
  jpeg_compress_struct codec{};
  JpegErrors errors{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const bool done = encode_jpeg(codec, errors, image, quality, dpi, row.data(), &bytes, &size);
  jpeg_destroy_compress(&codec);
  const std::unique_ptr<unsigned char, decltype(&std::free)> owner(bytes, std::free);
  if (!done)
    throw Error(ErrorCode::io, file.string() + ": libjpeg could not encode the picture; write a .png");
  return std::string(reinterpret_cast<const char*>(bytes), size);
}

}  // namespace

std::string jpeg_bytes(const Image<Rgba8>& image, int quality) {
  return encoded_jpeg("a picture in memory", image, quality, 0);
}

void write_jpeg(const std::filesystem::path& file, const Image<Rgba8>& image, int quality, double dpi) {
  AtomicWriter writer(file);
  writer.write(encoded_jpeg(file, image, quality, dpi));
  writer.commit();
}

void write_webp(const std::filesystem::path& file, const Image<Rgba8>& image, bool alpha, int quality) {
  refuse_size(file, image, WEBP_MAX_DIMENSION, "WebP");
  AtomicWriter writer(file);
  std::vector<std::uint8_t> pixels;
  pixels.reserve(image.size() * 4);
  for (const Rgba8& c : image) pixels.insert(pixels.end(), {c.r, c.g, c.b, std::uint8_t(alpha ? c.a : 255)});
  std::uint8_t* bytes = nullptr;
  const int stride = image.width() * 4;
  const std::size_t size =
      quality == 100
          ? WebPEncodeLosslessRGBA(pixels.data(), image.width(), image.height(), stride, &bytes)
          : WebPEncodeRGBA(pixels.data(), image.width(), image.height(), stride, float(quality), &bytes);
  const std::unique_ptr<std::uint8_t, decltype(&WebPFree)> owner(bytes, WebPFree);
  if (size == 0)
    throw Error(ErrorCode::io, file.string() + ": libwebp could not encode the picture; write a .png");
  writer.write(std::string_view(reinterpret_cast<const char*>(bytes), size));
  writer.commit();
}

void write_depth_png(const std::filesystem::path& file, const Image<float>& depth, PngTexts texts) {
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
  for (float z : depth)
    if (std::isfinite(z)) nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  Image<std::uint16_t> gray(depth.width(), depth.height());
  const double span = double(farthest) - double(nearest);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float z = depth.data()[i];
    if (!std::isfinite(z)) continue;
    const double share = span > 0 ? (double(z) - double(nearest)) / span : 0;
    gray.data()[i] = std::uint16_t(std::lround(1 + share * 65534));
  }
  texts.emplace_back("DepthNear", print(std::isfinite(nearest) ? nearest : 0));
  texts.emplace_back("DepthFar", print(farthest));
  write_png(file, gray, texts);
}

std::size_t write_depth_png(const std::filesystem::path& file, const Image<float>& depth, double step,
                            const std::string& unit, PngTexts texts) {
  Image<std::uint16_t> gray(depth.width(), depth.height());
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double steps = std::round(double(depth.data()[i]) / step);
    if (!std::isfinite(steps)) continue;
    beyond += steps > 65535;
    gray.data()[i] = std::uint16_t(std::clamp(steps, 1.0, 65535.0));
  }
  texts.emplace_back("DepthUnit", unit);
  write_png(file, gray, texts);
  return beyond;
}

}  // namespace sfumato::io
