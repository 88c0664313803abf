// What the command writes, and what it refuses to write over; presets and cameras that mean harm.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/command.h"

using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

constexpr bool is_sanitized() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#else
  return false;
#endif
}

TEST_F(CommandTest, InputsAreNoOutputsAndNoFileIsWrittenTwice) {
  write_cube("cube.ply", 4);
  write("c.json", R"({"position": [0, -5, 2], "target": [0, 0, 0]})");
  write("p.json", R"({"technique": "points"})");
  symlink("cube.ply", path("link.ply").c_str());
  const std::string before = text("cube.ply");
  struct Case {
    std::vector<std::string> words;
    std::string says;
  };
  for (const Case& c : std::vector<Case>{
           {{"cube.ply", "-o", "a.png", "--output-camera", "cube.ply"},
            "--output-camera cube.ply: would replace the input"},
           {{"cube.ply", "-o", "a.png", "--output-camera", "link.ply"}, "would replace the input"},
           {{"cube.ply", "-o", "a.png", "--save-preset", "./cube.ply"}, "would replace the input"},
           {{"cube.ply", "-o", "a.png", "--camera", "c.json", "--output-camera", "c.json"},
            "would replace --camera"},
           {{"cube.ply", "-o", "a.png", "--preset", "p.json", "--save-preset", "p.json"},
            "would replace --preset"},
           {{"cube.ply", "-o", "a.npy", "--output-depth", "a.npy"}, "is also written by -o"},
           {{"cube.ply", "--output-normal", "n.npy", "--output-depth", "n.npy"}, "is also written by"},
           {{"cube.ply", "-o", "/dev/null"}, "/dev/null"},
           {{"cube.ply", "-o", "a.png", "--output-camera", "/dev/null"}, "is a device"},
           {{"convert", "cube.ply", "-o", "cube.ply"}, "would replace the input"},
           {{"convert", "cube.ply", "-o", "link.ply"}, "would replace the input"},
           {{"cube.ply", "-o", "f_{n:2000000000}.png", "--path", "orbit"}, "template"},
           {{"cube.ply", "-o", "a.png", "--camera-position", "1e308,0,0"}, "beyond 1e15"},
           {{"cube.ply", "-o", "-", "--json"}, "both write to standard output"},
       }) {
    const Outcome outcome = run(c.words);
    EXPECT_EQ(outcome.code, 1) << c.says << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(c.says));
  }
  EXPECT_EQ(text("cube.ply"), before);
  EXPECT_EQ(files(), (std::vector<std::string>{"c.json", "cube.ply", "link.ply", "p.json"}));
}

TEST_F(CommandTest, PicturesOfRoomsThatAreCutOpenSaySo) {
  ASSERT_EQ(run({"synth", "room", "--points", "60k", "-o", "room.ply", "--quiet"}).code, 0);
  const auto description = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"room.ply",     "-t",    "points", "-o", "room.png",
                                      "--resolution", "64x48", "--up",   "+Z"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return png_texts("room.png")["Description"];
  };
  EXPECT_THAT(description({}), HasSubstr("--whole"));
  EXPECT_EQ(description({"--whole"}), "");
  EXPECT_EQ(description({"--camera-position", "2,2,1.5", "--camera-focal-point", "3,3,1.5"}), "") << "within";
}

TEST_F(CommandTest, StandardInputAndOutputAreFiles) {
  write_cube("cube.ply", 10);
  const Outcome picture = run({"cube.ply", "-t", "points", "-o", "-", "--resolution", "40x30", "--quiet"});
  ASSERT_EQ(picture.code, 0) << picture.err;
  EXPECT_TRUE(picture.out.starts_with("\x89PNG")) << "a picture on standard output";
  const Outcome cloud = run({"convert", "cube.ply", "-o", "/dev/stdout", "--quiet"});
  ASSERT_EQ(cloud.code, 0) << cloud.err;
  EXPECT_TRUE(cloud.out.starts_with("ply\n"));
  write("copy.ply", cloud.out);
  EXPECT_EQ(run_json({"info", "copy.ply", "--json"})["points"], 600);
}

TEST_F(CommandTest, PresetsSetLooksNeverFiles) {
  write_cube("cube.ply", 4);
  for (const char* preset :
       {R"({"options": {"output-camera": "owned"}})", R"({"options": {"save-preset": "owned"}})",
        R"({"options": {"output_depth": "owned.npy"}})", R"({"options": {"output": "owned.png"}})",
        R"({"options": {"output-camera=owned --x": "1"}})", R"({"parameters": {"output-camera": "owned"}})",
        R"({"options": {"camera": "/etc/passwd"}})", R"({"options": {"path": "orbit"}})",
        R"({"options": {"json": true}})"}) {
    write("p.json", preset);
    const Outcome outcome = run({"cube.ply", "-t", "points", "-o", "a.png", "--preset", "p.json"});
    EXPECT_EQ(outcome.code, 2) << preset << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("is no look"));
  }
  write("p.json", std::string(400000, '[') + std::string(400000, ']'));
  EXPECT_THAT(run({"cube.ply", "-o", "a.png", "--preset", "p.json"}).err, HasSubstr("deep"));
  EXPECT_THAT(run({"cube.ply", "-o", "a.png", "--camera", "p.json"}).err, HasSubstr("deep"));
  std::string keys = "{\"options\": {\"k\": 1";
  for (int i = 0; i < 200000; ++i) keys += ",\"k" + std::to_string(i) + "\": 1";
  write("p.json", keys + "}}");
  EXPECT_THAT(run({"cube.ply", "-o", "a.png", "--preset", "p.json"}).err, HasSubstr("more than 1000 keys"));
  EXPECT_EQ(files(), (std::vector<std::string>{"cube.ply", "p.json"}));
}

TEST_F(CommandTest, ACameraThatSeesNothingSaysSo) {
  write_cube("cube.ply", 4);
  const Outcome outcome = run({"cube.ply", "-t", "points", "-o", "a.png", "--resolution", "40x30",
                               "--camera-position", "0,0,9", "--camera-direction", "0,0,1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("the picture is empty"));
}

TEST_F(CommandTest, LittleMemoryIsExitCode5) {
  if (is_sanitized()) GTEST_SKIP() << "sanitizers need address space";
  write_cube("cube.ply", 20);
  struct rlimit old {};
  getrlimit(RLIMIT_AS, &old);
  for (rlim_t megabytes : {150, 200, 250, 300, 320, 420}) {
    struct rlimit tight = old;
    tight.rlim_cur = megabytes << 20;
    setrlimit(RLIMIT_AS, &tight);
    const Outcome outcome =
        run({"cube.ply", "-t", "points", "-o", "a.png"});  // Mesa would crash from 320 MB on
    setrlimit(RLIMIT_AS, &old);
    EXPECT_EQ(outcome.code, 5) << megabytes << " MB: " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("memory"));
  }
  EXPECT_FALSE(exists("a.png"));
}

TEST_F(CommandTest, VideosAreMadeByFfmpegOrRefusedBeforeAnythingIsRead) {
  write_cube("cube.ply", 8);
  const std::vector<std::string> words = {"cube.ply", "-t", "points",    "--path",       "orbit", "--frames",
                                          "3",        "-o", "orbit.mp4", "--resolution", "63x48", "--quiet"};
  const std::string before = std::getenv("PATH") ? std::getenv("PATH") : "";
  setenv("PATH", "/nowhere", 1);
  const Outcome without = run(words);
  setenv("PATH", before.c_str(), 1);
  EXPECT_EQ(without.code, 1) << without.err;
  EXPECT_THAT(without.err, ::testing::HasSubstr("frame_{n:04}.png"));
  EXPECT_EQ(run({"cube.ply", "-o", "still.mp4"}).code, 1);
  EXPECT_EQ(files(), std::vector<std::string>{"cube.ply"});
  if (std::system("command -v ffmpeg >/dev/null") != 0)
    GTEST_SKIP() << "ffmpeg is not installed: no video is made";
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(files(), (std::vector<std::string>{"cube.ply", "orbit.mp4"}));
  EXPECT_EQ(text("orbit.mp4").substr(4, 4), "ftyp");
  // What ffmpeg cannot write leaves nothing behind.
  EXPECT_EQ(run({"cube.ply", "-t", "points", "--path", "orbit", "--frames", "2", "-o", "no/such/folder.mp4",
                 "--quiet"})
                .code,
            6);
  EXPECT_EQ(files(), (std::vector<std::string>{"cube.ply", "orbit.mp4"}));
}

/// src/apps/cli/allocation.h, seen by a program that it starts.
TEST_F(CommandTest, MemoryIsTakenInLargePagesUnlessTheUserHasAWay) {
  if (is_sanitized()) GTEST_SKIP() << "sanitizers have their own allocation";
  write_cube("cube.ply", 4);
  write("ffmpeg",
        "#!/bin/sh\n"
        "tr '\\0' '\\n' < /proc/$PPID/environ | grep GLIBC_TUNABLES > of_command.txt\n"
        "cat /proc/$PPID/comm >> of_command.txt\n"
        "echo \"${GLIBC_TUNABLES-none}\" > own.txt\n"
        "exec cat > /dev/null\n");
  std::filesystem::permissions(path("ffmpeg"), std::filesystem::perms::owner_all);
  const std::string before = std::getenv("PATH") ? std::getenv("PATH") : "";
  setenv("PATH", (path("").string() + ":" + before).c_str(), 1);
  const std::vector<std::string> words = {"cube.ply", "-t", "points",    "--path",       "orbit", "--frames",
                                          "2",        "-o", "orbit.mp4", "--resolution", "32x32", "--quiet"};
  unsetenv("GLIBC_TUNABLES");
  run(words);
  EXPECT_THAT(text("of_command.txt"), HasSubstr("GLIBC_TUNABLES=glibc.malloc.hugetlb=1"));
  EXPECT_THAT(text("of_command.txt"), HasSubstr("\nsfumato\n"));
  EXPECT_EQ(text("own.txt"), "none\n");
  setenv("GLIBC_TUNABLES", "glibc.malloc.tcache_count=7", 1);
  run(words);
  EXPECT_EQ(text("of_command.txt"), "GLIBC_TUNABLES=glibc.malloc.tcache_count=7\nsfumato\n");
  EXPECT_EQ(text("own.txt"), "glibc.malloc.tcache_count=7\n");
  unsetenv("GLIBC_TUNABLES");
  setenv("PATH", before.c_str(), 1);
}

/// Of a file that cannot be read: code 2 would say that it was tried.
TEST_F(CommandTest, WhatCannotBeWrittenIsRefusedBeforeAnythingIsRead) {
  write("words.xyz", "no numbers here\n");
  write("ffmpeg", "#!/bin/sh\nexec cat\n");
  std::filesystem::permissions(path("ffmpeg"), std::filesystem::perms::owner_all);
  const std::string before = std::getenv("PATH") ? std::getenv("PATH") : "";
  setenv("PATH", (path("").string() + ":" + before).c_str(), 1);
  const std::vector<std::vector<std::string>> missing = {
      {"words.xyz", "-o", "no/a.png"},
      {"words.xyz", "-o", "a.png", "--output-depth", "no/a.npy"},
      {"words.xyz", "-o", "a.png", "--output-camera", "no/a.json"},
      {"words.xyz", "-o", "a.png", "--save-preset", "no/a.json"},
      {"words.xyz", "-t", "points,splats", "--output-panels", "no/{technique}.png"},
      {"words.xyz", "--path", "orbit", "-o", "no/a.mp4"},
      {"words.xyz", "--path", "orbit", "-o", "no/{n:04}.png"},
      {"words.xyz", "words.xyz", "--each", "-o", "no/{n}.png"},
      {"convert", "words.xyz", "-o", "no/a.ply"},
      {"build", "words.xyz", "-o", "no/a.copc.laz"},
      {"synth", "spheres", "-o", "no/a.ply"}};
  for (const std::vector<std::string>& words : missing) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 6) << words.back() << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("there is no folder no; make it")) << words.back();
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  // A folder that nobody writes to, whoever asks.
  const Outcome outcome = run({"words.xyz", "-o", "/proc/a.png"});
  EXPECT_EQ(outcome.code, 6) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("check the folder, permissions"));
  setenv("PATH", before.c_str(), 1);
  EXPECT_EQ(files(), (std::vector<std::string>{"ffmpeg", "words.xyz"}));
}

TEST_F(CommandTest, ConvertMovesFiles) {
  write("a.csv",
        "x,y,z,nx,ny,nz,intensity\n500000.125,5400000.5,3,0,0,1,7\n500001.125,5400002.5,4,0,1,0,8\n");
  const std::string quarter = "0,-1,0,0.5,1,0,0,0,0,0,1,-3,0,0,0,1";
  ASSERT_EQ(run({"convert", "a.csv", "-o", "b.csv", "--transform", quarter}).code, 0)
      << "one file needs no number";
  EXPECT_EQ(text("b.csv"),
            "x,y,z,nx,ny,nz,intensity\n-5400000,500000.125,0,0,0,1,7\n-5400002,500001.125,1,-1,0,0,8\n");
  ASSERT_EQ(
      run({"convert", "a.csv", "a.csv", "-o", "c.csv", "--transform", "2: 1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,0,1"})
          .code,
      0);
  EXPECT_THAT(text("c.csv"),
              HasSubstr("\n500001.125,5400002.5,4,0,1,0,8,1\n500000.625,5400000.5,3,0,0,1,7,2\n"));
  EXPECT_THAT(run({"convert", "a.csv", "a.csv", "-o", "d.csv", "--transform", quarter}).err,
              HasSubstr("there is no colon after the file's number"));
  // Its kind of numbers stays that of the file, its coordinate system is not known to hold.
  write("a.ply",
        "ply\nformat ascii 1.0\ncomment crs EPSG:25832\nelement vertex 1\nproperty double x\n"
        "property double y\nproperty double z\nend_header\n500000.125 5400000.5 3\n");
  const Outcome moved = run({"convert", "a.ply", "-o", "b.ply", "--transform", quarter});
  EXPECT_EQ(moved.code, 0);
  EXPECT_THAT(moved.err,
              HasSubstr("its coordinate system is kept, which holds only where --transform stays"));
  EXPECT_THAT(text("b.ply"), HasSubstr("EPSG:25832"));
}

}  // namespace
