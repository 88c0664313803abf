// What the words of a command line name: files, folders, patterns, standard input.
#include <glob.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "core/lower_case.h"
#include "io/byte_source.h"
#include "io/vpc.h"
#include "scene/scene.h"

namespace sfumato::scene {
namespace {

namespace fs = std::filesystem;

constexpr int poll_ms = 50;

std::vector<std::string> readable_extensions() {
  std::vector<std::string> all;
  for (const io::FormatInfo& format : io::formats()) {
    if (!format.can_read) continue;
    for (std::size_t at = 0; at < format.extensions.size();) {
      const std::size_t end = std::min(format.extensions.find(' ', at), format.extensions.size());
      all.push_back(format.extensions.substr(at, end - at));
      at = end + 1;
    }
  }
  return all;
}

std::vector<std::string> files_in(const std::string& folder) {
  // Such a folder is one scan: what lies in it are its parts.
  const auto has = [&](const char* name) { return fs::exists(fs::path(folder) / name); };
  for (const auto& [scan, beside] : {std::pair{"ept.json", "ept.json"},
                                     {"metadata.json", "octree.bin"},
                                     {"points3D.bin", "images.bin"},
                                     {"points3D.txt", "images.txt"}})
    if (has(scan) && has(beside)) return {(fs::path(folder) / scan).string()};
  const std::vector<std::string> extensions = readable_extensions();
  std::vector<std::string> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::string name = lower_case(entry.path().filename().string());
    if (name.starts_with('.') || !entry.is_regular_file(error)) continue;
    if (name.ends_with(".gz")) name.resize(name.size() - 3);
    if (std::any_of(extensions.begin(), extensions.end(),
                    [&](const auto& end) { return name.ends_with(end); }))
      found.push_back(entry.path().string());
  }
  if (error)
    throw Error(ErrorCode::io,
                folder + ": cannot read the folder (" + error.message() + "); check the permissions");
  std::sort(found.begin(), found.end());
  if (found.empty()) {
    std::string all;
    for (const std::string& extension : extensions) all += (all.empty() ? "" : " ") + extension;
    throw Error(ErrorCode::io, folder + ": the folder holds no point cloud; read are: " + all);
  }
  return found;
}

std::vector<std::string> matching(const std::string& pattern) {
  glob_t result{};
  std::vector<std::string> found;
  if (::glob(pattern.c_str(), 0, nullptr, &result) == 0)
    for (std::size_t i = 0; i < result.gl_pathc; ++i) found.emplace_back(result.gl_pathv[i]);
  ::globfree(&result);
  if (found.empty())
    throw Error(ErrorCode::io, pattern + ": no file has a name like this; check the folder and the pattern");
  return found;
}

}  // namespace

std::vector<std::string> expand_inputs(const std::vector<std::string>& words) {
  std::vector<std::string> files;
  for (const std::string& word : words) {
    std::error_code error;
    std::vector<std::string> found = {word};
    if (io::is_vpc_name(word) && (io::is_remote(word) || fs::is_regular_file(word, error))) {
      for (const fs::path& file : io::vpc_files(word)) files.push_back(file.string());
      continue;
    }
    if (io::is_remote(word)) {
      files.push_back(word);  // a query is no pattern
      continue;
    }
    if (word != "-" && fs::is_directory(word, error))
      found = files_in(word);
    else if (word.find_first_of("*?[") != std::string::npos && !fs::exists(word, error))
      found = matching(word);
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

std::shared_ptr<StandardInput> StandardInput::get() {
  static std::mutex mutex;
  static std::weak_ptr<StandardInput> kept;
  const std::lock_guard lock(mutex);
  std::shared_ptr<StandardInput> one = kept.lock();
  if (!one) kept = one = std::shared_ptr<StandardInput>(new StandardInput);
  return one;
}

StandardInput::StandardInput() {
  if (isatty(STDIN_FILENO))
    throw Error(ErrorCode::usage,
                "-: standard input is the keyboard; pipe a point cloud into it, or name a file");
  std::string name = (fs::temp_directory_path() / "sfumato-input-XXXXXX").string();
  handle_ = ::mkstemp(name.data());
  if (handle_ < 0)
    throw Error(ErrorCode::io,
                name + ": cannot keep standard input (" + std::strerror(errno) + "); set TMPDIR");
  ::unlink(name.c_str());  // gone with the last who has it open, whatever happens to us
  path_ = "/proc/self/fd/" + std::to_string(handle_);
}

const std::string& StandardInput::path(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  if (failure_) throw Error(*failure_);
  try {
    if (!is_whole_) take(progress);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    failure_ = error;  // what was read and could not be kept does not come again
    throw;
  }
  is_whole_ = true;
  return path_;
}

void StandardInput::take(const Progress& progress) {
  std::array<char, 1 << 16> block;
  while (true) {
    progress.check();
    // Who writes may take for ever, and Ctrl-C does not end a read.
    struct pollfd one {
      STDIN_FILENO, POLLIN, 0
    };
    const int ready = ::poll(&one, 1, poll_ms);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t got = ::read(STDIN_FILENO, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw Error(ErrorCode::io, std::string("standard input: read failed (") + std::strerror(errno) + ")");
    if (got == 0) break;
    for (ssize_t at = 0; at < got;) {
      const ssize_t done = ::write(handle_, block.data() + at, std::size_t(got - at));
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0)
        throw Error(ErrorCode::io,
                    std::string("standard input does not fit into the folder of temporary files (") +
                        std::strerror(errno) + "); set TMPDIR to another");
      at += done;
    }
  }
}

StandardInput::~StandardInput() {
  if (handle_ >= 0) ::close(handle_);
}

}  // namespace sfumato::scene
