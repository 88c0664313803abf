#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <random>

#include "io/text_rows.h"
#include "unit/io/files.h"
#include "unit/io/truth.h"

namespace sfumato {
namespace {

using test::write_file;

io::ReadResult read_text(const std::string& bytes, const std::string& name = "a.txt",
                         const io::ReadOptions& options = {}) {
  return io::read(write_file(name, bytes), options);
}

TEST(TextTest, NumbersAreRoundedExactly) {
  std::mt19937_64 random(7);
  const char* formats[] = {"%.3f", "%.9g", "%.17g", "%.6e", "%g", "%.12f"};
  char text[400];
  for (int i = 0; i < 20000; ++i) {
    const double written = std::ldexp(double(std::int64_t(random())), int(random() % 120) - 100);
    const int length = std::snprintf(text, sizeof text, formats[i % 6], written);
    double expected = 0, found = 0;
    std::from_chars(text, text + length, expected);
    ASSERT_EQ(io::parse_number(text, text + length, found), text + length) << text;
    ASSERT_EQ(found, expected) << text;
    // What the short way takes, it takes as the long one does.
    if (const char* end = io::parse_plain_number(text, text + length, found)) {
      ASSERT_EQ(end, text + length) << text;
      ASSERT_EQ(found, expected) << text;
    }
  }
}

TEST(TextTest, PlainNumbersAreTakenTheShortWay) {
  struct Case {
    std::string text;
    int length;  ///< -1: left to the long way
    double value;
  };
  for (const Case& c : {Case{"12.5", 4, 12.5}, Case{"-.5 ", 3, -0.5}, Case{"5.,", 2, 5}, Case{"255;", 3, 255},
                        Case{"999999999999.999", 16, 999999999999.999}, Case{"0.1x", 3, 0.1},
                        Case{"+1", -1, 0}, Case{"1e3", -1, 0}, Case{"1.5E2", -1, 0},
                        Case{"1234567890123456", -1, 0}, Case{"0.0000000000000001", -1, 0}, Case{".", -1, 0},
                        Case{"-", -1, 0}, Case{"", -1, 0}, Case{"nan", -1, 0}}) {
    double value = 0;
    const char *begin = c.text.data(), *end = io::parse_plain_number(begin, begin + c.text.size(), value);
    EXPECT_EQ(end ? int(end - begin) : -1, c.length) << c.text;
    if (end) EXPECT_EQ(value, c.value) << c.text;
  }
  double value = 1;
  const std::string zero = "-0";
  ASSERT_TRUE(io::parse_plain_number(zero.data(), zero.data() + 2, value));
  EXPECT_TRUE(value == 0 && std::signbit(value));
}

TEST(TextTest, NumbersOfEverySpelling) {
  const auto parse = [](std::string_view text) {
    double value = -1;
    const char* end = io::parse_number(text.data(), text.data() + text.size(), value);
    return std::pair(end ? int(end - text.data()) : -1, value);
  };
  EXPECT_EQ(parse("+12.5"), std::pair(5, 12.5));
  EXPECT_EQ(parse("-.5"), std::pair(3, -0.5));
  EXPECT_EQ(parse("5."), std::pair(2, 5.0));
  EXPECT_EQ(parse("1e+3,"), std::pair(4, 1000.0));
  EXPECT_EQ(parse("12345678901234567890123"), std::pair(23, 12345678901234567890123.0));
  EXPECT_EQ(parse("1e400").second, HUGE_VAL);
  EXPECT_TRUE(std::isnan(parse("nan").second));
  EXPECT_EQ(parse("-inf").second, -HUGE_VAL);
  EXPECT_EQ(parse("abc").first, -1);
  EXPECT_EQ(parse("").first, -1);
  EXPECT_EQ(parse("-").first, -1);
  EXPECT_EQ(parse("1e").first, 1);
}

TEST(TextTest, APtxGridIsNotTakenForPoints) {
  const std::string head = "2\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  try {
    read_text(head + "1 2 3 0.5\n4 5 6 0.5\n", "a.ptx");
    FAIL() << "the rows of the pose became points";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("ends inside a grid"));
  }
}

TEST(TextTest, SeparatorsMayBeMixed) {
  const PointCloud cloud = read_text("1 2\t3\n4,5;6\r\n\n 7 , 8 ; 9 ,\n# a remark\n10;11;12").cloud;
  EXPECT_EQ(cloud.positions, (std::vector<vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}}));
  EXPECT_EQ(cloud.up, UpAxis::pos_z);
}

TEST(TextTest, AnEmptyCellIsNoNumberAndMovesNothing) {
  const PointCloud cloud = read_text("x,y,z,a,b\n1,2,3,,5\n6,7,8,9,10\n,1,1,1,1\n").cloud;
  ASSERT_EQ(cloud.size(), 2u);  // the last one has no x
  EXPECT_TRUE(std::isnan(cloud.scalar("a")->value(0)));
  EXPECT_EQ(cloud.scalar("b")->value(0), 5);
}

struct Guess {
  const char* line;
  const char* columns;
};

TEST(TextTest, ColumnsAreGuessedFromTheirNumbers) {
  const Guess guesses[] = {
      {"1.5 2.5 3.5", "x,y,z"},
      {"1.5 2.5 3.5 -1200", "x,y,z,intensity"},
      {"1.5 2.5 3.5 10 200 30", "x,y,z,red,green,blue"},
      {"1.5 2.5 3.5 0.6 0 -0.8", "x,y,z,nx,ny,nz"},
      {"1.5 2.5 3.5 0.1 0.9 0.5", "x,y,z,red,green,blue"},
      {"1.5 2.5 3.5 -1200 10 200 30", "x,y,z,intensity,red,green,blue"},
      {"1.5 2.5 3.5 0.25 10 200 30", "x,y,z,intensity,red,green,blue"},
      {"1.5 2.5 3.5 25 10 200 30", "x,y,z,intensity,red,green,blue"},
      {"1.5 2.5 3.5 10 200 30 0.25", "x,y,z,red,green,blue,intensity"},
      {"1.5 2.5 3.5 10 200 30 0.6 0 -0.8", "x,y,z,red,green,blue,nx,ny,nz"},
      {"1.5 2.5 3.5 0.6 0 -0.8 10 200 30", "x,y,z,nx,ny,nz,red,green,blue"},
      {"1.5 2.5 3.5 700 800", "x,y,z,intensity,column_5"},
  };
  for (const Guess& guess : guesses) {
    const io::ReadResult result = read_text(std::string(guess.line) + "\n" + guess.line + "\n");
    ASSERT_EQ(result.report.notes.size(), 1u);
    EXPECT_NE(result.report.notes[0].find(std::string(": ") + guess.columns + " ("), std::string::npos)
        << guess.line << ": " << result.report.notes[0];
  }
}

TEST(TextTest, RowsAndColumnsOfAScanArePassedOver) {
  const std::string scan = "0 0 1.5 2.5 3.5\n0 1 1.6 2.5 3.5\n0 4 1.7 2.5 3.5\n1 0 1.5 2.6 3.5\n";
  const io::ReadResult result = read_text(scan);
  EXPECT_NEAR(glm::distance(result.cloud.world(1), dvec3(1.6, 2.5, 3.5)), 0, 1e-6);
  EXPECT_NE(result.report.notes.at(0).find("_,_,x,y,z, behind a row and a column"), std::string::npos);
  const io::ReadResult by_columns = read_text("3 7 1.5 2.5 3.5 90\n4 7 1.6 2.5 3.5 91\n3 8 1.7 2.5 3.5 92\n");
  EXPECT_NEAR(glm::distance(by_columns.cloud.world(2), dvec3(1.7, 2.5, 3.5)), 0, 1e-6);
  EXPECT_TRUE(by_columns.cloud.scalar("intensity"));
  // Heights on a grid of whole metres, with classes or in any order; a place twice.
  for (const char* heights :
       {"0 0 1.5 2 3.5\n0 1 1.6 2 3.5\n1 0 1.5 2 3.5\n",
        "0 0 1.5 0.1 0.2 0.97\n0 1 1.6 0.1 0.2 0.97\n1 0 1.5 0.1 0.2 0.97\n",
        "5 0 1.5 2.5 3.5\n0 1 1.6 2.5 3.5\n3 0 1.5 2.6 3.5\n",
        "0 0 1.5 2.5 3.5\n0 0 1.6 2.5 3.5\n0 1 1.5 2.6 3.5\n", "0 0 1.5\n0 1 1.6\n1 0 1.5\n"})
    EXPECT_NEAR(read_text(heights).cloud.world(1).z, 1.6, 1e-6) << heights;
}

TEST(TextTest, HeaderLinesNameTheColumns) {
  const io::ReadResult result =
      read_text("# exported\n//X Y Z R G B Scalar_field Nx Ny Nz\n1 2 3 10 20 30 0.5 0 0 1\n");
  EXPECT_EQ(result.cloud.colors.at(0), (Rgba8{10, 20, 30, 255}));
  EXPECT_EQ(result.cloud.normals.at(0), vec3(0, 0, 1));
  EXPECT_EQ(result.cloud.scalar("Scalar_field")->value(0), 0.5);
  EXPECT_NE(result.report.notes.at(0).find("header line"), std::string::npos);
  // Another order, and quotes.
  EXPECT_EQ(read_text("\"id\";\"z\";\"x\";\"y\"\n9;3;1;2\n").cloud.positions.at(0), vec3(1, 2, 3));
}

TEST(TextTest, DecimalCommasAndQuotesAreRead) {
  const std::vector<vec3> places{{1.5, -2.25, 3}, {4, 5.5, 6.75}};
  for (const char* text :
       {"1,5 -2,25 3\n4 5,5 6,75\n", "x;y;z\r\n1,5;-2,25;3\r\n4;5,5;6,75\r\n", "1,5\t-2,25\t3\n4\t5,5\t6,75",
        "\"x\",\"y\",\"z\"\n\"1.5\",\"-2.25\",\"3\"\n\"4\",\"5.5\",\"6.75\"\n",
        "\"1,5\";\"-2,25\";\"3\"\n\"4\";\"5,5\";\"6,75\"\n", "1.5,-2.25,3\n4,5.5,6.75\n"})
    EXPECT_EQ(read_text(text).cloud.positions, places) << text;
  // Commas that part numbers somewhere part them everywhere.
  EXPECT_EQ(read_text("1,2 3\n4, 5 6\n").cloud.positions, (std::vector<vec3>{{1, 2, 3}, {4, 5, 6}}));
  const io::ReadResult colored = read_text("1,5;2,5;3;255;0;128\n1;2;3,5;0;1;2\n");
  EXPECT_EQ(colored.cloud.colors.at(0), (Rgba8{255, 0, 128, 255}));
  EXPECT_NE(colored.report.notes.at(0).find("commas are decimal"), std::string::npos);
}

TEST(TextTest, DepthsAreBelow) {
  const io::ReadResult soundings = read_text("X,Y,Depth (m)\n363643.5,5800993.25,6.5\n363644,5800993,0.5\n");
  EXPECT_EQ(soundings.cloud.world(0), dvec3(363643.5, 5800993.25, -6.5));
  EXPECT_EQ(soundings.cloud.world(1), dvec3(363644, 5800993, -0.5));
  EXPECT_NE(soundings.report.notes.back().find("depth"), std::string::npos);
  EXPECT_EQ(read_text("X_m,Y_m,Seabed_Depth_m\n1,2,3\n4,5,6\n").cloud.positions.at(1), vec3(4, 5, -6));
  EXPECT_TRUE(read_text("x,y,z,snow_depth\n1,2,3,4\n").cloud.scalar("snow_depth"));
  // Written as heights they are some; beside z a depth is a number of the points; who names columns is right.
  EXPECT_EQ(read_text("lon;lat;Tiefe\n1;2;-3\n").cloud.positions.at(0), vec3(1, 2, -3));
  const PointCloud cloud = read_text("x y z depth\n1 2 3 4\n").cloud;
  EXPECT_EQ(cloud.positions.at(0), vec3(1, 2, 3));
  EXPECT_TRUE(cloud.scalar("depth"));
  io::ReadOptions named;
  named.columns = {"x", "y", "z"};
  EXPECT_EQ(read_text("x y depth\n1 2 3\n", "a.txt", named).cloud.positions.at(0), vec3(1, 2, 3));
}

TEST(TextTest, HeadersOfSurveyorsNameTheAxes) {
  for (const char* header : {"Easting,Northing,Elevation,Class\n", "E [m],N [m],H (m),class\n",
                             "// y_coord; x_coord; z; Class\n", "# lon, lat, height_above_datum, class\n"}) {
    const bool swapped = header[0] == '/';
    const PointCloud cloud = read_text(std::string(header) + "1,2,3,6\n").cloud;
    EXPECT_EQ(cloud.positions.at(0), swapped ? vec3(2, 1, 3) : vec3(1, 2, 3)) << header;
    ASSERT_TRUE(cloud.scalar("classification")) << header;
  }
  const PointCloud paraview =
      read_text("\"RGB:0\",\"RGB:1\",\"RGB:2\",\"Points:0\",\"Points:1\",\"Points:2\"\n9,8,7,1,2,3\n").cloud;
  EXPECT_EQ(paraview.positions.at(0), vec3(1, 2, 3));
  EXPECT_EQ(paraview.colors.at(0), (Rgba8{9, 8, 7, 255}));
  const PointCloud cloud = read_text("X,Y,Z,Height above ground,Return Number\n1,2,3,4,5\n").cloud;
  EXPECT_EQ(cloud.positions.at(0), vec3(1, 2, 3));
  EXPECT_TRUE(cloud.scalar("Height above ground"));
  EXPECT_TRUE(cloud.scalar("return_number"));
}

TEST(TextTest, NamesOfPointsArePassedOver) {
  const io::ReadResult result = read_text("P1 1 2 3 10 20 30\nP2 4 5 6 1 2 3\n");
  EXPECT_EQ(result.cloud.positions, (std::vector<vec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(result.cloud.colors.at(0), (Rgba8{10, 20, 30, 255}));
  EXPECT_EQ(read_text("name,z,y,x\na,3,2,1\n").cloud.positions.at(0), vec3(1, 2, 3));
}

TEST(TextTest, TheUsersColumnsWin) {
  io::ReadOptions options;
  options.columns = {"_", "z", "y", "x", "intensity"};
  const PointCloud cloud = read_text("x y z a b\nname 3 2 1 7\nother 6 5 4 8\n", "a.txt", options).cloud;
  EXPECT_EQ(cloud.positions, (std::vector<vec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(cloud.scalar("intensity")->value(1), 8);
  EXPECT_EQ(cloud.scalars.size(), 1u);
  options.columns = {"x", "y", "intensity"};
  const std::optional<Error> error = test::error_of(write_file("b.txt", "1 2 3\n"), options);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::usage);
}

TEST(TextTest, PtsCountsArePassedOver) {
  const io::ReadResult result = read_text("2\n1 2 3 -5 1 2 3\n4 5 6 9 255 0 0\n1\n7 8 9 0 1 1 1\n", "a.pts");
  EXPECT_EQ(result.report.points, 3u);
  EXPECT_EQ(result.cloud.colors.at(1), (Rgba8{255, 0, 0, 255}));
  EXPECT_EQ(result.cloud.scalar("intensity")->value(0), -5);
}

TEST(TextTest, LargeCoordinatesKeepTheirDigits) {
  const PointCloud cloud = read_text("500000.001 6600000.002 12.003\n500010.004 6600020.005 15.006\n").cloud;
  EXPECT_NEAR(cloud.world(0).y, 6600000.002, 2e-6);  // 24 bits of a 20 m cloud
  EXPECT_NEAR(cloud.world(1).x, 500010.004, 2e-6);
}

TEST(TextTest, DegreesBesideMetresKeepTheirDigits) {
  // Three metres of a track, whose heights range over more than a sixteenth of its longitude.
  const PointCloud cloud = read_text(
                               "-68.51469573 48.47884528 18.1 1 2\n-68.51466262 48.47887838 22.7 1 2\n"
                               "-68.51467771 48.47885993 20.2 1 2\n")
                               .cloud;
  EXPECT_NEAR(cloud.world(0).x, -68.51469573, 1e-11);
  EXPECT_NEAR(cloud.world(2).y, 48.47885993, 1e-11);
  // A floor keeps its place.
  EXPECT_EQ(read_text("0.5 0.5 5.0001\n90.5 90.5 5.0203\n").cloud.origin, dvec3(0));
}

TEST(TextTest, ManyBlocksKeepFileOrderAndLineNumbers) {
  std::string bytes;
  const int n = 500000;
  for (int i = 0; i < n; ++i)
    bytes += std::to_string(i) + ".5 2.25 -3 " + std::to_string(i % 3000 + 256) + "\n";
  const io::ReadResult result = read_text(bytes);
  ASSERT_EQ(result.cloud.size(), std::size_t(n));
  for (int i = 0; i < n; ++i) {
    ASSERT_EQ(result.cloud.positions[std::size_t(i)].x, float(i) + 0.5f);
    ASSERT_EQ(result.cloud.scalars[0].values[std::size_t(i)], float(i % 3000 + 256));
  }
  // Damage in two blocks: the first one is named.
  const std::size_t at = bytes.find("\n300000.5");
  bytes[bytes.size() - 3] = 'x';
  bytes[at + 1] = 'x';
  const std::optional<Error> error = test::error_of(write_file("b.txt", bytes));
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("line 300001:"), std::string::npos) << error->what();
}

TEST(TextTest, FilesWithoutAPointAreBadInput) {
  const std::pair<const char*, const char*> cases[] = {{"", "empty"},
                                                       {"\n\n\n", "no line of numbers"},
                                                       {"hello world\nthis is prose\n", "no line of numbers"},
                                                       {"x,y,z\n", "no line of numbers"},
                                                       {"1 2\n3 4\n", "found 2 numbers"},
                                                       {"1 2 3\n4 5 6\n7 8\n", "found 2 numbers"},
                                                       {"1 2 3\n4 oops 6\n", "line 2: found 'oops'"}};
  for (const auto& [bytes, message] : cases) {
    const std::optional<Error> error = test::error_of(write_file("a.txt", bytes));
    ASSERT_TRUE(error.has_value()) << bytes;
    EXPECT_EQ(error->code(), ErrorCode::bad_input) << bytes;
    EXPECT_NE(std::string(error->what()).find(message), std::string::npos) << error->what();
  }
}

TEST(TextTest, CutAndChangedFilesNeverCrash) {
  const std::string bytes = "x,y,z,intensity\n1,2,3,4\n5 , 6;7\t8\n";
  test::expect_cuts_are_safe("a.csv", bytes, 2);
  test::expect_changes_are_safe("b.csv", bytes);
  test::expect_changes_are_safe("c.pts", "2\n1 2 3\n4 5 6\n");
}

}  // namespace
}  // namespace sfumato
