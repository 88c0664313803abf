#include "io/texture.h"

#include <cstdio>  // jpeglib.h needs it first

#include <jpeglib.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>

#include "io/file.h"
#include "io/format.h"
#include "io/png_read.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr std::uint64_t largest_picture = 1 << 28;
/// 8192 x 8192, the largest that photogrammetry writes.
constexpr std::uint64_t most_pixels = 1 << 26;
/// JPEG is unpacked at a half, a quarter or an eighth beyond this: no more points show it.
constexpr std::uint64_t enough_pixels = 1 << 24;

struct JpegFailure {
  jpeg_error_mgr base;
  std::jmp_buf leave;
};
void leave_jpeg(j_common_ptr jpeg) { std::longjmp(reinterpret_cast<JpegFailure*>(jpeg->err)->leave, 1); }
void say_nothing(j_common_ptr) {}

// The parts that libjpeg may leave by longjmp: no object with a destructor lives in here.
bool start_jpeg(jpeg_decompress_struct& jpeg, JpegFailure& failure, const std::string& bytes) {
  if (setjmp(failure.leave)) return false;
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  // Also of CMYK, which libjpeg does not turn to RGB, the shades.
  jpeg.out_color_space = jpeg.num_components >= 4 ? JCS_CMYK : JCS_RGB;
  const std::uint64_t pixels = std::uint64_t(jpeg.image_width) * jpeg.image_height;
  if (pixels > 16 * most_pixels) return false;
  jpeg.scale_num = jpeg.scale_denom = 1;
  while (jpeg.scale_denom < 8 && pixels / jpeg.scale_denom / jpeg.scale_denom > enough_pixels)
    jpeg.scale_denom *= 2;
  return jpeg_start_decompress(&jpeg) != 0;
}

bool read_jpeg_rows(jpeg_decompress_struct& jpeg, JpegFailure& failure, Texture& texture,
                    std::vector<JSAMPLE>& row) {
  if (setjmp(failure.leave)) return false;
  while (jpeg.output_scanline < jpeg.output_height) {
    Rgba8* to = texture.pixels.data() + std::size_t(jpeg.output_scanline) * texture.width;
    JSAMPLE* from = row.data();
    jpeg_read_scanlines(&jpeg, &from, 1);
    for (std::uint32_t x = 0; x < texture.width; ++x, from += jpeg.output_components) {
      const auto shade = [&](int k) {  // Adobe's CMYK is inverted
        return jpeg.output_components == 4 ? std::uint8_t(from[k] * from[3] / 255) : from[k];
      };
      to[x] = {shade(0), shade(1), shade(2), 255};
    }
  }
  return true;
}

Texture read_jpeg(const std::filesystem::path& path, const std::string& bytes) {
  JpegFailure failure;
  jpeg_decompress_struct jpeg{};
  jpeg.err = jpeg_std_error(&failure.base);
  failure.base.error_exit = leave_jpeg;
  failure.base.output_message = say_nothing;
  Texture texture;
  std::vector<JSAMPLE> row;
  bool done = start_jpeg(jpeg, failure, bytes);
  if (done) {
    texture.width = jpeg.output_width, texture.height = jpeg.output_height;
    texture.pixels.resize(std::size_t(texture.width) * texture.height);
    row.resize(std::size_t(texture.width) * std::size_t(jpeg.output_components));
    done = read_jpeg_rows(jpeg, failure, texture, row);
  }
  jpeg_destroy_decompress(&jpeg);
  if (!done) bad_input(path, "byte 0", "found a JPEG that is damaged or too large; export it again");
  return texture;
}

Texture texture_of(const PngPicture& picture) {
  Texture texture{picture.width, picture.height, {}};
  texture.pixels.resize(std::size_t(picture.width) * picture.height);
  const int shift = picture.bits - 8, channels = picture.channels;
  for (std::size_t i = 0; i < texture.pixels.size(); ++i) {
    const std::uint16_t* from = picture.samples.data() + i * std::size_t(channels);
    const auto byte = [&](int k) { return std::uint8_t(from[k] >> shift); };
    const bool is_grey = channels < 3, has_alpha = channels % 2 == 0;
    texture.pixels[i] = {byte(0), byte(is_grey ? 0 : 1), byte(is_grey ? 0 : 2),
                         has_alpha ? byte(channels - 1) : std::uint8_t(255)};
  }
  return texture;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

void Texture::halve() {
  const std::uint32_t w = std::max(1u, width / 2), h = std::max(1u, height / 2);
  std::vector<Rgba8> half(std::size_t(w) * h);
  for (std::uint32_t y = 0; y < h; ++y)
    for (std::uint32_t x = 0; x < w; ++x) {
      int sum[4] = {2, 2, 2, 2};
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t from_x = std::min(width - 1, 2 * x + k % 2),
                            from_y = std::min(height - 1, 2 * y + k / 2);
        const Rgba8& c = pixels[std::size_t(from_y) * width + from_x];
        sum[0] += c.r, sum[1] += c.g, sum[2] += c.b, sum[3] += c.a;
      }
      half[std::size_t(y) * w + x] = {std::uint8_t(sum[0] / 4), std::uint8_t(sum[1] / 4),
                                      std::uint8_t(sum[2] / 4), std::uint8_t(sum[3] / 4)};
    }
  pixels = std::move(half), width = w, height = h;
}

Rgba8 Texture::at(const vec2& place) const {
  const auto wrapped = [](float value) { return std::isfinite(value) ? value - std::floor(value) : 0.0f; };
  const float x = wrapped(place.x) * float(width) - 0.5f, y = (1 - wrapped(place.y)) * float(height) - 0.5f;
  const auto left = std::int64_t(std::floor(x)), top = std::int64_t(std::floor(y));
  float sum[4] = {};
  for (int k = 0; k < 4; ++k) {
    const std::int64_t px = left + k % 2, py = top + k / 2;
    const float share = (1 - std::abs(x - float(px))) * (1 - std::abs(y - float(py)));
    const std::size_t column = std::size_t((px + width) % width), row = std::size_t((py + height) % height);
    const Rgba8& c = pixels[row * width + column];
    sum[0] += share * c.r, sum[1] += share * c.g, sum[2] += share * c.b, sum[3] += share * c.a;
  }
  const auto byte = [](float value) { return std::uint8_t(std::clamp(value + 0.5f, 0.0f, 255.0f)); };
  return {byte(sum[0]), byte(sum[1]), byte(sum[2]), byte(sum[3])};
}

std::optional<std::filesystem::path> file_beside(const std::filesystem::path& file, std::string_view name) {
  std::string words(trimmed(name));
  if (words.size() > 1 && words.front() == '"' && words.back() == '"')
    words = words.substr(1, words.size() - 2);
  std::replace(words.begin(), words.end(), '\\', '/');
  // Nothing above the file's folder is looked at, whatever it says.
  const std::filesystem::path inside = std::filesystem::path(words).lexically_normal();
  for (const std::filesystem::path& each : {inside, inside.filename()}) {
    if (each.empty() || each.is_absolute() || *each.begin() == "..") continue;
    const std::filesystem::path found = file.parent_path() / each;
    std::error_code error;
    if (std::filesystem::is_regular_file(found, error)) return found;
  }
  return std::nullopt;
}

Texture read_texture(const std::filesystem::path& path) {
  std::string bytes;
  {
    const File file(path);
    if (file.size() > largest_picture)
      bad_input(path, "byte 0", "found a picture of more than 256 MB; export a smaller one");
    const std::string head = file.read_text(0, 24);
    if (head.starts_with("\x89PNG") && head.size() == 24) {
      const auto number = [&](std::size_t at) {
        std::uint64_t value = 0;
        for (std::size_t k = 0; k < 4; ++k) value = value << 8 | std::uint8_t(head[at + k]);
        return value;
      };
      if (number(16) * number(20) > most_pixels)
        bad_input(path, "byte 16", "found a picture of more than 8192 x 8192 pixels; export a smaller one");
      return texture_of(read_png(path));
    }
    if (!head.starts_with("\xff\xd8")) bad_input(path, "byte 0", "found neither PNG nor JPEG");
    bytes = file.read_text(0, std::size_t(file.size()));
  }
  return read_jpeg(path, bytes);
}

std::map<std::string, Material, std::less<>> read_materials(const std::filesystem::path& path) {
  std::map<std::string, Material, std::less<>> materials;
  const File file(path);
  LineReader lines(file, 0, 1);
  std::string_view line;
  Material* material = nullptr;
  while (lines.next(line)) {
    line = trimmed(line);
    if (line.starts_with("newmtl ")) {
      material = &materials[std::string(trimmed(line.substr(7)))];
    } else if (material && line.starts_with("Kd ")) {
      double value[3] = {};
      const char *at = line.data() + 3, *end = line.data() + line.size();
      try {
        for (double& each : value) each = next_number(at, end, "Kd");
      } catch (const LineError&) {
        continue;  // "Kd spectral FILE"
      }
      const auto byte = [](double v) { return std::uint8_t(std::lround(255 * std::clamp(v, 0.0, 1.0))); };
      material->color = Rgba8{byte(value[0]), byte(value[1]), byte(value[2]), 255};
    } else if (material && line.starts_with("map_Kd ")) {
      std::string_view name = trimmed(line.substr(7));
      // "-s 1 1 1 FILE": behind options the last word is the name.
      if (name.starts_with('-')) name = name.substr(name.find_last_of(" \t") + 1);
      material->picture = name;
    }
  }
  return materials;
}

}  // namespace sfumato::io
