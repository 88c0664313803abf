// Files: point clouds in and out, cameras, pictures and arrays.
#pragma once

#include "io/camera_json.h"
#include "io/image_exr.h"
#include "io/image_png.h"
#include "io/io.h"
#include "io/npy.h"
