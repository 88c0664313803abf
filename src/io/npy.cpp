#include "io/npy.h"

#include <bit>
#include <string>

#include "io/atomic_writer.h"

namespace sfumato::io {
namespace {

static_assert(std::endian::native == std::endian::little, "NPY is written as the memory has it");

void write_array(const std::filesystem::path& file, const char* type, int width, int height, int channels,
                 const void* data, std::size_t bytes) {
  std::string header = std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (" +
                       std::to_string(height) + ", " + std::to_string(width) +
                       (channels > 1 ? ", " + std::to_string(channels) : "") + "), }";
  // Magic, version, header length, header, newline: together a multiple of 64 bytes, as the format asks.
  const std::size_t preamble = 10;
  header.append(63 - (preamble + header.size()) % 64, ' ');
  header += '\n';
  AtomicWriter writer(file);
  writer.write(std::string_view("\x93NUMPY\x01\x00", 8));
  const char length[] = {char(header.size() & 255), char(header.size() >> 8)};
  writer.write(std::string_view(length, 2));
  writer.write(header);
  writer.write(std::string_view(static_cast<const char*>(data), bytes));
  writer.commit();
}

}  // namespace

void write_npy(const std::filesystem::path& file, const Image<float>& image) {
  write_array(file, "<f4", image.width(), image.height(), 1, image.data(), image.size() * sizeof(float));
}

void write_npy(const std::filesystem::path& file, const Image<vec3>& image) {
  write_array(file, "<f4", image.width(), image.height(), 3, image.data(), image.size() * sizeof(vec3));
}

void write_npy(const std::filesystem::path& file, const Image<vec4>& image) {
  write_array(file, "<f4", image.width(), image.height(), 4, image.data(), image.size() * sizeof(vec4));
}

void write_npy(const std::filesystem::path& file, const Image<std::uint8_t>& image) {
  write_array(file, "|u1", image.width(), image.height(), 1, image.data(), image.size());
}

}  // namespace sfumato::io
