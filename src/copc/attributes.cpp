#include "copc/attributes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "analysis/attributes.h"
#include "analysis/nearby.h"
#include "analysis/prepare.h"

namespace sfumato::copc {
namespace {

using io::las::descriptor_size;
using io::las::Field;
using io::las::get;
using io::las::put;

constexpr double step = 1e-4, step_of_uncertainty = 0.004;
constexpr std::size_t longest_untyped = 255;

bool has_field(const Schema& schema, const std::string& name) {
  for (std::size_t at = 0; at + descriptor_size <= schema.extra_bytes.size(); at += descriptor_size)
    if (io::las::descriptor_name(schema.extra_bytes.data() + at) == name) return true;
  return false;
}

/// Extra bytes that no descriptor covers get one, so that those behind them are where theirs say: each as the
/// number that readers take it for while they are few (`extra_fields`), else all as bytes of no type.
void describe_the_rest(Schema& schema) {
  std::size_t described = 0;
  for (std::size_t at = 0; at + descriptor_size <= schema.extra_bytes.size(); at += descriptor_size)
    described += io::las::described_length(schema.extra_bytes.data() + at);
  std::size_t rest = schema.record_length - io::las::min_record_length[std::size_t(schema.format)];
  rest -= std::min(rest, described);
  Field byte;
  byte.name = "extra", byte.type = StoredType::uint8;
  const bool are_few = rest <= io::las::most_undescribed_fields;
  while (rest > 0) {
    const std::size_t length = are_few ? 1 : std::min(rest, longest_untyped);
    std::vector<std::uint8_t> descriptor = io::las::extra_bytes_record({byte});
    if (!are_few) descriptor[2] = 0, descriptor[3] = std::uint8_t(length);
    schema.extra_bytes.insert(schema.extra_bytes.end(), descriptor.begin(), descriptor.end());
    rest -= length;
  }
}

std::int16_t steps_of(double value) { return std::int16_t(std::lround(std::clamp(value, -1.0, 1.0) / step)); }

}  // namespace

void add_computed_fields(Schema& schema, Attributes wanted) {
  if (wanted.empty()) return;
  std::vector<Field> added;
  describe_the_rest(schema);
  std::size_t length = schema.record_length;
  const auto add = [&](const std::string& name, StoredType type, double scale) {
    Field field;
    field.name = name, field.type = type, field.scale = scale;
    field.byte = std::uint16_t(length);
    added.push_back(field);
    length += type == StoredType::uint8 ? 1 : 2;
    return field.byte;
  };
  const auto add_normal = [&](const std::string& name) { return add(name, StoredType::int16, step); };
  if (wanted.has(Attribute::normal)) {
    if (has_field(schema, "nx"))
      schema.notes.push_back("the files have normals, which are kept: none are computed");
    else
      schema.normal_byte = add_normal("nx"), add_normal("ny"), add_normal("nz");
  }
  if (wanted.has(Attribute::uncertainty)) {
    if (has_field(schema, "uncertainty") || has_field(schema, analysis::stored_uncertainty))
      schema.notes.push_back("the files have an uncertainty, which is kept: none is computed");
    else
      schema.uncertainty_byte = add(analysis::stored_uncertainty, StoredType::uint8, step_of_uncertainty);
  }
  if (length > 65535)
    throw Error(ErrorCode::usage,
                "the files have so many extra attributes that a record has no room for --attributes");
  const std::vector<std::uint8_t> described = io::las::extra_bytes_record(added);
  schema.extra_bytes.insert(schema.extra_bytes.end(), described.begin(), described.end());
  schema.record_length = std::uint16_t(length);
}

void compute_fields(const Schema& schema, std::span<std::uint8_t> records, std::span<const std::uint8_t> halo,
                    Progress& progress) {
  const std::size_t length = schema.record_length, count = records.size() / length;
  if (count == 0 || !schema.computes()) return;
  PointCloud cloud;
  cloud.las.emplace();  // as which it is read: strips of a survey are no sheets
  cloud.positions.reserve(count + halo.size() / length);
  std::int32_t first[3];
  std::memcpy(first, records.data(), sizeof first);
  const auto append = [&](std::span<const std::uint8_t> bytes) {
    for (std::size_t at = 0; at < bytes.size(); at += length) {
      vec3 place;
      for (int axis = 0; axis < 3;
           ++axis)  // from the first point, where float has digits enough for a part of a scan
        place[axis] = float(
            double(std::int64_t{get<std::int32_t>(bytes.data() + at + std::size_t(4 * axis))} - first[axis]) *
            schema.scale[axis]);
      cloud.positions.push_back(place);
    }
  };
  append(records);
  append(halo);

  analysis::PrepareOptions options;
  options.clutter_radius = 1;  // radii are of what is drawn, and not stored
  Attributes needs = Attribute::normal;
  if (schema.uncertainty_byte) needs = needs | Attribute::uncertainty | Attribute::radius;
  const PreparedCloud prepared = analysis::prepare(std::move(cloud), needs, options, progress);
  const PointCloud& found = prepared.cloud;
  std::vector<float> uncertainty;
  if (schema.uncertainty_byte)
    uncertainty = analysis::scale_free_uncertainty(prepared, analysis::Nearby(found.positions, progress));
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found.source_index[i] >= count) continue;
    std::uint8_t* record = records.data() + found.source_index[i] * length;
    for (int axis = 0; schema.normal_byte && axis < 3; ++axis)
      put(record + schema.normal_byte + 2 * axis, steps_of(found.normals[i][axis]));
    if (schema.uncertainty_byte)
      put(record + schema.uncertainty_byte,
          std::uint8_t(std::lround(double(uncertainty[i]) / step_of_uncertainty)));
  }
}

}  // namespace sfumato::copc
