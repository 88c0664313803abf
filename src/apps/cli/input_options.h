// Which files are read, how, and which of their points are wanted: the same options for rendering and
// `convert`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.h"
#include "scene/scene.h"

namespace sfumato::cli {

class InputOptions {
 public:
  /// `hide_classes`: those left out unless asked for, "7,18" or "none". `draws`: what is read is drawn, so
  /// that meshes are points on their faces.
  explicit InputOptions(const std::string& hide_classes, bool draws = false)
      : hide_classes_(hide_classes), draws_(draws) {}
  void declare(CommandLine& line);
  /// Throws Error(usage) for what can be wrong before a file is opened.
  void check();

  scene::SceneOptions scene;  ///< filled by `check`
  const std::string& hide_classes() const { return hide_classes_; }

 private:
  std::string hide_classes_;
  bool draws_ = false, vertices_ = false;
  std::optional<std::string> crop_, crop_relative_, show_classes_, columns_, max_points_, up_;
  Words filters_;
};

/// Declares --transform, and whose points it moves.
void declare_transforms(CommandLine& line, Words& transforms);
/// The files with their transforms: "N: 16 numbers", N counts from 1 and may be left out for a single file.
std::vector<scene::SceneFile> placed_files(const Words& files, const Words& transforms);

/// What --columns could not do: the files are no text. Empty when there is nothing to say.
std::string unused_columns(const scene::Scene& scene, const scene::SceneOptions& options);

/// What is said of files whose damaged parts were left out.
std::string missing_points(std::uint64_t missing, std::uint64_t points);

}  // namespace sfumato::cli
