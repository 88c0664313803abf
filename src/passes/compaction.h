// The points of a chunk that a pass has flagged, as a list in the order of the cloud.
#pragma once

#include "gl/buffer.h"
#include "gl/program.h"
#include "gl/texture.h"

namespace sfumato {

class Compaction {
 public:
  static constexpr unsigned group_size = 128;  ///< flags that one thread of compact.comp counts

  /// Makes room for a visit of `groups_per_batch` x `batches` work groups of 128 points, whose batches are
  /// the chunk's visible ones, and binds its flags as image 0: R8UI, place gl_GlobalInvocationID.x + y * 128
  /// * groups_per_batch. `most`: entries of the list.
  void bind_flags(unsigned groups_per_batch, unsigned batches, std::size_t most);
  /// Lists every point of the visit as often as its flag says. Every flag must have been written. Barriers:
  /// before, as images; after, for textures and draw commands.
  void run();

  const gl::TextureBuffer& list() const { return list_; }  ///< R32UI, places within the chunk
  const gl::Buffer& command() const { return command_; }  ///< an indirect draw of the list; first, its length

 private:
  gl::Program stages_[4];
  gl::TextureBuffer flags_, list_;
  gl::Buffer offsets_, sums_, command_;
  unsigned groups_per_batch_ = 0, group_count_ = 0;
};

}  // namespace sfumato
