// Attributes computed from a cloud: spacing, normals, radii, uncertainty.
#pragma once

#include "analysis/prepare.h"
