// Which colour a point has: its own, or one that shows an attribute.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/classes.h"
#include "core/colormap.h"
#include "core/point_cloud.h"
#include "core/vec.h"

namespace sfumato {

struct ColorSettings {
  std::string color_by =
      "auto";  ///< auto, rgb, intensity, classification, elevation, normal, clay or any scalar; A*SCALAR
  std::string colormap;  ///< empty: gray for intensity, land for heights, viridis for everything else
  std::optional<std::array<double, 2>> range;  ///< empty: 2-98 %; heights more, intensity less
  /// Where values that are equally spaced over the range lie on the map, 0 to 1; empty: equally spaced, but
  /// heights with neither map nor range of their own by how many points there are.
  std::vector<double> places;
  std::optional<std::array<double, 2>> shade;  ///< of A*SCALAR: black and full; empty: as `range`
  std::optional<Rgba8> solid;                  ///< every point has this colour, whatever `color_by` says
  std::optional<double> exposure;       ///< brightness of the file's own colours; empty: dark ones are raised
  std::optional<Rgba8> for_black;       ///< in what the file's own black is drawn; empty: by its colours
  std::map<int, Rgba8> class_colors;    ///< of classification codes, in place of `class_color`
  std::vector<std::string> file_names;  ///< what the numbers of the scalar `file` stand for, from 1
  bool operator==(const ColorSettings&) const = default;
};

/// files: also other numbers that name things, such as flight lines.
enum class ColorKind { rgb, scalar, classes, normal, files };

/// A colour that stands for something, in a legend.
struct Swatch {
  std::string label;
  Rgba8 color;
  std::size_t points = 0;
};

/// The colours of a cloud and what is needed to explain them in a legend.
struct Coloring {
  std::vector<Rgba8> colors;  ///< one per point of the cloud, sRGB
  ColorKind kind = ColorKind::rgb;
  std::string source;                          ///< what `auto` became
  std::string colormap;                        ///< scalar only
  double low = 0, high = 1;                    ///< scalar only: values at the ends of the colour map
  std::vector<double> places;                  ///< scalar only: as in the settings
  std::optional<std::array<double, 2>> shade;  ///< A*SCALAR only: values that are black and full
  std::vector<ClassShare> classes;             ///< classes only: those that occur, ascending
  std::vector<Swatch> swatches;                ///< classes and files: what the legend lists, in its order
  bool is_photographed = false;                ///< rgb only: are_of_photographs
  double exposure = 1;             ///< rgb only: how many times as bright the darkest of them became
  Rgba8 for_black{0, 0, 0, 255};   ///< rgb only: what black became before
  std::vector<std::string> notes;  ///< settings that have no effect on these colours

  /// Scalar only: from `low` to `high`.
  Colormap ramp() const;
  /// As it is drawn; of a class that is not drawn, what it has by default.
  Rgba8 color_of_class(int id) const;
};

/// What `color_by` means for this cloud. `auto` is rgb where it tells points apart, then elevation where the
/// cloud is land (less than 0.4 times as high as wide), then intensity unless it is speckle (Geary 1954),
/// then the classes or labels if there are several, then rgb of one colour on which light shows, then clay.
/// Throws Error(usage) naming the nearest attribute.
std::string resolve_color_by(const PointCloud& cloud, std::string_view color_by);

/// Colours every point. Elevation is the world coordinate along the cloud's up axis; a NaN value is mid-gray.
/// `normal` needs normals: Error(usage) without. "rgb*intensity" is the first darkened by the second, as
/// layers are multiplied. Photographed colours whose lightest tenth is dark, as of a dim room, are raised:
/// the dark ones by `exposure`, in linear light, the lighter the less, so that hues stay and white stays
/// white. Categories and scalars never are. Black of points that no photograph shows becomes the median
/// colour. `shown_heights`: those that the range and the places of heights are for; empty: of all points.
Coloring color_points(const PointCloud& cloud, const ColorSettings& settings,
                      const std::vector<double>& shown_heights = {});

/// Numbers that tell things apart instead of measuring them, by their name, and are few: a ramp between
/// flight line 66 and 67 shows nothing.
bool names_things(const ScalarField& field);

/// Whether there are no more colours than somebody would choose for labels.
bool are_labels(const std::vector<Rgba8>& colors);
/// Whether they are no labels, and hardly any is as pure as those of a ramp, which have one channel full and
/// one empty.
bool are_of_photographs(const std::vector<Rgba8>& colors);

/// The colours that occur, in the order of their first point; nothing when they are more than `limit`.
std::vector<Rgba8> distinct_colors(const std::vector<Rgba8>& colors, std::size_t limit);

/// Of many colours nearly black, on which light ones show and gaps read as shade, or white where dark ones
/// would be lost; of one colour, as of clay, white where it shows. sRGB, 0..1.
vec3 contrasting_background(const std::vector<Rgba8>& colors);

/// Behind photographed colours: neither black ones, of a contrast of 2.3 with it, nor white ones, of 9.3, are
/// taken for gaps; nor are greys and browns, which photographs are full of, as blue is far from them. What
/// readers marked best (docs/measurements/first_view.md).
inline constexpr vec3 background_of_photographs{0.23f, 0.28f, 0.37f};

}  // namespace sfumato
