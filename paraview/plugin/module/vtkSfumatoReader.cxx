#include "vtkSfumatoReader.h"

#include <sfumato/cloud.h>
#include <sfumato/io.h>

#include "cloud_of_blocks.h"
#include "io/las_fields.h"
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
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

namespace {

/// One array with a value of each point: `put(array, i)` sets that of point `i`.
template <class Array, class Put>
vtkSmartPointer<Array> array_of(const std::string& name, int components, std::size_t count, Put put) {
  const auto array = vtkSmartPointer<Array>::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(vtkIdType(count));
  for (std::size_t i = 0; i < count; ++i) put(*array, i);
  return array;
}

/// The points, each a vertex of its own, so that it can be selected.
void fill(const sfumato::PointCloud& cloud, vtkPolyData& out) {
  const std::size_t count = cloud.size();
  // Whole coordinates where floats hold them.
  const bool is_large = cloud.origin != sfumato::dvec3(0);
  vtkNew<vtkPoints> places;
  places->SetDataType(is_large ? VTK_DOUBLE : VTK_FLOAT);
  places->SetNumberOfPoints(vtkIdType(count));
  for (std::size_t i = 0; i < count; ++i) {
    const sfumato::dvec3 place = cloud.world(i);
    places->SetPoint(vtkIdType(i), place.x, place.y, place.z);
  }
  out.SetPoints(places);
  vtkNew<vtkDoubleArray> origin;
  origin->SetName(origin_name);
  origin->SetNumberOfComponents(3);
  origin->InsertNextTuple(&cloud.origin.x);
  out.GetFieldData()->AddArray(origin);
  vtkNew<vtkCellArray> vertices;
  vertices->AllocateExact(vtkIdType(count), vtkIdType(count));
  for (vtkIdType i = 0; i < vtkIdType(count); ++i) vertices->InsertNextCell(1, &i);
  out.SetVerts(vertices);

  vtkPointData& data = *out.GetPointData();
  const auto add = [&](const auto& array) { data.AddArray(array); };
  if (!cloud.colors.empty())
    add(array_of<vtkUnsignedCharArray>("RGB", 3, count, [&](auto& array, std::size_t i) {
      const sfumato::Rgba8 c = cloud.colors[i];
      const unsigned char values[] = {c.r, c.g, c.b};
      array.SetTypedTuple(vtkIdType(i), values);
    }));
  if (!cloud.normals.empty())
    data.SetNormals(array_of<vtkFloatArray>("Normals", 3, count, [&](auto& array, std::size_t i) {
      array.SetTypedTuple(vtkIdType(i), &cloud.normals[i].x);
    }));
  if (!cloud.radii.empty())
    add(array_of<vtkFloatArray>(
        "radius", 1, count, [&](auto& array, std::size_t i) { array.SetValue(vtkIdType(i), cloud.radii[i]); }));
  using sfumato::io::las::residual_suffix;
  for (const sfumato::ScalarField& field : cloud.scalars) {
    // What values were rounded by goes back to them; low bytes of colours are for copies.
    if (field.name.ends_with(residual_suffix) || field.name == sfumato::io::las::rgb_low_name) continue;
    const sfumato::ScalarField* rest = cloud.scalar(field.name + residual_suffix);
    if (field.offset == 0 && !rest)
      add(array_of<vtkFloatArray>(field.name, 1, count, [&](auto& array, std::size_t i) {
        array.SetValue(vtkIdType(i), field.values[i]);
      }));
    else
      add(array_of<vtkDoubleArray>(field.name, 1, count, [&](auto& array, std::size_t i) {
        array.SetValue(vtkIdType(i), field.value(i) + (rest ? rest->value(i) : 0));
      }));
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
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  try {
    sfumato::io::ReadOptions options;
    options.part = sfumato::io::Part{std::uint64_t(number(Pipeline::UPDATE_PIECE_NUMBER(), 0)),
                                     std::uint64_t(number(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1))};
    if (this->MaximumPoints > 0) options.max_points = std::uint64_t(this->MaximumPoints);
    const sfumato::io::ReadResult read = sfumato::io::read(this->FileName, options);
    for (const std::string& line : read.report.damage) vtkWarningMacro(<< line);
    fill(read.cloud, *vtkPolyData::GetData(wanted));
  } catch (const sfumato::Error& error) {
    vtkErrorMacro(<< error.what());
    return 0;
  }
  return 1;
}
