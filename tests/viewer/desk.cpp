#include "viewer/desk.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace sfumato::testing {
namespace {

using Clock = std::chrono::steady_clock;

void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(30)); }

bool is_there(const char* program) {
  return std::system(("command -v " + std::string(program) + " >/dev/null").c_str()) == 0;
}

/// The words of a line as a shell wrote them: quotes are single, and escaped as '\''.
std::vector<std::string> unquoted(const std::string& line) {
  std::vector<std::string> words(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\'')
      quoted = !quoted;
    else if (line[i] == '\\' && !quoted && i + 1 < line.size())
      words.back() += line[++i];
    else if (line[i] == ' ' && !quoted)
      words.emplace_back();
    else
      words.back() += line[i];
  }
  return words;
}

}  // namespace

void DeskTest::SetUp() {
  CommandTest::SetUp();
  for (const char* program : {"Xvfb", "xdotool", "xclip"})
    if (!is_there(program)) GTEST_SKIP() << program << " is not installed (scripts/install-deps)";
  folder_of_screen_ = path("").parent_path().string() + ".screen";
  std::filesystem::create_directory(folder_of_screen_);
  int pipes[2];
  ASSERT_EQ(pipe(pipes), 0);
  screen_ = fork();
  if (screen_ == 0) {
    close(pipes[0]);
    const int quiet = ::open("/dev/null", O_RDWR);
    dup2(quiet, STDOUT_FILENO);
    dup2(quiet, STDERR_FILENO);
    const std::string size = std::to_string(screen_width) + "x" + std::to_string(screen_height) + "x24";
    execlp("Xvfb", "Xvfb", "-displayfd", std::to_string(pipes[1]).c_str(), "-screen", "0", size.c_str(),
           "-nolisten", "tcp", "-fbdir", folder_of_screen_.c_str(), nullptr);
    _exit(127);
  }
  close(pipes[1]);
  char number[16] = {};
  ssize_t length = 0;
  while (length < 15 && read(pipes[0], number + length, 1) == 1 && number[length] != '\n') ++length;
  close(pipes[0]);
  ASSERT_GT(length, 0) << "Xvfb does not start";
  number[length] = 0;
  setenv("DISPLAY", (":" + std::string(number)).c_str(), 1);
  unsetenv("WAYLAND_DISPLAY");
}

void DeskTest::TearDown() {
  for (pid_t* each : {&window_, &screen_})
    if (*each > 0) {
      kill(*each, *each == window_ ? SIGKILL : SIGTERM);
      waitpid(*each, nullptr, 0);
      *each = -1;
    }
  if (HasFailure()) std::fprintf(stderr, "the window said:\n%s", said().c_str());
  if (!folder_of_screen_.empty()) std::filesystem::remove_all(folder_of_screen_);
  CommandTest::TearDown();
}

void DeskTest::open(const std::vector<std::string>& words) {
  std::vector<std::string> all = {SFUMATO_BINARY};
  all.insert(all.end(), words.begin(), words.end());
  all.push_back("--verbose");
  std::vector<char*> argv;
  for (std::string& word : all) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string err = path("said.txt");
  std::filesystem::remove(err);  // what the window before said
  window_ = fork();
  if (window_ == 0) {
    if (chdir(path("").c_str()) != 0) _exit(126);
    dup2(::open(err.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
}

std::string DeskTest::said() const { return text("said.txt"); }

int DeskTest::count(const std::string& wanted) const {
  const std::string all = said();
  int n = 0;
  for (std::size_t at = all.find(wanted); at != std::string::npos; at = all.find(wanted, at + 1)) ++n;
  return n;
}

void DeskTest::wait_for(const std::string& wanted, int n, double seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (count(wanted) < n) {
    // An exception, so that what follows does not wait in vain as well.
    if (waitpid(window_, nullptr, WNOHANG) == window_) {
      window_ = -1;
      throw std::runtime_error("the window is gone, before it said '" + wanted + "'");
    }
    if (Clock::now() > end)
      throw std::runtime_error("waited in vain for '" + wanted + "' number " + std::to_string(n));
    pause();
  }
}

void DeskTest::hand(const std::string& words) {
  ASSERT_EQ(std::system(("xdotool " + words).c_str()), 0) << words;
}

std::string DeskTest::save() {
  const int before = count("saved sfumato_");
  hand("key p");
  wait_for("saved sfumato_", before + 1);
  const std::string all = said();
  const std::size_t at = all.rfind("saved ") + 6;
  return all.substr(at, all.find('\n', at) - at);
}

std::string DeskTest::clipboard() {
  const std::string file = path("clipboard.txt");
  EXPECT_EQ(std::system(("xclip -selection clipboard -o >" + file).c_str()), 0);
  const std::string all = text("clipboard.txt");
  std::filesystem::remove(file);
  return all;
}

/// Xvfb keeps its screen in a file of the format XWD: a header of big-endian numbers, colours, then rows.
Image<Rgba8> DeskTest::screen() const {
  std::ifstream in(folder_of_screen_ + "/Xvfb_screen0", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const auto number = [&](std::size_t i) {
    std::size_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes.at(4 * i + k));
    return value;
  };
  const std::size_t begin = number(0) + 12 * number(19), width = number(4), height = number(5),
                    row = number(12);
  Image<Rgba8> image(int(width), int(height), {});
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const auto byte = [&](std::size_t k) { return std::uint8_t(bytes.at(begin + y * row + 4 * x + k)); };
      image.at(int(x), int(y)) = {byte(2), byte(1), byte(0), 255};
    }
  return image;
}

int DeskTest::exit_code(double seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  int status = 0;
  while (waitpid(window_, &status, WNOHANG) == 0) {
    if (Clock::now() > end) return -1;
    pause();
  }
  window_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string DeskTest::drawn_again(const std::string& command, const std::string& name) {
  std::vector<std::string> words = unquoted(command);
  EXPECT_EQ(words.at(0), "sfumato");
  words.erase(words.begin());
  EXPECT_EQ(words.at(words.size() - 2), "-o");
  words.back() = name;
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.code, 0) << command << "\n" << outcome.err;
  return name;
}

}  // namespace sfumato::testing
