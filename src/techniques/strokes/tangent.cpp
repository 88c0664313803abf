#include "techniques/strokes/tangent.h"

#include <cmath>

namespace sfumato::strokes {

TangentFrame householder_frame(const vec3& n) {  // (dos Anjos 2017, Alg. 1, corrected)
  if (n.x >= 0) {
    const float c = 1 / (n.x + 1), yz = -n.y * n.z * c;
    return {{-n.y, 1 - n.y * n.y * c, yz}, {-n.z, yz, 1 - n.z * n.z * c}};
  }
  const float c = 1 / (n.x - 1), yz = n.y * n.z * c;
  return {{n.y, 1 + n.y * n.y * c, yz}, -vec3(n.z, yz, 1 + n.z * n.z * c)};
}

TangentFrame eberly_frame(const vec3& n) {
  const vec3 a = glm::abs(n);
  vec3 t;
  if (a.x >= a.y && a.x >= a.z)
    t = {n.y, -n.x, 0};
  else if (a.y >= a.z)
    t = {0, n.z, -n.y};
  else
    t = {-n.z, 0, n.x};
  t = glm::normalize(t);
  return {t, glm::cross(n, t)};
}

TangentFrame frame_along(const vec3& n, const vec3& direction) {
  const TangentFrame plain = householder_frame(n);
  vec3 t = direction - glm::dot(direction, n) * n;
  const float length = glm::length(t);
  if (!(length > 0.05f)) return plain;  // what is left of less has lost its digits
  t /= glm::dot(t, plain.along) < 0 ? -length : length;
  return {t, glm::cross(n, t)};
}

}  // namespace sfumato::strokes
