// The table of formats, real scans of every format, and files that do not exist or cannot be written.
#include "io/io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "io/atomic_writer.h"
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

// Files of floats lose nothing; text and double coordinates lose half a float step (6e-8 of the largest
// number).
INSTANTIATE_TEST_SUITE_P(
    Files, RealScanTest,
    testing::Values(RealScan{"Guanyin.ply", "ply", 0}, RealScan{"dragon_vrip_res2.ply", "ply", 0},
                    RealScan{"office1.pcd", "pcd", 0}, RealScan{"FSite7_orig-utm.pcd", "pcd", 0},
                    RealScan{"fragment.pcd", "pcd", 0}, RealScan{"251370668.pcd", "pcd", 0},
                    RealScan{"251371071.pcd", "pcd", 0},
                    RealScan{"pumpAVisualReferenceImage.e57", "e57", 3e-7},
                    RealScan{"1.2-with-color.ptx", "ptx", 3e-4}, RealScan{"bunnyData.pts", "text", 1e-8},
                    RealScan{"armadillo.obj", "obj", 4e-8}, RealScan{"car_cloud400.csv", "text", 4e-6}),
    [](const auto& scan) {
      std::string name = scan.param.name;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
      return name;
    });

TEST(IoTest, ContentDecidesBeforeTheExtension) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n1 2 3\n";
  EXPECT_EQ(io::read(test::write_file("a.xyz", ply)).report.format, "ply");
  EXPECT_EQ(io::read(test::write_file("noextension", "1 2 3\n")).report.format, "text");
  const std::optional<Error> error =
      test::error_of(test::write_file("a.bin", std::string("\x01\x02\x00", 3)));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::bad_input);
}

TEST(IoTest, FilesThatCannotBeOpenedAreIoErrors) {
  const std::filesystem::path folder = testing::TempDir();
  for (const std::filesystem::path& path : {test::temp_file("missing.ply"), folder}) {
    const std::optional<Error> error = test::error_of(path);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::io);
    EXPECT_NE(std::string(error->what()).find(path.string()), std::string::npos);
  }
}

TEST(IoTest, AnEmptyFileIsBadInput) {
  for (const char* name : {"a.ply", "a.pcd", "a.xyz", "a.obj"})
    EXPECT_EQ(test::error_of(test::write_file(name, ""))->code(), ErrorCode::bad_input);
}

TEST(IoTest, SubsamplesInFileOrder) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += std::to_string(i) + " 0 0\n";
  const std::filesystem::path file = test::write_file("a.xyz", text);
  io::ReadOptions options;
  options.max_points = 100;
  const io::ReadResult result = io::read(file, options);
  EXPECT_EQ(result.report.points, 1000u);
  ASSERT_EQ(result.cloud.size(), 100u);
  EXPECT_EQ(io::read(file, options).cloud.positions, result.cloud.positions);
  EXPECT_TRUE(std::is_sorted(result.cloud.source_index.begin(), result.cloud.source_index.end()));
}

/// Says stop after some questions.
class Impatient final : public Progress {
 public:
  explicit Impatient(int patience) : patience_(patience) {}
  void update(double fraction, std::string_view) override {
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
  }
  bool cancelled() const override { return patience_-- <= 0; }

 private:
  mutable std::atomic<int> patience_;
};

TEST(IoTest, CancellingStopsReadersAndLeavesNoFile) {
  PointCloud cloud;
  cloud.positions.resize(200000);
  const std::filesystem::path file = test::temp_file("a.ply"), stopped = test::temp_file("stopped.ply");
  io::write(file, cloud);
  for (int patience : {0, 2}) {
    Impatient impatient(patience);
    EXPECT_THROW(io::read(file, {}, impatient), Cancelled);
    Impatient writer(patience);
    EXPECT_THROW(io::write(stopped, cloud, writer), Cancelled);
    EXPECT_FALSE(std::filesystem::exists(stopped));
  }
  Impatient patient(1000);
  EXPECT_EQ(io::read(file, {}, patient).cloud.size(), 200000u);
}

TEST(IoTest, UnknownExtensionsAreNotWritten) {
  try {
    io::write(test::temp_file("a.xls"), PointCloud());
    FAIL() << "an error was expected";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find(".ply"), std::string::npos);
  }
}

TEST(IoTest, TheTableNamesItsFormats) {
  const std::vector<io::FormatInfo> formats = io::formats();
  const auto ply =
      std::find_if(formats.begin(), formats.end(), [](const auto& f) { return f.name == "ply"; });
  ASSERT_NE(ply, formats.end());
  EXPECT_TRUE(ply->can_read && ply->can_write);
  EXPECT_EQ(formats.back().name, "text");  // it accepts nearly everything, so it must come last
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename());
  return names;
}

TEST(AtomicWriterTest, TheFileAppearsOnlyWhenComplete) {
  const std::filesystem::path folder = test::temp_file("folder");
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  {
    io::AtomicWriter writer(folder / "a.txt");
    writer.write("old");
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    writer.commit();
  }
  {
    io::AtomicWriter writer(folder / "a.txt");
    writer.write(std::string(3 << 20, 'x'));
  }  // no commit, as after an error
  EXPECT_EQ(names_in(folder), std::vector<std::string>{"a.txt"});
  EXPECT_EQ(io::File(folder / "a.txt").read_text(0, 100), "old");
  const auto permissions = std::filesystem::status(folder / "a.txt").permissions();
  EXPECT_NE(permissions & std::filesystem::perms::owner_read, std::filesystem::perms::none);
}

TEST(AtomicWriterTest, AFailedWriteIsAnIoError) {
  const std::filesystem::path missing = test::temp_file("no_such_folder") / "a.ply";
  try {
    io::write(missing, PointCloud());
    FAIL() << "an error was expected";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_NE(std::string(error.what()).find(missing.string()), std::string::npos);
  }
  const std::filesystem::path folder = test::temp_file("target");
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "a.ply");  // a folder has the name: the rename fails
  EXPECT_THROW(io::write(folder / "a.ply", PointCloud()), Error);
  EXPECT_EQ(names_in(folder), std::vector<std::string>{"a.ply"});
}

TEST(FileTest, ReadingBehindTheEndIsAnIoError) {
  const io::File file(test::write_file("a.txt", "abc"));
  EXPECT_EQ(file.read_text(1, 100), "bc");
  EXPECT_EQ(file.read_text(9, 100), "");
  std::byte bytes[2];
  EXPECT_THROW(file.read(2, bytes), Error);
}

}  // namespace
}  // namespace sfumato
