// NumPy's .npz: a zip of arrays. Which array is what, its name says: xyz (or points, positions, coords,
// vertices), rgb (colors), normals, all of three columns; lists of numbers are scalars by their own name, x,
// y, z among them.
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "io/file.h"
#include "io/format.h"
#include "io/npy_array.h"
#include "io/table.h"

namespace sfumato::io {
namespace {

// Deflate makes at most 1032 bytes of one.
constexpr std::uint64_t deflate_ratio = 1032, most_members = 256, local_header_size = 30, entry_size = 46,
                        end_size = 22;
constexpr std::uint64_t small_member_bytes = 64 << 20;

struct Member {
  std::string name;
  std::uint64_t byte = 0, packed = 0, size = 0;
  bool is_deflated = false;
};

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T value{};
  if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The list of files at the end of a zip.
std::vector<Member> members_of(const File& file) {
  const auto fail = [&](std::uint64_t byte, const std::string& what) {
    bad_input(file.path(), "byte " + std::to_string(byte),
              what + "; the file is truncated or damaged, fetch it again");
  };
  const std::uint64_t tail_at = file.size() - std::min<std::uint64_t>(file.size(), end_size + 65535);
  const std::string tail = file.read_text(tail_at, end_size + 65535);
  const std::size_t end = tail.rfind("PK\5\6");
  if (end == std::string::npos || tail.size() - end < end_size)
    fail(file.size(), "found no list of arrays at the end");
  std::uint64_t count = number_at<std::uint16_t>(tail, end + 10),
                size = number_at<std::uint32_t>(tail, end + 12),
                at = number_at<std::uint32_t>(tail, end + 16);
  // Files beyond 4 GB: the numbers stand in another record, 56 bytes before the 20 bytes that lead to it.
  if (at == 0xFFFFFFFF && end >= 76 && tail.compare(end - 76, 4, "PK\6\6") == 0)
    count = number_at<std::uint64_t>(tail, end - 76 + 32),
    size = number_at<std::uint64_t>(tail, end - 76 + 40), at = number_at<std::uint64_t>(tail, end - 76 + 48);
  if (count > most_members || at > file.size() || size > file.size() - at || size > 1 << 20)
    fail(tail_at + end, "found a list of " + std::to_string(count) + " arrays outside the file");
  const std::string list = file.read_text(at, std::size_t(size));
  std::vector<Member> members;
  for (std::size_t entry = 0; members.size() < count;) {
    if (list.compare(entry, 4, "PK\1\2") != 0 || list.size() - entry < entry_size)
      fail(at + entry, "found no array where one is listed");
    Member one;
    const auto flags = number_at<std::uint16_t>(list, entry + 8),
               method = number_at<std::uint16_t>(list, entry + 10);
    one.packed = number_at<std::uint32_t>(list, entry + 20);
    one.size = number_at<std::uint32_t>(list, entry + 24);
    const std::size_t name = number_at<std::uint16_t>(list, entry + 28),
                      extra = number_at<std::uint16_t>(list, entry + 30),
                      comment = number_at<std::uint16_t>(list, entry + 32);
    one.byte = number_at<std::uint32_t>(list, entry + 42);
    if (entry + entry_size + name + extra + comment > list.size())
      fail(at + entry, "found an array outside the list");
    one.name = list.substr(entry + entry_size, name);
    std::replace_if(
        one.name.begin(), one.name.end(), [](unsigned char c) { return c < ' '; }, '?');
    // Numbers of 64 bits for those that are all ones, in this order.
    for (std::size_t e = entry + entry_size + name, last = e + extra; e + 4 <= last;) {
      const std::size_t length = number_at<std::uint16_t>(list, e + 2);
      if (number_at<std::uint16_t>(list, e) == 1) {
        std::size_t value = e + 4;
        for (std::uint64_t* number : {&one.size, &one.packed, &one.byte})
          if (*number == 0xFFFFFFFF) *number = number_at<std::uint64_t>(list, value), value += 8;
      }
      e += 4 + length;
    }
    entry += entry_size + name + extra + comment;
    if ((flags & 1) || (method != 0 && method != 8))
      fail(at, "found '" + one.name + "' packed in a way that numpy does not use");
    one.is_deflated = method == 8;
    if (one.byte > file.size() || file.size() - one.byte < local_header_size)
      fail(at, "found '" + one.name + "' outside the file");
    // The head before the array has a name and extra bytes of its own.
    const std::string head = file.read_text(one.byte, local_header_size);
    if (!head.starts_with("PK\3\4")) fail(one.byte, "found no array where '" + one.name + "' is listed");
    one.byte += local_header_size + number_at<std::uint16_t>(head, 26) + number_at<std::uint16_t>(head, 28);
    if (one.byte > file.size() || one.packed > file.size() - one.byte ||
        one.size > (one.is_deflated ? deflate_ratio : 1) * one.packed)
      fail(one.byte,
           "found " + std::to_string(one.size) + " bytes of '" + one.name + "', more than the file can hold");
    members.push_back(one);
  }
  return members;
}

/// An array of the zip as a file of its own, in memory.
class Unpacked {
 public:
  Unpacked(const File& file, const Member& member, Progress& progress) {
    handle_ = ::memfd_create("array", MFD_CLOEXEC);
    if (handle_ < 0)
      throw Error(ErrorCode::out_of_memory, file.path().string() + ": no memory for '" + member.name + "'");
    path_ = "/proc/self/fd/" + std::to_string(handle_);
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
    const auto write = [&](const char* bytes, std::size_t count) {
      made += count;
      if (made > member.size || ::write(handle_, bytes, count) != ssize_t(count))
        bad_input(file.path(), "byte " + std::to_string(member.byte),
                  "found more bytes in '" + member.name + "' than listed; the file is damaged");
    };
    for (std::uint64_t done = 0; done < member.packed && !is_over;) {
      progress.check();
      std::string in = file.read_text(member.byte + done,
                                      std::size_t(std::min<std::uint64_t>(1 << 20, member.packed - done)));
      done += in.size();
      if (!member.is_deflated) {
        write(in.data(), in.size());
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
          bad_input(file.path(), "byte " + std::to_string(member.byte + done),
                    "found an impossible deflate stream in '" + member.name + "'; the file is damaged");
        write(out.data(), out.size() - stream.avail_out);
      } while (!is_over && (stream.avail_in > 0 || stream.avail_out == 0));
    }
  }
  ~Unpacked() {
    if (handle_ >= 0) ::close(handle_);
  }
  Unpacked(const Unpacked&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  int handle_ = -1;
  std::filesystem::path path_;
};

}  // namespace

bool is_npz(std::string_view head) {
  const std::size_t name = std::string_view("PK\3\4").size() + 26;
  return head.starts_with("PK\3\4") && head.size() > name && head.substr(0, 300).find(".npy") != head.npos;
}

ReadResult read_npz(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const File file(path);
  std::vector<Column> columns;
  std::vector<std::vector<double>> values;
  std::map<std::size_t, std::size_t> numbers;  // columns of each length
  ReadResult result;
  std::uint64_t taken = 0;
  for (const Member& member : members_of(file)) {
    if (!member.name.ends_with(".npy")) continue;
    const std::string name = member.name.substr(0, member.name.size() - 4);
    // Files of zeros unpack to a thousand times their size: nobody's scan.
    taken += member.size;
    if (taken > std::max(small_member_bytes, 64 * file.size()))
      bad_input(path, "byte " + std::to_string(member.byte),
                "found arrays of more than 64 times the file's size; the file is damaged");
    const Unpacked array(file, member, progress);
    try {
      NpyValues one = read_npy_values(array.path(), progress);
      std::vector<std::string> names = one.names;
      if (names.empty()) names = columns_named(name, one.columns.size());
      for (std::size_t k = 0; k < one.columns.size(); ++k) {
        ++numbers[one.columns[k].size()];
        columns.push_back({names[k], one.types[k]});
        values.push_back(std::move(one.columns[k]));
      }
    } catch (const Error& error) {
      if (error.code() != ErrorCode::bad_input) throw;
      std::string what = error.what();
      what = what.substr(std::min(what.size(), what.find(": ") + 2));
      result.report.notes.push_back("the array '" + name + "' is left out: " + what);
    }
  }
  // The cloud is what most arrays are as long as.
  const auto most = std::max_element(numbers.begin(), numbers.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const std::size_t rows = most == numbers.end() ? 0 : most->first;
  std::vector<Column> wanted;
  std::vector<std::size_t> from;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (values[i].size() != rows) {
      result.report.notes.push_back("'" + columns[i].name +
                                    "' is left out: " + std::to_string(values[i].size()) + " numbers for " +
                                    std::to_string(rows) + " points");
      continue;
    }
    wanted.push_back(columns[i]);
    from.push_back(i);
  }
  if (!assign_roles(wanted))
    bad_input(
        path, "arrays",
        "found none called xyz, points or positions with three columns, and no x, y and z; name one so" +
            (result.report.notes.empty() ? std::string() : " (" + result.report.notes.front() + ")"));
  Table table(std::move(wanted), rows);
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::copy(values[from[i]].begin(), values[from[i]].end(), table.column(i).begin());
    values[from[i]] = {};
  }
  const std::vector<std::string> notes = std::move(result.report.notes);
  table.build(false, progress, result);
  result.report.notes.insert(result.report.notes.end(), notes.begin(), notes.end());
  return result;
}

}  // namespace sfumato::io
