#include "techniques/strokes/style.h"

#include <algorithm>
#include <cmath>

namespace sfumato::strokes {
namespace {

struct StyleValues {
  Brush brush;
  Look look;
};

/// In the order of `Style`. Gaussians: kind, rows, columns, A, dev, lambda, sigma_x, sigma_y, noise,
/// bristles. Look: aspect, length, coverage, opacity, relief, variation, saturation, flatten, detail, divided
/// colour, canvas, medium.
const StyleValues style_values[] = {
    {{BrushKind::gaussians, 4, 4, 3, 0.13f, 3, 0.12f, 0.085f, 12, 0.75f},
     {3.2f, 3.2f, 6, 1, 0.35f, 0.06f, 1, 0, 1}},
    {{BrushKind::gaussians, 3, 3, 4, 0.12f, 2.4f, 0.13f, 0.1f, 30, 0.5f},
     {2.2f, 4, 6, 1, 0.4f, 0.2f, 1.1f, 0, 0.6f}},
    {{BrushKind::gaussians, 1, 1, 8, 0, 2, 0.17f, 0.17f, 90, 0},
     {1, 1.6f, 5, 1, 0.25f, 0.1f, 1, 0, 0.7f, 0.3f}},
    {{BrushKind::gaussians, 3, 4, 1, 0.16f, 2.6f, 0.15f, 0.13f, 25, 0.35f},
     {1.8f, 7, 9, 0.45f, 0, 0.1f, 1, 0.3f, 0.6f, 0, 0.5f, Medium::watercolor}},
    {{BrushKind::gaussians, 5, 4, 1.3f, 0.14f, 2.4f, 0.14f, 0.05f, 6, 1},
     {4.5f, 5, 6, 1, 0.3f, 0.25f, 0, 0, 0.7f, 0, 0.6f, Medium::charcoal}},
    // The three brushes of Figure 4, quads as wide as long; every point is a stroke of its own size s.
    {{BrushKind::gaussians, 3, 3, 8, 0.03f, 3, 0.114f, 0.0989f, 15, 0}, {1, 0, 4, 1, 0, 0, 1, 0, 0}},
    {{BrushKind::gaussians, 3, 3, 1, 0.38f, 2.7f, 0.142f, 0.071f, 15, 0}, {1, 0, 4, 1, 0, 0, 1, 0, 0}},
    {{BrushKind::gaussians, 2, 3, 2.27f, 0.3f, 2.4f, 0.099f, 0.1259f, 15, 0}, {1, 0, 4, 1, 0, 0, 1, 0, 0}},
};

}  // namespace

void Parameters::describe(ParamList& p) {
  p.add("style", style,
        {"oil", "impressionist", "pointillist", "watercolor", "charcoal", "figure_4b", "figure_4c",
         "figure_4d"})
      .help(
          "sets brush and look together; parameters given besides win; the last three are the paper's "
          "brushes");
  p.add("tangent", tangent, {"auto", "householder", "eberly", "covariance"})
      .help(
          "direction of strokes: from the normal, but along strips, poles and folds; from the normal; along "
          "the neighbourhood's longest axis")
      .paper("dos Anjos 2017, Alg. 1 and Fig. 3");
  p.add("brush", brush, {"gaussians", "ellipse"})
      .help("a stroke, or a plain ellipse to compare with")
      .paper("dos Anjos 2017, Fig. 7");
  p.add("brush_rows", brush_rows).range(1, 5).help("Gaussians across the stroke");
  p.add("brush_columns", brush_columns).range(1, 5).help("Gaussians along the stroke");
  p.add("amplitude", amplitude)
      .range(0.05, 100)
      .help("height of a Gaussian; above 1 it saturates to a plateau")
      .paper("dos Anjos 2017, A");
  p.add("center_separation", center_separation)
      .range(0, 0.5)
      .unit("of the quad")
      .help("distance of the Gaussians' centres")
      .paper("dos Anjos 2017, dev");
  p.add("shape_exponent", shape_exponent)
      .range(0.5, 20)
      .help("2 is a Gaussian, larger is boxier")
      .paper("dos Anjos 2017, lambda");
  p.add("sigma_x", sigma_x)
      .range(0.01, 0.5)
      .unit("of the quad")
      .help("width of a Gaussian along the stroke")
      .paper("dos Anjos 2017, sigma_x");
  p.add("sigma_y", sigma_y)
      .range(0.01, 0.5)
      .unit("of the quad")
      .help("width of a Gaussian across the stroke")
      .paper("dos Anjos 2017, sigma_y");
  p.add("orientation_noise", orientation_noise)
      .range(0, 180)
      .unit("deg")
      .help("strokes, and the columns within a stroke, turn by up to this; seeded by the point")
      .paper("dos Anjos 2017, theta");
  p.add("bristles", bristles).range(0, 1).help("streaks that the hairs of the brush leave");
  p.add("stroke_aspect", stroke_aspect).range(0.2, 10).help("length of the quad by its width");
  p.add("stroke_length", stroke_length)
      .point_size()
      .range(0, 50)
      .unit("% of the image height")
      .help("length of strokes where points are dense enough; 0: as short as the spacing allows");
  p.add("coverage", coverage).range(0.5, 32).help("number of strokes that cover a point of the surface");
  p.add("opacity", opacity).range(0.05, 1).help("of the paint");
  p.add("relief", relief).range(0, 2).help("thickness of the paint, in a light from the upper left");
  p.add("variation", variation).range(0, 1).help("how much the lightness of strokes differs");
  p.add("saturation", saturation).range(0, 2).help("of the paint; 0 is grey");
  p.add("flatten", flatten).range(0, 1).help("share of the cluster's mean in the colour of a stroke");
  p.add("detail", detail)
      .range(0, 4)
      .help("how much strokes shrink where colours or the surface change; 0: not even at borders");
  p.add("divided_color", divided_color)
      .range(0, 1)
      .help("strokes lean towards red, green or blue by chance, so that the eye mixes their colours again");
  p.add("medium", medium, {"auto", "paint", "charcoal", "watercolor"})
      .help(
          "paint, charcoal on paper (the background), or washes whose pigment gathers at edges; auto: by "
          "style");
  p.add("canvas", canvas).range(0, 1).help("how much the weave of canvas or the grain of paper shows");
  p.add("lighting", lighting, {"auto", "on", "off"})
      .help(
          "light on the paint; auto: off where colours are the scan's own, which were lit when it was taken")
      .paper("dos Anjos 2017, Sec. 5.2");
  p.add("seed_step", seed_step)
      .range(1e-12, 1e12)
      .unit("scene units")
      .help(
          "positions are rounded to this step to seed a stroke's random numbers (auto: a power of two near a "
          "16th of the cloud's spacing; set it for sequences whose spacing varies)");
  p.add("hold_still", hold_still)
      .help(
          "in a sequence, points that noise moved by less than half their spacing stay where they were, and "
          "keep their colour while it changes by less than `cluster_color_step`");
  p.add("gloss", gloss).range(0, 1).help("strength of highlights on lit paint, in place of `specular`");
  p.add("underpainting", underpainting)
      .help("paints what strokes leave open within a surface (sorted pictures)");
  p.add("two_layers", two_layers)
      .help("small clusters get a second, finer stroke on top")
      .paper("dos Anjos 2017, Sec. 3.2.1");
  p.add("blend", blend, {"a_buffer", "blur", "z_buffer"})
      .help("sorted fragments; nearest fragment and a weighted blur (fast); nearest fragment")
      .paper("dos Anjos 2017, Sec. 3.3");
  p.add("stroke_order", stroke_order, {"stroke", "fragment"})
      .help("what lies on top: whole strokes in one order, or what is nearer in each pixel (the paper)");
  p.add("refine", refine, {"at_once", "per_frame"})
      .help(
          "sort everything in one picture, or show it blurred and sort some steps on in each picture of the "
          "same view that follows on a path; the same in the end")
      .paper("dos Anjos 2017, Sec. 3.3");
  p.add("min_sorted", min_sorted)
      .range(0, 64)
      .help("per_frame: steps before the sorted picture replaces the blurred one");
  p.add("sort_steps", sort_steps)
      .range(1, 64)
      .help("per_frame: bubble-sort steps of a frame (the paper takes 1)")
      .paper("dos Anjos 2017, Alg. 2");
  p.add("blur_radius", blur_radius).range(0, 16).unit("px").help("standard deviation of the blur");
  p.add("fragment_memory", fragment_memory)
      .range(1, 1500)
      .unit("MB")
      .help("memory of sorted fragments; a picture that needs more is sorted in horizontal bands");
}

Brush Parameters::resolve_brush() {
  Brush b = style_values[int(style)].brush;
  b.kind = brush;
  b.rows = brush_rows.resolve(b.rows);
  b.columns = brush_columns.resolve(b.columns);
  b.amplitude = amplitude.resolve(b.amplitude);
  b.center_separation = center_separation.resolve(b.center_separation);
  b.shape_exponent = shape_exponent.resolve(b.shape_exponent);
  b.sigma_x = sigma_x.resolve(b.sigma_x);
  b.sigma_y = sigma_y.resolve(b.sigma_y);
  b.noise_deg = orientation_noise.resolve(b.noise_deg);
  b.bristles = bristles.resolve(b.bristles);
  return b;
}

Look Parameters::resolve_look() {
  Look l = style_values[int(style)].look;
  l.aspect = stroke_aspect.resolve(l.aspect);
  l.length_percent = stroke_length.resolve(l.length_percent);
  l.coverage = coverage.resolve(l.coverage);
  l.opacity = opacity.resolve(l.opacity);
  l.relief = relief.resolve(l.relief);
  l.variation = variation.resolve(l.variation);
  l.saturation = saturation.resolve(l.saturation);
  l.flatten = flatten.resolve(l.flatten);
  l.detail = detail.resolve(l.detail);
  l.divided_color = divided_color.resolve(l.divided_color);
  l.canvas = canvas.resolve(l.canvas);
  if (medium != Medium::automatic) l.medium = medium;
  return l;
}

float covered_share(const Brush& brush) {
  constexpr int n = 48;
  if (brush.kind == BrushKind::ellipse)
    return std::min(1.0f, 4 * 3.14159265f * brush.sigma_x * brush.sigma_y);
  double sum = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      double z = 0;
      for (int r = 0; r < brush.rows; ++r)
        for (int c = 0; c < brush.columns; ++c) {
          const double u = (x + 0.5) / n - 0.5 - (c - 0.5 * (brush.columns - 1)) * brush.center_separation;
          const double v = (y + 0.5) / n - 0.5 - (r - 0.5 * (brush.rows - 1)) * brush.center_separation;
          z += brush.amplitude *
               std::exp(-0.5 * std::pow(std::abs(u) / brush.sigma_x, brush.shape_exponent)) *
               std::exp(-0.5 * std::pow(std::abs(v) / brush.sigma_y, brush.shape_exponent));
        }
      sum += std::min(z, 1.0);
    }
  return float(std::max(sum / (n * n), 1e-3));
}

}  // namespace sfumato::strokes
