// Several files become one scene: read, put together, reduced to what is wanted.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "copc/select.h"
#include "core/selection.h"
#include "io/io.h"

namespace sfumato::scene {

/// A file of a scene, and where its points go.
struct SceneFile {
  std::string name;
  std::optional<dmat4> transform;  ///< world from file
};

struct SceneOptions {
  io::ReadOptions read;
  Selection selection;
  std::optional<UpAxis> up;  ///< wins over what the files say
};

struct Scene {
  PointCloud cloud;
  std::vector<io::ReadReport> files;
  std::uint64_t points_read = 0;
  SelectionReport selected;
  std::vector<std::string> notes;       ///< of readers ("FILE: ..."), of putting together and of selecting
  std::vector<std::string> damage;      ///< parts of files that could not be read and are left out, one line each
  std::optional<copc::NodeSelection> levels;  ///< of a scene that was read by its levels
  std::vector<std::string> file_names;  ///< without folders; of several files the scalar `file` counts from 1
};

/// `io::read`, and "-" is standard input.
io::ReadResult read_file(const std::string& file, const io::ReadOptions& options = {},
                         Progress& progress = no_progress());

/// Several files get the origin of the first and the scalar `file`. `read.max_points` holds for the whole
/// scene, after the selection. Throws Error(bad_input) when a file has no points or none is left.
Scene read_scene(const std::vector<SceneFile>& files, const SceneOptions& options,
                 Progress& progress = no_progress());
Scene read_scene(const std::vector<std::string>& files, const SceneOptions& options,
                 Progress& progress = no_progress());

/// COPC files with more points than are read at once: seen from afar first, then as far as a view needs.
class LeveledScene {
 public:
  /// Nothing unless all files are COPC, stand where their points say and have more points together than `read.max_points` and `memory` allow.
  static std::optional<LeveledScene> open(const std::vector<SceneFile>& files, const SceneOptions& options,
                                          std::uint64_t memory);

  /// The coarse levels: from where to look follows from them.
  Scene overview(Progress& progress = no_progress()) const;
  /// What the views need, within the budget. `has_shadows`: what is out of view counts too, coarsely.
  Scene read(std::span<const copc::View> views, bool has_shadows, Progress& progress = no_progress()) const;

 private:
  Scene read(const copc::NodeSelection& selection, Progress& progress) const;

  std::vector<SceneFile> files_;
  std::vector<copc::Tree> trees_;
  SceneOptions options_;
  std::uint64_t budget_ = 0;
};

/// What a point takes in memory from file to picture, for most techniques.
inline constexpr std::uint64_t memory_of_point = 100;
/// What the points of COPC files may take unless the user says so; the others are read whole.
inline constexpr std::uint64_t default_memory = 4'000'000'000;

/// The files that words name: folders (every file in them that can be read, by name), patterns with * ? [ ]
/// when no file has that very name, and names as they are. Throws Error(io) when a folder or a pattern names
/// nothing.
std::vector<std::string> expand_inputs(const std::vector<std::string>& words);

/// "-" as a file: what standard input holds, kept in a temporary file without a name while this lives.
class StandardInput {
 public:
  /// Reads standard input to its end.
  StandardInput();
  ~StandardInput();
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;
  const std::string& path() const { return path_; }

 private:
  int handle_ = -1;
  std::string path_;
};

}  // namespace sfumato::scene
