// Clouds, cameras, pictures and the one exception: what every other header speaks of.
#pragma once

#include "core/camera.h"
#include "core/coloring.h"
#include "core/error.h"
#include "core/image.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/version.h"
