// Points in the OpenGL scene of another program, such as a viewer or an editor. Its objects and the
// points occlude each other.
//
//   sfumato::EmbeddedRenderer points;                 // any thread
//   points.set_cloud(sfumato::io::read("scan.laz").cloud);
//   // every frame, with the host's context current, after its opaque objects were drawn:
//   points.request("surface", {view_matrix, projection_matrix, width, height});
//   points.draw(framebuffer, {0, 0, width, height});
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "sfumato/renderer.h"

namespace sfumato {

/// The host's matrices as OpenGL takes them, column by column: world to eye (turns and moves), eye to clip.
struct HostView {
  dmat4 view, projection;
  int width = 0, height = 0;  ///< px
  bool operator==(const HostView&) const = default;
};

/// Pictures are made by a separate thread in a separate context, so the host never waits. Only `draw`
/// uses the host's context, and it restores its state.
class EmbeddedRenderer {
 public:
  EmbeddedRenderer();
  /// Cancels what is going on and waits for it.
  ~EmbeddedRenderer();
  EmbeddedRenderer(const EmbeddedRenderer&) = delete;
  EmbeddedRenderer& operator=(const EmbeddedRenderer&) = delete;

  /// Returns at once; pictures of the cloud before it are cancelled. Rooms keep all of their walls.
  void set_cloud(PointCloud cloud, const ColorSettings& coloring = {});
  /// Asks for a picture and returns at once. The newest request wins; a repeated request does
  /// nothing. Throws Error(usage) for matrices that no camera has (camera_of_matrices).
  void request(const std::string& technique, const HostView& view, const Parameters& parameters = {});
  /// Waits up to `seconds` until the last request is answered; false: not yet. Throws its
  /// error.
  bool wait(double seconds);
  /// The newest picture over `viewport` (as of glViewport) of the framebuffer (0: the window's) in the
  /// current context, depth-tested against its content. It may be of an earlier view
  /// while a newer one is being drawn: `drawn` says which. `opacity` is that of the whole picture. False:
  /// there is none yet. Throws Error(no_gl) where no context of OpenGL 4.5 is current, and the error of the
  /// last request.
  bool draw(std::uint32_t framebuffer, const std::array<int, 4>& viewport, float opacity = 1);
  /// The view of the picture that `draw` would show.
  HostView drawn() const;
  /// Frees the objects of `draw` in the host's context, which must be current. Otherwise they are freed with
  /// the context.
  void release();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato
