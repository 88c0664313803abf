#include "levels_of_file.h"

#include <string_view>
#include <utility>
#include <vector>

#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkWeakPointer.h"

using sfumato::io::Part;
using sfumato::io::ReadResult;
using sfumato::scene::LeveledScene;

namespace {

/// Decoded nodes of one view are kept for the next: records of LAS with colours and a time are this long.
constexpr std::uint64_t bytes_of_record = 40;

struct Given {
  vtkWeakPointer<vtkDataArray> places;
  std::vector<vtkWeakPointer<vtkAbstractArray>> arrays;
  std::shared_ptr<LevelsOfFile> levels;
};

/// As long as their points are somewhere. ParaView's pipelines run on one thread.
std::vector<Given>& all_given() {
  static std::vector<Given> all;
  std::erase_if(all, [](const Given& given) { return !given.places; });
  return all;
}

}  // namespace

LevelsOfFile::LevelsOfFile(const std::string& file, std::uint64_t budget, LeveledScene scene)
    : file_(file), budget_(budget), scene_(std::move(scene)), choices_(sfumato::copc::choices_of(scene_.trees()[0])),
      kept_(budget * bytes_of_record) {}

std::shared_ptr<LevelsOfFile> LevelsOfFile::Open(const std::string& file, std::uint64_t budget) {
  sfumato::scene::SceneOptions options;
  options.keep_degrees = true;  // ParaView shows coordinates as they are
  auto scene = LeveledScene::open({{file, {}}}, options, budget * sfumato::scene::memory_of_point, true);
  if (!scene || scene->points() <= budget) return nullptr;
  return std::shared_ptr<LevelsOfFile>(new LevelsOfFile(file, budget, std::move(*scene)));
}

ReadResult LevelsOfFile::ReadOverview(const Part& part) {
  return this->Read(sfumato::copc::select_overview(scene_.trees(), budget_), part);
}

sfumato::copc::NodeSelection LevelsOfFile::Select(const sfumato::Camera& camera, bool has_shadows) const {
  return scene_.select(sfumato::copc::views_of({&camera, 1}), has_shadows);
}

ReadResult LevelsOfFile::Read(const sfumato::copc::NodeSelection& selection, const Part& part) {
  const sfumato::copc::Tree& tree = scene_.trees()[0];
  kept_.begin_read();
  return sfumato::copc::read_nodes(tree, part_of(tree, selection.nodes[0], part), sfumato::no_progress(), {&kept_, 0},
                                   &choices_);
}

void LevelsOfFile::Give(std::shared_ptr<LevelsOfFile> levels, vtkPolyData& overview) {
  Given given{overview.GetPoints()->GetData(), {}, std::move(levels)};
  for (int i = 0; i < overview.GetPointData()->GetNumberOfArrays(); ++i)
    given.arrays.emplace_back(overview.GetPointData()->GetAbstractArray(i));
  all_given().push_back(std::move(given));
}

std::shared_ptr<LevelsOfFile> LevelsOfFile::Of(vtkPolyData& block) {
  if (!block.GetPoints()) return nullptr;
  for (const Given& given : all_given()) {
    if (given.places != block.GetPoints()->GetData()) continue;
    const auto is_given = [&](vtkAbstractArray* array) {
      return std::find(given.arrays.begin(), given.arrays.end(), array) != given.arrays.end();
    };
    for (int i = 0; i < block.GetPointData()->GetNumberOfArrays(); ++i) {
      vtkAbstractArray* array = block.GetPointData()->GetAbstractArray(i);
      // ParaView numbers points for itself as "vtkOriginalPointIds".
      const bool is_of_paraview = array->GetName() && std::string_view(array->GetName()).starts_with("vtk");
      if (!is_given(array) && !is_of_paraview) return nullptr;
    }
    return given.levels;
  }
  return nullptr;
}

std::shared_ptr<LevelsOfFile> LevelsOfFile::Named(const std::string& file, std::uint64_t budget) {
  for (const Given& given : all_given())
    if (given.levels->File() == file && given.levels->Budget() == budget) return given.levels;
  return Open(file, budget);
}
