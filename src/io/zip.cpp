#include "io/zip.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <new>

#include "io/format.h"

namespace sfumato::io {
namespace {

// Deflate makes at most 1032 bytes of one.
constexpr std::uint64_t deflate_ratio = 1032, most_members = 256, local_header_size = 30, zip_entry_size = 46,
                        end_size = 22;

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T value{};
  if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::string zip_text(const ByteSource& file, std::uint64_t offset, std::uint64_t count) {
  std::string text(std::size_t(std::min(count, file.size - std::min(offset, file.size))), '\0');
  file.read(offset, std::as_writable_bytes(std::span(text)));
  return text;
}

}  // namespace

std::vector<ZipMember> zip_members(const ByteSource& file, const std::filesystem::path& path) {
  const auto fail = [&](std::uint64_t byte, const std::string& what) {
    bad_input(path, "byte " + std::to_string(byte),
              what + "; the file is truncated or damaged, fetch it again");
  };
  const std::uint64_t tail_at = file.size - std::min<std::uint64_t>(file.size, end_size + 65535);
  const std::string tail = zip_text(file, tail_at, end_size + 65535);
  const std::size_t end = tail.rfind("PK\5\6");
  if (end == std::string::npos || tail.size() - end < end_size)
    fail(file.size, "found no list of files at the end");
  std::uint64_t count = number_at<std::uint16_t>(tail, end + 10),
                size = number_at<std::uint32_t>(tail, end + 12),
                at = number_at<std::uint32_t>(tail, end + 16);
  // Files beyond 4 GB: the numbers stand in another record, 56 bytes before the 20 bytes that lead to it.
  if (at == 0xFFFFFFFF && end >= 76 && tail.compare(end - 76, 4, "PK\6\6") == 0)
    count = number_at<std::uint64_t>(tail, end - 76 + 32),
    size = number_at<std::uint64_t>(tail, end - 76 + 40), at = number_at<std::uint64_t>(tail, end - 76 + 48);
  if (count > most_members || at > file.size || size > file.size - at || size > 1 << 20)
    fail(tail_at + end, "found a list of " + std::to_string(count) + " files outside the file");
  const std::string list = zip_text(file, at, std::size_t(size));
  std::vector<ZipMember> members;
  for (std::size_t entry = 0; members.size() < count;) {
    if (list.compare(entry, 4, "PK\1\2") != 0 || list.size() - entry < zip_entry_size)
      fail(at + entry, "found no file where one is listed");
    ZipMember one;
    const auto flags = number_at<std::uint16_t>(list, entry + 8),
               method = number_at<std::uint16_t>(list, entry + 10);
    one.packed = number_at<std::uint32_t>(list, entry + 20);
    one.size = number_at<std::uint32_t>(list, entry + 24);
    const std::size_t name = number_at<std::uint16_t>(list, entry + 28),
                      extra = number_at<std::uint16_t>(list, entry + 30),
                      comment = number_at<std::uint16_t>(list, entry + 32);
    one.byte = number_at<std::uint32_t>(list, entry + 42);
    if (entry + zip_entry_size + name + extra + comment > list.size())
      fail(at + entry, "found a file outside the list");
    one.name = list.substr(entry + zip_entry_size, name);
    std::replace_if(
        one.name.begin(), one.name.end(), [](unsigned char c) { return c < ' '; }, '?');
    // Numbers of 64 bits for those that are all ones, in this order.
    for (std::size_t e = entry + zip_entry_size + name, last = e + extra; e + 4 <= last;) {
      const std::size_t length = number_at<std::uint16_t>(list, e + 2);
      if (number_at<std::uint16_t>(list, e) == 1) {
        std::size_t value = e + 4;
        for (std::uint64_t* number : {&one.size, &one.packed, &one.byte})
          if (*number == 0xFFFFFFFF) *number = number_at<std::uint64_t>(list, value), value += 8;
      }
      e += 4 + length;
    }
    entry += zip_entry_size + name + extra + comment;
    if ((flags & 1) || (method != 0 && method != 8))
      fail(at, "found '" + one.name + "' packed by another method than Deflate, or encrypted");
    one.is_deflated = method == 8;
    if (one.byte > file.size || file.size - one.byte < local_header_size)
      fail(at, "found '" + one.name + "' outside the file");
    // The head before the array has a name and extra bytes of its own.
    const std::string head = zip_text(file, one.byte, local_header_size);
    if (!head.starts_with("PK\3\4")) fail(one.byte, "found no file where '" + one.name + "' is listed");
    one.byte += local_header_size + number_at<std::uint16_t>(head, 26) + number_at<std::uint16_t>(head, 28);
    if (one.byte > file.size || one.packed > file.size - one.byte ||
        one.size > (one.is_deflated ? deflate_ratio : 1) * one.packed)
      fail(one.byte,
           "found " + std::to_string(one.size) + " bytes of '" + one.name + "', more than the file can hold");
    members.push_back(one);
  }
  return members;
}

void unpack(const ByteSource& file, const std::filesystem::path& path, const ZipMember& member,
            const std::function<void(std::span<const char>)>& take, Progress& progress) {
  z_stream stream{};
  if (member.is_deflated && ::inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  struct End {  // whatever happens
    z_stream* stream;
    ~End() {
      if (stream) ::inflateEnd(stream);
    }
  } end{member.is_deflated ? &stream : nullptr};
  std::vector<char> out(1 << 20);
  std::uint64_t made = 0;
  bool is_over = false;
  const auto give = [&](const char* bytes, std::size_t count) {
    made += count;
    if (made > member.size)
      bad_input(path, "byte " + std::to_string(member.byte),
                "found more bytes in '" + member.name + "' than listed; the file is damaged");
    take({bytes, count});
  };
  for (std::uint64_t done = 0; done < member.packed && !is_over;) {
    progress.check();
    std::string in =
        zip_text(file, member.byte + done, std::min<std::uint64_t>(1 << 20, member.packed - done));
    done += in.size();
    if (!member.is_deflated) {
      give(in.data(), in.size());
      continue;
    }
    stream.next_in = reinterpret_cast<Bytef*>(in.data());
    stream.avail_in = uInt(in.size());
    do {
      stream.next_out = reinterpret_cast<Bytef*>(out.data());
      stream.avail_out = uInt(out.size());
      const int got = ::inflate(&stream, Z_NO_FLUSH);
      is_over = got == Z_STREAM_END;
      if (got != Z_OK && got != Z_STREAM_END && got != Z_BUF_ERROR)
        bad_input(path, "byte " + std::to_string(member.byte + done),
                  "found an impossible deflate stream in '" + member.name + "'; the file is damaged");
      give(out.data(), out.size() - stream.avail_out);
    } while (!is_over && (stream.avail_in > 0 || stream.avail_out == 0));
  }
}

}  // namespace sfumato::io
