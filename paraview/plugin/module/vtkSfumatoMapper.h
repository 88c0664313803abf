// Draws the points of its input through sfumato: colours of ParaView's arrays, the camera of its renderer, depths
// in its buffer.
#ifndef vtkSfumatoMapper_h
#define vtkSfumatoMapper_h

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "vtkBoundingBox.h"
#include "vtkCompositePolyDataMapper2.h"

class CloudOfBlocks;
class vtkPolyData;

class vtkSfumatoMapper : public vtkCompositePolyDataMapper2 {
 public:
  static vtkSfumatoMapper* New();
  vtkTypeMacro(vtkSfumatoMapper, vtkCompositePolyDataMapper2);

  void Render(vtkRenderer* renderer, vtkActor* actor) override;
  bool HasOpaqueGeometry() override { return true; }
  bool HasTranslucentPolygonalGeometry() override { return false; }
  void ReleaseGraphicsResources(vtkWindow* window) override;

  double Opacity = 1;
  std::string Technique = "auto";
  /// By the names of `sfumato techniques`; those of one technique as "points.point_size".
  std::map<std::string, std::string> Parameters;
  /// Whether the points are spread over ranks, all of which have to ask: then each says what its points show, and rank 0
  /// puts the picture together; for pictures that cannot be put together it gathers the points.
  void SetDistributed(bool distributed);

 protected:
  vtkSfumatoMapper();
  ~vtkSfumatoMapper() override;
  /// Of the points, be they part of cells or not.
  void ComputeBounds() override;

 private:
  vtkSfumatoMapper(const vtkSfumatoMapper&) = delete;
  void operator=(const vtkSfumatoMapper&) = delete;
  struct State;
  std::unique_ptr<State> Own;
  bool IsDistributed = false;
  vtkBoundingBox BoundsOfAllRanks;

  /// What is drawn: the input, or in its place what a view needs of the levels of its file.
  std::vector<vtkPolyData*> Blocks();
  /// Reads that, where the input is the overview of such a file. While the view moves, what is there stays. All ranks have
  /// to call it where points are spread over them.
  void ChooseDetail(vtkRenderer* renderer, vtkActor* actor, bool is_distributed);
  /// What the points that are shown were made from; another one asks for them anew.
  std::string DescribeInput(vtkActor* actor);
  CloudOfBlocks CloudOf(vtkActor* actor);
  void ShowInput(vtkActor* actor);
  /// What this rank has, or, where it has to know what lies around, has after points are dealt out by place; and
  /// what all together are.
  void ShowPart(vtkActor* actor, const std::string& technique_with_around);
  void Draw(vtkRenderer* renderer);
  void DrawParts(vtkRenderer* renderer, vtkActor* actor);
};

#endif
