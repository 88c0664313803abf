#include "vtkSfumatoRepresentation.h"

#include <charconv>

#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPVRenderView.h"
#include "vtkSfumatoActor.h"
#include "vtkSfumatoMapper.h"

vtkStandardNewMacro(vtkSfumatoRepresentation);

vtkSfumatoRepresentation::vtkSfumatoRepresentation() {
  // In place of those that the superclass made.
  this->Mapper->Delete();
  this->LODMapper->Delete();
  this->Actor->Delete();
  this->Mapper = vtkSfumatoMapper::New();
  this->LODMapper = vtkSfumatoMapper::New();
  this->Actor = vtkSfumatoActor::New();
  this->SuppressLOD = true;
  this->SetupDefaults();
}

vtkSfumatoMapper* vtkSfumatoRepresentation::Points() { return vtkSfumatoMapper::SafeDownCast(this->Mapper); }

void vtkSfumatoRepresentation::SetTechnique(const char* name) {
  this->Points()->Technique = name ? name : "auto";
  this->Modified();
}

void vtkSfumatoRepresentation::SetText(const char* name, const char* value) {
  if (!name || !value) return;
  this->Points()->Parameters[name] = value;
  this->Modified();
}

void vtkSfumatoRepresentation::SetNumber(const char* name, double value) {
  char text[64] = {};
  std::to_chars(text, text + sizeof text - 1, value);
  this->SetText(name, text);
}

void vtkSfumatoRepresentation::SetFlag(const char* name, int value) {
  this->SetText(name, value ? "true" : "false");
}

void vtkSfumatoRepresentation::SetOpacity(double value) { this->Points()->Opacity = value; }

bool vtkSfumatoRepresentation::NeedsOrderedCompositing() { return this->Points()->Opacity < 1; }

int vtkSfumatoRepresentation::ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in,
                                                 vtkInformation* out) {
  if (!this->Superclass::ProcessViewRequest(request, in, out)) return 0;
  if (request == vtkPVView::REQUEST_RENDER()) {
    auto* view = vtkPVRenderView::SafeDownCast(in->Get(vtkPVRenderView::VIEW()));
    this->Points()->SetDistributed(view && view->GetUseDistributedRenderingForRender());
  }
  return 1;
}
