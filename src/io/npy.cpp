#include "io/npy.h"

#include <bit>
#include <string>

#include "io/atomic_writer.h"

namespace sfumato::io {
namespace {

static_assert(std::endian::native == std::endian::little, "NPY is written as the memory has it");

void write_header(AtomicWriter& writer, const char* type, int width, int height, int channels) {
  std::string header = std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (" +
                       std::to_string(height) + ", " + std::to_string(width) +
                       (channels > 1 ? ", " + std::to_string(channels) : "") + "), }";
  // Magic, version, header length, header, newline: together a multiple of 64 bytes, as the format asks.
  const std::size_t preamble = 10;
  header.append(63 - (preamble + header.size()) % 64, ' ');
  header += '\n';
  writer.write(std::string_view("\x93NUMPY\x01\x00", 8));
  const char length[] = {char(header.size() & 255), char(header.size() >> 8)};
  writer.write(std::string_view(length, 2));
  writer.write(header);
}

template <class T>
void write_pixels(AtomicWriter& writer, const Image<T>& rows) {
  writer.write(std::string_view(reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(T)));
}

template <class T>
void write_array(const std::filesystem::path& file, const char* type, int channels, const Image<T>& image) {
  AtomicWriter writer(file);
  write_header(writer, type, image.width(), image.height(), channels);
  write_pixels(writer, image);
  writer.commit();
}

}  // namespace

NpyRows::NpyRows(const std::filesystem::path& file, int width, int height, int channels)
    : writer_(std::make_unique<AtomicWriter>(file)) {
  write_header(*writer_, channels == 0 ? "<i8" : "<f4", width, height, channels);
}
NpyRows::~NpyRows() = default;
void NpyRows::write(const Image<float>& rows) { write_pixels(*writer_, rows); }
void NpyRows::write(const Image<vec3>& rows) { write_pixels(*writer_, rows); }
void NpyRows::write(const Image<vec4>& rows) { write_pixels(*writer_, rows); }
void NpyRows::write(const Image<std::int64_t>& rows) { write_pixels(*writer_, rows); }
void NpyRows::finish() { writer_->commit(); }

void write_npy(const std::filesystem::path& file, const Image<float>& image) {
  write_array(file, "<f4", 1, image);
}

void write_npy(const std::filesystem::path& file, const Image<vec3>& image) {
  write_array(file, "<f4", 3, image);
}

void write_npy(const std::filesystem::path& file, const Image<vec4>& image) {
  write_array(file, "<f4", 4, image);
}

void write_npy(const std::filesystem::path& file, const Image<std::uint8_t>& image) {
  write_array(file, "|u1", 1, image);
}

void write_npy(const std::filesystem::path& file, const Image<std::int64_t>& image) {
  write_array(file, "<i8", 1, image);
}

}  // namespace sfumato::io
