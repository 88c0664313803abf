// What has to hold of the parts of a file (ReadOptions::part).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/io.h"
#include "io/las_fields.h"

namespace sfumato::test {

/// What a point holds: place, colour, normal, and the scalars of these names with what they were rounded by.
inline std::vector<double> values_of(const PointCloud& cloud, std::size_t i,
                                     const std::vector<std::string>& names) {
  const dvec3 place = cloud.world(i);
  std::vector<double> all{place.x, place.y, place.z};
  if (!cloud.colors.empty()) {
    const Rgba8 c = cloud.colors[i];
    all.insert(all.end(), {double(c.r), double(c.g), double(c.b), double(c.a)});
  }
  if (!cloud.normals.empty())
    all.insert(all.end(), {cloud.normals[i].x, cloud.normals[i].y, cloud.normals[i].z});
  for (const std::string& name : names) {
    const ScalarField* rest = cloud.scalar(name + io::las::residual_suffix);
    all.push_back(cloud.scalar(name)->value(i) + (rest ? rest->value(i) : 0));
  }
  return all;
}

inline std::vector<std::string> names_of(const PointCloud& cloud) {
  std::vector<std::string> names;
  for (const ScalarField& field : cloud.scalars) names.push_back(field.name);
  return names;
}

inline std::vector<io::ReadResult> parts_of(const std::filesystem::path& file, std::uint64_t count,
                                            io::ReadOptions options = {}) {
  std::vector<io::ReadResult> parts;
  for (std::uint64_t i = 0; i < count; ++i) {
    options.part = io::Part{i, count};
    parts.push_back(io::read(file, options));
  }
  return parts;
}

/// Parts one behind the other are the whole.
inline void expect_parts_are_all(const std::filesystem::path& file, const std::vector<std::uint64_t>& counts,
                                 const io::ReadOptions& options = {}) {
  SCOPED_TRACE(file.string());
  const PointCloud whole = io::read(file, options).cloud;
  std::vector<std::string> names = names_of(whole);
  std::erase_if(names, [](const std::string& name) { return name.ends_with(io::las::residual_suffix); });
  std::vector<std::vector<double>> expected;
  for (std::size_t i = 0; i < whole.size(); ++i) expected.push_back(values_of(whole, i, names));
  for (const std::uint64_t count : counts) {
    SCOPED_TRACE(std::to_string(count) + " parts");
    std::vector<std::vector<double>> got;
    std::vector<std::string> all_names;
    for (const io::ReadResult& part : parts_of(file, count, options)) {
      const PointCloud& cloud = part.cloud;
      if (cloud.empty()) continue;
      if (all_names.empty()) all_names = names_of(cloud);
      ASSERT_EQ(names_of(cloud), all_names);
      ASSERT_EQ(cloud.colors.empty(), whole.colors.empty());
      for (const std::string& name : names) ASSERT_TRUE(cloud.scalar(name)) << name;
      for (std::size_t i = 0; i < cloud.size(); ++i) got.push_back(values_of(cloud, i, names));
      for (const ScalarField& field : cloud.scalars) {
        // Of 16 bits that were made of 8 the whole needs none.
        if (whole.scalar(field.name) || field.name == io::las::rgb_low_name) continue;
        ASSERT_TRUE(std::all_of(field.values.begin(), field.values.end(), [](float v) { return v == 0; }))
            << field.name;
      }
    }
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) ASSERT_EQ(got[i], expected[i]) << "point " << i;
  }
}

}  // namespace sfumato::test
