// From a scene and a camera to files: rendering with every chosen technique, and writing what was asked for.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "analysis/still.h"
#include "console.h"
#include "io/georeference.h"
#include "io/image_png.h"
#include "labels/contact_sheet.h"
#include "parameters.h"
#include "render_options.h"
#include "report.h"
#include "session/point_index.h"
#include "session/session.h"
#include "video.h"

namespace sfumato::cli {

/// Wall time of the stages, for the report.
class Stopwatch {
 public:
  explicit Stopwatch(RenderReport& report) : report_(report) {}
  void lap(const char* stage);

 private:
  RenderReport& report_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// One instance a command.
class PictureWriter {
 public:
  /// `command` is kept in the pictures.
  PictureWriter(const RenderOptions& options, Choice& choice, RenderReport& report, std::string command,
                Console& console);
  ~PictureWriter();

  /// Makes the scene ready to be drawn: resolves `auto`, measures, colours, and notes what there is to say.
  /// Returns why `auto` chose the technique, if it did.
  std::string set_scene(scene::Scene scene, Pose pose);
  /// Renders one view with every technique and writes its files. `n` fills the names of pictures.
  void render_picture(const Camera& camera, int n, Stopwatch& watch);
  /// After the last picture.
  void finish();

 private:
  RenderOutput render(ChosenTechnique& chosen, const Camera& camera);
  void draw_furniture(Image<Rgba8>& rows, const Camera& camera, int first_row = 0) const;
  std::optional<io::Georeference> place_of(const Camera& camera) const;
  void report(std::size_t i, const RenderOutput& out);
  void write_panels(const std::vector<labels::Panel>& panels, const Camera& camera, int n);
  void write_depth_png(const std::string& name, const Image<float>& depth);
  void write(RenderOutput& out, const Camera& camera, int n);
  struct Rows;
  void write_rows(const Camera& camera, int n, Stopwatch& watch);
  void open(Rows& rows, const Camera& camera, int width, int height, int n);
  void add(Rows& rows, RenderOutput& strip, int first_row, const Camera& camera);
  void close(Rows& rows, const Camera& camera);
  io::PngTexts texts_of(const Camera& camera) const;
  bool is_blank(const Image<Rgba8>& image, const Rgba8& corner) const;

  const RenderOptions& options_;
  Choice& choice_;
  RenderReport& report_;
  std::string command_;
  Console& console_;
  std::unique_ptr<Video> video_;  ///< of -o NAME.mp4, from the first frame on
  std::unique_ptr<gl::Context> context_;
  Session session_;
  analysis::StillPoints still_;      ///< of --sequence
  std::optional<PointIndex> index_;  ///< for --output-index
  bool tells_unit_ = false;          ///< whether it was said that depths are taken for metres
  std::string crs_;                  ///< of the points that are drawn
  std::optional<std::pair<std::filesystem::path, io::Georeference>> world_;  ///< of the picture in the making
  RenderWants wants_;
};

}  // namespace sfumato::cli
