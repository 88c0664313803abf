// Each LAS point format, extra bytes and coordinate systems, from bytes laid out by hand (LAS 1.4 R15, tables
// 7-17).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>

#include "io/io.h"
#include "unit/io/las_bytes.h"

using namespace sfumato;
using test::Bytes;
using test::LasFile;

namespace {

struct Layout {
  std::uint16_t length;
  int gps_time, rgb, nir;  // bytes, -1 where absent
};
constexpr Layout layouts[11] = {{20, -1, -1, -1}, {28, 20, -1, -1}, {26, -1, 20, -1}, {34, 20, 28, -1},
                                {57, 20, -1, -1}, {63, 20, 28, -1}, {30, 22, -1, -1}, {36, 22, 30, -1},
                                {38, 22, 30, 36}, {59, 22, -1, -1}, {67, 22, 30, 36}};

Bytes record_of(int format, int i) {
  const Layout& layout = layouts[format];
  Bytes r(layout.length);
  test::put<std::int32_t>(r, 0, 100 * i);
  test::put<std::int32_t>(r, 4, -50 * i);
  test::put<std::int32_t>(r, 8, i);
  test::put<std::uint16_t>(r, 12, std::uint16_t(1000 + i));
  if (format < 6) {
    r[14] = std::uint8_t((1 + i % 5) | 5 << 3 | (i % 2) << 6 | 1 << 7);
    r[15] = std::uint8_t((i % 32) | (i == 2) << 7);
    r[16] = std::uint8_t(-i);
    r[17] = std::uint8_t(7 + i);
    test::put<std::uint16_t>(r, 18, 4242);
  } else {
    r[14] = std::uint8_t((1 + i % 15) | 15 << 4);
    r[15] = std::uint8_t(8 | (i % 4) << 4 | (i % 2) << 6);
    r[16] = std::uint8_t(200 + i);
    r[17] = std::uint8_t(7 + i);
    test::put<std::int16_t>(r, 18, std::int16_t(-1000 * i));
    test::put<std::uint16_t>(r, 20, 4242);
  }
  if (layout.gps_time >= 0) test::put<double>(r, std::size_t(layout.gps_time), 3.9e8 + i * 0.123456789);
  for (int c = 0; c < 3 && layout.rgb >= 0; ++c)
    test::put<std::uint16_t>(r, std::size_t(layout.rgb + 2 * c), std::uint16_t(1000 * i + 300 * c + 17));
  if (layout.nir >= 0) test::put<std::uint16_t>(r, std::size_t(layout.nir), std::uint16_t(60000 + i));
  return r;
}

LasFile file_of(int format, int points) {
  LasFile file;
  file.minor = format >= 6 ? 4 : format >= 4 ? 3 : format >= 2 ? 2 : 0;
  file.format = format;
  file.record_length = layouts[format].length;
  for (int i = 0; i < points; ++i) {
    const Bytes r = record_of(format, i);
    file.records.insert(file.records.end(), r.begin(), r.end());
  }
  return file;
}

class LasPointFormat : public testing::TestWithParam<int> {};

void expect_points(const io::ReadResult& result, int format, int points) {
  const Layout& layout = layouts[format];
  const PointCloud& cloud = result.cloud;
  ASSERT_EQ(cloud.size(), std::size_t(points));
  auto value = [&](const char* name, int i) {
    const ScalarField* field = cloud.scalar(name);
    const ScalarField* rest = cloud.scalar(std::string(name) + "_residual");
    if (!field) return -12345.0;
    return field->offset +
           (double(field->values[std::size_t(i)]) + (rest ? rest->values[std::size_t(i)] : 0));
  };
  for (int i = 0; i < points; ++i) {
    const dvec3 p = cloud.world(std::size_t(i));
    // Half a float step of a cloud that is some metres wide.
    EXPECT_NEAR(p.x, 1000 + 0.01 * 100 * i, 1e-6);
    EXPECT_NEAR(p.y, -2000 - 0.01 * 50 * i, 1e-6);
    EXPECT_NEAR(p.z, 5 + 0.001 * i, 1e-6);
    EXPECT_EQ(value("intensity", i), 1000 + i);
    EXPECT_EQ(value("user_data", i), 7 + i);
    EXPECT_EQ(value("point_source_id", i), 4242);
    EXPECT_EQ(value("scan_direction_flag", i), i % 2);
    if (format < 6) {
      EXPECT_EQ(value("classification", i), i % 32);
      EXPECT_EQ(value("return_number", i), 1 + i % 5);
      EXPECT_EQ(value("number_of_returns", i), 5);
      EXPECT_EQ(value("edge_of_flight_line", i), 1);
      EXPECT_EQ(value("withheld", i), i == 2);
      EXPECT_EQ(value("scan_angle", i), -i);
    } else {
      EXPECT_EQ(value("classification", i), 200 + i);
      EXPECT_EQ(value("return_number", i), 1 + i % 15);
      EXPECT_EQ(value("number_of_returns", i), 15);
      EXPECT_EQ(value("overlap", i), 1);
      EXPECT_EQ(value("scanner_channel", i), i % 4);
      EXPECT_EQ(value("scan_angle", i), double(float(-1000 * i * 0.006)));
      EXPECT_EQ(cloud.scalar("withheld"), nullptr);
    }
    if (layout.gps_time >= 0) {
      EXPECT_EQ(value("gps_time", i), 3.9e8 + i * 0.123456789);
    }
    if (layout.rgb >= 0) {
      EXPECT_EQ(cloud.colors[std::size_t(i)].g, (1000 * i + 317) >> 8);
    }
    if (layout.nir >= 0) {
      EXPECT_EQ(value("nir", i), 60000 + i);
    }
  }
  EXPECT_EQ(cloud.colors.empty(), layout.rgb < 0);
  EXPECT_EQ(cloud.scalar("gps_time") != nullptr, layout.gps_time >= 0);
}

TEST_P(LasPointFormat, IsReadFieldByFieldAndSurvivesLasAndLaz) {
  const int format = GetParam(), points = 12;
  const auto path = test::save(file_of(format, points).bytes(), "in.las");
  const io::ReadResult result = io::read(path);
  expect_points(result, format, points);
  const bool has_waves = format == 4 || format == 5 || format >= 9;
  EXPECT_EQ(result.report.notes,
            has_waves ? std::vector<std::string>{"wave packets are not read"} : std::vector<std::string>{});
  for (const char* name : {"out.las", "out.laz"}) {
    const auto out = test::temporary(name);
    io::write(out, result.cloud);
    const io::ReadResult again = io::read(out);
    expect_points(again, format, points);
    EXPECT_EQ(again.report.format, std::string(name).substr(4));
    // Packed again, all but the wave packet equals the bytes laid out by hand.
    if (std::string(name) == "out.las") {
      const Bytes written = test::load(out);
      const std::size_t start = test::get<std::uint32_t>(written, 96),
                        length = test::get<std::uint16_t>(written, 105);
      for (int i = 0; i < points; ++i) {
        const Bytes original = record_of(format, i);
        const std::size_t kept = std::min<std::size_t>(length, original.size());
        const std::size_t at = start + length * std::size_t(i);
        const std::size_t compared = has_waves && format == 10 ? 38 : kept;
        ASSERT_LE(at + compared, written.size());
        EXPECT_TRUE(std::equal(written.begin() + std::ptrdiff_t(at),
                               written.begin() + std::ptrdiff_t(at + compared), original.begin()))
            << "point " << i;
      }
    }
    std::filesystem::remove(out);
  }
  std::filesystem::remove(path);
}

INSTANTIATE_TEST_SUITE_P(Las, LasPointFormat, testing::Range(0, 11));

TEST(LasExtraBytes, AreScalarsUnderTheirNamesWithScaleAndOffset) {
  LasFile file = file_of(0, 0);
  file.minor = 4;
  file.record_length = 20 + 2 + 12 + 4 + 8 + 1;
  Bytes first = test::extra_field("height", 4, 8 | 16, 0.01, 100);  // int16, scale and offset
  const Bytes triple = test::extra_field("echo", 25, 0);            // 3 x uint32, deprecated
  const Bytes whole = test::extra_field("range_mm", 5), time = test::extra_field("time", 10);
  first.insert(first.end(), triple.begin(), triple.end());
  first.insert(first.end(), whole.begin(), whole.end());
  file.vlrs = {{"LASF_Spec", 4, first}, {"LASF_Spec", 4, time}};  // two records, one after the other
  for (int i = 0; i < 10; ++i) {
    Bytes r = record_of(0, i);
    r.resize(file.record_length);
    test::put<std::int16_t>(r, 20, std::int16_t(-i));
    for (std::size_t k = 0; k < 3; ++k)
      test::put<std::uint32_t>(r, 22 + 4 * k, std::uint32_t(10 * k) + std::uint32_t(i));
    test::put<std::uint32_t>(r, 34, 4000000001u + std::uint32_t(i));
    test::put<double>(r, 38, 1e9 + i * 1e-6);
    r[46] = std::uint8_t(i);  // in no record
    file.records.insert(file.records.end(), r.begin(), r.end());
  }
  const auto path = test::save(file.bytes(), "extra.las");
  const auto laz = test::temporary("extra.laz");
  io::write(laz, io::read(path).cloud);
  for (const auto& each : {path, laz}) {
    const io::ReadResult result = io::read(each);
    auto stats = [&](const std::string& name) {
      for (const io::AttributeStats& s : result.report.attributes)
        if (s.name == name) return s;
      ADD_FAILURE() << "no " << name << " in " << each;
      return io::AttributeStats{};
    };
    EXPECT_EQ(stats("height").min, 100 - 9 * 0.01);
    EXPECT_EQ(stats("height").max, 100);
    EXPECT_EQ(stats("echo_2").max, 29);
    EXPECT_EQ(stats("range_mm").min, 4000000001.0);
    EXPECT_EQ(stats("range_mm").max, 4000000010.0);
    EXPECT_EQ(stats("time").max, 1e9 + 9 * 1e-6);
    EXPECT_EQ(stats("extra").max, 9);
    const ScalarField& range = *result.cloud.scalar("range_mm");
    EXPECT_EQ(range.value(3), 4000000004.0);
    EXPECT_EQ(range.type, StoredType::uint32);
    std::filesystem::remove(each);
  }
}

Bytes geo_keys(const std::vector<std::array<std::uint16_t, 4>>& keys) {
  Bytes data(8 + 8 * keys.size());
  test::put<std::uint16_t>(data, 6, std::uint16_t(keys.size()));
  for (std::size_t i = 0; i < keys.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) test::put(data, 8 + 8 * i + 2 * k, keys[i][k]);
  return data;
}

std::string crs_of(std::vector<test::TestVlr> vlrs, std::uint16_t global_encoding = 0) {
  LasFile file = file_of(1, 2);
  file.vlrs = std::move(vlrs);
  file.global_encoding = global_encoding;
  const auto path = test::save(file.bytes(), "crs.las");
  io::ReadResult result = io::read(path);
  // Written and read again it must be the same text.
  io::write(path, result.cloud);
  EXPECT_EQ(io::read(path).report.crs, result.report.crs);
  EXPECT_EQ(result.cloud.crs, result.report.crs);
  std::filesystem::remove(path);
  return result.report.crs;
}

TEST(LasCrs, ComesFromGeoTiffKeysOrWkt) {
  const std::string text = "PROJCS[\"somewhere\",UNIT[\"metre\",1]]";
  const Bytes wkt(text.begin(), text.end());
  const std::string names = "Lambert 93|RGF93|";
  const Bytes ascii(names.begin(), names.end());
  EXPECT_EQ(crs_of({}), "");
  EXPECT_EQ(crs_of({{"LASF_Projection", 34735, geo_keys({{3072, 0, 1, 2154}})}}), "EPSG:2154");
  EXPECT_EQ(crs_of({{"LASF_Projection", 34735, geo_keys({{2048, 0, 1, 4326}})}}), "EPSG:4326");
  EXPECT_EQ(crs_of({{"LASF_Projection", 34735, geo_keys({{3072, 0, 1, 3005}, {4096, 0, 1, 5713}})}}),
            "EPSG:3005+5713");
  EXPECT_EQ(crs_of({{"LASF_Projection", 2112, wkt}}, 16), text);
  // The WKT bit decides between the two; a user-defined code leaves the WKT.
  EXPECT_EQ(
      crs_of({{"LASF_Projection", 34735, geo_keys({{3072, 0, 1, 2154}})}, {"LASF_Projection", 2112, wkt}},
             16),
      text);
  EXPECT_EQ(
      crs_of({{"LASF_Projection", 34735, geo_keys({{3072, 0, 1, 32767}})}, {"LASF_Projection", 2112, wkt}}),
      text);
  EXPECT_EQ(crs_of({{"LASF_Projection", 34735, geo_keys({{1026, 34737, 11, 0}})},
                    {"LASF_Projection", 34737, ascii}}),
            "Lambert 93");
}

TEST(LasColors, BothWaysOfWideningComeBackExactly) {
  for (const bool shifted : {true, false}) {
    LasFile file = file_of(2, 0);
    for (int i = 0; i < 256; ++i) {
      Bytes r = record_of(2, i);
      for (std::size_t c = 0; c < 3; ++c)
        test::put<std::uint16_t>(r, 20 + 2 * c, std::uint16_t(shifted ? i << 8 : i * 257));
      file.records.insert(file.records.end(), r.begin(), r.end());
    }
    const auto path = test::save(file.bytes(), "color.las");
    const io::ReadResult result = io::read(path);
    EXPECT_EQ(result.cloud.colors[255], (Rgba8{255, 255, 255, 255}));
    // No scalar is spent on low bytes that follow from the high ones.
    EXPECT_EQ(result.cloud.scalar("rgb_low_bytes"), nullptr);
    io::write(path, result.cloud);
    const io::ReadResult again = io::read(path);
    EXPECT_EQ(again.report.attributes[0].name, "red");
    EXPECT_EQ(again.report.attributes[0].max, shifted ? 65280 : 65535);
    EXPECT_TRUE(again.cloud.colors == result.cloud.colors);
    std::filesystem::remove(path);
  }
}

TEST(LasColors, EightBitValuesAreNamedInTheReport) {
  LasFile file = file_of(2, 3);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      test::put<std::uint16_t>(file.records, 26 * i + 20 + 2 * c, std::uint16_t(80 * (i + 1)));
  const auto path = test::save(file.bytes(), "color.las");
  const io::ReadResult result = io::read(path);
  EXPECT_EQ(result.cloud.colors[2], (Rgba8{240, 240, 240, 255}));
  EXPECT_THAT(result.report.notes, testing::ElementsAre(testing::HasSubstr("8-bit")));
  io::write(path, result.cloud);
  EXPECT_EQ(io::read(path).report.attributes[0].max, 240);
  std::filesystem::remove(path);
}

// A cloud that never was LAS: every attribute finds a place, in LAS and LAZ.
TEST(LasWriter, KeepsACloudThatIsNotLas) {
  PointCloud cloud;
  cloud.origin = {3e5, 5e6, 100};
  for (int i = 0; i < 500; ++i) {
    const float t = float(i) * 0.013f;
    cloud.positions.push_back({std::cos(t) * 20, std::sin(t) * 20, t});
    cloud.normals.push_back(i == 7 ? vec3(0) : vec3(std::cos(t), std::sin(t), 0));
    cloud.colors.push_back({std::uint8_t(i), std::uint8_t(255 - i % 256), 3, 255});
    cloud.radii.push_back(0.01f * float(i + 1));
  }
  auto field = [&](const char* name, StoredType type, double offset, auto value) {
    ScalarField f{name, offset, {}, type};
    for (int i = 0; i < 500; ++i) f.values.push_back(float(value(i)));
    cloud.set_scalar(f);
  };
  field("intensity", StoredType::float32, 0, [](int i) { return i / 499.0; });  // no uint16 holds 0..1
  field("classification", StoredType::uint8, 0, [](int i) { return i % 80; });  // not in formats 0 to 5
  field("ring", StoredType::int32, 0, [](int i) { return -i; });
  field("time", StoredType::float64, 1.6e9, [](int i) { return i * 0.25; });
  field("a_name_that_is_longer_than_thirty_two_bytes_1", StoredType::float32, 0, [](int i) { return i; });
  field("a_name_that_is_longer_than_thirty_two_bytes_2", StoredType::float32, 0, [](int i) { return -i; });
  for (const char* name : {"other.las", "other.laz"}) {
    const auto path = test::temporary(name);
    io::write(path, cloud);
    const PointCloud back = io::read(path).cloud;
    ASSERT_EQ(back.size(), cloud.size());
    EXPECT_EQ(back.las->point_format, 7);
    EXPECT_TRUE(back.colors == cloud.colors);
    EXPECT_TRUE(back.radii == cloud.radii);
    EXPECT_TRUE(back.normals == cloud.normals);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      for (int k = 0; k < 3; ++k)  // a step is at most 40 m / 2^22, a float's own precision half of that
        EXPECT_NEAR(back.world(i)[k], cloud.world(i)[k], 1e-5);
    for (const ScalarField& original : cloud.scalars) {
      const bool is_long = original.name.size() > 32;
      const ScalarField* copy =
          back.scalar(!is_long                       ? original.name
                      : original.name.ends_with("1") ? original.name.substr(0, 32)
                                                     : original.name.substr(0, 28) + "_2");
      ASSERT_NE(copy, nullptr) << original.name;
      for (std::size_t i = 0; i < cloud.size(); ++i)
        ASSERT_EQ(copy->value(i), original.value(i)) << original.name;
    }
    std::filesystem::remove(path);
  }
}

// As when files of different attributes are put together: what one does not have is no number there.
TEST(LasWriter, PointsWithoutAStandardDimensionLeaveItInItsPlace) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 1, 1}};
  for (const char* name : {"classification", "return_number", "number_of_returns", "withheld"})
    cloud.set_scalar({name, 0, {1, nan}, StoredType::uint8});
  cloud.set_scalar({"number_of_returns", 0, {3, nan}, StoredType::uint8});
  cloud.set_scalar({"scan_angle", 0, {-7, nan}});
  cloud.set_scalar({"ring", 0, {5, nan}, StoredType::uint8});
  const auto path = test::temporary("mixed.las");
  const io::WriteReport report = io::write(path, cloud);
  EXPECT_THAT(report.notes, testing::Contains("1 point has no classification: it is written as 0"));
  EXPECT_THAT(report.notes, testing::Contains("1 point has no return_number: it is written as 1"));
  const Bytes bytes = test::load(path);
  EXPECT_EQ(test::get<std::uint16_t>(bytes, 105), 20 + 4) << "format 0, and a float for the ring";
  const auto first = std::size_t(test::get<std::uint32_t>(bytes, 96));
  EXPECT_EQ(bytes.at(first + 14), 1 | 3 << 3);
  EXPECT_EQ(bytes.at(first + 15), 1 | 1 << 7);
  EXPECT_EQ(std::int8_t(bytes.at(first + 16)), -7);
  EXPECT_EQ(bytes.at(first + 24 + 14), 1 | 1 << 3) << "one return";
  EXPECT_EQ(bytes.at(first + 24 + 15), 0);
  EXPECT_EQ(bytes.at(first + 24 + 16), 0);
  EXPECT_TRUE(std::isnan(io::read(path).cloud.scalar("ring")->value(1)));
  std::filesystem::remove(path);
}

TEST(LasWriter, KeepsWhatTheHeaderSaysAboutTimesAndReturns) {
  test::LasFile file = file_of(1, 3);
  file.global_encoding = 1 | 8;  // adjusted standard GPS time, synthetic return numbers
  const auto path = test::save(file.bytes(), "in.las");
  const PointCloud cloud = io::read(path).cloud;
  for (const char* name : {"out.las", "out.laz"}) {
    const auto out = test::temporary(name);
    io::write(out, cloud);
    EXPECT_EQ(test::get<std::uint16_t>(test::load(out), 6), 1 | 8) << name;
    std::filesystem::remove(out);
  }
  std::filesystem::remove(path);
}

TEST(LasWriter, NoPointsAreFine) {
  for (const char* name : {"empty.las", "empty.laz"}) {
    const auto path = test::temporary(name);
    io::write(path, PointCloud{});
    const io::ReadResult result = io::read(path);
    EXPECT_EQ(result.report.points, 0u);
    EXPECT_TRUE(result.cloud.empty());
    std::filesystem::remove(path);
  }
}

TEST(LasWriter, PointsOutsideTheOldScalingGetANewOne) {
  const auto path = test::save(file_of(0, 4).bytes(), "far.las");
  PointCloud cloud = io::read(path).cloud;
  PointCloud far = cloud;
  far.origin.x += 1e9;  // 0.01 steps reach 2e7
  append(cloud, far);
  io::write(path, cloud);
  const io::ReadResult result = io::read(path);
  EXPECT_NEAR(result.report.bounds_max.x, bounds(cloud).max.x, 100);  // 1e9 / 2^23
  std::filesystem::remove(path);
}

TEST(LasReader, IsTheSameForAnyNumberOfThreadsAndStopsWhenAsked) {
  PointCloud cloud;
  ScalarField number{"number", 0, {}, StoredType::uint32};
  for (int i = 0; i < 170000; ++i) {  // four LASzip chunks, three blocks
    cloud.positions.push_back({float(i % 411), float(i / 411), float(i % 7)});
    number.values.push_back(float(i));
  }
  cloud.set_scalar(number);
  for (const char* name : {"threads.las", "threads.laz"}) {
    const auto path = test::temporary(name);
    io::write(path, cloud);
    ASSERT_EQ(setenv("SFUMATO_THREADS", "1", 1), 0);
    const io::ReadResult one = io::read(path);
    ASSERT_EQ(setenv("SFUMATO_THREADS", "4", 1), 0);
    const io::ReadResult four = io::read(path);
    ASSERT_EQ(unsetenv("SFUMATO_THREADS"), 0);
    EXPECT_TRUE(one.cloud.positions == four.cloud.positions);
    EXPECT_TRUE(one.cloud.scalar("number")->values == number.values);
    EXPECT_TRUE(four.cloud.scalar("number")->values == number.values);
    for (std::size_t i = 0; i < one.report.attributes.size(); ++i)
      EXPECT_EQ(one.report.attributes[i].mean, four.report.attributes[i].mean);

    struct Stop final : Progress {
      void update(double fraction, std::string_view) override { stopped = fraction > 0; }
      bool cancelled() const override { return stopped; }
      std::atomic<bool> stopped{false};
    } stop;
    EXPECT_THROW(io::read(path, {}, stop), Cancelled);
    Stop stop_writing;
    EXPECT_THROW(io::write(path, cloud, stop_writing), Cancelled);
    EXPECT_EQ(io::read(path).cloud.size(), cloud.size());  // the older file of that name is still whole
    std::filesystem::remove(path);
  }
}

}  // namespace
