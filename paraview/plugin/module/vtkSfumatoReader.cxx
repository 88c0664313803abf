#include "vtkSfumatoReader.h"

#include <sfumato/cloud.h>
#include <sfumato/io.h>

#include <vector>

#include "cloud_of_blocks.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

namespace {

/// One array with a value of each point from `first` on: `put(array, i, k)` sets that of point `first + k`.
template <class Array, class Put>
void add_array(vtkPointData& data, const char* name, int components, std::size_t first, std::size_t count, Put put,
               bool are_normals = false) {
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(vtkIdType(count));
  for (std::size_t k = 0; k < count; ++k) put(array.Get(), first + k, vtkIdType(k));
  if (are_normals) data.SetNormals(array);
  else data.AddArray(array);
}

/// Points [first, first + count), each a vertex of its own, so that it can be selected.
void fill(const sfumato::PointCloud& cloud, std::size_t first, std::size_t count, vtkPolyData& out) {
  // Whole coordinates where floats hold them.
  const bool is_large = cloud.origin != sfumato::dvec3(0);
  vtkNew<vtkPoints> places;
  places->SetDataType(is_large ? VTK_DOUBLE : VTK_FLOAT);
  places->SetNumberOfPoints(vtkIdType(count));
  for (std::size_t k = 0; k < count; ++k) {
    const sfumato::dvec3 place = cloud.world(first + k);
    places->SetPoint(vtkIdType(k), place.x, place.y, place.z);
  }
  out.SetPoints(places);
  vtkNew<vtkDoubleArray> origin;
  origin->SetName(origin_name);
  origin->SetNumberOfComponents(3);
  origin->InsertNextTuple(&cloud.origin.x);
  out.GetFieldData()->AddArray(origin);
  vtkNew<vtkCellArray> vertices;
  vertices->AllocateExact(vtkIdType(count), vtkIdType(count));
  for (vtkIdType k = 0; k < vtkIdType(count); ++k) vertices->InsertNextCell(1, &k);
  out.SetVerts(vertices);

  vtkPointData& data = *out.GetPointData();
  if (!cloud.colors.empty())
    add_array<vtkUnsignedCharArray>(data, "RGB", 3, first, count, [&](auto* array, std::size_t i, vtkIdType k) {
      const sfumato::Rgba8 c = cloud.colors[i];
      array->SetTypedComponent(k, 0, c.r), array->SetTypedComponent(k, 1, c.g), array->SetTypedComponent(k, 2, c.b);
    });
  if (!cloud.normals.empty())
    add_array<vtkFloatArray>(
        data, "Normals", 3, first, count,
        [&](auto* array, std::size_t i, vtkIdType k) { array->SetTypedTuple(k, &cloud.normals[i].x); }, true);
  if (!cloud.radii.empty())
    add_array<vtkFloatArray>(data, "radius", 1, first, count, [&](auto* array, std::size_t i, vtkIdType k) {
      array->SetTypedComponent(k, 0, cloud.radii[i]);
    });
  for (const sfumato::ScalarField& field : cloud.scalars) {
    const char* name = field.name.c_str();
    if (field.offset == 0)
      add_array<vtkFloatArray>(data, name, 1, first, count, [&](auto* array, std::size_t i, vtkIdType k) {
        array->SetTypedComponent(k, 0, field.values[i]);
      });
    else
      add_array<vtkDoubleArray>(data, name, 1, first, count, [&](auto* array, std::size_t i, vtkIdType k) {
        array->SetTypedComponent(k, 0, field.value(i));
      });
  }
}

}  // namespace

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
  const std::size_t piece = std::size_t(number(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0));
  const std::size_t pieces =
      std::size_t(number(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1));
  try {
    sfumato::io::ReadOptions options;
    if (this->MaximumPoints > 0) options.max_points = std::uint64_t(this->MaximumPoints);
    const sfumato::io::ReadResult read = sfumato::io::read(this->FileName, options);
    for (const std::string& line : read.report.damage) vtkWarningMacro(<< line);
    const std::size_t all = read.cloud.size();
    const std::size_t first = all * piece / pieces, end = all * (piece + 1) / pieces;
    fill(read.cloud, first, end - first, *vtkPolyData::GetData(wanted));
  } catch (const sfumato::Error& error) {
    vtkErrorMacro(<< error.what());
    return 0;
  }
  return 1;
}
