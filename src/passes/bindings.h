// Every binding point of the house, in one place. Kept in step with shaders/bindings.glsl.
#pragma once

namespace sfumato::binding {

enum Unit {
  positions = 0,
  source_index = 1,
  colors = 2,
  normals = 3,
  radii = 4,
  field = 5,
  shadow = 6,
  batches = 7,
  input = 8,  ///< 8..15: textures of the pass
  places = 16,
  list = 17,  ///< places within the chunk, in drawing order
  fragment_offsets = 18,
  fragments = 19,
  casters = 20,
  tiles = 21,        ///< one texel a tile of the image
  more_inputs = 22,  ///< 22..24: the ninth texture of the pass and those after it
  farthest = 22,     ///< 22..26: of light maps, in the lit test, which has no more inputs
  thickness = 27,    ///< of layers
};
/// 0..3: outputs of screen passes.
enum ImageUnit { fragment_cursor_image = 4, fragment_image = 5, progress_image = 6 };
enum Block { frame = 0, cut = 1 };

}  // namespace sfumato::binding
