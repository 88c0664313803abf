// Reads pictures back, with libpng's own simple reader and not with the code that wrote them.
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <filesystem>

#include "core/image.h"

namespace sfumato::testing {

/// RGBA, top row first; an empty picture and a test failure when the file cannot be read.
inline Image<Rgba8> read_png(const std::filesystem::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, file.c_str())) {
    ADD_FAILURE() << file << ": " << png.message;
    return {};
  }
  png.format = PNG_FORMAT_RGBA;
  Image<Rgba8> image(int(png.width), int(png.height));
  EXPECT_TRUE(png_image_finish_read(&png, nullptr, image.data(), 0, nullptr)) << png.message;
  return image;
}

/// 16-bit grey, as stored.
inline Image<std::uint16_t> read_gray(const std::filesystem::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, file.c_str())) {
    ADD_FAILURE() << file << ": " << png.message;
    return {};
  }
  png.format = PNG_FORMAT_LINEAR_Y;
  Image<std::uint16_t> image(int(png.width), int(png.height));
  EXPECT_TRUE(png_image_finish_read(&png, nullptr, image.data(), 0, nullptr)) << png.message;
  return image;
}

}  // namespace sfumato::testing
