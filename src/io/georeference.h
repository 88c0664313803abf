// Pictures that stand at their place on the earth: GeoTIFF and world files.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/camera.h"
#include "core/image.h"

namespace sfumato::io {

/// World coordinates of the pixels of a plan: x = a column + b row + c, y = d column + e row + f, where the
/// upper left corner of the picture is column 0, row 0.
struct Georeference {
  double a = 1, b = 0, c = 0, d = 0, e = -1, f = 0;
  std::string crs;  ///< "EPSG:n", WKT, or empty
};

/// Of a camera that looks straight down a z-up scene in parallel projection; Error(usage) of any other, which
/// names `who` asks.
Georeference georeference(const Camera& camera, UpAxis up, const std::string& crs, const std::string& who);

/// "plan.png": "plan.pgw", and so by the first and the last letter of every extension.
std::filesystem::path world_file_name(const std::filesystem::path& picture);
/// The six lines of ESRI's world file, whose place is the middle of the first pixel.
void write_world_file(const std::filesystem::path& file, const Georeference& place);

/// TIFF 6.0 in Deflate strips, 8-bit sRGB, with straight alpha where `alpha`; with `place` a GeoTIFF
/// (OGC 19-008r4), whose reference system is written as its EPSG code or, without one, as its WKT in the
/// citation that GDAL reads. `dpi` 0: none is said. Throws Error(io), Error(usage) beyond 4 GB. The file
/// appears when it is finished.
class TiffRows {
 public:
  TiffRows(const std::filesystem::path& file, int width, int height, bool alpha, double dpi,
           const std::optional<Georeference>& place, const std::string& description);
  ~TiffRows();
  /// The next rows from the top, as wide as the picture.
  void write(const Image<Rgba8>& rows);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato::io
