// Outputs: what they replace, what they refuse, what a killed or failing writer leaves behind.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>

#include "core/camera.h"
#include "io/atomic_writer.h"
#include "io/bounded_json.h"
#include "io/camera_json.h"
#include "io/file_names.h"
#include "io/image_exr.h"
#include "io/io.h"
#include "unit/io/files.h"

namespace sfumato {
namespace {

namespace fs = std::filesystem;

class OutputsTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::path(testing::TempDir()) / "outputs-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path path(const std::string& name) const { return folder_ / name; }
  static std::string text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void put(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }
  static void write(const fs::path& file, const std::string& text) {
    io::AtomicWriter writer(file);
    writer.write(text);
    writer.commit();
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) all.push_back(entry.path().filename());
    std::sort(all.begin(), all.end());
    return all;
  }
  static ErrorCode code_of(const std::function<void()>& work, std::string* what = nullptr) {
    try {
      work();
    } catch (const Error& error) {
      if (what) *what = error.what();
      return error.code();
    }
    return ErrorCode(0);
  }
  fs::path folder_;
};

TEST_F(OutputsTest, AReplacedFileKeepsItsModeAndANewOneHasTheUsualOne) {
  put(path("old"), "1");
  fs::permissions(path("old"), fs::perms(0640));
  write(path("old"), "2");
  EXPECT_EQ(text(path("old")), "2");
  EXPECT_EQ(fs::status(path("old")).permissions(), fs::perms(0640));
  const mode_t mask = umask(022);
  write(path("new"), "3");
  umask(mask);
  EXPECT_EQ(fs::status(path("new")).permissions(), fs::perms(0644));
  EXPECT_EQ(names(), (std::vector<std::string>{"new", "old"}));
}

TEST_F(OutputsTest, LinksAreFollowedAlsoToFilesThatAreNotThere) {
  fs::create_directory(path("there"));
  put(path("there/real"), "old");
  fs::create_symlink("there/real", path("link"));
  fs::create_symlink("link", path("link_to_link"));
  fs::create_symlink("there/none", path("dangling"));
  write(path("link_to_link"), "new");
  write(path("dangling"), "made");
  EXPECT_TRUE(fs::is_symlink(path("link_to_link")) && fs::is_symlink(path("link")) &&
              fs::is_symlink(path("dangling")));
  EXPECT_EQ(text(path("there/real")), "new");
  EXPECT_EQ(text(path("there/none")), "made");
  fs::create_symlink("b", path("a"));
  fs::create_symlink("a", path("b"));
  EXPECT_EQ(code_of([&] { write(path("a"), ""); }), ErrorCode::io);
}

TEST_F(OutputsTest, WhatIsNoRegularFileIsRefusedAndStays) {
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  fs::create_directory(path("folder"));
  std::string what;
  for (const auto& [name, kind] : {std::pair("fifo", "a FIFO"), std::pair("folder", "a folder")}) {
    EXPECT_EQ(code_of([&] { write(path(name), "x"); }, &what), ErrorCode::usage);
    EXPECT_NE(what.find(kind), std::string::npos) << what;
  }
  EXPECT_EQ(code_of([&] { write("/dev/null", "x"); }, &what), ErrorCode::usage);
  EXPECT_NE(what.find("a device"), std::string::npos) << what;
  EXPECT_TRUE(fs::is_fifo(path("fifo")) && fs::is_character_file("/dev/null"));
}

TEST_F(OutputsTest, NamesOfAnyLegalLengthAreWritten) {
  for (std::size_t length : {1u, 200u, 244u, 255u}) {
    write(path(std::string(length, 'n')), "x");
    write(path(std::string(length, 'n')), "y");  // and replaced
    EXPECT_EQ(text(path(std::string(length, 'n'))), "y");
  }
  std::string what;
  EXPECT_EQ(code_of([&] { write(path(std::string(256, 'n')), "x"); }, &what), ErrorCode::io);
  EXPECT_NE(what.find("File name too long"), std::string::npos) << what;
  EXPECT_EQ(names().size(), 4u);
}

TEST_F(OutputsTest, NamesOfOneFileAreOneFile) {
  put(path("scan.ply"), "");
  fs::create_hard_link(path("scan.ply"), path("hard"));
  fs::create_symlink("scan.ply", path("soft"));
  fs::create_directory(path("sub"));
  for (const char* name : {"scan.ply", "hard", "soft", "sub/../scan.ply"}) {
    io::FileNames files;
    files.input("the input", path("scan.ply"));
    std::string what;
    EXPECT_EQ(code_of([&] { files.output("-o", path(name)); }, &what), ErrorCode::usage) << name;
    EXPECT_NE(what.find("would replace the input"), std::string::npos) << what;
  }
  io::FileNames files;
  files.output("-o", path("a.npy"));
  files.output("--output-normal", path("b.npy"));
  std::string what;
  EXPECT_EQ(code_of([&] { files.output("--output-depth", path("sub/../a.npy")); }, &what), ErrorCode::usage);
  EXPECT_NE(what.find("also written by -o"), std::string::npos) << what;
  fs::create_symlink("not_yet.npy", path("to_come"));
  files.output("-1", path("not_yet.npy"));
  EXPECT_EQ(code_of([&] { files.output("-2", path("to_come")); }), ErrorCode::usage);
}

TEST_F(OutputsTest, KilledWritersLeaveTheOldFileOrTheNewOneAndNothingElse) {
  // 1 MB of one letter each: a mixture, or a shorter file, would show. The child replaces the file over and
  // over until it is killed, at 200 random times.
  constexpr std::size_t size = 1 << 20;
  put(path("out"), std::string(size, 'a'));
  std::mt19937 random(1);
  const auto write_until_killed = [&](bool once) {
    for (char letter = 'a';; letter = letter == 'z' ? 'a' : char(letter + 1)) {
      write(path("out"), std::string(size, letter));
      if (once) _exit(0);
    }
  };
  for (int run = 0; run < 200; ++run) {
    const pid_t child = fork();
    if (child == 0) write_until_killed(false);
    ::usleep(useconds_t(random() % 5000));
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    ::waitpid(child, nullptr, 0);
    const std::string bytes = text(path("out"));
    ASSERT_EQ(bytes.size(), size);
    ASSERT_EQ(bytes.find_first_not_of(bytes[0]), std::string::npos) << "run " << run;
  }
  const pid_t next = fork();
  if (next == 0) write_until_killed(true);
  ::waitpid(next, nullptr, 0);
  EXPECT_EQ(names(), std::vector<std::string>{"out"});
}

TEST_F(OutputsTest, TemporariesOfTheDeadAreSweptThoseOfTheLivingStay) {
  put(path(".sfumato-1-0.tmp"), "dead");
  put(path(".sfumato-2-0.tmp"), "alive");
  put(path("sfumato.tmp"), "somebody else's");
  const int alive = ::open(path(".sfumato-2-0.tmp").c_str(), O_RDWR);
  ASSERT_EQ(::flock(alive, LOCK_EX), 0);
  write(path("out"), "x");
  EXPECT_EQ(names(), (std::vector<std::string>{".sfumato-2-0.tmp", "out", "sfumato.tmp"}));
  ::close(alive);
}

PointCloud small_cloud() {
  PointCloud cloud;
  for (int i = 0; i < 40000; ++i) cloud.positions.push_back({float(i % 200), float(i / 200), float(i % 7)});
  return cloud;
}

TEST_F(OutputsTest, AFullDiskIsAnIoErrorThatNamesFileAndCause) {
  // A limit on the size of files fails writes like a full disk does (EFBIG for ENOSPC).
  Image<vec4> color(300, 300);
  Image<float> depth(300, 300);
  Image<vec3> normal(300, 300);
  std::uint32_t noise = 1;
  for (std::size_t i = 0; i < depth.size(); ++i)
    depth.data()[i] = float(noise = noise * 1664525u + 1013904223u);
  struct rlimit old {};
  getrlimit(RLIMIT_FSIZE, &old);
  for (const char* name : {"a.las", "a.laz", "a.ply", "a.exr"}) {
    put(path(name), "old");
    struct rlimit tight = old;
    tight.rlim_cur = 20000;
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &tight);
    std::string what;
    const ErrorCode code = code_of(
        [&] {
          if (fs::path(name).extension() == ".exr")
            io::write_exr(path(name), color, depth, normal, "");
          else
            io::write(path(name), small_cloud());
        },
        &what);
    setrlimit(RLIMIT_FSIZE, &old);
    signal(SIGXFSZ, SIG_DFL);
    EXPECT_EQ(code, ErrorCode::io) << name;
    EXPECT_NE(what.find(path(name).string()), std::string::npos) << what;
    EXPECT_NE(what.find("File too large"), std::string::npos) << what;
    EXPECT_EQ(what.find("/proc"), std::string::npos) << what;
    EXPECT_EQ(text(path(name)), "old");
  }
  EXPECT_EQ(names().size(), 4u);
}

TEST_F(OutputsTest, JsonIsBounded) {
  std::string keys = "{";
  for (int i = 0; i < 200000; ++i) keys += (i ? ",\"" : "\"") + std::to_string(i) + "\":1";
  keys += "}";
  std::string what;
  for (const std::string& bad :
       {std::string(400000, '['), std::string(400000, '[') + std::string(400000, ']'), keys, std::string(),
        std::string("{\"a\":"), std::string("\xff\xfe")}) {
    EXPECT_EQ(code_of([&] { io::parse_json(bad, "file"); }, &what), ErrorCode::bad_input);
    EXPECT_TRUE(what.starts_with("file: ")) << what;
  }
  EXPECT_EQ(io::parse_json("{\"a\": [1, [2]]}", "file")["a"][1][0], 2);
}

TEST_F(OutputsTest, CamerasBeyondAnyPointAreRefused) {
  std::string what;
  EXPECT_EQ(
      code_of([&] { io::camera_from_json(R"({"position": [1e308,0,0], "target": [0,0,0]})", "c.json"); },
              &what),
      ErrorCode::bad_input);
  EXPECT_NE(what.find("'position' is beyond 1e15"), std::string::npos) << what;
}

}  // namespace
}  // namespace sfumato
