// Frames of brush strokes: from a normal to the direction of the stroke, in the space of the object.
#pragma once

#include "core/vec.h"

namespace sfumato::strokes {

/// `automatic`: along strips, poles and folds, else as Householder.
enum class Tangent { automatic, householder, eberly, covariance };

struct TangentFrame {
  vec3 along{1, 0, 0};   ///< t: the direction of the stroke
  vec3 across{0, 1, 0};  ///< b: t x b = n
};

/// Columns 2 and 3 of the Householder matrix that takes e_x to -sgn(n_x) n (dos Anjos 2017, Alg. 1). The
/// printed algorithm has the wrong sign in t_z of the second branch; there b is also turned so that t x b = n
/// everywhere. `n` is unit. Jumps by 2 |n_y| at n_x = 0: a field of tangents on a sphere has to jump
/// somewhere.
TangentFrame householder_frame(const vec3& n);

/// Swaps the component of largest magnitude with its successor (Eberly, "Computing Orthonormal Sets in 2D,
/// 3D, and 4D").
TangentFrame eberly_frame(const vec3& n);

/// The frame whose t is `direction` laid into the tangent plane, pointing to the side of the Householder
/// frame's t, so that the arbitrary sign of an eigenvector does not show; the Householder frame where that
/// fails.
TangentFrame frame_along(const vec3& n, const vec3& direction);

}  // namespace sfumato::strokes
