// Every binding point of the house, in one place. Kept in step with src/passes/bindings.h.
#define UNIT_POSITIONS 0      // RGB32F, relative to the cloud's origin
#define UNIT_SOURCE_INDEX 1   // R32UI, place in the file
#define UNIT_COLORS 2         // RGBA8, sRGB
#define UNIT_NORMALS 3        // RG16, octahedral, (0,0) = none
#define UNIT_RADII 4          // RG32F, and how far the point lies on a surface
#define UNIT_FIELD 5          // R32F, whatever scalar the technique asked for
#define UNIT_SHADOW 6         // R32F, shadow factor: 1 lit, 0 dark
#define UNIT_BATCHES 7        // RGBA32UI, two texels each: first, count, bits of least and most log2 spacing; bits of its plane
#define UNIT_INPUT 8          // 8..15: textures of the pass
#define UNIT_PLACES 16        // R32UI, place in the sorted cloud of each source index
#define UNIT_LIST 17          // R32UI, places within the chunk in drawing order
#define UNIT_FRAGMENT_OFFSETS 18  // R32UI, place of the first fragment of each pixel
#define UNIT_FRAGMENTS 19     // RG32UI, fragments of all pixels
#define UNIT_CASTERS 20       // R32F, share of the light that a point stops
#define UNIT_TILES 21         // one texel a tile of the image, above 0 where a pass has to run
#define UNIT_MORE_INPUTS 22   // 22..24: the ninth texture of the pass and those after it
#define UNIT_FARTHEST 22      // 22..26: of light maps, in the lit test, which has no more inputs
#define UNIT_THICKNESS 27     // R32F, of the layer that a point lies in

// Images 0..3 are the outputs of screen passes.
#define IMAGE_FRAGMENT_CURSOR 4   // R32UI, fragments stored in each pixel, or the first of its list
#define IMAGE_FRAGMENTS 5         // RG32UI; RGBA32UI where they are linked
#define IMAGE_PROGRESS 6          // R32UI, how far a pixel is that several passes work on

#define BLOCK_FRAME 0
#define BLOCK_CUT 1
