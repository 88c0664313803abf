// Files and clouds that broke something once: each stays fixed.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>

#include "io/text_rows.h"
#include "unit/io/files.h"
#include "unit/io/las_bytes.h"

namespace sfumato {
namespace {

TEST(Faults, AByteOrderMarkIsNoPartOfTheFirstPoint) {
  const io::ReadResult result = io::read(test::write_file("a.xyz",
                                                          "\xEF\xBB\xBF"
                                                          "1 2 3\n4 5 6\n"));
  ASSERT_EQ(result.cloud.size(), 2u);
  EXPECT_EQ(result.cloud.positions[0], vec3(1, 2, 3));
  EXPECT_EQ(io::read(test::write_file("b.csv",
                                      "\xEF\xBB\xBF"
                                      "x,y,z\n1,2,3\n4,5,6\n"))
                .cloud.size(),
            2u);
  EXPECT_EQ(io::read(test::write_file("unnamed",
                                      "\xEF\xBB\xBF"
                                      "1 2 3\n4 5 6\n"))
                .cloud.size(),
            2u);
}

TEST(Faults, ADamagedFileIsNotReadAsText) {
  const std::string body =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\n1 2 3\n4 5 6\n";
  const std::optional<Error> error = test::error_of(test::write_file("a.pcd", body));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::bad_input);
  EXPECT_NE(std::string(error->what()).find("PCD header"), std::string::npos) << error->what();
  EXPECT_TRUE(test::error_of(test::write_file("a.ply", "format ascii 1.0\n1 2 3\n4 5 6\n")));
}

TEST(Faults, NumbersTooSmallAreZeroAndTooLargeOnesAreNoCoordinates) {
  const auto parsed = [](const std::string& text) {
    double value = -1;
    EXPECT_EQ(io::parse_number(text.data(), text.data() + text.size(), value), text.data() + text.size())
        << text;
    return value;
  };
  const std::string many = "12345678901234567890123";
  for (const std::string& tiny : {std::string("1e-400"), many + "e-400", "0." + many + "e-400",
                                  std::string("1e-99999999999"), "0." + std::string(400, '0') + "1",
                                  "0.000" + many + "e-330", std::string("0.01e-9223372036854775807")})
    EXPECT_EQ(parsed(tiny), 0) << tiny;
  for (const std::string& huge :
       {std::string("1e400"), many + "e400", "0." + many + "e+400", std::string("1e99999999999"),
        std::string(400, '9'), std::string("10e9223372036854775807")})
    EXPECT_TRUE(std::isinf(parsed(huge))) << huge;
  EXPECT_EQ(io::read(test::write_file("a.xyz", "1 2 3\n" + many + "e-400 5 6\n")).report.points_finite, 2u);
}

PointCloud room_and_stray(double stray) {
  PointCloud cloud;
  for (int i = 0; i < 2001; ++i)
    cloud.positions.push_back({float(i) * 0.005f, float(i % 100) * 0.1f, float(i % 7)});
  cloud.positions.push_back({float(stray), 0, 0});
  return cloud;
}

TEST(Faults, LasMovesNoPlaceByMoreThanHalfTheStepItStates) {
  for (const char* name : {"a.las", "a.laz"})
    for (double stray : {10.0, 1e5, 1e6}) {
      const PointCloud cloud = room_and_stray(stray);
      const io::WriteReport report = io::write(test::temp_file(name), cloud);
      ASSERT_EQ(report.notes.size(), 1u);
      const double step = std::stod(report.notes[0].substr(report.notes[0].find("steps of ") + 9));
      EXPECT_LE(step, std::max(1e-5, stray / 1e9)) << report.notes[0];
      const PointCloud back = io::read(test::temp_file(name)).cloud;
      ASSERT_EQ(back.size(), cloud.size());
      // Half a step, and what a float 10 m from the origin of the reader rounds: 2^-21.
      for (std::size_t i = 0; i + 1 < cloud.size(); ++i)
        for (int k = 0; k < 3; ++k)
          ASSERT_NEAR(back.world(i)[k], cloud.world(i)[k], 0.5001 * step + 0x1p-20)
              << name << " " << stray << " " << i;
    }
}

TEST(Faults, LasRefusesWhatItWouldDestroyOrNobodyCouldRead) {
  for (double stray : {1e9, 1e30}) {
    try {
      io::write(test::temp_file("a.las"), room_and_stray(stray));
      FAIL() << stray;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_NE(std::string(error.what()).find(".ply"), std::string::npos) << error.what();
    }
  }
  PointCloud far_out = room_and_stray(5);
  far_out.origin = dvec3(1e300, 0, 0);
  EXPECT_THROW(io::write(test::temp_file("a.las"), far_out), Error);
  EXPECT_FALSE(std::filesystem::exists(test::temp_file("a.las")));
}

TEST(Faults, AStrayPointDoesNotTakeTheDigitsOfTheOthers) {
  std::string rows;
  for (int i = 0; i < 2001; ++i) rows += std::to_string(500000 + i * 0.005) + " 5400000.125 3\n";
  const io::ReadResult result = io::read(test::write_file("a.xyz", rows + "1e12 0 0\n"));
  // Floats 10 m from their origin have steps of 2^-20.
  for (std::size_t i = 0; i < 2001; ++i)
    ASSERT_NEAR(result.cloud.world(i).x, 500000 + double(i) * 0.005, 1e-6) << i;
}

}  // namespace
}  // namespace sfumato
