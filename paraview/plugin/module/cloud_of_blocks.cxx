#include "cloud_of_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "io/las_fields.h"
#include "passes/visible_points.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkShortArray.h"
#include "vtkSignedCharArray.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnsignedShortArray.h"

using sfumato::dmat4;
using sfumato::dvec3;
using sfumato::PointCloud;
using sfumato::vec3;

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

}  // namespace

void Fill(const sfumato::io::ReadResult& read, vtkPolyData& out) {
  const PointCloud& cloud = read.cloud;
  const std::size_t count = cloud.size();
  // Whole coordinates where floats hold them.
  const bool is_large = cloud.origin != dvec3(0);
  vtkNew<vtkPoints> places;
  places->SetDataType(is_large ? VTK_DOUBLE : VTK_FLOAT);
  places->SetNumberOfPoints(vtkIdType(count));
  for (std::size_t i = 0; i < count; ++i) {
    const dvec3 place = cloud.world(i);
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
  // Small whole numbers of LAS are in bytes, of which many attributes are nothing but zeros. Points of several files
  // may have NaN for what theirs does not say, and so do numbers that stand for no value.
  const bool has_types = cloud.las && read.report.format != "vpc";
  const auto is_whole = [&](const sfumato::ScalarField& field) {
    return field.offset == 0 && std::none_of(cloud.las->steps.begin(), cloud.las->steps.end(),
                                             [&](const sfumato::LasStep& step) { return step.name == field.name; });
  };
  using sfumato::io::las::residual_suffix;
  for (const sfumato::ScalarField& field : cloud.scalars) {
    // What values were rounded by goes back to them; low bytes of colours are for copies.
    if (field.name.ends_with(residual_suffix) || field.name == sfumato::io::las::rgb_low_name) continue;
    const sfumato::ScalarField* rest = cloud.scalar(field.name + residual_suffix);
    const auto add_as = [&]<class Array>() {
      add(array_of<Array>(field.name, 1, count, [&](auto& array, std::size_t i) {
        array.SetValue(vtkIdType(i), typename Array::ValueType(field.values[i]));
      }));
    };
    using sfumato::StoredType;
    switch (has_types && is_whole(field) ? field.type : StoredType::float32) {
      case StoredType::uint8: add_as.template operator()<vtkUnsignedCharArray>(); break;
      case StoredType::int8: add_as.template operator()<vtkSignedCharArray>(); break;
      case StoredType::uint16: add_as.template operator()<vtkUnsignedShortArray>(); break;
      case StoredType::int16: add_as.template operator()<vtkShortArray>(); break;
      default:
        if (field.offset == 0 && !rest) add_as.template operator()<vtkFloatArray>();
        else
          add(array_of<vtkDoubleArray>(field.name, 1, count, [&](auto& array, std::size_t i) {
            array.SetValue(vtkIdType(i), field.value(i) + (rest ? rest->value(i) : 0));
          }));
    }
  }
}

void CloudOfBlocks::Add(vtkPolyData* block, vtkUnsignedCharArray* colors) {
  vtkPoints* places = block->GetPoints();
  if (!places || places->GetNumberOfPoints() == 0) return;
  const vtkIdType count = places->GetNumberOfPoints();
  if (colors && colors->GetNumberOfTuples() < count) colors = nullptr;
  vtkDataArray* normals = block->GetPointData()->GetNormals();
  if (normals && (normals->GetNumberOfComponents() != 3 || normals->GetNumberOfTuples() < count))
    normals = nullptr;
  has_normals_ = has_normals_ || normals;
  const bool is_moved = placement_ != dmat4(1.0);
  if (vtkDataArray* origin = block->GetFieldData()->GetArray(origin_name);
      origin && origin->GetNumberOfComponents() == 3 && origin->GetNumberOfTuples() > 0)
    for (int k = 0; k < 3; ++k) origin_[k] = std::max(origin_[k], origin->GetComponent(0, k));
  has_doubles_ = has_doubles_ || is_moved || places->GetDataType() != VTK_FLOAT;
  const glm::dmat3 turned = glm::transpose(glm::inverse(glm::dmat3(placement_)));
  points_.reserve(points_.size() + std::size_t(count));
  const int components = colors ? colors->GetNumberOfComponents() : 0;
  for (vtkIdType i = 0; i < count; ++i) {
    Point point{};
    point.color = solid_;
    places->GetPoint(i, point.place);
    if (!std::isfinite(point.place[0] + point.place[1] + point.place[2])) continue;
    double normal[3] = {0, 0, 0};
    if (normals) normals->GetTuple(i, normal);
    dvec3 n(normal[0], normal[1], normal[2]);
    if (is_moved) {
      const glm::dvec4 moved = placement_ * glm::dvec4(point.place[0], point.place[1], point.place[2], 1);
      for (int k = 0; k < 3; ++k) point.place[k] = moved[k];
      n = turned * n;
    }
    const double length = glm::length(n);
    for (int k = 0; k < 3; ++k) point.normal[k] = length > 0 ? float(n[k] / length) : 0.0f;
    if (components >= 3) {
      const unsigned char* c = colors->GetPointer(i * components);
      point.color = {c[0], c[1], c[2], 255};
    } else if (components > 0) {
      const unsigned char grey = *colors->GetPointer(i * components);
      point.color = {grey, grey, grey, 255};
    }
    points_.push_back(point);
  }
}

dvec3 CloudOfBlocks::LeastOf(const std::vector<Point>& points) {
  dvec3 least(std::numeric_limits<double>::infinity());
  for (const Point& point : points)
    for (int k = 0; k < 3; ++k) least[k] = std::min(least[k], point.place[k]);
  return least;
}

PointCloud CloudOfBlocks::Take(const std::vector<Point>& points, const dvec3& least) const {
  PointCloud cloud;
  if (has_doubles_) cloud.origin = std::isfinite(origin_.x) ? origin_ : glm::floor(least);
  cloud.positions.reserve(points.size()), cloud.colors.reserve(points.size());
  if (has_normals_) cloud.normals.reserve(points.size());
  for (const Point& point : points) {
    cloud.positions.emplace_back(dvec3(point.place[0], point.place[1], point.place[2]) - cloud.origin);
    cloud.colors.push_back(point.color);
    if (has_normals_) cloud.normals.emplace_back(point.normal[0], point.normal[1], point.normal[2]);
  }
  return cloud;
}

PointCloud CloudOfBlocks::TakeNumbered(const dvec3& least) {
  const std::vector<Point> points = std::exchange(points_, {});
  // A number follows from all that a point is: points of one number look alike.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
  for (const Point& point : points) {
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
    for (const unsigned char* byte = reinterpret_cast<const unsigned char*>(&point);
         byte < reinterpret_cast<const unsigned char*>(&point + 1); ++byte)
      hash = (hash ^ *byte) * 0x100000001b3;
    order.emplace_back(std::uint32_t(hash ^ hash >> 32) % sfumato::VisiblePoints::nothing, std::uint32_t(order.size()));
  }
  std::sort(order.begin(), order.end());
  std::vector<Point> sorted;
  sorted.reserve(points.size());
  for (const auto& [number, i] : order) sorted.push_back(points[i]);
  PointCloud cloud = Take(sorted, least);
  for (const auto& [number, i] : order) cloud.source_index.push_back(number);
  return cloud;
}

PointCloud CloudOfBlocks::Take() {
  return points_.empty() ? PointCloud() : TakeNumbered(LeastOf(points_));
}

void CloudOfBlocks::AgreeOnKind() {
  int own[2] = {has_normals_, has_doubles_}, any[2] = {};
  vtkMultiProcessController::GetGlobalController()->AllReduce(own, any, 2, vtkCommunicator::MAX_OP);
  has_normals_ = any[0], has_doubles_ = any[1];
  const dvec3 own_origin = origin_;
  vtkMultiProcessController::GetGlobalController()->AllReduce(&own_origin.x, &origin_.x, 3, vtkCommunicator::MAX_OP);
}

PointCloud CloudOfBlocks::TakeOfOwnRank() {
  this->AgreeOnKind();
  dvec3 least = LeastOf(points_), of_all(0);
  vtkMultiProcessController::GetGlobalController()->AllReduce(&least.x, &of_all.x, 3, vtkCommunicator::MIN_OP);
  return std::isfinite(of_all.x) ? TakeNumbered(of_all) : PointCloud();
}

PointCloud CloudOfBlocks::TakeOfAllRanks() {
  vtkMultiProcessController* ranks = vtkMultiProcessController::GetGlobalController();
  if (!ranks || ranks->GetNumberOfProcesses() < 2) return Take();
  this->AgreeOnKind();
  const std::vector<Point> mine = std::exchange(points_, {});
  const vtkIdType bytes = vtkIdType(mine.size() * sizeof(Point));
  std::vector<vtkIdType> lengths(std::size_t(ranks->GetNumberOfProcesses())), offsets(lengths.size());
  ranks->Gather(&bytes, lengths.data(), 1, 0);
  std::vector<Point> all;
  if (ranks->GetLocalProcessId() == 0) {
    vtkIdType total = 0;
    for (std::size_t i = 0; i < lengths.size(); ++i) offsets[i] = total, total += lengths[i];
    all.resize(std::size_t(total) / sizeof(Point));
  }
  ranks->GatherV(reinterpret_cast<const char*>(mine.data()), reinterpret_cast<char*>(all.data()), bytes,
                 lengths.data(), offsets.data(), 0);
  std::sort(all.begin(), all.end(), [](const Point& a, const Point& b) {
    const auto key = [](const Point& p) {
      return std::tie(p.place[2], p.place[1], p.place[0], p.color.r, p.color.g, p.color.b, p.normal[0],
                      p.normal[1], p.normal[2]);
    };
    return key(a) < key(b);
  });
  return all.empty() ? PointCloud() : Take(all, LeastOf(all));
}
