// NumPy's .npz: a zip of arrays. Which array is what, its name says: xyz (or points, positions, coords,
// vertices), rgb (colors), normals, all of three columns; lists of numbers are scalars by their own name, x,
// y, z among them.
#include <sys/mman.h>
#include <unistd.h>
#include <algorithm>
#include <map>

#include "io/file.h"
#include "io/format.h"
#include "io/npy_array.h"
#include "io/table.h"
#include "io/zip.h"

namespace sfumato::io {
namespace {

constexpr std::uint64_t small_member_bytes = 64 << 20;

/// An array of the zip as a file of its own, in memory.
class Unpacked {
 public:
  Unpacked(const File& file, const ZipMember& member, Progress& progress) {
    handle_ = ::memfd_create("array", MFD_CLOEXEC);
    if (handle_ < 0)
      throw Error(ErrorCode::out_of_memory, file.path().string() + ": no memory for '" + member.name + "'");
    path_ = "/proc/self/fd/" + std::to_string(handle_);
    unpack(
        file.source(), file.path(), member,
        [&](std::span<const char> bytes) { append_to(handle_, bytes.data(), bytes.size()); }, progress);
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
  for (const ZipMember& member : zip_members(file.source(), path)) {
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
