// Clouds of every format of sfumato in ParaView, each rank with its part of the points.
#ifndef vtkSfumatoReader_h
#define vtkSfumatoReader_h

#include <string>

#include "SfumatoRepresentationsModule.h"  // for the export macro
#include "vtkPolyDataAlgorithm.h"

class SFUMATOREPRESENTATIONS_EXPORT vtkSfumatoReader : public vtkPolyDataAlgorithm {
 public:
  static vtkSfumatoReader* New();
  vtkTypeMacro(vtkSfumatoReader, vtkPolyDataAlgorithm);

  void SetFileName(const char* name);
  const char* GetFileName() { return this->FileName.c_str(); }
  /// 0: all of them; else a deterministic subsample of at most so many.
  vtkSetMacro(MaximumPoints, int);
  /// Of files with levels that have more points: the coarse levels, as many as have no more; 0: all points.
  vtkSetMacro(PointBudget, int);

 protected:
  vtkSfumatoReader() { this->SetNumberOfInputPorts(0); }
  ~vtkSfumatoReader() override = default;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* out) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* out) override;

 private:
  vtkSfumatoReader(const vtkSfumatoReader&) = delete;
  void operator=(const vtkSfumatoReader&) = delete;
  std::string FileName;
  int MaximumPoints = 0;
  int PointBudget = 0;
};

#endif
