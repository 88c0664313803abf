#include "synth/columns.h"

#include <cmath>

namespace sfumato::synth {

ColumnWriter::ColumnWriter(PointCloud& cloud, const Columns& columns)
    : cloud_(cloud), normals_(columns.normals) {
  const auto add = [&](Column column, bool asked, const std::string& name, StoredType type) {
    place_[column] = -1;
    if (!asked) return;
    ScalarField field;
    field.name = name;
    field.type = type;
    place_[column] = int(cloud_.scalars.size());
    cloud_.scalars.push_back(std::move(field));
  };
  add(intensity, columns.intensity, "intensity", StoredType::uint16);
  add(class_id, columns.classes, "classification", StoredType::uint8);
  add(piece, !columns.piece.empty(), columns.piece, StoredType::uint8);
  add(scanner, columns.scanner, "scanner", StoredType::uint8);
  add(amplitude, columns.amplitude, "amplitude", StoredType::float32);
  add(outlier, columns.outlier, "outlier", StoredType::uint8);
  add(return_number, columns.returns, "return_number", StoredType::uint8);
  add(number_of_returns, columns.returns, "number_of_returns", StoredType::uint8);
}

void ColumnWriter::resize(std::size_t count) {
  cloud_.positions.resize(count);
  if (normals_) cloud_.normals.resize(count);
  cloud_.colors.resize(count);
  for (ScalarField& field : cloud_.scalars) field.values.resize(count);
}

void ColumnWriter::write(std::size_t i, const Sample& s) {
  cloud_.positions[i] = vec3(s.point.position - cloud_.origin);
  if (normals_) cloud_.normals[i] = vec3(s.point.normal);
  cloud_.colors[i] = to_srgb(s.color, s.alpha);
  const float values[column_count] = {float(std::floor(65535 * s.reflectance + 0.5)),
                                      float(s.class_id),
                                      float(s.surface),
                                      float(s.scanner),
                                      float(s.amplitude),
                                      float(s.outlier),
                                      float(s.return_number),
                                      float(s.number_of_returns)};
  for (std::size_t c = 0; c < column_count; ++c)
    if (place_[c] >= 0) cloud_.scalars[std::size_t(place_[c])].values[i] = values[c];
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
