// What a stroke looks like: the brush, how strokes are laid, and named styles that set them together.
#pragma once

#include "core/param.h"
#include "techniques/strokes/tangent.h"

namespace sfumato::strokes {

enum class Style { oil, impressionist, pointillist, watercolor, charcoal, figure_4b, figure_4c, figure_4d };
enum class BrushKind { gaussians, ellipse };
enum class BlendMode { a_buffer, blur, z_buffer };
enum class Refine { at_once, per_frame };
/// `automatic`: light where colours show an attribute, none where they are the scan's own.
enum class Lighting { automatic, on, off };
/// What happens to the finished paint on its ground; `automatic` by style.
enum class Medium { automatic, paint, charcoal, watercolor };
enum class StrokeOrder { stroke, fragment };

/// A brush with nothing left to choose (dos Anjos 2017, Sec. 3.2; symbols in Parameters::describe).
struct Brush {
  BrushKind kind = BrushKind::gaussians;
  int rows = 3, columns = 3;
  float amplitude = 8, center_separation = 0.03f, shape_exponent = 3, sigma_x = 0.114f, sigma_y = 0.0989f;
  float noise_deg = 15, bristles = 0;
  bool operator==(const Brush&) const = default;
};

/// Share of the quad that the brush covers: the mean of its alpha without noise.
float covered_share(const Brush& brush);

struct Look {
  float aspect = 1;          ///< length / width of the quad
  float length_percent = 4;  ///< length of the painted part, of the image's height
  float coverage = 5;        ///< strokes over a point of the surface
  float opacity = 1, relief = 0, variation = 0, saturation = 1, flatten = 0;
  float detail = 1;  ///< how much strokes shrink for it
  float divided_color = 0, canvas = 0;
  Medium medium = Medium::paint;
};

/// Every value that a style chooses is `auto`: what the user sets wins.
struct Parameters {
  Style style = Style::oil;
  Tangent tangent = Tangent::automatic;
  BrushKind brush = BrushKind::gaussians;
  Auto<int> brush_rows, brush_columns;
  Auto<float> amplitude, center_separation, shape_exponent, sigma_x, sigma_y, orientation_noise, bristles;
  Auto<float> stroke_aspect, stroke_length, coverage, opacity, relief, variation, saturation, flatten, detail,
      divided_color, canvas;
  Medium medium = Medium::automatic;
  Lighting lighting = Lighting::automatic;
  float gloss = 0;
  Auto<float> seed_step;
  bool hold_still = true;
  bool underpainting = true;
  bool two_layers = true;
  BlendMode blend = BlendMode::a_buffer;
  StrokeOrder stroke_order = StrokeOrder::stroke;
  Refine refine = Refine::at_once;
  int min_sorted = 16, sort_steps = 2;
  float blur_radius = 1.5f;
  int fragment_memory = 1024;

  void describe(ParamList& p);
  Brush resolve_brush();
  Look resolve_look();
  bool operator==(const Parameters&) const = default;
};

}  // namespace sfumato::strokes
