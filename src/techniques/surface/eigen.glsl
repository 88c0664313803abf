// Eigenvalues of a symmetric matrix, ascending (Smith 1961).
vec3 eigenvalues(mat3 a) {
  float q = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
  mat3 b = a - mat3(q);
  float p = sqrt(max((dot(b[0], b[0]) + dot(b[1], b[1]) + dot(b[2], b[2])) / 6.0, 1e-20));
  float angle = acos(clamp(0.5 * determinant(b / p), -1.0, 1.0)) / 3.0;
  float high = q + 2.0 * p * cos(angle), low = q + 2.0 * p * cos(angle + 2.0943951);
  return vec3(low, 3.0 * q - high - low, high);
}

// A vector that a - value maps to nothing: the longest cross product of its rows.
vec3 eigenvector(mat3 a, float value) {
  a -= mat3(value);
  vec3 u = cross(a[0], a[1]), v = cross(a[1], a[2]), w = cross(a[2], a[0]);
  float uu = dot(u, u), vv = dot(v, v), ww = dot(w, w);
  vec3 best = uu >= max(vv, ww) ? u : vv >= ww ? v : w;
  float size = max(uu, max(vv, ww));
  return size > 0.0 ? best * inversesqrt(size) : vec3(0.0);
}
