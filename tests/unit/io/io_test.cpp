// The table of formats, real scans of every format, and files that do not exist or cannot be written.
#include "io/io.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "io/file.h"
#include "unit/io/files.h"
#include "unit/io/truth.h"

namespace sfumato {
namespace {

struct RealScan {
  const char* name;
  const char* format;
  double position_tolerance;
};

class RealScanTest : public testing::TestWithParam<RealScan> {};

TEST_P(RealScanTest, MatchesItsTruth) {
  const RealScan& scan = GetParam();
  SFUMATO_NEEDS_REAL_SCAN(scan.name);
  const io::ReadResult result = io::read(test::data_folder() / scan.name);
  EXPECT_EQ(result.report.format, scan.format);
  test::expect_truth(scan.name, result, scan.position_tolerance);
}

// Files of floats lose nothing; text and double coordinates lose half a float step (6e-8 of the largest number).
INSTANTIATE_TEST_SUITE_P(Files, RealScanTest,
                         testing::Values(RealScan{"Guanyin.ply", "ply", 0}, RealScan{"dragon_vrip_res2.ply", "ply", 0},
                                         RealScan{"office1.pcd", "pcd", 0}, RealScan{"FSite7_orig-utm.pcd", "pcd", 0},
                                         RealScan{"fragment.pcd", "pcd", 0}, RealScan{"251370668.pcd", "pcd", 0},
                                         RealScan{"251371071.pcd", "pcd", 0}, RealScan{"bunnyData.pts", "text", 1e-8},
                                         RealScan{"armadillo.obj", "obj", 4e-8},
                                         RealScan{"car_cloud400.csv", "text", 4e-6}),
                         [](const auto& scan) {
                           std::string name = scan.param.name;
                           std::replace_if(name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
                           return name;
                         });

}  // namespace
}  // namespace sfumato
