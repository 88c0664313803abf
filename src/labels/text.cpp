#include "labels/text.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>

#include "core/error.h"

// The font file becomes part of the program, so that no font has to be installed where it runs.
asm(".section .rodata\n"
    ".global sfumato_font_begin\n"
    ".global sfumato_font_end\n"
    "sfumato_font_begin:\n"
    ".incbin \"" SFUMATO_FONT_FILE
    "\"\n"
    "sfumato_font_end:\n"
    ".byte 0\n"
    ".previous\n");
extern "C" const unsigned char sfumato_font_begin[], sfumato_font_end[];

namespace sfumato::labels {

struct Text::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;

  explicit Face(int size_px) {
    if (FT_Init_FreeType(&library) != 0 ||
        FT_New_Memory_Face(library, sfumato_font_begin, FT_Long(sfumato_font_end - sfumato_font_begin), 0,
                           &face) != 0 ||
        FT_Set_Pixel_Sizes(face, 0, FT_UInt(size_px)) != 0)
      throw Error(ErrorCode::out_of_memory, "FreeType cannot load the embedded font");
  }
  ~Face() {
    FT_Done_Face(face);
    FT_Done_FreeType(library);
  }
};

namespace {

/// The next code point of `text` from `i`, which moves on; a broken byte counts as a question mark.
unsigned next_code(std::string_view text, std::size_t& i) {
  const auto byte = [&](std::size_t k) {
    return k < text.size() ? unsigned(static_cast<unsigned char>(text[k])) : 0u;
  };
  const unsigned first = byte(i++);
  if (first < 0x80) return first;
  const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc0 ? 1 : 0;
  unsigned code = first & (0x3fu >> more);
  for (int k = 0; k < more; ++k) {
    if ((byte(i) & 0xc0) != 0x80) return '?';
    code = code << 6 | (byte(i++) & 0x3f);
  }
  return more == 0 ? '?' : code;
}

}  // namespace

Text::Text(int size_px) : size_px_(size_px), face_(std::make_unique<Face>(size_px)) {}
Text::~Text() = default;

int Text::width(std::string_view utf8) const {
  FT_Pos pen = 0;
  for (std::size_t i = 0; i < utf8.size();)
    if (FT_Load_Char(face_->face, next_code(utf8, i), FT_LOAD_DEFAULT) == 0)
      pen += face_->face->glyph->advance.x;
  return int((pen + 63) >> 6);
}

void Text::draw(Image<Rgba8>& image, int x, int y, std::string_view utf8, Rgba8 color) const {
  FT_Pos pen = FT_Pos(x) << 6;
  for (std::size_t i = 0; i < utf8.size();) {
    if (FT_Load_Char(face_->face, next_code(utf8, i), FT_LOAD_RENDER) != 0) continue;
    const FT_GlyphSlot glyph = face_->face->glyph;
    const int left = int(pen >> 6) + glyph->bitmap_left, top = y - glyph->bitmap_top;
    for (int row = 0; row < int(glyph->bitmap.rows); ++row)
      for (int column = 0; column < int(glyph->bitmap.width); ++column) {
        const int px = left + column, py = top + row;
        if (px < 0 || py < 0 || px >= image.width() || py >= image.height()) continue;
        blend(image.at(px, py), color, glyph->bitmap.buffer[row * glyph->bitmap.pitch + column]);
      }
    pen += glyph->advance.x;
  }
}

void blend(Rgba8& pixel, Rgba8 color, int coverage) {
  const int a = color.a * coverage / 255, b = pixel.a * (255 - a) / 255, sum = a + b;
  if (sum == 0) return;
  auto mix = [&](int over, int under) { return std::uint8_t((over * a + under * b + sum / 2) / sum); };
  pixel = {mix(color.r, pixel.r), mix(color.g, pixel.g), mix(color.b, pixel.b), std::uint8_t(sum)};
}

void fill(Image<Rgba8>& image, int x, int y, int width, int height, Rgba8 color, int coverage) {
  const int right = std::min(x + width, image.width()), bottom = std::min(y + height, image.height());
  for (int py = std::max(y, 0); py < bottom; ++py)
    for (int px = std::max(x, 0); px < right; ++px) blend(image.at(px, py), color, coverage);
}

Rgba8 ink_on(const vec3& background) {
  const bool light = glm::dot(background, vec3(0.299f, 0.587f, 0.114f)) > 0.5f;
  return light ? Rgba8{20, 20, 20, 255} : Rgba8{240, 240, 240, 255};
}

}  // namespace sfumato::labels
