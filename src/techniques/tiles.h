// How a picture that is too large for one canvas is cut into tiles.
#pragma once

#include <string>
#include <vector>

namespace sfumato {

/// Pixels of one axis, half open.
struct TileSpan {
  int first = 0, last = 0;              ///< what is kept
  int drawn_first = 0, drawn_last = 0;  ///< what is drawn: as far beyond as pixels see, within the picture
};

/// Tiles of at most `side` px (a multiple of `tile_grid`) that overlap by `overlap` px or a little more. All
/// that is drawn begins at multiples of `tile_grid`, so that squares of pixels that techniques sum up (the
/// pyramids of surface, blocks of 8 px) are those of the whole picture.
std::vector<TileSpan> tile_spans(int size, int side, int overlap);
constexpr int tile_grid = 64;

/// Adds the notes of a tile to those of the tiles before it: of lines that differ by nothing but numbers the
/// one with the largest first number stays, marked as of a tile, for a count of a part is none of the whole.
void add_tile_notes(std::vector<std::string>& all, const std::vector<std::string>& of_tile);

}  // namespace sfumato
