// Frames to a video, by the program ffmpeg where it is installed.
#pragma once

#include <sys/types.h>

#include <string>

#include "core/image.h"

namespace sfumato::cli {

/// Whether the name is one of a video: ".mp4".
bool is_video(const std::string& file);
/// Throws Error(usage) that names the way without it when ffmpeg is not on the PATH.
void require_ffmpeg(const std::string& file);

class Video {
 public:
  static constexpr int frames_per_second = 25;
  /// Frames of this size; the last row or column is repeated as background where a side is odd. Throws
  /// Error(io).
  Video(const std::string& file, int width, int height);
  /// Without `finish`, what was written is removed.
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;
  /// Throws Error(io) when ffmpeg takes no more.
  void add(const Image<Rgba8>& frame);
  /// The file appears under its name. Throws Error(io) with what ffmpeg said.
  void finish();

 private:
  int close_and_wait();
  std::string file_, part_, said_;
  int pipe_ = -1;
  pid_t program_ = -1;
};

}  // namespace sfumato::cli
