// Where a work group is in its dispatch, which may be submitted in slices (gl/pace.h): of blocks of rows taken from
// all over it, block b * step modulo their number, as dear rows lie side by side.
uniform uvec4 group_rows;  // first, rows of a block, step, blocks; what is left of the rows comes last

uint group_row() {
  uint k = group_rows.x + gl_WorkGroupID.y, block = k / group_rows.y;
  if (block >= group_rows.w) return k;
  return block * group_rows.z % group_rows.w * group_rows.y + k % group_rows.y;
}
