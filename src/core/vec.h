// The vector types of sfumato: glm, under one include.
#pragma once

// GLM_FORCE_CTOR_INIT is set by the build: a default-constructed vector is zero, never garbage.
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace sfumato {

using glm::dmat4;
using glm::dvec3;
using glm::ivec2;
using glm::mat4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

}  // namespace sfumato
