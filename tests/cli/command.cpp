#include "cli/command.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "reference/png.h"

namespace sfumato::testing {
namespace {

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

void CommandTest::SetUp() {
  std::string name = (std::filesystem::temp_directory_path() / "sfumato-cli-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  folder_ = name;
  setenv("SFUMATO_CONFIG", "", 1);  // nobody's own defaults
  unsetenv("DISPLAY");              // a command without -o opens no window on somebody's screen
  unsetenv("WAYLAND_DISPLAY");
}

void CommandTest::TearDown() { std::filesystem::remove_all(folder_); }

Outcome CommandTest::run(const std::vector<std::string>& words, int interrupt_after_ms) {
  return run(
      words,
      [&](int child, Outcome&) {
        if (interrupt_after_ms <= 0) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(interrupt_after_ms));
        kill(child, SIGINT);
      },
      -1);
}

Outcome CommandTest::run_interrupted(const std::vector<std::string>& words,
                                     const std::function<bool(double)>& is_time, int input) {
  return run(
      words,
      [&](int child, Outcome& outcome) {
        clockid_t clock{};
        struct timespec used {};
        while (clock_getcpuclockid(child, &clock) == 0 && clock_gettime(clock, &used) == 0) {
          outcome.seconds_late = double(used.tv_sec) + 1e-9 * double(used.tv_nsec);
          siginfo_t state{};
          const bool has_ended =
              waitid(P_PID, id_t(child), &state, WEXITED | WNOHANG | WNOWAIT) == 0 && state.si_pid == child;
          if (has_ended || is_time(outcome.seconds_late)) break;
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        kill(child, SIGINT);
      },
      input);
}

Outcome CommandTest::run(const std::vector<std::string>& words,
                         const std::function<void(int, Outcome&)>& meanwhile, int input) {
  // Outside the folder, so that `files` lists only what the command wrote.
  const std::string out = folder_.string() + ".out", err = folder_.string() + ".err";
  std::vector<std::string> all = {SFUMATO_BINARY};
  all.insert(all.end(), first_words_.begin(), first_words_.end());
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& word : all) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder_.c_str()) != 0) _exit(126);
    if (input >= 0) dup2(input, STDIN_FILENO);
    dup2(open(out.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), STDOUT_FILENO);
    dup2(open(err.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  Outcome outcome;
  meanwhile(child, outcome);
  int status = 0;
  struct rusage used {};
  wait4(child, &status, 0, &used);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_all(out), outcome.err = read_all(err);
  outcome.seconds = double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                    1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  outcome.seconds_late = outcome.seconds - outcome.seconds_late;
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  return outcome;
}

nlohmann::json CommandTest::run_json(const std::vector<std::string>& words) {
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  nlohmann::json json = nlohmann::json::parse(outcome.out, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << outcome.out;
  return json;
}

std::string CommandTest::write(const std::string& name, const std::string& text) {
  std::ofstream(path(name), std::ios::binary) << text;
  return name;
}

std::string CommandTest::text(const std::string& name) const { return read_all(path(name)); }

std::vector<std::string> CommandTest::files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::string CommandTest::write_cube(const std::string& name, int per_edge) {
  std::ostringstream rows;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i < per_edge; ++i)
      for (int k = 0; k < per_edge; ++k) {
        double p[3];
        p[face / 2] = face % 2;
        p[(face / 2 + 1) % 3] = (i + 0.5) / per_edge;
        p[(face / 2 + 2) % 3] = (k + 0.5) / per_edge;
        rows << p[0] << ' ' << p[1] << ' ' << p[2] << (p[2] < 0.5 ? " 255 0 0 " : " 0 255 0 ") << i << '\n';
      }
  std::ostringstream file;
  file << "ply\nformat ascii 1.0\ncomment up +Z\nelement vertex " << 6 * per_edge * per_edge
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
          "property uchar blue\nproperty float row\nend_header\n"
       << rows.str();
  return write(name, file.str());
}

Image<Rgba8> CommandTest::read_png(const std::string& name) const { return testing::read_png(path(name)); }

std::map<std::string, std::string> CommandTest::png_texts(const std::string& name) const {
  const std::string bytes = text(name);
  std::map<std::string, std::string> texts;
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const auto byte = [&](std::size_t i) { return std::size_t(static_cast<unsigned char>(bytes[at + i])); };
    const std::size_t length = byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
    const std::string type = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, length);
    if (type == "tEXt")
      texts[data.c_str()] = data.substr(std::strlen(data.c_str()) + 1);
    else if (type == "iTXt")
      texts[data.c_str()] = data.substr(data.rfind('\0') + 1);
    else
      texts[type] = "";
    at += 12 + length;
  }
  return texts;
}

Array CommandTest::read_npy(const std::string& name) const {
  const std::string bytes = text(name);
  Array array;
  if (bytes.size() < 10 || bytes.compare(0, 8, std::string("\x93NUMPY\x01\x00", 8)) != 0) {
    ADD_FAILURE() << name << " is no NPY file";
    return array;
  }
  const std::size_t header = std::size_t(static_cast<unsigned char>(bytes[8])) +
                             256 * std::size_t(static_cast<unsigned char>(bytes[9]));
  EXPECT_EQ((10 + header) % 64, 0u);
  const std::string text = bytes.substr(10, header);
  const std::size_t type = text.find("'descr': '") + 10;
  array.type = text.substr(type, text.find('\'', type) - type);
  std::stringstream shape(text.substr(text.find('(') + 1, text.find(')') - text.find('(') - 1));
  for (std::string word; std::getline(shape, word, ',');) array.shape.push_back(std::stoi(word));
  if (array.type == "<i8") {
    array.indices.resize((bytes.size() - 10 - header) / sizeof(std::int64_t));
    std::memcpy(array.indices.data(), bytes.data() + 10 + header,
                array.indices.size() * sizeof(std::int64_t));
    return array;
  }
  array.values.resize((bytes.size() - 10 - header) / sizeof(float));
  std::memcpy(array.values.data(), bytes.data() + 10 + header, array.values.size() * sizeof(float));
  return array;
}

}  // namespace sfumato::testing
