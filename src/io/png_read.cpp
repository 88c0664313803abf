#include "io/png_read.h"

#include <png.h>

#include <algorithm>
#include <cstring>

#include "io/file.h"
#include "io/format.h"

namespace sfumato::io {
namespace {

struct Source {
  const std::string& bytes;
  std::size_t at = 0;
};

void read_bytes(png_structp png, png_bytep out, png_size_t count) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (count > source->bytes.size() - source->at) png_error(png, "the file ends too early");
  std::memcpy(out, source->bytes.data() + source->at, count);
  source->at += count;
}

struct Failure {
  char text[128] = "damaged";
};

void keep_error(png_structp png, png_const_charp what) {
  auto* failure = static_cast<Failure*>(png_get_error_ptr(png));
  std::strncpy(failure->text, what, sizeof failure->text - 1);
  png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

// The parts that libpng may leave by longjmp: no object with a destructor lives in here.
bool read_info(png_structp png, png_infop info, PngPicture& picture) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_info(png, info);
  png_set_packing(png);
  if (png_get_color_type(png, info) == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (png_get_bit_depth(png, info) < 8) png_set_expand(png);
  if (png_get_bit_depth(png, info) == 16) png_set_swap(png);  // big-endian in the file
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  picture.width = png_get_image_width(png, info);
  picture.height = png_get_image_height(png, info);
  picture.channels = png_get_channels(png, info);
  picture.bits = png_get_bit_depth(png, info);
  return true;
}

bool read_pixels(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, rows);
  return true;
}

}  // namespace

PngPicture read_png(const std::filesystem::path& path) {
  const File file(path);
  constexpr std::uint64_t largest_file = 1 << 30;
  if (file.size() > largest_file)
    bad_input(path, "byte 0", "found a picture of more than 1 GB, expected a frame of a camera");
  const std::string bytes = file.read_text(0, std::size_t(file.size()));
  if (bytes.size() < 8 || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) != 0)
    bad_input(path, "byte 0", "found no PNG, expected one");
  Source source{bytes};
  Failure failure;
  PngPicture picture;
  std::vector<std::uint8_t> pixels;
  std::vector<png_bytep> rows;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, keep_error, ignore_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info) {
    png_destroy_read_struct(&png, nullptr, nullptr);
    throw Error(ErrorCode::out_of_memory, path.string() + ": libpng is out of memory");
  }
  png_set_read_fn(png, &source, read_bytes);
  bool done = read_info(png, info, picture);
  if (done) {
    // Deflate makes at most 1032 bytes out of one: more cannot be in the file.
    const std::uint64_t row =
        std::uint64_t(picture.width) * std::uint64_t(picture.channels) * std::uint64_t(picture.bits / 8);
    if (row * picture.height > 1100 * file.size()) {
      std::strcpy(failure.text, "more pixels than its bytes can hold");
      done = false;
    } else {
      pixels.resize(std::size_t(row * picture.height));
      for (std::uint32_t y = 0; y < picture.height; ++y) rows.push_back(pixels.data() + y * row);
      done = read_pixels(png, rows.data());
    }
  }
  png_destroy_read_struct(&png, &info, nullptr);
  if (!done)
    bad_input(path, "byte " + std::to_string(source.at),
              std::string(failure.text) + "; the picture is damaged");
  picture.samples.resize(pixels.size() / std::size_t(picture.bits / 8));
  if (picture.bits == 16)
    std::memcpy(picture.samples.data(), pixels.data(), pixels.size());
  else
    std::copy(pixels.begin(), pixels.end(), picture.samples.begin());
  return picture;
}

}  // namespace sfumato::io
