// The 3 x 3 Gaussian around a pixel. Loops over it run `taps` = 9 or 0 times: llvmpipe computes both sides of
// a branch, but leaves a loop when none of its pixels wants more.
ivec2 gaussian_offset(int tap) { return ivec2(tap % 3 - 1, tap / 3 - 1); }
float gaussian_weight(int tap) { return (tap % 3 == 1 ? 2.0 : 1.0) * (tap / 3 == 1 ? 2.0 : 1.0) / 16.0; }
