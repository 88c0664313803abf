#include "video.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/error.h"

namespace sfumato::cli {

bool is_video(const std::string& file) { return file.size() > 4 && file.ends_with(".mp4"); }

void require_ffmpeg(const std::string& file) {
  std::istringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((folder + "/ffmpeg").c_str(), X_OK) == 0) return;
  throw Error(ErrorCode::usage,
              "-o " + file +
                  ": the program ffmpeg, which makes videos, is not installed; install it, or write the "
                  "frames: -o frame_{n:04}.png");
}

Video::Video(const std::string& file, int width, int height)
    : file_(file), part_(file + ".part.mp4"), said_(file + ".part.txt") {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw Error(ErrorCode::io, file + ": no pipe to ffmpeg: " + std::strerror(errno));
  const std::string size = std::to_string(width) + "x" + std::to_string(height),
                    rate = std::to_string(frames_per_second);
  // Sides of 4:2:0 are even; sRGB pictures are tagged so that players show the colours that were drawn.
  const char* const words[] = {"ffmpeg",
                               "-y",
                               "-loglevel",
                               "error",
                               "-f",
                               "rawvideo",
                               "-pix_fmt",
                               "rgba",
                               "-s",
                               size.c_str(),
                               "-r",
                               rate.c_str(),
                               "-i",
                               "-",
                               "-an",
                               "-vf",
                               "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709",
                               "-pix_fmt",
                               "yuv420p",
                               "-colorspace",
                               "bt709",
                               "-color_primaries",
                               "bt709",
                               "-color_trc",
                               "iec61966-2-1",
                               "-crf",
                               "18",
                               "-movflags",
                               "+faststart",
                               part_.c_str(),
                               nullptr};
  program_ = ::fork();
  if (program_ == 0) {
    ::dup2(ends[0], STDIN_FILENO);
    const int said = ::open(said_.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
    ::dup2(said, STDERR_FILENO);
    ::setpgid(0, 0);  // Ctrl-C is for the command, which then removes what is half done
    ::execvp("ffmpeg", const_cast<char* const*>(words));
    ::_exit(127);
  }
  ::close(ends[0]);
  pipe_ = ends[1];
  if (program_ < 0) throw Error(ErrorCode::io, file + ": ffmpeg does not start: " + std::strerror(errno));
}

int Video::close_and_wait() {
  if (pipe_ >= 0) ::close(std::exchange(pipe_, -1));
  int status = -1;
  if (program_ > 0) ::waitpid(std::exchange(program_, -1), &status, 0);
  return status;
}

Video::~Video() {
  close_and_wait();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  std::filesystem::remove(said_, ignored);
}

void Video::add(const Image<Rgba8>& frame) {
  // A reader that is gone is an error to tell, not the end of the program.
  void (*const before)(int) = ::signal(SIGPIPE, SIG_IGN);
  const char* at = reinterpret_cast<const char*>(frame.data());
  std::size_t left = frame.size() * sizeof(Rgba8);
  while (left > 0) {
    const ssize_t written = ::write(pipe_, at, left);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) break;
    at += written, left -= std::size_t(written);
  }
  ::signal(SIGPIPE, before);
  if (left > 0) finish();
}

void Video::finish() {
  const bool is_good = close_and_wait() == 0;
  std::error_code error;
  if (is_good) std::filesystem::rename(part_, file_, error);
  if (is_good && !error) return;
  std::ifstream said(said_);
  std::string line;
  std::getline(said, line);
  throw Error(ErrorCode::io, file_ + ": ffmpeg wrote no video" + (line.empty() ? "" : ": " + line));
}

}  // namespace sfumato::cli
