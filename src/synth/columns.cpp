#include "synth/columns.h"

#include <cmath>

namespace sfumato::synth {

ColumnWriter::ColumnWriter(PointCloud& cloud, std::size_t count, const Columns& columns)
    : cloud_(cloud), normals_(columns.normals) {
  cloud.positions.resize(count);
  if (normals_) cloud.normals.resize(count);
  cloud.colors.resize(count);
  cloud.scalars.reserve(6);  // the pointers below stay valid
  if (columns.intensity) intensity_ = add(cloud, "intensity", StoredType::uint16);
  if (columns.classes) class_ = add(cloud, "classification", StoredType::uint8);
  if (!columns.piece.empty()) piece_ = add(cloud, columns.piece.c_str(), StoredType::uint8);
  if (columns.scanner) scanner_ = add(cloud, "scanner", StoredType::uint8);
  if (columns.amplitude) amplitude_ = add(cloud, "amplitude", StoredType::float32);
  if (columns.outlier) outlier_ = add(cloud, "outlier", StoredType::uint8);
}

float* ColumnWriter::add(PointCloud& cloud, const char* name, StoredType type) {
  ScalarField field;
  field.name = name;
  field.type = type;
  field.values.resize(cloud.size());
  return cloud.set_scalar(std::move(field)).values.data();
}

void ColumnWriter::write(std::size_t i, const Sample& s) const {
  cloud_.positions[i] = vec3(s.point.position - cloud_.origin);
  if (normals_) cloud_.normals[i] = vec3(s.point.normal);
  cloud_.colors[i] = to_srgb(s.color, s.alpha);
  if (intensity_) intensity_[i] = float(std::floor(65535 * s.reflectance + 0.5));
  if (class_) class_[i] = s.class_id;
  if (piece_) piece_[i] = float(s.surface);
  if (scanner_) scanner_[i] = s.scanner;
  if (amplitude_) amplitude_[i] = float(s.amplitude);
  if (outlier_) outlier_[i] = s.outlier;
}

Sample make_outlier(const Bounds& box, Random& random) {
  Sample s;
  for (int axis = 0; axis < 3; ++axis) s.point.position[axis] = random.uniform(box.min[axis], box.max[axis]);
  dvec3 direction;
  do {
    for (int axis = 0; axis < 3; ++axis) direction[axis] = random.uniform(-1, 1);
  } while (glm::dot(direction, direction) > 1 || glm::dot(direction, direction) < 1e-6);
  s.point.normal = glm::normalize(direction);
  s.color = vec3(float(random.uniform(0.05, 0.6)));
  s.reflectance = s.color.r;
  s.outlier = 1;
  return s;
}

}  // namespace sfumato::synth
