// What a hit says about a surface, in units of what a surface needs to be believed (automatic threshold).
//
// A place that n splats cover at random weighs n/7 on average (the mean of Wendland's function over a disc is 1/7).
// Eq. 20 makes it n = 4 times the square of the radius scale; where pixels are larger than splats, all splats of a pixel
// meet in it, and more of them where the surface is tilted.
uniform float covers;         // n; 0: weights as they are (a threshold given by hand)
uniform float surface_share;  // of that mean

float evidence(Splat splat) {
  float n = covers;
#ifdef SPLAT_PREFILTER
  float facing = max(abs(dot(splat.normal, to_camera(splat.center))), 0.05);
  float radius_px = splat.radius * pixels_at(max(-splat.center.z, splat_near())) / splat_prefilter_px;
  n *= max(1.0, 1.0 / (radius_px * radius_px * facing));
#endif
  return 7.0 / (surface_share * n);
}
