// Base and Concentric models: the inside of every sphere along every ray (Seemann 2018, Secs. 3.1, 3.2
// and 4.2).
#pragma once

#include "passes/fragment_list.h"
#include "passes/screen_pass.h"
#include "techniques/soft/soft_points.h"

namespace sfumato::soft {

enum class Density { radial, uniform };
enum class Normalization { exact, eq13, eq15 };

struct InteriorSettings {
  bool concentric = false;
  Density density = Density::radial;                   ///< Base
  Normalization normalization = Normalization::exact;  ///< Concentric
  int most_shells = 32;                                ///< of any point
};

class Interior {
 public:
  /// Blends the soft points over `color`; `result` (RGBA32F, the view's size) takes the picture.
  void draw(SoftPoints& points, const View& view, const gl::Texture& solid_t, const gl::Texture& color,
            const gl::Texture& result, const InteriorSettings& settings, bool as_quads, gl::Timers& timers);
  /// Places where rays enter or leave a sphere, in the last picture.
  std::uint64_t fragments() const { return fragments_; }
  /// Entries that found 64 spheres open already; waits for the GPU.
  std::uint32_t overflows() const;
  const FragmentList& list() const { return list_; }

 private:
  gl::Program& program(bool store, bool concentric, bool as_quads);
  FragmentList list_;
  gl::Program programs_[8];
  void resolve(SoftPoints& points, const gl::Texture& solid_t, const gl::Texture& color,
               const gl::Texture& result, const InteriorSettings& settings, int shell_bits);
  ScreenPass& resolve_pass(const InteriorSettings& settings, bool long_lists);
  ScreenPass passes_[6];
  gl::Buffer counts_;     ///< pixels that a pass left unfinished, summed up; entries that found no room
  gl::Texture progress_;  ///< of long lists
  std::uint64_t fragments_ = 0;
};

}  // namespace sfumato::soft
