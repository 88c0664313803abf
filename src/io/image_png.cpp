#include "io/image_png.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <optional>

#include "core/error.h"
#include "io/atomic_writer.h"

namespace sfumato::io {
namespace {

struct Sink {
  std::function<void(std::string_view)> write;
  std::exception_ptr error;  // exceptions must not cross libpng's C frames
};

void write_bytes(png_structp png, png_bytep bytes, png_size_t count) {
  auto* sink = static_cast<Sink*>(png_get_io_ptr(png));
  try {
    sink->write(std::string_view(reinterpret_cast<const char*>(bytes), count));
  } catch (...) {
    sink->error = std::current_exception();
    png_error(png, "write failed");
  }
}

void fill_row(const Image<Rgba8>& image, int y, bool alpha, std::uint8_t* out) {
  for (int x = 0; x < image.width(); ++x) {
    const Rgba8& c = image.at(x, y);
    *out++ = c.r, *out++ = c.g, *out++ = c.b;
    if (alpha) *out++ = c.a;
  }
}

void fill_row(const Image<std::uint16_t>& image, int y, bool, std::uint8_t* out) {
  for (int x = 0; x < image.width(); ++x) {  // PNG is big-endian
    *out++ = std::uint8_t(image.at(x, y) >> 8);
    *out++ = std::uint8_t(image.at(x, y) & 255);
  }
}

/// The parts that libpng may leave by longjmp: no object with a destructor lives in them.
bool begin(png_structp png, png_infop info, int width, int height, bool gray, bool alpha,
           const std::vector<png_text>& texts, double dpi) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), gray ? 16 : 8,
               gray    ? PNG_COLOR_TYPE_GRAY
               : alpha ? PNG_COLOR_TYPE_RGB_ALPHA
                       : PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // Level 1 with the SUB filter: 424 ms for a 4K picture on one core; level 6 takes several times as long for
  // a few per cent.
  png_set_compression_level(png, 1);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  if (!gray) png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  const auto per_metre = png_uint_32(std::lround(dpi / 0.0254));
  if (dpi > 0) png_set_pHYs(png, info, per_metre, per_metre, PNG_RESOLUTION_METER);
  if (!texts.empty()) png_set_text(png, info, texts.data(), int(texts.size()));
  png_write_info(png, info);
  return true;
}

template <class T>
bool write_rows(png_structp png, const Image<T>& rows, bool alpha, std::vector<std::uint8_t>& row) {
  if (setjmp(png_jmpbuf(png))) return false;
  for (int y = 0; y < rows.height(); ++y) {
    fill_row(rows, y, alpha, row.data());
    png_write_row(png, row.data());
  }
  return true;
}

bool end(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_write_end(png, info);
  return true;
}

}  // namespace

struct PngRows::State {
  std::string file;
  int width, height;
  bool alpha;
  std::optional<AtomicWriter> writer;  ///< nothing: into memory
  Sink sink;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<std::uint8_t> row;

  State(const std::filesystem::path& path, int width_px, int height_px, bool gray, bool with_alpha,
        const PngTexts& texts, double dpi = 0, std::string* bytes = nullptr);
  ~State() { png_destroy_write_struct(&png, &info); }
  void expect(bool done) const {
    if (sink.error) std::rethrow_exception(sink.error);
    if (!done)
      throw Error(ErrorCode::io, "cannot write " + file + ": libpng refused a picture of " +
                                     std::to_string(width) + "x" + std::to_string(height));
  }
  template <class T>
  void write(const Image<T>& rows) {
    expect(write_rows(png, rows, alpha, row));
  }
  void finish() {
    expect(end(png, info));
    if (writer) writer->commit();
  }
};

PngRows::State::State(const std::filesystem::path& path, int width_px, int height_px, bool gray,
                      bool with_alpha, const PngTexts& texts, double dpi, std::string* bytes)
    : file(path.string()),
      width(width_px),
      height(height_px),
      alpha(with_alpha),
      row(std::size_t(width_px) * 4) {
  if (bytes)
    sink.write = [bytes](std::string_view more) { bytes->append(more); };
  else
    writer.emplace(path), sink.write = [this](std::string_view more) { writer->write(more); };
  std::vector<png_text> entries;
  for (const auto& [key, value] : texts) {
    png_text entry{};
    // Plain Latin-1 where it will do: every tool shows tEXt, fewer show iTXt.
    const bool ascii = std::all_of(value.begin(), value.end(), [](char c) { return (c & 0x80) == 0; });
    entry.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
    entry.key = const_cast<char*>(key.c_str());
    entry.text = const_cast<char*>(value.c_str());
    entry.text_length = ascii ? value.size() : 0;
    entry.itxt_length = ascii ? 0 : value.size();
    entries.push_back(entry);
  }
  png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr,
                                [](png_structp, png_const_charp) {});  // warnings are no errors
  info = png ? png_create_info_struct(png) : nullptr;
  if (!info) {
    png_destroy_write_struct(&png, nullptr);
    throw Error(ErrorCode::out_of_memory, "cannot write " + file + ": libpng is out of memory");
  }
  png_set_write_fn(png, &sink, write_bytes, nullptr);
  // libpng takes a million pixels a side for an attack unless told otherwise.
  png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
  const bool done = begin(png, info, width, height, gray, alpha, entries, dpi);
  if (!done) {
    png_destroy_write_struct(&png, &info);
    expect(false);
  }
}

PngRows::PngRows(const std::filesystem::path& file, int width, int height, bool alpha, const PngTexts& texts,
                 double dpi)
    : state_(std::make_unique<State>(file, width, height, false, alpha, texts, dpi)) {}
PngRows::~PngRows() = default;
void PngRows::write(const Image<Rgba8>& rows) { state_->write(rows); }
void PngRows::finish() { state_->finish(); }

void write_png(const std::filesystem::path& file, const Image<Rgba8>& image, bool alpha,
               const PngTexts& texts, double dpi) {
  PngRows rows(file, image.width(), image.height(), alpha, texts, dpi);
  rows.write(image);
  rows.finish();
}

std::string png_bytes(const Image<Rgba8>& image, bool alpha, const PngTexts& texts) {
  std::string bytes;
  PngRows::State state("a picture in memory", image.width(), image.height(), false, alpha, texts, 0, &bytes);
  state.write(image);
  state.finish();
  return bytes;
}

void write_png(const std::filesystem::path& file, const Image<std::uint16_t>& gray, const PngTexts& texts) {
  PngRows::State state(file, gray.width(), gray.height(), true, false, texts);
  state.write(gray);
  state.finish();
}

}  // namespace sfumato::io
