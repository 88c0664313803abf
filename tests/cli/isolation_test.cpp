// A decoder that dies takes nothing with it but its chunk.
#include <fcntl.h>
#include <unistd.h>

#include "cli/command.h"

using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

constexpr int chunk = 50'000,
              points = 120'000;  // three chunks, of which the second begins with a point of its own

class IsolationTest : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    setenv("SFUMATO_DECODER", SFUMATO_DECODER_THAT_DIES, 1);
  }
  void TearDown() override {
    unsetenv("SFUMATO_DECODER");
    CommandTest::TearDown();
  }
  /// The decoder of the middle chunk does what `deadly` stands for (faults/die_as_told.cpp).
  void write_scan(const std::string& name, int deadly) {
    std::string rows = "x,y,z,intensity\n";
    for (int i = 0; i < points; ++i)
      rows += std::to_string(i % 400) + "," + std::to_string(i / 400) + "," + std::to_string(i % 7) + "," +
              std::to_string(i == chunk ? deadly : 1) + "\n";
    write("scan.csv", rows);
    const Outcome outcome = run({"convert", "scan.csv", "-o", name, "--quiet"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
};

TEST_F(IsolationTest, ADeadDecoderIsOneErrorAndTheRestIsDrawn) {
  write_scan("scan.laz", 667);
  const Outcome outcome = run({"scan.laz", "-t", "points", "-o", "a.png", "--resolution", "60x40"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("scan.laz: byte "));
  EXPECT_THAT(outcome.err, HasSubstr("bytes that ended their decoder (SIGSEGV)"));
  EXPECT_THAT(outcome.err, HasSubstr("chunk 1, points 50000 to 99999"));
  EXPECT_THAT(outcome.err, HasSubstr("50000 of 120000 points are missing"));
  EXPECT_TRUE(exists("a.png"));
  const Outcome strict = run({"scan.laz", "-t", "points", "-o", "b.png", "--strict"});
  EXPECT_EQ(strict.code, 2) << strict.err;
  EXPECT_THAT(strict.err, HasSubstr("chunk 1, points 50000 to 99999"));
  EXPECT_FALSE(exists("b.png"));
}

TEST_F(IsolationTest, WhatACutFileHoldsIsDrawn) {
  write_scan("scan.ply", 0);
  std::filesystem::resize_file(path("scan.ply"), std::filesystem::file_size(path("scan.ply")) / 2);
  const Outcome outcome = run({"scan.ply", "-t", "points", "-o", "a.png", "--resolution", "60x40"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(", expected 120000; fetch the rest; it is left out"));
  EXPECT_THAT(outcome.err, HasSubstr(" of 120000 points are missing"));
  EXPECT_TRUE(exists("a.png"));
  EXPECT_EQ(run({"scan.ply", "-t", "points", "-o", "b.png", "--strict"}).code, 2);
  EXPECT_FALSE(exists("b.png"));
  const int input = ::open(path("scan.ply").c_str(), O_RDONLY);
  const Outcome piped = run_interrupted(
      {"info", "-"}, [](double) { return false; }, input);
  ::close(input);
  EXPECT_EQ(piped.code, 3);
  EXPECT_THAT(piped.err, HasSubstr("sfumato: standard input: byte "));
}

TEST_F(IsolationTest, EveryCommandSaysWhatIsMissing) {
  write_scan("scan.laz", 666);
  const Outcome info = run({"info", "scan.laz", "--json"});
  EXPECT_EQ(info.code, 3) << info.err;
  const auto json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json["points"], points);
  EXPECT_EQ(json["points_missing"], chunk);
  EXPECT_EQ(run({"info", "scan.laz", "--strict"}).code, 2);
  const Outcome convert = run({"convert", "scan.laz", "-o", "rest.ply"});
  EXPECT_EQ(convert.code, 3) << convert.err;
  EXPECT_THAT(convert.err, HasSubstr("SIGABRT"));
  EXPECT_EQ(run_json({"info", "rest.ply", "--json"})["points"], points - chunk);
  // What is built is whole or not at all.
  EXPECT_EQ(run({"build", "scan.laz", "-o", "all.copc.laz"}).code, 2);
  EXPECT_FALSE(exists("all.copc.laz"));
}

TEST_F(IsolationTest, NoWayToDieIsAWayOut) {
  struct Case {
    int deadly;
    const char* says;
  };
  for (const Case& c : {Case{668, "took too long"}, Case{671, "exit code 0"}
#ifndef __SANITIZE_ADDRESS__  // which confine nothing
                        ,
                        Case{669, "want more memory"}, Case{670, "SIGSYS"}
#endif
       }) {
    write_scan("scan.laz", c.deadly);
    const Outcome outcome = run({"info", "scan.laz"});
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(c.says));
  }
}

TEST_F(IsolationTest, WithoutDecodersTheCommandSaysSo) {
  write_scan("scan.laz", 1);
  setenv("SFUMATO_DECODER", "none", 1);
  const Outcome without = run({"info", "scan.laz"});
  EXPECT_EQ(without.code, 0) << without.err;
  EXPECT_THAT(without.err, HasSubstr("LASzip decodes in this process"));
  for (const char* wrong : {"/nowhere/decoder", "/bin/true", "/etc/passwd"}) {
    setenv("SFUMATO_DECODER", wrong, 1);
    const Outcome outcome = run({"info", "scan.laz"});
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("SFUMATO_DECODER: "));
  }
}

}  // namespace
