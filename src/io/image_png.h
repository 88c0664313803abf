// Pictures as PNG.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"

namespace sfumato::io {

/// Key and value pairs kept in the picture, readable by any image viewer ("Software", "Command", ...).
using PngTexts = std::vector<std::pair<std::string, std::string>>;

/// 8-bit sRGB. With `alpha` the picture is RGBA with straight alpha, else RGB. The file appears under its
/// name only when it is complete; throws Error(io). `dpi`: pixels an inch on paper, 0: none is said.
void write_png(const std::filesystem::path& file, const Image<Rgba8>& image, bool alpha,
               const PngTexts& texts = {}, double dpi = 0);

/// What `write_png` would write.
std::string png_bytes(const Image<Rgba8>& image, bool alpha, const PngTexts& texts = {});

/// The same from top to bottom, for pictures that are never in memory as a whole. Without `finish` nothing
/// appears.
class PngRows {
 public:
  PngRows(const std::filesystem::path& file, int width, int height, bool alpha, const PngTexts& texts = {},
          double dpi = 0);
  ~PngRows();
  PngRows(const PngRows&) = delete;
  PngRows& operator=(const PngRows&) = delete;
  /// The next rows, as wide as the picture.
  void write(const Image<Rgba8>& rows);
  /// After the last row.
  void finish();

  struct State;

 private:
  std::unique_ptr<State> state_;
};

/// 16-bit grey, linear numbers.
void write_png(const std::filesystem::path& file, const Image<std::uint16_t>& gray,
               const PngTexts& texts = {});

}  // namespace sfumato::io
