// The facts about the real scans, measured by other programs (truth.json beside them), for the readers'
// tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "io/io.h"

namespace sfumato::test {

/// The folder of real scans: SFUMATO_TEST_DATA, or shared/data beside the checkout or one of its parents.
inline std::filesystem::path data_folder() {
  if (const char* folder = std::getenv("SFUMATO_TEST_DATA")) return folder;
  for (std::filesystem::path at = SFUMATO_SOURCE_DIR; at.has_relative_path(); at = at.parent_path())
    if (std::filesystem::exists(at.parent_path() / "shared/data")) return at.parent_path() / "shared/data";
  return {};
}

/// Skips the test, and says why, when the real scans are not here.
#define SFUMATO_NEEDS_REAL_SCAN(name)                                  \
  if (!std::filesystem::exists(sfumato::test::data_folder() / (name))) \
  GTEST_SKIP() << (name) << " is not here; set SFUMATO_TEST_DATA to the folder of real scans"

inline nlohmann::json truth_of(const std::string& name) {
  std::ifstream file(data_folder() / "truth.json");
  return nlohmann::json::parse(file).at(name);
}

/// Counts, bounds, first and last point, and each attribute's range and mean. `position_tolerance`: what the
/// file's coordinates lose at most on their way to origin + float.
inline void expect_truth(const std::string& name, const io::ReadResult& result, double position_tolerance) {
  const nlohmann::json truth = truth_of(name);
  const io::ReadReport& report = result.report;
  const PointCloud& cloud = result.cloud;
  EXPECT_EQ(report.points, truth["points"].get<std::uint64_t>());
  // Other programs keep records of 0 0 0 where nothing returned.
  std::uint64_t no_returns = 0;
  for (const std::string& note : report.notes)
    if (note.find("0 0 0, as scanners write") != std::string::npos) no_returns = std::stoull(note);
  EXPECT_EQ(report.points_finite + no_returns, truth["points_finite"].get<std::uint64_t>());
  EXPECT_EQ(report.points_dropped, report.points - report.points_finite);
  ASSERT_EQ(cloud.size(), report.points_finite);
  for (int k = 0; k < 3; ++k) {
    // Bounds are taken from the numbers of the file: one rounding of a double is all that may differ.
    const double low = truth["bbox_min"][std::size_t(k)], high = truth["bbox_max"][std::size_t(k)];
    EXPECT_NEAR(report.bounds_min[k], low, 1e-12 * std::max(1.0, std::abs(low))) << "axis " << k;
    EXPECT_NEAR(report.bounds_max[k], high, 1e-12 * std::max(1.0, std::abs(high))) << "axis " << k;
    EXPECT_NEAR(cloud.world(0)[k], truth["first_finite"][std::size_t(k)].get<double>(), position_tolerance);
    EXPECT_NEAR(cloud.world(cloud.size() - 1)[k], truth["last_finite"][std::size_t(k)].get<double>(),
                position_tolerance);
  }
  for (const auto& [attribute, facts] : truth["attributes"].items()) {
    if (!facts.contains("mean")) continue;
    const auto found = std::find_if(report.attributes.begin(), report.attributes.end(),
                                    [&](const io::AttributeStats& stats) { return stats.name == attribute; });
    ASSERT_NE(found, report.attributes.end()) << name << " has " << attribute;
    const double low = facts["min"], high = facts["max"], mean = facts["mean"];
    const double size = std::max({std::abs(low), std::abs(high), 1e-30});
    EXPECT_NEAR(found->min, low, 1e-12 * size) << attribute;
    EXPECT_NEAR(found->max, high, 1e-12 * size) << attribute;
    EXPECT_NEAR(found->mean, mean, 1e-9 * size) << attribute;  // sums of 1e7 doubles in another order
  }
}

}  // namespace sfumato::test
