// Arrays as NPY version 1.0, the format of numpy.save.
#pragma once

#include <filesystem>
#include <memory>

#include "core/image.h"

namespace sfumato::io {

/// Little-endian, C order, shape (height, width) or (height, width, channels). The file appears under its
/// name only when it is complete; throws Error(io).
void write_npy(const std::filesystem::path& file, const Image<float>& image);
void write_npy(const std::filesystem::path& file, const Image<vec3>& image);
void write_npy(const std::filesystem::path& file, const Image<vec4>& image);
void write_npy(const std::filesystem::path& file, const Image<std::uint8_t>& image);
void write_npy(const std::filesystem::path& file, const Image<std::int64_t>& image);

/// Floats, or int64 with `channels` 0, from top to bottom, for pictures that are never in memory as a whole.
/// Without `finish` nothing appears.
class NpyRows {
 public:
  NpyRows(const std::filesystem::path& file, int width, int height, int channels);
  ~NpyRows();
  NpyRows(const NpyRows&) = delete;
  NpyRows& operator=(const NpyRows&) = delete;
  void write(const Image<float>& rows);
  void write(const Image<vec3>& rows);
  void write(const Image<vec4>& rows);
  void write(const Image<std::int64_t>& rows);
  void finish();

 private:
  std::unique_ptr<class AtomicWriter> writer_;
};

}  // namespace sfumato::io
