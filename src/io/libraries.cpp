#include "io/libraries.h"

#include <OpenEXRConfig.h>
#include <jpeglib.h>
#include <laszip/laszip_api_version.h>
#include <png.h>
#include <webp/encode.h>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

namespace sfumato::io {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> library_versions() {
  const int webp = WebPGetEncoderVersion();
  return {{"LASzip", dotted(LASZIP_API_VERSION_MAJOR, LASZIP_API_VERSION_MINOR, LASZIP_API_VERSION_PATCH)},
          {"libpng", png_get_libpng_ver(nullptr)},
          {"OpenEXR", OPENEXR_VERSION_STRING},
#ifdef LIBJPEG_TURBO_VERSION_NUMBER
          {"libjpeg-turbo",
           dotted(LIBJPEG_TURBO_VERSION_NUMBER / 1'000'000, LIBJPEG_TURBO_VERSION_NUMBER / 1000 % 1000,
                  LIBJPEG_TURBO_VERSION_NUMBER % 1000)},
#endif
          {"libwebp", dotted(webp >> 16, webp >> 8 & 255, webp & 255)},
          {"GLM", dotted(GLM_VERSION_MAJOR, GLM_VERSION_MINOR, GLM_VERSION_PATCH)},
          {"nlohmann/json",
           dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)}};
}

}  // namespace sfumato::io
