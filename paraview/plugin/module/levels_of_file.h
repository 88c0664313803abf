// Files with levels of detail: the reader gives their coarse levels, and a mapper that draws just these draws what its
// view needs in their place.
#pragma once

#include <memory>
#include <string>

#include "scene/leveled_scene.h"

class vtkPolyData;

class LevelsOfFile {
 public:
  /// Null where the file has no levels, or no more points than the budget. Throws sfumato::Error.
  static std::shared_ptr<LevelsOfFile> Open(const std::string& file, std::uint64_t budget);

  const std::string& File() const { return file_; }
  std::uint64_t Budget() const { return budget_; }
  /// As many whole levels as the budget allows, the coarsest in any case; of these nodes those of the part.
  sfumato::io::ReadResult ReadOverview(const sfumato::io::Part& part);
  sfumato::copc::NodeSelection Select(const sfumato::Camera& camera, bool has_shadows) const;
  /// With the attributes that the overview has, whatever the nodes hold.
  sfumato::io::ReadResult Read(const sfumato::copc::NodeSelection& nodes, const sfumato::io::Part& part);

  /// `overview` is what was read of these levels.
  static void Give(std::shared_ptr<LevelsOfFile> levels, vtkPolyData& overview);
  /// The levels whose overview this is, with no other coordinates or values: null behind filters that make new ones,
  /// and where the points came from another process.
  static std::shared_ptr<LevelsOfFile> Of(vtkPolyData& block);
  /// Those that were given here, else opened anew.
  static std::shared_ptr<LevelsOfFile> Named(const std::string& file, std::uint64_t budget);

 private:
  LevelsOfFile(const std::string& file, std::uint64_t budget, sfumato::scene::LeveledScene scene);

  std::string file_;
  std::uint64_t budget_;
  sfumato::scene::LeveledScene scene_;
  sfumato::copc::TreeChoices choices_;
  sfumato::io::ChunkCache kept_;
};
