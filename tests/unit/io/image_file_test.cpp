// Lossy pictures, decoded by the libraries themselves.
#include "io/image_exr.h"
#include "io/image_file.h"
#include "io/npy.h"

#include <gtest/gtest.h>
#include <cstdio>  // jpeglib.h needs it before

#include <jpeglib.h>
#include <unistd.h>
#include <webp/decode.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

using namespace sfumato;

namespace {

constexpr int width = 61, height = 37;  // no multiples of the blocks of 8 and 16

Image<Rgba8> gradient() {
  Image<Rgba8> image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at(x, y) = {std::uint8_t(4 * x), std::uint8_t(6 * y), std::uint8_t(120 + x + y),
                        std::uint8_t(x < 30 ? 255 : 6 * y)};
  return image;
}

/// Rows [first, last) of it.
template <class T>
Image<T> rows_of(const Image<T>& image, int first, int last) {
  Image<T> out(image.width(), last - first);
  for (int y = first; y < last; ++y)
    for (int x = 0; x < image.width(); ++x) out.at(x, y - first) = image.at(x, y);
  return out;
}

class ImageFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("sfumato_images_" + std::to_string(getpid())),
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::vector<unsigned char> bytes(const char* name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::filesystem::path folder_;
};

TEST_F(ImageFileTest, JpegKeepsColoursAndRows) {
  const Image<Rgba8> image = gradient();
  io::write_jpeg(folder_ / "a.jpg", image, 95);
  const std::vector<unsigned char> data = bytes("a.jpg");
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, data.data(), data.size());
  ASSERT_EQ(jpeg_read_header(&info, TRUE), JPEG_HEADER_OK);
  info.out_color_space = JCS_RGB;
  jpeg_start_decompress(&info);
  ASSERT_EQ(int(info.output_width), width);
  ASSERT_EQ(int(info.output_height), height);
  std::vector<unsigned char> row(3 * width);
  double off = 0;
  for (int y = 0; y < height; ++y) {
    unsigned char* rows[] = {row.data()};
    jpeg_read_scanlines(&info, rows, 1);
    for (int x = 0; x < width; ++x)
      for (int k = 0; k < 3; ++k)
        off += std::abs(int(row[std::size_t(3 * x + k)]) - int((&image.at(x, y).r)[k]));
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
  // A smooth ramp at quality 95 is coded within a few steps; a channel or row in the wrong place is off by 40
  // and more.
  EXPECT_LT(off / (3.0 * width * height), 3);
}

TEST_F(ImageFileTest, WebpOfAHundredKeepsEveryPixel) {
  const Image<Rgba8> image = gradient();
  io::write_webp(folder_ / "a.webp", image, true, 100);
  const std::vector<unsigned char> data = bytes("a.webp");
  int w = 0, h = 0;
  unsigned char* pixels = WebPDecodeRGBA(data.data(), data.size(), &w, &h);
  ASSERT_TRUE(pixels);
  ASSERT_EQ(w, width);
  ASSERT_EQ(h, height);
  for (int i = 0; i < width * height; ++i) {
    const Rgba8 expected = image.begin()[i];
    const unsigned char* p = pixels + 4 * i;
    ASSERT_EQ(int(p[3]), int(expected.a)) << i;
    if (expected.a == 0) continue;  // the colour of nothing
    ASSERT_EQ(int(p[0]), int(expected.r)) << i;
    ASSERT_EQ(int(p[1]), int(expected.g)) << i;
    ASSERT_EQ(int(p[2]), int(expected.b)) << i;
  }
  WebPFree(pixels);
}

// Written in parts, a picture is the file that it is in one go; nothing appears before it is complete.
TEST_F(ImageFileTest, RowsComeInParts) {
  const Image<Rgba8> colors = gradient();
  Image<vec4> linear(width, height);
  Image<float> depth(width, height);
  Image<vec3> normal(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      linear.at(x, y) = vec4(x, y, x * y, 1) / 100.0f;
      depth.at(x, y) = float(x) + 0.5f * float(y);
      normal.at(x, y) = vec3(float(x), -float(y), 1);
    }
  io::write_png(folder_ / "whole.png", colors, true, {{"Software", "sfumato"}});
  io::write_exr(folder_ / "whole.exr", linear, depth, normal, "a command");
  io::write_exr(folder_ / "depth.exr", {}, depth, {}, "a command");
  io::write_npy(folder_ / "whole.npy", normal);
  {
    io::PngRows png(folder_ / "rows.png", width, height, true, {{"Software", "sfumato"}});
    io::ExrRows exr(folder_ / "rows.exr", width, height, true, true, true, "a command");
    io::ExrRows depths(folder_ / "rows_depth.exr", width, height, false, true, false, "a command");
    io::NpyRows npy(folder_ / "rows.npy", width, height, 3);
    for (const auto& [first, last] : {std::pair(0, 1), {1, 20}, {20, 36}, {36, height}}) {
      png.write(rows_of(colors, first, last));
      exr.write(rows_of(linear, first, last), rows_of(depth, first, last), rows_of(normal, first, last));
      depths.write({}, rows_of(depth, first, last), {});
      npy.write(rows_of(normal, first, last));
    }
    for (const char* name : {"rows.png", "rows.exr", "rows_depth.exr", "rows.npy"})
      EXPECT_FALSE(std::filesystem::exists(folder_ / name)) << name;
    png.finish(), exr.finish(), depths.finish(), npy.finish();
  }
  EXPECT_EQ(bytes("rows.png"), bytes("whole.png"));
  EXPECT_EQ(bytes("rows.exr"), bytes("whole.exr"));
  EXPECT_EQ(bytes("rows_depth.exr"), bytes("depth.exr"));
  EXPECT_EQ(bytes("rows.npy"), bytes("whole.npy"));
  // Who gives up leaves nothing.
  {
    io::PngRows png(folder_ / "half.png", width, height, true);
    io::ExrRows exr(folder_ / "half.exr", width, height, false, true, false);
    png.write(rows_of(colors, 0, 10));
    exr.write({}, rows_of(depth, 0, 10), {});
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "half.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "half.exr"));
}

}  // namespace
