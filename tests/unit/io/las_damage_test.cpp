// Damaged LAS, LAZ and COPC files: an error that names the byte, or the points all the same; never a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

#include "io/io.h"
#include "unit/io/las_bytes.h"
#include "unit/io/las_cloud.h"

using namespace sfumato;
using test::Bytes;

namespace {

constexpr std::size_t table_address_bytes = 8;

PointCloud cloud_of(int points, int format) { return test::las_cloud(points, format, 97); }

Bytes bytes_of(const PointCloud& cloud, const std::string& extension) {
  const auto path = test::temporary("seed" + extension);
  io::write(path, cloud);
  Bytes bytes = test::load(path);
  std::filesystem::remove(path);
  return bytes;
}

/// One file name for all the damaged files of a test.
class Damage {
 public:
  explicit Damage(std::string name) : path_(test::temporary(name)) {}
  ~Damage() { std::filesystem::remove(path_); }

  /// Empty when the file was read, else the error, which must be one line that names file and place.
  std::string read(const Bytes& bytes, std::size_t* points = nullptr) {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    try {
      io::ReadOptions options;
      options.strict = true;
      const io::ReadResult result = io::read(path_, options);
      if (points) *points = result.cloud.size();
      return {};
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input) << error.what();
      EXPECT_THAT(error.what(), testing::HasSubstr(path_.string()));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      return error.what();
    }
  }

 private:
  std::filesystem::path path_;
};

template <class T>
Bytes with(Bytes bytes, std::size_t at, T value) {
  test::put(bytes, at, value);
  return bytes;
}

std::size_t point_data(const Bytes& bytes) { return test::get<std::uint32_t>(bytes, 96); }

// A COPC file of one node a cloud, made of the chunks of LAZ files (COPC 1.0: info VLR first, hierarchy
// EVLR).
Bytes copc_of(const std::vector<PointCloud>& nodes) {
  const Bytes first = bytes_of(nodes[0], ".laz");
  Bytes head(first.begin(), first.begin() + 375), laszip;
  for (std::size_t at = 375; at < point_data(first); at += 54 + test::get<std::uint16_t>(first, at + 20))
    if (test::get<std::uint16_t>(first, at + 18) == 22204)
      laszip.assign(first.begin() + std::ptrdiff_t(at),
                    first.begin() + std::ptrdiff_t(at + 54 + test::get<std::uint16_t>(first, at + 20)));
  test::put<std::uint32_t>(laszip, 54 + 12, 0xFFFFFFFFu);
  Bytes info(54 + 160);
  std::memcpy(info.data() + 2, "copc", 4);
  test::put<std::uint16_t>(info, 18, 1);
  test::put<std::uint16_t>(info, 20, 160);
  Bytes out = head;
  out.insert(out.end(), info.begin(), info.end());
  out.insert(out.end(), laszip.begin(), laszip.end());
  test::put<std::uint32_t>(out, 96, std::uint32_t(out.size()));
  test::put<std::uint32_t>(out, 100, 2);
  out.resize(out.size() + table_address_bytes);
  Bytes entries;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Bytes laz = bytes_of(nodes[i], ".laz");
    const std::size_t begin = point_data(laz) + table_address_bytes,
                      end = test::get<std::uint64_t>(laz, point_data(laz));
    Bytes entry(32);
    test::put<std::int32_t>(entry, 0, i ? 1 : 0);
    test::put<std::int32_t>(entry, 4, i ? int(i) - 1 : 0);
    test::put<std::uint64_t>(entry, 16, out.size());
    test::put<std::int32_t>(entry, 24, int(end - begin));
    test::put<std::int32_t>(entry, 28, int(nodes[i].size()));
    out.insert(out.end(), laz.begin() + std::ptrdiff_t(begin), laz.begin() + std::ptrdiff_t(end));
    entries.insert(entries.end(), entry.begin(), entry.end());
    points += nodes[i].size();
  }
  test::put<std::uint64_t>(out, 247, points);
  test::put<std::uint64_t>(out, 375 + 54 + 40, out.size() + 60);
  test::put<std::uint64_t>(out, 375 + 54 + 48, entries.size());
  test::put<std::uint64_t>(out, 235, out.size());
  test::put<std::uint32_t>(out, 243, 1);
  Bytes evlr(60);
  std::memcpy(evlr.data() + 2, "copc", 4);
  test::put<std::uint16_t>(evlr, 18, 1000);
  test::put<std::uint64_t>(evlr, 20, entries.size());
  out.insert(out.end(), evlr.begin(), evlr.end());
  out.insert(out.end(), entries.begin(), entries.end());
  return out;
}

TEST(LasDamage, HeaderFieldsAreChecked) {
  const Bytes las = bytes_of(cloud_of(50, 3), ".las"), laz = bytes_of(cloud_of(50, 3), ".laz");
  Damage damage("damaged.las");
  ASSERT_EQ(damage.read(las), "");
  ASSERT_EQ(damage.read(laz), "");
  const double infinity = std::numeric_limits<double>::infinity(),
               nan = std::numeric_limits<double>::quiet_NaN();
  for (const Bytes& file : {las, laz}) {
    EXPECT_THAT(damage.read(with<std::uint8_t>(file, 25, 5)), testing::HasSubstr("byte 24"));
    EXPECT_THAT(damage.read(with<std::uint16_t>(file, 94, 100)), testing::HasSubstr("byte 94"));
    EXPECT_THAT(damage.read(with<std::uint16_t>(file, 94, 65535)), testing::HasSubstr("byte 94"));
    EXPECT_THAT(damage.read(with<std::uint32_t>(file, 96, 10)), testing::HasSubstr("byte 96"));
    EXPECT_THAT(damage.read(with<std::uint32_t>(file, 96, 0xFFFFFFFFu)), testing::HasSubstr("byte 96"));
    EXPECT_THAT(damage.read(with<std::uint32_t>(file, 100, 0xFFFFFFFFu)),
                testing::HasSubstr("variable length"));
    EXPECT_THAT(damage.read(with<std::uint8_t>(file, 104, 63)), testing::HasSubstr("byte 104"));
    EXPECT_THAT(damage.read(with<std::uint16_t>(file, 105, 0)), testing::HasSubstr("byte 105"));
    for (const double bad : {0.0, nan, infinity, 1e300})
      EXPECT_THAT(damage.read(with<double>(file, 131, bad)), testing::HasSubstr("scale"));
    EXPECT_THAT(damage.read(with<double>(file, 155, nan)), testing::HasSubstr("offset"));
    for (const std::uint64_t count :
         {std::uint64_t{51}, std::uint64_t{1} << 31, std::uint64_t{1} << 63, ~std::uint64_t{0}})
      EXPECT_NE(damage.read(with<std::uint64_t>(file, 247, count)), "") << count;
  }
  EXPECT_NE(damage.read(with<std::uint16_t>(laz, 105, 65535)), "");
  EXPECT_THAT(damage.read(with<std::uint16_t>(las, 105, 65535)), testing::HasSubstr("truncated"));
}

TEST(LasDamage, ACutFileIsAnErrorWhereverItIsCut) {
  for (const int format : {3, 7}) {
    for (const char* extension : {".las", ".laz"}) {
      const Bytes whole = bytes_of(cloud_of(300, format), extension);
      const std::size_t end = std::string(extension) == ".las"
                                  ? whole.size()
                                  : test::get<std::uint64_t>(whole, point_data(whole));
      Damage damage(std::string("cut") + extension);
      for (std::size_t size = 0; size < end; size += size < 400 ? 13 : 37) {
        const Bytes cut(whole.begin(), whole.begin() + std::ptrdiff_t(size));
        EXPECT_NE(damage.read(cut), "") << extension << " format " << format << " cut at byte " << size;
      }
    }
  }
}

// Chunks of LASzip 2 (formats 0 to 5) are found without the table by decoding in order, those of LASzip 3 by
// walking.
TEST(LazDamage, AMissingOrWrongChunkTableIsDoneWithout) {
  const int points = 120000;  // three chunks
  for (const int format : {3, 7}) {
    const Bytes laz = bytes_of(cloud_of(points, format), ".laz");
    const std::size_t start = point_data(laz), table = test::get<std::uint64_t>(laz, start);
    ASSERT_EQ(test::get<std::uint32_t>(laz, table + 4), 3u);
    Damage damage("table.laz");
    std::vector<Bytes> damaged;
    for (const std::uint64_t address : {std::uint64_t{0}, std::uint64_t(start), std::uint64_t(laz.size()) * 2,
                                        ~std::uint64_t{0} - 7, std::uint64_t(laz.size())})
      damaged.push_back(with<std::uint64_t>(laz, start, address));
    for (const std::uint32_t count : {0u, 1u, 2u, 4u, 0x7FFFFFFFu, 0xFFFFFFFEu, 0xFFFFFFFFu})
      damaged.push_back(with<std::uint32_t>(laz, table + 4, count));
    damaged.push_back(with<std::uint32_t>(laz, table, 9));
    for (const Bytes& bytes : damaged) {
      std::size_t read = 0;
      EXPECT_EQ(damage.read(bytes, &read), "");
      EXPECT_EQ(read, std::size_t(points));
    }
    // Entries: each byte wrong in its turn. The chunks of format 7 carry their own sizes, so that nothing is
    // lost.
    for (std::size_t at = table + 8; at < laz.size(); ++at) {
      std::size_t read = 0;
      const std::string error = damage.read(with<std::uint8_t>(laz, at, std::uint8_t(laz[at] ^ 0xA5)), &read);
      EXPECT_TRUE(!error.empty() || read == std::size_t(points));
    }
    // Without the table's end, and with the address at the end of the file as streams have it.
    Bytes streamed = with<std::uint64_t>(laz, start, ~std::uint64_t{0});
    streamed.resize(streamed.size() + 8);
    test::put<std::uint64_t>(streamed, streamed.size() - 8, table);
    std::size_t read = 0;
    EXPECT_EQ(damage.read(streamed, &read), "");
    EXPECT_EQ(read, std::size_t(points));
  }
}

TEST(LazDamage, VariableChunksNeedTheirTable) {
  Bytes laz = bytes_of(cloud_of(100, 3), ".laz");
  for (std::size_t at = 375; at < point_data(laz); at += 54 + test::get<std::uint16_t>(laz, at + 20))
    if (test::get<std::uint16_t>(laz, at + 18) == 22204)
      test::put<std::uint32_t>(laz, at + 54 + 12, 0xFFFFFFFFu);
  test::put<std::uint64_t>(laz, point_data(laz), point_data(laz));
  Damage damage("variable.laz");
  EXPECT_THAT(damage.read(laz), testing::HasSubstr("chunk table"));
}

TEST(LazDamage, LaszipRecordIsChecked) {
  const Bytes laz = bytes_of(cloud_of(100, 3), ".laz");
  Damage damage("record.laz");
  std::size_t record = 0;
  for (std::size_t at = 375; at < point_data(laz); at += 54 + test::get<std::uint16_t>(laz, at + 20))
    if (test::get<std::uint16_t>(laz, at + 18) == 22204) record = at + 54;
  ASSERT_NE(record, 0u);
  for (const std::size_t at : {0u, 2u, 32u, 34u, 36u, 38u, 40u})
    for (const std::uint16_t value : {9, 255, 65535})
      EXPECT_NE(damage.read(with<std::uint16_t>(laz, record + at, value)), "") << at;
  EXPECT_THAT(damage.read(with<std::uint32_t>(laz, record + 12, 0x7FFFFFFF)),
              testing::HasSubstr("chunks of"));
  EXPECT_NE(damage.read(with<std::uint8_t>(laz, record - 54 + 2, 'x')), "");
}

TEST(CopcDamage, NodesAreReadInFileOrderAndTheOctreeIsChecked) {
  const std::vector<PointCloud> nodes{cloud_of(200, 7), cloud_of(31, 7), cloud_of(50, 7)};
  const Bytes copc = copc_of(nodes);
  const std::size_t page = test::get<std::uint64_t>(copc, 375 + 54 + 40), page_field = 375 + 54 + 40;
  Damage damage("damaged.copc.laz");
  std::size_t points = 0;
  ASSERT_EQ(damage.read(copc, &points), "");
  EXPECT_EQ(points, 281u);
  // Entries in another order: the same file order.
  Bytes swapped = copc;
  std::swap_ranges(swapped.begin() + std::ptrdiff_t(page), swapped.begin() + std::ptrdiff_t(page + 32),
                   swapped.begin() + std::ptrdiff_t(page + 64));
  const auto a = test::save(copc, "a.copc.laz"), b = test::save(swapped, "b.copc.laz");
  const io::ReadResult first = io::read(a), second = io::read(b);
  EXPECT_EQ(first.report.format, "copc");
  EXPECT_TRUE(first.cloud.positions == second.cloud.positions);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(first.cloud.colors[i], nodes[0].colors[i]);
  for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(first.cloud.colors[231 + i], nodes[2].colors[i]);
  std::filesystem::remove(a);
  std::filesystem::remove(b);

  EXPECT_THAT(damage.read(with<std::uint64_t>(copc, page_field, copc.size() * 3)),
              testing::HasSubstr("page"));
  EXPECT_THAT(damage.read(with<std::uint64_t>(copc, page_field + 8, 33)), testing::HasSubstr("page"));
  EXPECT_THAT(damage.read(with<std::uint64_t>(copc, page_field + 8, std::uint64_t{1} << 60)),
              testing::HasSubstr("page"));
  EXPECT_THAT(damage.read(with<std::int32_t>(copc, page, 40)), testing::HasSubstr("level"));
  EXPECT_THAT(damage.read(with<std::int32_t>(copc, page + 4, 1)), testing::HasSubstr("level"));
  EXPECT_THAT(damage.read(with<std::int32_t>(copc, page + 28, -2)), testing::HasSubstr("negative"));
  EXPECT_NE(damage.read(with<std::int32_t>(copc, page + 28, 201)), "");
  EXPECT_NE(damage.read(with<std::int32_t>(copc, page + 28, 199)), "");
  EXPECT_NE(damage.read(with<std::int32_t>(copc, page + 24, 10)), "");
  EXPECT_NE(damage.read(with<std::int32_t>(copc, page + 24, 0x7FFFFFFF)), "");
  EXPECT_NE(damage.read(with<std::uint64_t>(copc, page + 16, copc.size())), "");
  EXPECT_THAT(damage.read(with<std::int32_t>(copc, page + 64 + 4, 0)), testing::HasSubstr("twice"));
  // A child page that is its own parent.
  Bytes cycle = with<std::int32_t>(copc, page + 60, -1);
  test::put<std::uint64_t>(cycle, page + 48, page);
  test::put<std::int32_t>(cycle, page + 56, 96);
  EXPECT_THAT(damage.read(cycle), testing::HasSubstr("damaged"));
  for (std::size_t size = 0; size < copc.size(); size += 61)
    EXPECT_NE(damage.read(Bytes(copc.begin(), copc.begin() + std::ptrdiff_t(size))), "") << "cut at " << size;
}

// Random damage anywhere. Most of it in the compressed points, where it may go unnoticed but must not be
// fatal.
TEST(LasDamage, RandomBytesAreNeverFatal) {
  std::mt19937 random(20240612);
  const std::vector<std::pair<Bytes, std::string>> seeds{
      {bytes_of(cloud_of(40, 3), ".las"), "flip.las"},
      {bytes_of(cloud_of(400, 3), ".laz"), "flip.laz"},
      {bytes_of(cloud_of(400, 7), ".laz"), "flip.laz"},
      {copc_of({cloud_of(90, 7), cloud_of(60, 7)}), "flip.copc.laz"}};
  for (const auto& [seed, name] : seeds) {
    Damage damage(name);
    for (int round = 0; round < 300; ++round) {
      Bytes bytes = seed;
      for (unsigned k = 0, flips = 1 + random() % 8; k < flips; ++k)
        bytes[random() % bytes.size()] = std::uint8_t(random());
      damage.read(bytes);
    }
  }
}

}  // namespace
