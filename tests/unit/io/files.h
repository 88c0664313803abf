// Small files made by the tests of the readers.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "io/io.h"

namespace sfumato::test {

/// A path of its own for each test.
inline std::filesystem::path temp_file(const std::string& name) {
  const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
  return std::filesystem::path(testing::TempDir()) /
         (std::string(info->test_suite_name()) + "_" + info->name() + "_" + name);
}

inline std::filesystem::path write_file(const std::string& name, const std::string& bytes) {
  const std::filesystem::path path = temp_file(name);
  std::filesystem::remove(
      path);  // a fresh file: some file systems flush one that is truncated and written again
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

/// The bytes of values, in this machine's order or reversed.
template <class... T>
std::string bytes_of(T... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}
template <class... T>
std::string reversed_bytes_of(T... values) {
  std::string bytes;
  const auto add = [&](std::string one) { bytes.append(one.rbegin(), one.rend()); };
  (add(bytes_of(values)), ...);
  return bytes;
}

/// The error that reading the file gives.
inline std::optional<Error> error_of(const std::filesystem::path& file, const io::ReadOptions& options = {}) {
  try {
    io::read(file, options);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// Every cut of the file is an Error(bad_input) or a smaller cloud, never a crash. Returns how many were
/// errors or damage in the report.
inline int expect_cuts_are_safe(const std::string& name, const std::string& bytes, std::size_t points) {
  int errors = 0;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const std::filesystem::path file = write_file(name, bytes.substr(0, length));
    try {
      const io::ReadResult read = io::read(file);
      EXPECT_LE(read.cloud.size(), points) << "cut at byte " << length;
      errors += !read.report.damage.empty();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input) << "cut at byte " << length;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      ++errors;
    }
  }
  return errors;
}

/// Every byte set to 0, 255 and its complement in turn: an Error or a cloud, never a crash or a hang.
inline void expect_changes_are_safe(const std::string& name, const std::string& bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const char value : {char(0), char(-1), char(~bytes[i]), '9'}) {
      std::string changed = bytes;
      changed[i] = value;
      const std::filesystem::path file = write_file(name, changed);
      try {
        for (const vec3& p : io::read(file).cloud.positions)
          EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << "byte " << i;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::bad_input) << "byte " << i << ": " << error.what();
      }
    }
}

}  // namespace sfumato::test
