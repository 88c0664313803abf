// Every binding point of the house, in one place. Kept in step with src/passes/bindings.h.
#define UNIT_POSITIONS 0      // RGB32F, relative to the cloud's origin
#define UNIT_SOURCE_INDEX 1   // R32UI, place in the file
#define UNIT_COLORS 2         // RGBA8, sRGB
#define UNIT_NORMALS 3        // RG16, octahedral, (0,0) = none
#define UNIT_RADII 4          // R32F
#define UNIT_FIELD 5          // R32F, whatever scalar the technique asked for
#define UNIT_SHADOW 6         // R32F, shadow factor: 1 lit, 0 dark
#define UNIT_BATCHES 7        // RGBA32UI: first, count, spacing (float bits), 0
#define UNIT_INPUT 8          // 8..15: textures of the pass
#define UNIT_PLACES 16        // R32UI, place in the sorted cloud of each source index
#define UNIT_LIST 17          // R32UI, places within the chunk in drawing order

#define BLOCK_FRAME 0
