// Where a level of clusters begins in the image that holds all of them side by side; `size` is that of the finest.
// Levels of one texture would not do: software GL fetches four neighbouring pixels from the level of the first.
ivec2 level_corner(int l, ivec2 size) { return l == 0 ? ivec2(0) : ivec2(size.x, size.y - (size.y >> (l - 1))); }
