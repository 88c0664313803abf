// Shadow factors from `convert` to pictures, through files of every format that is written.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "cli/command.h"

using namespace sfumato;
using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

using Words = std::vector<std::string>;

class StoredShadows : public CommandTest {
 protected:
  /// A table over a floor, with normals: ascii PLY, z up.
  void write_table(const std::string& name) {
    constexpr int side = 90;
    std::ostringstream file;
    file << "ply\nformat ascii 1.0\ncomment up +Z\nelement vertex " << 2 * side * side
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
            "property float nz\nend_header\n";
    for (const auto& [height, extent] : {std::pair(0.0, 1.0), std::pair(0.5, 0.5)})
      for (int i = 0; i < side * side; ++i)
        file << extent * ((i % side + 0.5) / side * 2 - 1) << ' '
             << extent * ((i / side + 0.5) / side * 2 - 1) << ' ' << height << " 0 0 1\n";
    write(name, file.str());
  }

  void ok(const Words& words) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }
  void draw(const std::string& file, const std::string& picture, const Words& more) {
    Words words{file, "-t", "splats", "-o", picture, "--resolution", "160x120", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    ok(words);
  }
  bool same(const std::string& a, const std::string& b) {
    return std::ranges::equal(read_png(a), read_png(b));
  }

  /// The column `shadow` of a .csv.
  std::vector<double> factors(const std::string& csv) {
    std::istringstream lines(text(csv));
    std::string line, cell;
    std::getline(lines, line);
    std::istringstream names(line);
    int column = -1;
    for (int i = 0; std::getline(names, cell, ','); ++i)
      if (cell == "shadow") column = i;
    EXPECT_GE(column, 0) << line;
    std::vector<double> values;
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      for (int i = 0; i <= column; ++i) std::getline(cells, cell, ',');
      values.push_back(std::stod(cell));
    }
    return values;
  }
};

// The same picture, whether shadows are found or stored, also under the light that is chosen where nobody
// asks for one.
TEST_F(StoredShadows, DrawTheSamePicture) {
  write_table("table.ply");
  for (const Words& light :
       {Words{"--light", "dir:1,0.3,2"}, Words{"--light", "1,1,3", "--light-size", "0.5"},
        Words{"--light-samples", "5"}}) {
    SCOPED_TRACE(light[1]);
    Words found{"--shadows", "soft"}, stored{"--shadows", "stored"};
    Words words{"convert", "table.ply", "-o", "lit.ply", "--shadows", "soft"};
    for (Words* each : {&found, &stored, &words}) each->insert(each->end(), light.begin(), light.end());
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("--shadows stored --light "));
    draw("table.ply", "found.png", found);
    draw("lit.ply", "stored.png", stored);
    EXPECT_TRUE(same("found.png", "stored.png"));
    draw("lit.ply", "off.png", {});
    draw("table.ply", "plain.png", {});
    EXPECT_TRUE(same("off.png", "plain.png")) << "factors are used where they are asked for";
    draw("lit.ply", "off.png", light);
    EXPECT_FALSE(same("off.png", "stored.png"));
  }
}

TEST_F(StoredShadows, EveryFormatThatIsWrittenKeepsThem) {
  write_table("table.ply");
  ok({"convert", "table.ply", "-o", "lit.ply", "--shadows", "soft", "--light", "dir:1,0,2"});
  ok({"convert", "lit.ply", "-o", "lit.csv"});
  const std::vector<double> expected = factors("lit.csv");
  ASSERT_EQ(expected.size(), 2u * 90 * 90);
  // The floor has dark points under the table, light ones around it, and a penumbra.
  EXPECT_GT(std::count(expected.begin(), expected.end(), 0.0), 100);
  EXPECT_GT(std::count(expected.begin(), expected.end(), 1.0), 5000);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](double v) { return v > 0.2 && v < 0.8; }),
            100);
  for (const std::string extension : {".las", ".laz", ".pcd", ".npy", ".xyz", ".txt", ".asc", ".csv"}) {
    SCOPED_TRACE(extension);
    ok({"convert", "table.ply", "-o", "a" + extension, "--shadows", "soft", "--light", "dir:1,0,2"});
    ok({"convert", "a" + extension, "-o", "back.csv"});
    const std::vector<double> back = factors("back.csv");
    ASSERT_EQ(back.size(), expected.size());
    double worst = 0;
    for (std::size_t i = 0; i < back.size(); ++i) worst = std::max(worst, std::abs(back[i] - expected[i]));
    EXPECT_LT(worst, 1e-6) << "text has the shortest spelling of a float";
  }
}

TEST_F(StoredShadows, WhatCannotBeIsSaidBeforeAnythingIsRead) {
  write_table("table.ply");
  const auto refuse = [&](const Words& words, const std::string& says) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(says));
  };
  refuse({"convert", "none.ply", "-o", "a.obj", "--shadows", "soft"}, "clouds are written as");
  refuse({"convert", "none.ply", "-o", "a.ply", "--shadows", "stored"}, "hard or soft");
  refuse({"convert", "none.ply", "-o", "a.ply", "--shadows", "sotf"}, "is not one of: off | hard | soft");
  refuse({"convert", "none.ply", "-o", "a.ply", "--shadows", "soft", "--light", "lamp"}, "dir:X,Y,Z");
  refuse({"convert", "none.ply", "-o", "a.ply", "--light-size", "2"}, "add --shadows soft");
  refuse({"table.ply", "-o", "a.png", "--shadows", "stored"}, "sfumato convert IN --shadows soft");
  refuse({"table.ply", "-o", "a.png", "--shadows", "stored", "--ground"}, "--shadows soft");
  EXPECT_FALSE(exists("a.ply"));
}

TEST_F(StoredShadows, WithoutGlPlainConversionsGoOn) {
  write_table("table.ply");
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/none", 1);  // libglvnd then finds no driver
  const Outcome plain = run({"convert", "table.ply", "-o", "plain.ply"});
  const Outcome lit = run({"convert", "table.ply", "-o", "lit.ply", "--shadows", "hard"});
  unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  EXPECT_EQ(plain.code, 0) << plain.err;
  EXPECT_EQ(lit.code, 4);
  EXPECT_THAT(lit.err, HasSubstr("OpenGL"));
  EXPECT_FALSE(exists("lit.ply"));
}

}  // namespace
