// LAS files built byte by byte, without the writer under test.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato::test {

using Bytes = std::vector<std::uint8_t>;

template <class T>
void put(Bytes& bytes, std::size_t at, T value) {
  ASSERT_LE(at + sizeof value, bytes.size());
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class T>
T get(const Bytes& bytes, std::size_t at) {
  T value{};
  if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

inline std::filesystem::path temporary(const std::string& name) {
  // Tests of one run share the folder: the test's name keeps them apart.
  std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  for (char& c : test)
    if (c == '/') c = '_';
  return std::filesystem::path(testing::TempDir()) / ("sfumato_" + test + "_" + name);
}

inline std::filesystem::path save(const Bytes& bytes, const std::string& name) {
  const std::filesystem::path path = temporary(name);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  return path;
}

inline Bytes load(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

struct TestVlr {
  std::string user_id;
  std::uint16_t record_id;
  Bytes data;
};

/// Header, records and no points; `records` are appended by `add_records`.
struct LasFile {
  int minor = 2, format = 0;
  std::uint16_t record_length = 20;
  std::uint16_t global_encoding = 0;
  double scale[3] = {0.01, 0.01, 0.001}, offset[3] = {1000, -2000, 5};
  std::vector<TestVlr> vlrs;
  Bytes records;

  Bytes bytes() const {
    const std::size_t header = minor == 4 ? 375 : minor == 3 ? 235 : 227;
    Bytes out(header);
    const auto count = std::uint32_t(records.size() / record_length);
    std::memcpy(out.data(), "LASF", 4);
    put<std::uint16_t>(out, 6, global_encoding);
    out[24] = 1;
    out[25] = std::uint8_t(minor);
    put<std::uint16_t>(out, 94, std::uint16_t(header));
    put<std::uint32_t>(out, 100, std::uint32_t(vlrs.size()));
    out[104] = std::uint8_t(format);
    put<std::uint16_t>(out, 105, record_length);
    if (format < 6) put<std::uint32_t>(out, 107, count);
    for (std::size_t k = 0; k < 3; ++k) put(out, 131 + 8 * k, scale[k]), put(out, 155 + 8 * k, offset[k]);
    if (minor == 4) put<std::uint64_t>(out, 247, count);
    for (const TestVlr& vlr : vlrs) {
      Bytes head(54);
      std::memcpy(head.data() + 2, vlr.user_id.data(), vlr.user_id.size());
      put(head, 18, vlr.record_id);
      put(head, 20, std::uint16_t(vlr.data.size()));
      out.insert(out.end(), head.begin(), head.end());
      out.insert(out.end(), vlr.data.begin(), vlr.data.end());
    }
    put<std::uint32_t>(out, 96, std::uint32_t(out.size()));
    out.insert(out.end(), records.begin(), records.end());
    return out;
  }
};

/// The 192 bytes that describe one field of extra bytes.
inline Bytes extra_field(const std::string& name, std::uint8_t type, std::uint8_t options = 0,
                         double scale = 0, double offset = 0) {
  Bytes d(192);
  d[2] = type;
  d[3] = options;
  std::memcpy(d.data() + 4, name.data(), name.size());
  for (std::size_t k = 0; k < 3; ++k) put(d, 112 + 8 * k, scale), put(d, 136 + 8 * k, offset);
  return d;
}

}  // namespace sfumato::test
