#include "vtkSfumatoReader.h"

#include <sfumato/io.h>

#include "cloud_of_blocks.h"
#include "levels_of_file.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkStandardNewMacro(vtkSfumatoReader);

void vtkSfumatoReader::SetFileName(const char* name) {
  const std::string wanted = name ? name : "";
  if (wanted == this->FileName) return;
  this->FileName = wanted;
  this->Modified();
}

int vtkSfumatoReader::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* out) {
  out->GetInformationObject(0)->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  return 1;
}

int vtkSfumatoReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* out) {
  vtkInformation* wanted = out->GetInformationObject(0);
  const auto number = [&](vtkInformationIntegerKey* key, int otherwise) {
    return wanted->Has(key) ? wanted->Get(key) : otherwise;
  };
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  try {
    sfumato::io::ReadOptions options;
    const sfumato::io::Part part{std::uint64_t(number(Pipeline::UPDATE_PIECE_NUMBER(), 0)),
                                     std::uint64_t(number(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1))};
    options.part = part;
    if (this->MaximumPoints > 0) options.max_points = std::uint64_t(this->MaximumPoints);
    std::shared_ptr<LevelsOfFile> levels;
    if (this->PointBudget > 0 && !options.max_points)
      levels = LevelsOfFile::Open(this->FileName, std::uint64_t(this->PointBudget));
    const sfumato::io::ReadResult read =
        levels ? levels->ReadOverview(part) : sfumato::io::read(this->FileName, options);
    for (const std::string& line : read.report.damage) vtkWarningMacro(<< line);
    vtkPolyData* points = vtkPolyData::GetData(wanted);
    Fill(read, *points);
    if (levels) LevelsOfFile::Give(std::move(levels), *points);
  } catch (const sfumato::Error& error) {
    vtkErrorMacro(<< error.what());
    return 0;
  }
  return 1;
}
