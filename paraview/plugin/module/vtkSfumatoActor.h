// Sees to it that pictures that let through what lies behind them are drawn after all that may lie there.
#ifndef vtkSfumatoActor_h
#define vtkSfumatoActor_h

#include "vtkPVLODActor.h"

class vtkSfumatoActor : public vtkPVLODActor {
 public:
  static vtkSfumatoActor* New();
  vtkTypeMacro(vtkSfumatoActor, vtkPVLODActor);

  int RenderOpaqueGeometry(vtkViewport* viewport) override;
  /// The last pass over a scene with depths.
  int RenderVolumetricGeometry(vtkViewport* viewport) override;
  vtkTypeBool HasTranslucentPolygonalGeometry() override { return 0; }

 protected:
  vtkSfumatoActor() = default;
  ~vtkSfumatoActor() override = default;

 private:
  vtkSfumatoActor(const vtkSfumatoActor&) = delete;
  void operator=(const vtkSfumatoActor&) = delete;
  bool DrawsOpaque();
};

#endif
