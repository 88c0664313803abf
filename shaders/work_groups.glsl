// Where a work group is in its dispatch, which may be submitted in slices (gl/pace.h): of blocks of four rows taken
// from all over it, block b * step modulo their number, as dear rows lie side by side.
uniform uvec3 group_rows;  // first row, step, blocks; what is left of the rows comes last

uint group_row() {
  uint k = group_rows.x + gl_WorkGroupID.y, block = k / 4u, blocks = max(group_rows.z, 1u);
  // The remainder by a quotient that is off by one at most: software GL divides whole numbers lane by lane,
  // which took a sixth of a frame of raw points.
  uint product = block * group_rows.y;
  int rest = int(product - uint(float(product) / float(blocks)) * blocks);
  rest += rest < 0 ? int(blocks) : 0;
  rest -= rest >= int(blocks) ? int(blocks) : 0;
  return block < group_rows.z ? uint(rest) * 4u + k % 4u : k;
}
