// Pictures of Python as files, as the command writes them.
#include <pybind11/pybind11.h>

#include "core/error.h"
#include "core/version.h"
#include "io/camera_json.h"
#include "io/georeference.h"
#include "io/image_exr.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "labels/furniture.h"
#include "cloud_renderer.h"

namespace sfumato::python {
namespace {

/// A plan of a scene whose up is +Z has its place on the map.
void save_tiff(const RenderedPicture& picture, const std::string& file, const std::string& made_by,
               double dpi) {
  std::optional<io::Georeference> place;
  if (picture.up == UpAxis::pos_z && labels::is_plan(picture.camera, picture.up))
    place = io::georeference(picture.camera, picture.up, picture.crs, file);
  const Image<Rgba8>& image = picture.images.rgba8;
  io::TiffRows rows(file, image.width(), image.height(), picture.transparent, dpi, place, made_by);
  rows.write(image);
  rows.finish();
}

}  // namespace

void save(const RenderedPicture& picture, const std::string& file, const std::string& extension, int quality,
          double dpi) {
  const RenderOutput& images = picture.images;
  const bool is_linear = extension == ".exr" || extension == ".npy";
  if ((is_linear ? images.color_linear.empty() : images.rgba8.empty()))
    throw Error(ErrorCode::usage, file + ": the picture has no " + (is_linear ? "linear" : "rgba") +
                                      " image; name it in outputs when rendering");
  const std::string made_by = std::string("sfumato ") + version();
  const pybind11::gil_scoped_release release;
  if (extension == ".png")
    io::write_png(file, images.rgba8, picture.transparent,
                  {{"Software", made_by},
                   {"Technique", picture.technique},
                   {"Camera", io::camera_to_json(picture.camera)}},
                  dpi);
  else if (extension == ".tif" || extension == ".tiff")
    save_tiff(picture, file, made_by, dpi);
  else if (extension == ".jpg" || extension == ".jpeg")
    io::write_jpeg(file, images.rgba8, quality, dpi);
  else if (extension == ".webp")
    io::write_webp(file, images.rgba8, picture.transparent, quality);
  else if (extension == ".exr")
    io::write_exr(file, images.color_linear, images.depth, images.normal, made_by);
  else if (extension == ".npy")
    io::write_npy(file, images.color_linear);
  else
    throw Error(ErrorCode::usage, file + ": pictures are written as .png, .jpg, .webp, .tif, .exr or .npy");
}

}  // namespace sfumato::python
