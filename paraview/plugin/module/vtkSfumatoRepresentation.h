// The representation "Sfumato" of ParaView: points drawn by any technique of sfumato. Its properties are generated
// (write_xml.cpp).
#ifndef vtkSfumatoRepresentation_h
#define vtkSfumatoRepresentation_h

#include "SfumatoRepresentationsModule.h"  // for the export macro
#include "vtkGeometryRepresentationWithFaces.h"

class vtkSfumatoMapper;

class SFUMATOREPRESENTATIONS_EXPORT vtkSfumatoRepresentation : public vtkGeometryRepresentationWithFaces {
 public:
  static vtkSfumatoRepresentation* New();
  vtkTypeMacro(vtkSfumatoRepresentation, vtkGeometryRepresentationWithFaces);

  void SetTechnique(const char* name);
  /// Values as on the command line.
  void SetText(const char* name, const char* value);
  void SetNumber(const char* name, double value);
  void SetFlag(const char* name, int value);

  void SetOpacity(double value) override;
  /// Points are neither decimated nor looked up in textures.
  void SetSuppressLOD(bool) override {}
  void SetInterpolateScalarsBeforeMapping(int) override {}
  int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out) override;

 protected:
  vtkSfumatoRepresentation();
  ~vtkSfumatoRepresentation() override = default;
  /// Not for colours as they are, which might have an opacity: every point is clipped for it, cell by cell.
  bool NeedsOrderedCompositing() override;

 private:
  vtkSfumatoRepresentation(const vtkSfumatoRepresentation&) = delete;
  void operator=(const vtkSfumatoRepresentation&) = delete;
  vtkSfumatoMapper* Points();
};

#endif
