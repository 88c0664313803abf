// The fragments of whole strokes on software GL. Strokes come near to far, so that one pass on the processor
// finds the opaque fragment of a pixel, what lies before it, and nothing else; GL draws the strokes once for
// either (stroke_lists.h), and the rasteriser spends most of that on what turns out to be hidden.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "techniques/strokes/stroke_set.h"

namespace sfumato::strokes {

class FragmentsCpu {
 public:
  /// Lists take whole pages; a strip of rows leaves at most one of them unfilled.
  static constexpr std::uint64_t page = 1024;
  static constexpr int strip_rows = 16;

  /// Takes over the strokes of a view.
  void begin(const View& view, const StrokeSet& strokes, const BrushPicture& brush);
  /// Links the fragments of rows [first, last) into lists from near to far, as far as `room` fragments
  /// suffice, and counts all of them. The lists do not depend on the number of threads, their places in
  /// `fragments` do.
  std::uint64_t list(int first_row, int last_row, glm::uvec4* fragments, std::uint64_t room);
  /// First fragment of every pixel.
  const Image<std::uint32_t>& heads() const { return heads_; }
  /// Fragments of every row that was listed.
  const std::vector<std::uint32_t>& row_counts() const { return row_counts_; }

 private:
  /// A stroke on the screen. Places on it are (u . p, v . p) / (w . p) of p = (x - base_x, y - base_y, 1), x
  /// and y whole pixels: the first of the whole picture that it may touch, so that a tile computes what the
  /// whole does.
  struct Quad {
    vec3 u, v, w;
    vec2 reach;                    // of the paint, -1 to 1
    int x0, y0, x1 = -1, y1 = -1;  // first and last pixel; nothing of it is seen where x1 < x0
    int base_x, base_y;
    std::uint32_t key, stroke;  // bits of a positive float sort like it
    int tile_x, tile_y, level;
    float between_levels, inset, opacity;
    bool too_near;  // parts of it
    vec3 depth;     // of the centre, and how it grows along and across
  };
  struct Pages;
  void order_strokes(const StrokeSet& strokes);
  void set_up(const View& view, const BrushPicture& brush);
  void list_strip(std::uint32_t strip, int first_row, int last_row, Pages& pages);

  std::vector<glm::uvec4> records_;
  std::vector<std::uint32_t> order_, starts_, entries_, row_counts_;
  std::vector<Quad> quads_;
  const BrushPicture* brush_ = nullptr;
  Image<std::uint32_t> heads_;
  float near_ = 0;
};

}  // namespace sfumato::strokes
