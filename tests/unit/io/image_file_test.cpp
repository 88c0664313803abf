// Lossy pictures, decoded by the libraries themselves.
#include "io/image_file.h"

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

}  // namespace
