// Light and material shared by every technique.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/camera.h"
#include "core/param.h"
#include "core/vec.h"

namespace sfumato {

/// From `occlusion` on only some techniques can (Technique::shows): `occlusion` and `hidden` show hidden
/// point removal at work, `weight` how much a pixel's surface weighs.
enum class Shading { lit, albedo, normals, depth, occlusion, hidden, weight };

struct Light {
  /// shoulder, headlight: over the left shoulder of whoever looks, and at the eye; both move with the camera.
  enum class Kind { shoulder, headlight, point, directional };
  Kind kind = Kind::shoulder;
  dvec3 vector{0};  ///< point: world position; directional: unit direction TOWARDS the light, world
  bool is_of_camera() const { return kind == Kind::shoulder || kind == Kind::headlight; }
  /// "shoulder", "headlight", "X,Y,Z" (a point light in world coordinates) or "dir:X,Y,Z" (direction the
  /// light comes from). Throws Error(usage) on anything else.
  static Light parse(std::string_view text);
};

/// A directional light as `Light::parse` reads it; `towards`: unit direction.
std::string light_text_of(const dvec3& towards);

/// Phong terms: colour = albedo (ambient + m diffuse n.l) + m specular (r.v)^shininess, m = shadow factor
/// (Dobrev 2010, Sec. 4: c = k_a + m (k_d + k_s)).
struct Phong {
  static constexpr float usual_ambient = 0.3f, usual_diffuse = 0.7f, usual_specular = 0.1f;
  float shininess = 24;
  /// Automatic: all ambient where colours bring their light and the lamp is nobody's choice (Session).
  Auto<float> ambient{std::nullopt, usual_ambient}, diffuse{std::nullopt, usual_diffuse};
  Auto<float> specular{std::nullopt, usual_specular};  ///< automatic: none there, nor where they are values
  /// Of photographs (dos Anjos 2017, Sec. 5.2): they were lit when they were taken.
  void resolve(bool is_photographed, bool are_values);
  bool operator==(const Phong&) const = default;
};

/// Unit direction towards a light over the left shoulder, in the axes of the camera (x right, z backwards):
/// 25 degrees from the line of sight, which readers prefer to 0 and 45 (docs/measurements/relief.md); nearer
/// to it where surfaces are seen edge-on.
inline constexpr vec3 over_shoulder{-0.298836f, 0.298836f, 0.906308f};

/// A light that casts shadows which are seen: farther to the left and high along `up`.
Light key_light(const Camera& camera, UpAxis up);

/// `stored`: the points bring their shadow factors as the scalar `shadow`.
enum class Shadows { off, hard, soft, stored };
/// Whether shadows are found by looking from the light.
inline bool casts_shadows(Shadows shadows) { return shadows == Shadows::hard || shadows == Shadows::soft; }
struct RenderSettings;

/// With shadows, a light of the camera becomes the key light of `camera` and stays where it is: call it with
/// the first camera of a path, so that shadows do not wander with the view.
void fix_light(RenderSettings& settings, const Camera& camera, UpAxis up);

/// What every technique shares; the command line lists these parameters beside the technique's own.
struct RenderSettings {
  Shading shading = Shading::lit;
  std::string light_text = "shoulder";
  Phong phong;
  Shadows shadows = Shadows::off;
  Auto<float> light_size;  ///< diameter of the light's disc, scene units
  int light_samples = 16;
  Auto<float> shadow_distance;  ///< d_min of the lit test, scene units
  bool ground = false;          ///< a plane under the cloud that catches shadows
  Auto<bool> edl;               ///< automatic: what the technique wants
  /// Pixels of a picture 720 px high, of higher ones so much more (the two numbers Potree users know).
  float edl_radius = 1.4f;
  static constexpr float usual_edl = 0.4f;
  Auto<float> edl_strength{std::nullopt, usual_edl};  ///< automatic: Technique::edl_strength, else the usual
  /// The colours are photographs: small shapes are in them, with their light, and what is drawn of depth is
  /// coarse. Set by whoever chose the colours, and no parameter.
  bool photographed = true;
  /// Share of the light from everywhere that what is around takes; automatic: Session.
  static constexpr float usual_occlusion = 1;
  Auto<float> ambient_occlusion;
  /// Strength of radiance scaling; automatic: Session.
  static constexpr float usual_scaling = 0.25f;
  Auto<float> radiance_scaling;
  /// Linear colours of categories: a surface shows one of them and nothing between them. At most
  /// `palette_limit` of them; empty: colours blend. Set by whoever chose the colours, and no parameter.
  std::vector<vec3> palette;
  static constexpr std::size_t palette_limit = 64;
  vec3 background{1};          ///< sRGB 0..1
  bool transparent = false;    ///< --no-background
  int samples = 1;             ///< places in a pixel whose pictures are averaged
  Auto<bool> smooth_outlines;  ///< of one sample; automatic: where the edges of a technique are hard
  bool fast = false;           ///< allow float atomics: not bit-reproducible

  /// All that is set like a technique's own parameters; the background has options of its own.
  void describe(ParamList& params);
  bool operator==(const RenderSettings&) const = default;
};

}  // namespace sfumato
