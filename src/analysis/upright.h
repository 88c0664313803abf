// Which way is up in a cloud whose file does not say.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

struct Upright {
  UpAxis up = UpAxis::pos_z;
  std::string reason;  ///< what speaks for it: "a camera's view: y down"
  /// Of length 1: what stands upright in the first picture where ground is tilted against axes of a camera;
  /// else 0, for the axis.
  dvec3 vertical{0};
  double azimuth_deg = -30;  ///< from where the first picture is taken, as --camera-azimuth-angle
  double elevation_deg = 30;
  /// The convention of the format where it is not that, else what it may be as well where nothing tells
  /// clearly.
  std::optional<UpAxis> other;
};

/// What may speak for an axis.
enum class UpEvidence {
  y_for_z,   ///< it is Y where the convention of the format is Z
  z_for_y,   ///< it is Z where the convention of the format is Y
  z_in_obj,  ///< it is Z in OBJ, which keeps its convention more strictly than PLY
  down,      ///< it is -Y where the convention is not, or +Y or +Z where it is
  rare,      ///< it is X, -X or -Z
  camera,    ///< a camera at the origin, in whose axes all lies, has it for up
  normals,   ///< the normals of what lies point there in the mean
  base,      ///< stands on a base that closes below the centre of mass
  aside,     ///< how far its foot is from below the centre of mass, over how far all is, 1 at most
  lies,      ///< all is thin along it
  stands,    ///< the columns along it end below on one plane, and all else is above that
  room,      ///< level floor and ceiling across it
  mirrored,  ///< alike above and below, as things are left and right
  level,     ///< surfaces lie across it
  plumb,     ///< surfaces lie across or along it
  faces_up,  ///< by the normals of the file what lies across it faces there
  reaches,   ///< one column, a stem or a wall, holds points at all its heights
  lidar,     ///< a lidar turned about it
  ground,    ///< more of what is level lies below that lidar than above
  placed,    ///< its lowest place is at 0 of the axis, and 0 in the middle of it across
  count
};

/// One axis and what speaks for it, each 0 (nothing) to 1; `normals`, `stands`, `faces_up`
/// and `ground` from -1.
struct UpCandidate {
  UpAxis up;
  std::array<double, std::size_t(UpEvidence::count)> evidence{};
  double probability = 0;  ///< of all candidates 1
};

/// All six axes, the likeliest first; of clouds that are no survey. From a sample of at most 65,536 points.
std::vector<UpCandidate> up_candidates(const PointCloud& cloud, Progress& progress = no_progress());

/// Across the ground, of length 1 and at most 40 degrees from the axis, where that is certain; else along
/// what is long, at most 45 degrees from it, as a statue; else 0. For clouds in the axes of a camera: where
/// axes are plumb, tilted ground is a slope.
dvec3 up_from_ground(const PointCloud& cloud, UpAxis up);

/// The likeliest of the candidates, of which `cloud.up` is the convention of the file's format; LAS keeps
/// that, and what is georeferenced otherwise has heights along z.
Upright guess_upright(const PointCloud& cloud, Progress& progress = no_progress());

}  // namespace sfumato::analysis
