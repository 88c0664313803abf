#include "vtkSfumatoActor.h"

#include "vtkObjectFactory.h"
#include "vtkSfumatoMapper.h"

vtkStandardNewMacro(vtkSfumatoActor);

bool vtkSfumatoActor::DrawsOpaque() {
  const auto* mapper = vtkSfumatoMapper::SafeDownCast(this->GetMapper());
  return !mapper || mapper->Opacity >= 1;
}

int vtkSfumatoActor::RenderOpaqueGeometry(vtkViewport* viewport) {
  return this->DrawsOpaque() ? this->Superclass::RenderOpaqueGeometry(viewport) : 0;
}

int vtkSfumatoActor::RenderVolumetricGeometry(vtkViewport* viewport) {
  return this->DrawsOpaque() ? 0 : this->Superclass::RenderOpaqueGeometry(viewport);
}
