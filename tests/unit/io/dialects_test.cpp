// Files in the dialects of programs that surveyors, mappers and roboticists use, written down from
// what those programs write: where the points are, how many, and their colours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "unit/io/files.h"

namespace sfumato {
namespace {

struct DialectFile {
  const char* name;  ///< of the file, whose extension counts
  std::string bytes;
  dvec3 first, last;  ///< places of the first and the last point
  std::size_t points;
  std::optional<Rgba8> color = {};  ///< of the first point; nothing: it has none
  std::function<void(const PointCloud&)> more = {};
};

template <class... T>
std::string line(const char* format, T... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// `count` lines by `one`.
std::string lines(int count, const std::function<std::string(int)>& one) {
  std::string text;
  for (int i = 0; i < count; ++i) text += one(i);
  return text;
}

/// A wavy ground around (x, y, z).
dvec3 ground(int i, dvec3 at = {0, 0, 0}) {
  return at + dvec3(0.37 * (i % 23), 0.53 * ((i * 7) % 31), 0.5 * std::sin(0.9 * i) + 0.25);
}

std::string floats(int count, int width, const std::function<float(int, int)>& value) {
  std::string bytes;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < width; ++k) bytes += test::bytes_of(value(i, k));
  return bytes;
}

/// A spinning scanner of 32 rings: x y z, reflectance, ring, seconds.
float spinning(int i, int k) {
  const float angle = 0.006f * float(i / 32), ring = float(i % 32),
              range = 6 + 25 * std::abs(std::cos(2 * angle));
  const float tilt = -0.4f + 0.018f * ring;
  switch (k) {
    case 0: return range * std::cos(angle) * std::cos(tilt);
    case 1: return range * std::sin(angle) * std::cos(tilt);
    case 2: return range * std::sin(tilt);
    case 3: return float((i * 7919) % 200) / 255.0f;
    case 4: return ring;
    default: return 0.1f * float(i) / 6400;
  }
}
dvec3 spinning_point(int i) { return {spinning(i, 0), spinning(i, 1), spinning(i, 2)}; }

std::vector<DialectFile> dialects() {
  const dvec3 utm{412300, 5652100, 210}, swiss{2683100, 1247900, 430};
  std::vector<DialectFile> all;
  const auto add = [&](DialectFile file) { all.push_back(std::move(file)); };
  add({"cloudcompare.asc",
       "//X Y Z R G B Scalar_field\n60\n" + lines(60,
                                                  [&](int i) {
                                                    const dvec3 p = ground(i, utm);
                                                    return line("%.8f %.8f %.8f %d %d %d %f\n", p.x, p.y, p.z,
                                                                90 + i, 40, 12, 0.1 * i);
                                                  }),
       ground(0, utm), ground(59, utm), 60, Rgba8{90, 40, 12, 255}});
  add({"metashape.txt",
       lines(80,
             [&](int i) {
               const dvec3 p = ground(i);
               return line("%.6f %.6f %.6f %d %d %d %.6f %.6f %.6f\n", p.x, p.y, p.z, 30 + i, 99, 60, 0.6,
                           0.0, 0.8);
             }),
       ground(0), ground(79), 80, Rgba8{30, 99, 60, 255},
       [](const PointCloud& c) { EXPECT_NEAR(c.normals.at(0).z, 0.8f, 1e-4); }});
  add({"pdal.csv",
       "\"X\",\"Y\",\"Z\",\"Intensity\",\"ReturnNumber\",\"NumberOfReturns\",\"Classification\",\"GpsTime\","
       "\"Red\","
       "\"Green\",\"Blue\"\n" +
           lines(70,
                 [&](int i) {
                   const dvec3 p = ground(i, utm);
                   return line("%.3f,%.3f,%.3f,%d.000,1.000,1.000,2.000,245380.781,%d.000,%d.000,%d.000\n",
                               p.x, p.y, p.z, 100 + i, 257 * (i + 20), 257 * 100, 257 * 200);
                 }),
       ground(0, utm), ground(69, utm), 70, Rgba8{20, 100, 200, 255}});
  add({"arcgis.txt",
       "OBJECTID,CLASS_CODE,POINT_X,POINT_Y,POINT_Z\r\n" + lines(50,
                                                                 [&](int i) {
                                                                   const dvec3 p = ground(i, utm);
                                                                   return line("%d,2,%.3f,%.3f,%.3f\r\n",
                                                                               i + 1, p.x, p.y, p.z);
                                                                 }),
       ground(0, utm), ground(49, utm), 50});
  add({"pnezd.csv",
       "Point,Northing,Easting,Elevation,Description\n" +
           lines(40,
                 [&](int i) {
                   const dvec3 p = ground(i, utm);
                   return line("%d,%.3f,%.3f,%.3f,%s\n", 1000 + i, p.y, p.x, p.z,
                               i % 2 ? "EP, edge" : "TOP OF BANK");
                 }),
       ground(0, utm), ground(39, utm), 40});
  add({"vermessung.csv",
       "Punktnummer;Rechtswert [m];Hochwert [m];H\xF6he [m];Bemerkung\r\n" +
           lines(40,
                 [&](int i) {
                   const dvec3 p = ground(i, utm);
                   std::string text = line("%d;%.3f;%.3f;%.3f;", 20001 + i, p.x, p.y, p.z);
                   std::replace(text.begin(), text.end(), '.', ',');
                   return text + (i % 3 ? "Zaun\r\n" : "Baum, Eiche\r\n");
                 }),
       ground(0, utm), ground(39, utm), 40});
  add({"swiss.txt",
       "E;N;H\n" + lines(40,
                         [&](int i) {
                           const dvec3 p = ground(i, swiss);
                           return line("%.2f;%.2f;%.2f\n", p.x, p.y, p.z);
                         }),
       ground(0, swiss), ground(39, swiss), 40});
  add({"drone_track.csv",
       "time,latitude,longitude,ele\n" + lines(40,
                                               [&](int i) {
                                                 return line("2024-05-01T10:%02d:00Z,%.7f,%.7f,%.1f\n", i,
                                                             47.1 + 1e-4 * i, 8.5 + 2e-4 * i, 400.5 + i);
                                               }),
       {8.5, 47.1, 400.5},
       {8.5 + 39 * 2e-4, 47.1 + 39e-4, 439.5},
       40});
  add({"obra.txt",
       "Punto Este Norte Cota\n" + lines(40,
                                         [&](int i) {
                                           const dvec3 p = ground(i, utm);
                                           return line("P%d %.3f %.3f %.3f\n", i, p.x, p.y, p.z);
                                         }),
       ground(0, utm), ground(39, utm), 40});
  add({"veloview.csv",
       "\"Points:0\",\"Points:1\",\"Points:2\",\"intensity\",\"laser_id\",\"azimuth\",\"distance_m\","
       "\"timestamp\"\n" +
           lines(60,
                 [&](int i) {
                   const dvec3 p = ground(i, {-4, -8, 0});
                   return line("%.4f,%.4f,%.4f,%d,%d,%d,%.3f,%lld\n", p.x, p.y, p.z, i, i % 16, 20 * i,
                               glm::length(p), 1690000000000LL + i);
                 }),
       ground(0, {-4, -8, 0}), ground(59, {-4, -8, 0}), 60});
  add({"ouster.csv",
       "# TIMESTAMP (ns), RANGE (mm), SIGNAL (photons), REFLECTIVITY (%), NEAR_IR (photons), X (m), Y (m), Z "
       "(m), "
       "MEASUREMENT_ID, ROW, COLUMN\n" +
           lines(60,
                 [&](int i) {
                   const dvec3 p = ground(i, {-4, -8, 0});
                   return line("%lld, %d, %d, %d, %d, %.4f, %.4f, %.4f, %d, %d, %d\n", 1690000000000LL + i,
                               4000 + i, 90, 30 + i, 200, p.x, p.y, p.z, i, i % 64, i / 64);
                 }),
       ground(0, {-4, -8, 0}), ground(59, {-4, -8, 0}), 60});
  add({"livox.csv",
       "Version,Slot ID,LiDAR Index,Rsvd,Error Code,Timestamp Type,Data "
       "Type,Timestamp,X,Y,Z,Reflectivity,Tag,Ori_x,"
       "Ori_y,Ori_z,Ori_radius\n" +
           lines(60,
                 [&](int i) {
                   const dvec3 p = ground(i, {3, -8, 0});
                   return line("5,1,1,0,0x00000000,0,2,%lld,%.3f,%.3f,%.3f,%d,0,%d,%d,%d,0\n",
                               1690000000000LL + i, p.x, p.y, p.z, i, int(1000 * p.x), int(1000 * p.y),
                               int(1000 * p.z));
                 }),
       ground(0, {3, -8, 0}), ground(59, {3, -8, 0}), 60});
  add({"semantic3d.txt",
       lines(90,
             [&](int i) {
               const dvec3 p = ground(i, {-14, 3, 0});
               return line("%.3f %.3f %.3f %d %d %d %d\n", p.x, p.y, p.z, -1900 + 17 * i, 80 + i, 90 + i,
                           60 + i);
             }),
       ground(0, {-14, 3, 0}), ground(89, {-14, 3, 0}), 90, Rgba8{80, 90, 60, 255}});
  add({"shapenet_part.txt",
       lines(90,
             [&](int i) {
               const dvec3 p = 0.02 * ground(i);
               return line("%.5f %.5f %.5f %.4f %.4f %.4f %.6f\n", p.x, p.y, p.z, 0.0, -0.6, 0.8,
                           double(12 + i % 4));
             }),
       0.02 * ground(0),
       0.02 * ground(89),
       90,
       {},
       [](const PointCloud& c) {
         EXPECT_NEAR(c.normals.at(0).y, -0.6f, 1e-4);
         EXPECT_EQ(c.scalars.at(0).value(1), 13);
       }});
  add({"gdal_dx_dy.asc",
       "ncols        4\nnrows        3\nxllcorner    1000.000000000000\nyllcorner    2000.000000000000\n"
       "dx           2.0\ndy           1.0\nNODATA_value  -9999\n 10 11 12 13\n 14 -9999 16 17\n 18 19 20 "
       "21\n",
       {1001, 2002.5, 10},
       {1007, 2000.5, 21},
       11});
  add({"pandas_index.csv",
       ",x,y,z,red,green,blue\n" + lines(50,
                                         [&](int i) {
                                           const dvec3 p = ground(i);
                                           return line("%d,%.17g,%.17g,%.17g,%.3f,%.3f,%.3f\n", i, p.x, p.y,
                                                       p.z, 1.0, 0.5, 0.0);
                                         }),
       ground(0), ground(49), 50, Rgba8{255, 128, 0, 255}});
  add({"matlab.txt",
       lines(50,
             [&](int i) {
               const dvec3 p = ground(i);
               return line("   %.7e   %.7e   %.7e\n", p.x, p.y, p.z);
             }),
       ground(0), ground(49), 50});
  add({"nuscenes.pcd.bin",
       floats(6400, 5, spinning),
       spinning_point(0),
       spinning_point(6399),
       6400,
       {},
       [](const PointCloud& c) { EXPECT_TRUE(c.scalar("ring") && c.scalar("intensity")); }});
  add({"boreas.bin",
       floats(6400, 6, spinning),
       spinning_point(0),
       spinning_point(6399),
       6400,
       {},
       [](const PointCloud& c) { EXPECT_TRUE(c.scalar("ring") && c.scalar("time")); }});
  const auto lvis_point = [](int i) {
    return dvec3(301.2 + 0.0001 * i, 78.3 - 0.0002 * (i % 10), 1956 + i % 7);
  };
  add({"lvis.TXT",
       "# Several elevations are derived from the waveform. Please visit the site for discussion.\n"
       "# LVIS_LFID SHOTNUMBER TIME LONGITUDE_CENTROID LATITUDE_CENTROID ELEVATION_CENTROID LONGITUDE_LOW "
       "LATITUDE_LOW ELEVATION_LOW\n" +
           lines(50,
                 [&](int i) {
                   const dvec3 p = lvis_point(i);
                   return line("1654935003  %d  42504.48313  %.6f  %.6f  %.3f  %.6f  %.6f  %.3f\n",
                               1103940 + i, p.x, p.y, p.z, p.x + 1e-5, p.y, p.z - 3);
                 }),
       lvis_point(0),
       lvis_point(49),
       50,
       {},
       [](const PointCloud& c) { EXPECT_EQ(c.crs, "EPSG:4326"); }});
  const auto nclt_point = [](int i) {
    return dvec3(0.005 * (i % 700) - 1, 20 - 0.01 * i, -0.005 * (i % 97));
  };
  std::string nclt;
  for (int i = 0; i < 900; ++i) {
    for (int k = 0; k < 3; ++k)
      nclt += test::bytes_of(std::uint16_t(std::lround((nclt_point(i)[k] + 100) / 0.005)));
    nclt += char(i % 250), nclt += char(i % 32);
  }
  add({"nclt.bin", nclt, nclt_point(0), nclt_point(899), 900, {}, [](const PointCloud& c) {
         ASSERT_TRUE(c.scalar("intensity") && c.scalar("ring"));
         EXPECT_EQ(c.scalar("ring")->values.at(35), 3);
         EXPECT_EQ(c.up, UpAxis::neg_z);
         ASSERT_EQ(c.scanners.size(), 1u);
       }});
  const auto up_z = [](const PointCloud& c) { EXPECT_NEAR(c.normals.at(0).z, 1, 1e-6); };
  const auto easy3d = [](bool has_colors, bool has_normals) {
    const int points = 70;
    const auto block = [&](bool has, const std::function<dvec3(int)>& one) {
      std::string bytes = test::bytes_of(std::int32_t(has ? points : 0));
      for (int i = 0; i < points && has; ++i)
        for (int k = 0; k < 3; ++k) bytes += test::bytes_of(float(one(i)[k]));
      return bytes;
    };
    return block(true, [](int i) { return ground(i); }) +
           block(has_colors, [](int i) { return dvec3(i / 100.0, 0.2, 1); }) +
           block(has_normals, [](int) { return dvec3(0, 0, 1); });
  };
  add({"easy3d.bin", easy3d(false, true), ground(0), ground(69), 70, {}, up_z});
  add({"easy3d_colors.bin", easy3d(true, true), ground(0), ground(69), 70, Rgba8{0, 51, 255, 255}, up_z});
  add({"easy3d_places.bin", easy3d(false, false), ground(0), ground(69), 70});
  std::string expe =
      "[Expe/PointSet/Binary/0.1]\nproperty position 12\nproperty radius 4\nproperty normal 12\n"
      "property color 4\nnofpoints 60\ndata\n";
  for (int i = 0; i < 60; ++i) {
    const dvec3 p = ground(i);
    expe += test::bytes_of(float(p.x), float(p.y), float(p.z), 0.5f, 0.0f, 0.0f, 1.0f) +
            test::bytes_of(std::uint8_t(9), std::uint8_t(8), std::uint8_t(7), std::uint8_t(255));
  }
  add({"expe.pts", expe, ground(0), ground(59), 60, Rgba8{9, 8, 7, 255}, up_z});
  add({"expe_ascii.pts",
       "[Expe/PointSet/Ascii/0.2]\nproperty position 3 r32\nproperty radius 1 r32\nproperty normal 3 r32\n"
       "property color 4 ui8\nnofpoints 60\ndata\n" +
           lines(60,
                 [&](int i) {
                   const dvec3 p = ground(i);
                   return line("%f,%f,%f ; %f ; %f,%f,%f ; %d,%d,%d,%d\n", p.x, p.y, p.z, 0.6, 0.0, 0.0, 1.0,
                               9, 8, 7, 255);
                 }),
       ground(0), ground(59), 60, Rgba8{9, 8, 7, 255}, up_z});
  add({"expe_shares.pts",
       "[Expe/PointSet/Ascii/0.2]\nproperty position 3 r32\nproperty color 4 ui8\nnofpoints 60\ndata\n" +
           lines(60,
                 [&](int i) {
                   const dvec3 p = ground(i);
                   return line("%f,%f,%f ; %g,%g,%g,%g\n", p.x, p.y, p.z, 1.0, 0.2, 0.0, 1.0);
                 }),
       ground(0), ground(59), 60, Rgba8{255, 51, 0, 255}});
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 60\nproperty double x\nproperty double y\n"
      "property double z\nproperty ushort red\nproperty ushort green\nproperty ushort blue\nend_header\n";
  for (int i = 0; i < 60; ++i) {
    const dvec3 p = ground(i, utm);
    ply += test::bytes_of(p.x, p.y, p.z, std::uint16_t(i * 69), std::uint16_t(2000), std::uint16_t(4095));
  }
  std::string tuples;
  for (int i = 0; i < 60; ++i) {
    const dvec3 p = ground(i);
    tuples += "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + ")\n";
  }
  add({"python_tuples.txt", tuples, ground(0), ground(59), 60});
  add({"twelve_bits.ply", ply, ground(0, utm), ground(59, utm), 60, Rgba8{0, 125, 255, 255}});
  return all;
}

TEST(Dialects, AllAreReadRight) {
  const std::vector<DialectFile> all = dialects();
  EXPECT_EQ(all.size(), 29u);
  for (const DialectFile& file : all) {
    SCOPED_TRACE(file.name);
    std::optional<io::ReadResult> read;
    try {
      read = io::read(test::write_file(file.name, file.bytes));
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
      continue;
    }
    const PointCloud& cloud = read->cloud;
    for (const std::string& note : read->report.notes) SCOPED_TRACE(note);
    EXPECT_EQ(cloud.size(), file.points);
    if (cloud.empty()) continue;
    EXPECT_LT(glm::length(cloud.world(0) - file.first), 0.01) << cloud.world(0).x << " " << cloud.world(0).y;
    EXPECT_LT(glm::length(cloud.world(cloud.size() - 1) - file.last), 0.01);
    EXPECT_EQ(cloud.colors.empty(), !file.color);
    if (file.color && !cloud.colors.empty()) EXPECT_EQ(cloud.colors[0], *file.color);
    if (file.more) file.more(cloud);
  }
}

TEST(Dialects, PointSetsThatEndEarlyAreReadAsFarAsTheyGo) {
  for (const DialectFile& file : dialects())
    if (std::string(file.name).starts_with("expe")) {
      EXPECT_GT(test::expect_cuts_are_safe(file.name, file.bytes, file.points), 0) << file.name;
      const io::ReadResult half =
          io::read(test::write_file(file.name, file.bytes.substr(0, file.bytes.size() / 2)));
      EXPECT_EQ(half.cloud.size() + half.report.points_missing, file.points) << file.name;
      EXPECT_EQ(half.report.points, file.points) << file.name;
      EXPECT_EQ(half.report.damage.size(), 1u) << file.name;
    }
}

// Headers of which nothing can be read name the line.
TEST(Dialects, HeadersOfPointSetsThatSayNoPlacesAreRefused) {
  for (const auto& [header, says] :
       {std::pair("nofpoints 1\ndata\n", "position"),
        {"property position 12\ndata\n", "number of points"},
        {"property position x\nnofpoints 1\ndata\n", "line 2"},
        {"property position 12\nproperty a 200\nproperty b 900\nnofpoints 1\ndata\n", "256 numbers"},
        {"property position 3 r99\nnofpoints 1\ndata\n", "r99"},
        {"property position 12\nnofpoints 1\n", "data"}}) {
    const std::string bytes = std::string("[Expe/PointSet/Binary/0.1]\n") + header + std::string(12, '\0');
    const std::optional<Error> error = test::error_of(test::write_file("a.pts", bytes));
    ASSERT_TRUE(error) << header;
    EXPECT_THAT(error->what(), testing::HasSubstr(says));
  }
}

}  // namespace
}  // namespace sfumato
