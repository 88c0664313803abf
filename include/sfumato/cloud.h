// Clouds, cameras, pictures and the exception type: shared by all other headers.
#pragma once

#include "core/camera.h"
#include "core/coloring.h"
#include "core/error.h"
#include "core/image.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/version.h"
