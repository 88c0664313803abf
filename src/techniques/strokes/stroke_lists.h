// The A-buffer: the fragments of every pixel that lie before the first opaque one, sorted front to back and mixed,
// all at once or one step a frame (dos Anjos 2017, Sec. 3.3 and Alg. 2).
#pragma once

#include <cstdint>
#include <vector>

#include "gl/state.h"
#include "techniques/strokes/stroke_set.h"

namespace sfumato::strokes {

class StrokeLists {
 public:
  /// Running sums over the sorted fragments: colour and transmittance, normal and shadow, ray distance.
  struct Sums {
    gl::Texture color, normal, rest;
  };

  /// Finds, counts and stores the fragments of `strokes`. What needs more than `most_bytes` is cut into bands of
  /// rows, each stored by itself: none is lost.
  void count(const View& view, StrokeSet& strokes, const gl::Texture& brush, StrokeOrder order,
             std::uint64_t most_bytes);
  /// All bands, completely.
  void sort_all(const View& view, const StrokeSet& strokes, const gl::Texture& brush, float relief);
  /// `steps` more of each pixel's fragments; only for a picture of one band, after `store_only_band`. True when
  /// nothing is left to do.
  void store_only_band(const View& view, const StrokeSet& strokes, const gl::Texture& brush);
  bool sort_some(const View& view, const StrokeSet& strokes, float relief, int steps);

  /// The stored lists, for a screen pass: offsets, cursors and fragments at UNIT_INPUT + 1 to 3.
  void bind_lists() const;

  std::size_t bands() const { return bands_.size(); }
  std::uint64_t fragments() const { return fragment_count_; }
  const Sums& sums() const { return sums_[current_]; }

 private:
  struct Band {
    int first_row, last_row;
    std::uint64_t fragments;
  };
  const gl::Texture* before_opaque() const;
  gl::State before_opaque_state(gl::State::Blend blend) const;
  void draw(const StrokeSet& strokes, gl::Program& program, const gl::Texture& brush) const;
  void cut_bands(int width, int height, std::uint64_t most_bytes);
  void store(const View& view, const StrokeSet& strokes, const gl::Texture& brush, const Band& band);
  bool sort(const View& view, const StrokeSet& strokes, float relief, const Band& band, int first_step, int steps);

  StrokeOrder order_ = StrokeOrder::stroke;
  gl::Program opaque_[2], count_[2], store_[2], sum_rows_, place_rows_;
  ScreenPass sort_;
  gl::Texture opaque_depth_, counts_, offsets_, cursors_;
  gl::Buffer row_places_, unfinished_;
  gl::TextureBuffer fragments_;
  std::vector<Band> bands_;
  std::uint64_t fragment_count_ = 0;
  Sums sums_[2];
  int current_ = 0, steps_done_ = 0;
};

}  // namespace sfumato::strokes
