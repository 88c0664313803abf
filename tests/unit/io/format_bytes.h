// Files of formats that we do not write, made byte by byte.
#pragma once

#include <zlib.h>

#include <array>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#ifdef SFUMATO_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <draco/point_cloud/point_cloud_builder.h>
#endif

#include "io/e57_file.h"
#include "unit/io/files.h"

namespace sfumato::test {

inline std::string le(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += char(value >> (8 * i));
  return text;
}

/// Bits, least significant first.
class Bits {
 public:
  void add(std::uint64_t value, int bits) {
    for (int i = 0; i < bits; ++i, ++count_) {
      if (count_ % 8 == 0) bytes_ += '\0';
      bytes_.back() = char(bytes_.back() | char((value >> i & 1) << (count_ % 8)));
    }
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  int count_ = 0;
};

/// An E57 file of 1024-byte pages: sections of points, then the XML, whose %0, %1 become the sections'
/// offsets.
inline std::string e57(const std::vector<std::vector<std::string>>& sections, std::string xml,
                       std::size_t packet = 40) {
  const auto physical = [](std::size_t logical) { return logical / 1020 * 1024 + logical % 1020; };
  std::string logical(48, '\0');
  for (std::size_t s = 0; s < sections.size(); ++s) {
    while (logical.size() % 4) logical += '\0';
    const std::size_t begin = logical.size();
    // Each packet takes up to `packet` bytes of every stream, so that values run across packets.
    std::string packets;
    std::size_t longest = 0;
    for (const std::string& stream : sections[s]) longest = std::max(longest, stream.size());
    for (std::size_t at = 0; at < longest; at += packet) {
      std::string lengths, bytes;
      for (const std::string& stream : sections[s]) {
        const std::string part = stream.substr(std::min(at, stream.size()), packet);
        lengths += le(part.size(), 2);
        bytes += part;
      }
      std::string one = lengths + bytes;
      while ((one.size() + 6) % 4) one += '\0';
      packets += le(1, 1) + le(0, 1) + le(one.size() + 6 - 1, 2) + le(sections[s].size(), 2) + one;
      if (at == 0) packets += le(2, 1) + le(0, 1) + le(8 - 1, 2) + le(0, 4);  // an empty packet
    }
    logical += le(1, 1) + std::string(7, '\0') + le(32 + packets.size(), 8) + le(physical(begin + 32), 8) +
               le(0, 8) + packets;
    const std::string mark = "%" + std::to_string(s);
    xml.replace(xml.find(mark), mark.size(), std::to_string(physical(begin)));
  }
  const std::size_t xml_at = logical.size();
  logical += xml;
  while (logical.size() % 1020) logical += '\0';
  const std::string head = "ASTM-E57" + le(1, 4) + le(0, 4) + le(logical.size() / 1020 * 1024, 8) +
                           le(physical(xml_at), 8) + le(xml.size(), 8) + le(1024, 8);
  logical.replace(0, 48, head);
  std::string file;
  for (std::size_t at = 0; at < logical.size(); at += 1020) {
    const std::string page = logical.substr(at, 1020);
    const std::uint32_t crc = io::crc32c(reinterpret_cast<const std::byte*>(page.data()), page.size());
    file += page;
    for (int i = 3; i >= 0; --i) file += char(crc >> (8 * i));  // big-endian
  }
  return file;
}

/// One cartesian scan of scaled integers, moved and turned; one spherical scan of floats with invalid cells.
inline std::string two_scans() {
  Bits x, y, z, red, empty;
  for (int i = 0; i < 100; ++i) {
    x.add(std::uint64_t(i), 7);  // minimum -50, 7 bits
    y.add(std::uint64_t(2 * i), 11);
    z.add(std::uint64_t(i % 2), 1);
    red.add(std::uint64_t(i), 8);
  }
  std::string range, azimuth, elevation;
  Bits invalid;
  for (int i = 0; i < 30; ++i) {
    range += bytes_of(2.0f);
    azimuth += bytes_of(std::numbers::pi / 2);
    elevation += bytes_of(i == 29 ? std::numbers::pi / 2 : 0.0);
    invalid.add(i < 10 ? 2 : 0, 2);
  }
  const std::string xml = R"(<?xml version="1.0"?><e57Root type="Structure"><data3D type="Vector">
<vectorChild type="Structure"><pose type="Structure"><rotation type="Structure"><w type="Float">0.7071067811865476</w>
<x type="Float">0</x><y type="Float"/><z type="Float">0.7071067811865476</z></rotation>
<translation type="Structure"><x type="Float">1e3</x><y type="Float">200</y><z type="Float"/></translation></pose>
<points type="CompressedVector" fileOffset="%0" recordCount="100"><prototype type="Structure">
<cartesianX type="ScaledInteger" minimum="-50" maximum="49" scale="0.5" offset="1"/>
<cartesianY type="Integer" minimum="0" maximum="2047"/><cartesianZ type="Integer" minimum="5" maximum="6"/>
<colorRed type="Integer" minimum="0" maximum="255"/><colorGreen type="Integer" minimum="7" maximum="7"/>
<colorBlue type="Integer" minimum="0" maximum="0"/></prototype></points></vectorChild>
<vectorChild type="Structure"><points type="CompressedVector" fileOffset="%1" recordCount="30"><prototype type="Structure">
<sphericalRange type="Float" precision="single"/><sphericalAzimuth type="Float"/><sphericalElevation type="Float"/>
<sphericalInvalidState type="Integer" minimum="0" maximum="2"/></prototype></points></vectorChild></data3D></e57Root>)";
  return e57(
      {{x.bytes(), y.bytes(), z.bytes(), red.bytes(), "", ""}, {range, azimuth, elevation, invalid.bytes()}},
      xml);
}

inline const char* const ptx_head = "10 20 30\n1 0 0\n0 1 0\n0 0 1\n";

inline std::string npy(const std::string& descr, const std::string& shape, const std::string& body,
                       bool fortran = false) {
  std::string head = "{'descr': " + descr + ", 'fortran_order': " + (fortran ? "True" : "False") +
                     ", 'shape': (" + shape + "), }\n";
  return std::string("\x93NUMPY\x01\x00", 8) + le(head.size(), 2) + head + body;
}

/// A zip of files as numpy.savez (stored) and savez_compressed write it.
inline std::string zip(const std::vector<std::pair<std::string, std::string>>& files, bool deflated) {
  std::string bytes, list;
  for (const auto& [name, content] : files) {
    std::string packed = content;
    if (deflated) {
      z_stream stream{};
      deflateInit2(&stream, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
      packed.resize(deflateBound(&stream, content.size()));
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
      stream.avail_in = uInt(content.size());
      stream.next_out = reinterpret_cast<Bytef*>(packed.data());
      stream.avail_out = uInt(packed.size());
      deflate(&stream, Z_FINISH);
      packed.resize(stream.total_out);
      deflateEnd(&stream);
    }
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(content.data()), uInt(content.size()));
    const std::string common = le(20, 2) + le(0, 2) + le(deflated ? 8 : 0, 2) + le(0, 4) + le(crc, 4) +
                               le(packed.size(), 4) + le(content.size(), 4) + le(name.size(), 2);
    list += "PK\1\2" + le(20, 2) + common + le(0, 2) + le(0, 2) + le(0, 2) + le(0, 2) + le(0, 4) +
            le(bytes.size(), 4) + name;
    // numpy leaves room for sizes of 64 bits before each array.
    bytes += "PK\3\4" + common + le(20, 2) + name + le(1, 2) + le(16, 2) + le(content.size(), 8) +
             le(packed.size(), 8) + packed;
  }
  return bytes + list + "PK\5\6" + le(0, 4) + le(files.size(), 2) + le(files.size(), 2) + le(list.size(), 4) +
         le(bytes.size(), 4) + le(0, 2);
}

/// Four points in two colours, with normals, an intensity, and a list that belongs to nothing.
inline std::string npz_cloud(bool deflated) {
  const std::string rows =
      bytes_of(1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f, 8.0f, 9.0f, 10.0f, 11.0f, 12.0f);
  return zip({{"points.npy", npy("'<f4'", "4, 3", rows)},
              {"colors.npy",
               npy("'|u1'", "4, 3", std::string("\x01\x02\x03\x01\x02\x03\xff\x02\x03\x04\x02\x03", 12))},
              {"intensity.npy", npy("'<f8'", "4,", bytes_of(0.5, 1.5, 2.5, 1e-3))},
              {"other.npy", npy("'<i4'", "2,", bytes_of(7, 8))}},
             deflated);
}

/// A grey PNG of 16 bits, stored without compression.
inline std::string png16(std::uint32_t width, std::uint32_t height,
                         const std::vector<std::uint16_t>& samples) {
  const auto be = [](std::uint64_t value, int bytes) {
    std::string text = le(value, bytes);
    return std::string(text.rbegin(), text.rend());
  };
  const auto crc32 = [](const std::string& text) {
    std::uint32_t crc = ~0u;
    for (unsigned char c : text) {
      crc ^= c;
      for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xEDB88320u : 0);
    }
    return ~crc;
  };
  const auto chunk = [&](const std::string& type, const std::string& data) {
    return be(data.size(), 4) + type + data + be(crc32(type + data), 4);
  };
  std::string raw;
  for (std::uint32_t y = 0; y < height; ++y) {
    raw += '\0';
    for (std::uint32_t x = 0; x < width; ++x) raw += be(samples[y * width + x], 2);
  }
  std::uint32_t a = 1, b = 0;
  for (unsigned char c : raw) a = (a + c) % 65521, b = (b + a) % 65521;
  const std::string packed = std::string("\x78\x01\x01", 3) + le(raw.size(), 2) +
                             le(~raw.size() & 0xFFFF, 2) + raw + be(b << 16 | a, 4);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", be(width, 4) + be(height, 4) + std::string("\x10\0\0\0\0", 5)) +
         chunk("IDAT", packed) + chunk("IEND", "");
}

#ifdef SFUMATO_DRACO
/// A thousand points with colours and a scalar called "intensity", as Draco writes it.
inline std::string draco_cloud() {
  constexpr int points = 1000;
  draco::PointCloudBuilder builder;
  builder.Start(points);
  const int place = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
  const int scalar = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT16);
  for (int i = 0; i < points; ++i) {
    const float xyz[] = {float(i % 10), float(i / 10 % 10), float(i / 100)};
    const std::uint8_t rgb[] = {std::uint8_t(i), 2, 3};
    const auto value = std::uint16_t(i * 7);
    builder.SetAttributeValueForPoint(place, draco::PointIndex(std::uint32_t(i)), xyz);
    builder.SetAttributeValueForPoint(color, draco::PointIndex(std::uint32_t(i)), rgb);
    builder.SetAttributeValueForPoint(scalar, draco::PointIndex(std::uint32_t(i)), &value);
  }
  const auto cloud = builder.Finalize(false);
  auto metadata = std::make_unique<draco::AttributeMetadata>();
  metadata->AddEntryString("name", "intensity");
  cloud->AddAttributeMetadata(scalar, std::move(metadata));
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  if (!encoder.EncodePointCloudToBuffer(*cloud, &buffer).ok()) return {};
  return {buffer.data(), buffer.size()};
}

/// A square of so many triangles in the plane z = 2, from 0 0 to 10 10, red; by one of Draco's two encodings.
inline std::string draco_mesh(int encoding, int across = 8) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2 * across * across);
  const int place = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
  const std::uint8_t red[] = {255, 0, 0};
  std::uint32_t face = 0;
  const auto add = [&](int x0, int y0, int x1, int y1, int x2, int y2) {
    const auto at = [&](int x, int y) {
      return std::array<float, 3>{10 * float(x) / float(across), 10 * float(y) / float(across), 2};
    };
    const auto a = at(x0, y0), b = at(x1, y1), c = at(x2, y2);
    builder.SetAttributeValuesForFace(place, draco::FaceIndex(face), a.data(), b.data(), c.data());
    builder.SetAttributeValuesForFace(color, draco::FaceIndex(face++), red, red, red);
  };
  for (int x = 0; x < across; ++x)
    for (int y = 0; y < across; ++y) add(x, y, x + 1, y, x, y + 1), add(x + 1, y, x + 1, y + 1, x, y + 1);
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  encoder.SetEncodingMethod(encoding);
  if (!mesh || !encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) return {};
  return {buffer.data(), buffer.size()};
}
#endif

}  // namespace sfumato::test
