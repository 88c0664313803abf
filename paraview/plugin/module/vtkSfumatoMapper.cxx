#include <epoxy/gl.h>  // before anything of VTK that brings other loaders
#include "vtkSfumatoMapper.h"

#include <sfumato/embedded.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cloud_of_blocks.h"
#include "session/choice.h"
#include "session/look.h"
#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkScalarsToColors.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWeakPointer.h"

namespace {

sfumato::dmat4 columns_of(const vtkMatrix4x4& rows) {
  sfumato::dmat4 out;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out[column][row] = rows.GetElement(row, column);
  return out;
}

/// Those that differ from the technique's own.
sfumato::Parameters changed_parameters(const std::string& technique,
                                       const std::map<std::string, std::string>& given) {
  const bool is_auto = technique == sfumato::automatic_technique;
  sfumato::Look look(is_auto ? "points" : technique);
  for (const auto& [name, value] : given) {
    const std::size_t dot = name.find('.');
    if (dot == std::string::npos) look.set(name, value);
    else if (!is_auto && name.compare(0, dot, technique) == 0) look.set(name.substr(dot + 1), value);
  }
  look.check();
  sfumato::Parameters out = look.changed();
  return out;
}

std::vector<vtkPolyData*> blocks_of(vtkDataObject* input) {
  std::vector<vtkPolyData*> out;
  if (auto* composite = vtkCompositeDataSet::SafeDownCast(input)) {
    vtkSmartPointer<vtkCompositeDataIterator> it;
    it.TakeReference(composite->NewIterator());
    for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem())
      if (auto* block = vtkPolyData::SafeDownCast(it->GetCurrentDataObject())) out.push_back(block);
  } else if (auto* block = vtkPolyData::SafeDownCast(input)) {
    out.push_back(block);
  }
  return out;
}

}  // namespace

struct vtkSfumatoMapper::State {
  std::unique_ptr<sfumato::EmbeddedRenderer> renderer;
  vtkWeakPointer<vtkWindow> window;  ///< in whose context it draws
  std::string shown;                 ///< as DescribeInput has it
  bool is_empty = true;              ///< there is no point to draw
};

vtkStandardNewMacro(vtkSfumatoMapper);

vtkSfumatoMapper::vtkSfumatoMapper() : Own(std::make_unique<State>()) {
  this->SetInterpolateScalarsBeforeMapping(0);  // colours of points, and no texture to look them up in
}
vtkSfumatoMapper::~vtkSfumatoMapper() = default;

void vtkSfumatoMapper::ComputeBounds() {
  vtkBoundingBox box;
  for (vtkPolyData* block : blocks_of(this->GetInputDataObject(0, 0)))
    if (block->GetPoints() && block->GetNumberOfPoints() > 0) box.AddBounds(block->GetPoints()->GetBounds());
  vtkMath::UninitializeBounds(this->Bounds);
  if (this->BoundsOfAllRanks.IsValid()) box = this->BoundsOfAllRanks;
  if (box.IsValid()) box.GetBounds(this->Bounds);
}

void vtkSfumatoMapper::SetDistributed(bool distributed) {
  this->IsDistributed = distributed;
  this->BoundsOfAllRanks.Reset();
  if (!distributed) return;
  // Each has to draw where one has points.
  this->ComputeBounds();
  vtkBoundingBox own, all;
  if (vtkMath::AreBoundsInitialized(this->Bounds)) own.SetBounds(this->Bounds);
  vtkMultiProcessController::GetGlobalController()->AllReduce(own, all);
  this->BoundsOfAllRanks = all;
}

std::string vtkSfumatoMapper::DescribeInput(vtkActor* actor) {
  std::string out;
  const auto add = [&](auto value) { out += std::to_string(value) + ' '; };
  for (vtkPolyData* block : blocks_of(this->GetInputDataObject(0, 0))) {
    add(reinterpret_cast<std::uintptr_t>(block)), add(block->GetMTime());
    add(block->GetPoints() ? block->GetPoints()->GetMTime() : 0);
  }
  add(this->ScalarVisibility), add(this->ScalarMode), add(this->ColorMode), add(this->ArrayId);
  add(this->UseLookupTableScalarRange), add(this->ScalarRange[0]), add(this->ScalarRange[1]);
  if (this->ScalarVisibility && this->LookupTable) add(this->LookupTable->GetMTime());
  out += this->ArrayName ? this->ArrayName : "";
  for (int i = 0; i < 3; ++i) add(actor->GetProperty()->GetDiffuseColor()[i]);
  const vtkMatrix4x4* placement = actor->GetMatrix();
  for (int i = 0; i < 16; ++i) add(placement->GetElement(i / 4, i % 4));
  return out;
}

void vtkSfumatoMapper::ShowInput(vtkActor* actor) {
  const double* solid = actor->GetProperty()->GetDiffuseColor();
  const auto byte = [](double value) { return (unsigned char)std::lround(255 * std::clamp(value, 0.0, 1.0)); };
  CloudOfBlocks cloud(columns_of(*actor->GetMatrix()), {byte(solid[0]), byte(solid[1]), byte(solid[2]), 255});
  for (vtkPolyData* block : blocks_of(this->GetInputDataObject(0, 0))) {
    int is_of_cells = 0;
    vtkUnsignedCharArray* colors =
        this->ScalarVisibility ? this->MapScalars(block, 1.0, is_of_cells) : nullptr;
    cloud.Add(block, is_of_cells ? nullptr : colors);
  }
  sfumato::PointCloud points = this->IsDistributed ? cloud.TakeOfAllRanks() : cloud.Take();
  this->Own->is_empty = points.empty();
  if (points.empty()) return;
  // Colours are the host's: as they are, though they be dark.
  sfumato::ColorSettings coloring{.color_by = "rgb"};
  coloring.exposure = 1;
  this->Own->renderer->set_cloud(std::move(points), coloring);
}

void vtkSfumatoMapper::Render(vtkRenderer* renderer, vtkActor* actor) {
  if (renderer->GetSelector()) return this->Superclass::Render(renderer, actor);
  this->GetInputAlgorithm()->Update();
  try {
    if (this->Own->window != renderer->GetRenderWindow()) {
      this->ReleaseGraphicsResources(nullptr);
      this->Own->window = renderer->GetRenderWindow();
    }
    if (!this->Own->renderer) this->Own->renderer = std::make_unique<sfumato::EmbeddedRenderer>();
    const std::string input = this->DescribeInput(actor);
    const bool is_new = input != this->Own->shown;
    if (this->IsDistributed ? CloudOfBlocks::AnyRank(is_new) : is_new) {
      this->Own->shown = input;
      this->ShowInput(actor);
    }
    if (!this->Own->is_empty) this->Draw(renderer);
  } catch (const sfumato::Error& error) {
    vtkErrorMacro(<< "sfumato: " << error.what());
  }
}

void vtkSfumatoMapper::Draw(vtkRenderer* renderer) {
  sfumato::HostView view;
  int left = 0, bottom = 0;
  renderer->GetTiledSizeAndOrigin(&view.width, &view.height, &left, &bottom);
  if (view.width <= 0 || view.height <= 0) return;
  vtkCamera* camera = renderer->GetActiveCamera();
  view.view = columns_of(*camera->GetViewTransformMatrix());
  view.projection =
      columns_of(*camera->GetProjectionTransformMatrix(renderer->GetTiledAspectRatio(), -1, 1));
  sfumato::EmbeddedRenderer& points = *this->Own->renderer;
  points.request(this->Technique, view, changed_parameters(this->Technique, this->Parameters));
  // While somebody moves the view, a picture of the view before may do; the last one is always waited for.
  const double rate = renderer->GetRenderWindow()->GetDesiredUpdateRate();
  const bool is_moving = rate > 0.1 && !this->IsDistributed;
  while (!points.wait(is_moving ? 1 / rate : 600) && !is_moving) {
  }
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  points.draw(std::uint32_t(framebuffer), {left, bottom, view.width, view.height}, float(this->Opacity));
}

void vtkSfumatoMapper::ReleaseGraphicsResources(vtkWindow* window) {
  // Names of one context mean something else in another: they are deleted in their own, or left to go with it.
  if (this->Own->renderer && window && window == this->Own->window) {
    window->MakeCurrent();
    this->Own->renderer->release();
  } else {
    this->Own->renderer.reset();
    this->Own->shown.clear();
  }
  this->Superclass::ReleaseGraphicsResources(window);
}
