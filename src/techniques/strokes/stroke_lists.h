// The A-buffer: the fragments of every pixel that lie before the first opaque one, sorted front to back and
// mixed, all at once or one step a frame (dos Anjos 2017, Sec. 3.3 and Alg. 2).
#pragma once

#include <cstdint>
#include <vector>

#include "gl/state.h"
#include "techniques/strokes/fragments_cpu.h"
#include "techniques/strokes/stroke_set.h"

namespace sfumato::strokes {

class StrokeLists {
 public:
  /// Running sums over the sorted fragments: colour and transmittance, normal and shadow, ray distance.
  struct Sums {
    gl::Texture color, normal, rest;
  };

  /// Finds the fragments of `strokes` and links them into lists, in one pass if there is room. What needs
  /// more than `most_bytes` is counted and cut into bands of rows, each stored by itself: none is lost.
  void build(const View& view, StrokeSet& strokes, const BrushPicture& brush, StrokeOrder order,
             std::uint64_t most_bytes);
  /// All bands, completely.
  void sort_all(const View& view, const StrokeSet& strokes, const BrushPicture& brush, float relief);
  /// `steps` more of each pixel's fragments; only for a picture of one band. True when nothing is left to do.
  bool sort_some(const View& view, const StrokeSet& strokes, float relief, int steps);

  /// The lists before any sorting, for a screen pass: first fragments and fragments at UNIT_INPUT + 1 and 2.
  void bind_lists() const;

  std::size_t bands() const { return bands_.size(); }
  std::uint64_t fragments() const { return fragment_count_; }
  const Sums& sums() const { return sums_[current_]; }

 private:
  struct Band {
    int first_row, last_row;
  };
  void find_opaque(const View& view, StrokeSet& strokes, const BrushPicture& brush);
  const gl::Texture* before_opaque() const;
  gl::State before_opaque_state(gl::State::Blend blend) const;
  void draw(const StrokeSet& strokes, gl::Program& program, const BrushPicture& brush) const;
  void make_room(std::uint64_t fragments);
  std::uint64_t room() const;
  std::uint64_t page_slack(int height) const;
  std::vector<std::uint32_t> count(const View& view, const StrokeSet& strokes, const BrushPicture& brush);
  void cut_bands(const std::vector<std::uint32_t>& rows, std::uint64_t limit);
  std::uint64_t store(const View& view, const StrokeSet& strokes, const BrushPicture& brush,
                      const Band& band);
  bool sort(const View& view, const StrokeSet& strokes, float relief, const Band& band, int first_step,
            int steps);

  StrokeOrder order_ = StrokeOrder::stroke;
  gl::Program opaque_[2], count_[2], store_[2], count_rows_;
  ScreenPass sort_;
  gl::Texture opaque_depth_, counts_, heads_;
  gl::Buffer row_counts_, stored_, unfinished_;
  gl::TextureBuffer fragments_;
  FragmentsCpu cpu_;
  bool on_cpu_ = false;
  std::vector<Band> bands_;
  std::uint64_t fragment_count_ = 0;  ///< of the picture, also of one that needs bands
  Sums sums_[2];
  int current_ = 0, steps_done_ = 0;
};

}  // namespace sfumato::strokes
