// A folder of static files that shows a scan from all around: pictures, their depth, and a page that turns
// them. No server and no graphics card are needed to look at it.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/units.h"
#include "session/pose.h"

namespace sfumato::publish {

/// What the page and its details say of the scan.
struct Facts {
  std::string title;    ///< of the page
  std::string command;  ///< that wrote the folder
  std::vector<std::pair<std::string, std::string>> rows;
  vec3 background{1};
  LengthUnit unit;
  UpAxis up = UpAxis::pos_z;
  double vertical_exaggeration = 1;
  bool has_furniture = false;  ///< titles and legends stand at the borders of the pictures
};

/// The folder appears under its name when it is complete. Without `finish` nothing is left of it, and an
/// older one stays as it was.
class Publication {
 public:
  /// `around`: pictures of a full turn; `elevations_deg`: from which heights, empty: that of the first view
  /// and one 30 degrees from it. Throws Error(usage) for a folder that holds anything but what an earlier
  /// publication wrote.
  Publication(std::filesystem::path folder, int around, std::vector<double> elevations_deg);
  ~Publication();
  Publication(const Publication&) = delete;
  Publication& operator=(const Publication&) = delete;

  /// From where the pictures are taken; the first is `first`, but for its distance where `may_step_back`.
  std::vector<Camera> cameras(const Camera& first, UpAxis up, const Subject& subject, bool may_step_back);
  /// The next picture, with its eye depth.
  void add(const Image<Rgba8>& picture, const Image<float>& depth, const Camera& camera);
  /// Writes the pages and gives the folder its name. Throws Error(io).
  void finish(const Facts& facts);
  /// "web (72 views, 21.4 MB)"
  std::string summary() const;

 private:
  struct View {
    double turn_deg, elevation_deg;
    Camera camera;
  };
  void write(const std::string& name, const std::string& text);
  void note(const std::string& name);
  std::string data_text(const Facts& facts) const;
  std::string details_text(const Facts& facts) const;
  void take_place();

  std::filesystem::path folder_, part_;
  int around_;
  std::vector<double> elevations_deg_;
  std::vector<View> views_;
  std::vector<std::string> files_;
  std::size_t added_ = 0;
  glm::dvec2 reach_{0};  ///< how far from its middle a picture shows anything, of half its sides
  std::uint64_t picture_bytes_ = 0, depth_bytes_ = 0, bytes_ = 0;
};

/// What the page is made of.
struct PageFile {
  std::string name, type, text;
};
extern const std::vector<PageFile> page_files;

}  // namespace sfumato::publish
