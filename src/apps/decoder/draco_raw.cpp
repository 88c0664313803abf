#include "draco_raw.h"

#include <draco/compression/decode.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato {
namespace {

int stored_type(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8: return int(StoredType::int8);
    case draco::DT_UINT8:
    case draco::DT_BOOL: return int(StoredType::uint8);
    case draco::DT_INT16: return int(StoredType::int16);
    case draco::DT_UINT16: return int(StoredType::uint16);
    case draco::DT_INT32: return int(StoredType::int32);
    case draco::DT_UINT32: return int(StoredType::uint32);
    case draco::DT_INT64: return int(StoredType::int64);
    case draco::DT_UINT64: return int(StoredType::uint64);
    case draco::DT_FLOAT32: return int(StoredType::float32);
    case draco::DT_FLOAT64: return int(StoredType::float64);
    default: return -1;
  }
}

/// The name that whoever wrote the file gave an attribute, as far as it can be a name of ours.
std::string given_name(const draco::PointCloud& cloud, int attribute) {
  std::string name, plain;
  const draco::AttributeMetadata* metadata = cloud.GetAttributeMetadataByAttributeId(attribute);
  if (!metadata || !metadata->GetEntryString("name", &name)) return "attribute_" + std::to_string(attribute);
  for (const char c : name.substr(0, 40))
    plain += std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' ? c : '_';
  return plain.empty() ? "attribute_" + std::to_string(attribute) : plain;
}

std::string component_name(const draco::PointCloud& cloud, int attribute, int component) {
  static const char* const places[] = {"x", "y", "z"};
  static const char* const normals[] = {"nx", "ny", "nz"};
  static const char* const colors[] = {"red", "green", "blue", "alpha"};
  const draco::PointAttribute& one = *cloud.attribute(attribute);
  switch (one.attribute_type()) {
    case draco::GeometryAttribute::POSITION:
      if (component < 3) return places[component];
      break;
    case draco::GeometryAttribute::NORMAL:
      if (component < 3) return normals[component];
      break;
    case draco::GeometryAttribute::COLOR:
      if (component < 4 && one.num_components() >= 3) return colors[component];
      break;
    default: break;
  }
  const std::string name = given_name(cloud, attribute);
  return one.num_components() == 1 ? name : name + "_" + std::to_string(component);
}

bool holds_mesh(draco::DecoderBuffer& buffer) {
  const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
  return type.ok() && type.value() == draco::TRIANGULAR_MESH;
}

}  // namespace

struct DracoCloud::State {
  std::unique_ptr<draco::PointCloud> cloud;
  bool is_mesh = false;
  std::vector<const draco::PointAttribute*> attributes;
  std::string fields;
  std::size_t record_length = 0;
};

DracoCloud::DracoCloud(std::span<const std::uint8_t> bytes) : state_(std::make_unique<State>()) {
  State& s = *state_;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  s.is_mesh = holds_mesh(buffer);
  draco::Decoder decoder;
  auto decoded = decoder.DecodePointCloudFromBuffer(&buffer);
  if (!decoded.ok()) throw std::runtime_error("\"" + decoded.status().error_msg_string() + "\"");
  s.cloud = std::move(decoded).value();
  for (int i = 0; i < s.cloud->num_attributes(); ++i) {
    const draco::PointAttribute& one = *s.cloud->attribute(i);
    const int type = stored_type(one.data_type());
    const auto size = std::size_t(draco::DataTypeLength(one.data_type())) * std::size_t(one.num_components());
    if (type < 0 || size == 0 || one.byte_stride() != std::int64_t(size))
      throw std::runtime_error("an attribute of no known type");
    for (int k = 0; k < one.num_components(); ++k)
      s.fields += component_name(*s.cloud, i, k) + " " + std::to_string(type) + ";";
    if (s.fields.size() > 900) throw std::runtime_error("too many attributes");
    s.attributes.push_back(&one);
    s.record_length += size;
  }
  if (s.attributes.empty()) throw std::runtime_error("no attribute");
}

DracoCloud::~DracoCloud() = default;

std::uint64_t DracoCloud::points() const { return state_->cloud->num_points(); }
bool DracoCloud::is_mesh() const { return state_->is_mesh; }
const std::string& DracoCloud::fields() const { return state_->fields; }
std::size_t DracoCloud::record_length() const { return state_->record_length; }

void DracoCloud::pack(std::uint64_t first, std::size_t count, std::uint8_t* records) const {
  std::size_t offset = 0;
  for (const draco::PointAttribute* one : state_->attributes) {
    for (std::size_t i = 0; i < count; ++i)
      one->GetMappedValue(draco::PointIndex(std::uint32_t(first + i)),
                          records + i * state_->record_length + offset);
    offset += std::size_t(one->byte_stride());
  }
}

struct DracoFaces::State {
  std::unique_ptr<draco::Mesh> mesh;
};

DracoFaces::DracoFaces(std::span<const std::uint8_t> bytes) : state_(std::make_unique<State>()) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!holds_mesh(buffer)) return;
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) throw std::runtime_error("\"" + decoded.status().error_msg_string() + "\"");
  state_->mesh = std::move(decoded).value();
}

DracoFaces::~DracoFaces() = default;

std::uint64_t DracoFaces::faces() const { return state_->mesh ? state_->mesh->num_faces() : 0; }

void DracoFaces::pack(std::uint64_t first, std::size_t count, std::uint8_t* records) const {
  for (std::size_t i = 0; i < count; ++i) {
    const draco::Mesh::Face& face = state_->mesh->face(draco::FaceIndex(std::uint32_t(first + i)));
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t place = face[corner].value();
      std::memcpy(records + (3 * i + corner) * sizeof place, &place, sizeof place);
    }
  }
}

}  // namespace sfumato
