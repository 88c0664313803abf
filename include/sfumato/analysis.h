// What a cloud does not bring along: spacing, normals, radii, uncertainty.
#pragma once

#include "analysis/prepare.h"
