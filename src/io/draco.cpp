// Draco point clouds (.drc), and the vertices of Draco meshes. A decoder process does it (docs/adr/0130): the
// library has no place in ours.
#include <algorithm>
#include <charconv>

#include "io/columns.h"
#include "io/decoder_pool.h"
#include "io/file.h"
#include "io/format.h"

namespace sfumato::io {
namespace {

constexpr std::size_t block_size = 4 << 20;
// What Draco may take to decode: attributes of all points at once, some of them twice.
constexpr std::uint64_t least_memory = 192 << 20, memory_of_byte = 64;
// Beyond so many bytes of points for one byte of the file, or so few of them, a count is damage.
constexpr std::uint64_t trusted_bytes = 16 << 20, trusted_ratio = 64;

/// "x 6;y 6;z 6;": the columns of packed records.
std::vector<Column> columns_of(std::string_view text) {
  std::vector<Column> columns;
  std::size_t offset = 0;
  while (!text.empty()) {
    const std::string_view one = text.substr(0, text.find(';'));
    text.remove_prefix(std::min(one.size() + 1, text.size()));
    const std::size_t space = one.find(' ');
    int type = -1;
    if (space == one.npos ||
        std::from_chars(one.data() + space + 1, one.data() + one.size(), type).ec != std::errc() ||
        type < 0 || type > int(StoredType::int64))
      throw DecodeFault("a decoder out of step");
    columns.push_back({std::string(one.substr(0, space)), StoredType(type), StoredType(type), offset, 0});
    offset += size_of(StoredType(type));
  }
  for (Column& column : columns) column.stride = offset;
  return columns;
}

}  // namespace

bool is_draco(std::string_view head) { return head.starts_with("DRACO"); }

ReadResult read_draco(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const File file(path);
  if (const std::string reason = why_no_decoders(); !reason.empty())
    throw Error(ErrorCode::usage,
                path.string() + ": Draco needs a decoder process, and there is none: " + reason);
  const auto fail = [&](const std::string& what) {
    bad_input(path, "byte 0", "found " + what + " in a Draco file; it is truncated or damaged");
  };
  ReadResult result;
  try {
    DecoderJob job;
    const std::span<std::uint8_t> input = job.make_room(std::size_t(file.size()), block_size);
    file.read(0, std::as_writable_bytes(input));
    DecodeJob wanted;
    wanted.what = Decode::draco;
    wanted.input_size = file.size();
    wanted.points = 10 * file.size();  // which bounds its time: most points take more than a tenth of a byte
    job.begin(wanted, least_memory + memory_of_byte * file.size());
    const DecodeReply reply = job.fields(progress);
    std::vector<Column> columns = columns_of(reply.text);
    if (!assign_roles(columns)) fail("no positions of three numbers");
    const std::size_t record = columns.front().stride, most = block_size / record;
    if (reply.total > 0xFFFFFFFFull ||
        reply.total * record > std::max(trusted_bytes, trusted_ratio * file.size()))
      fail(std::to_string(reply.total) + " points, more than its bytes can hold,");
    const auto rows = std::size_t(reply.total);
    CloudBuilder builder(std::move(columns), rows);
    std::vector<CloudBuilder::Cursor> cursors{builder.cursor(0, rows)};
    for (std::size_t done = 0; done < rows;) {
      const std::span<std::uint8_t> block = job.next(std::min(most, rows - done), record, progress);
      const std::size_t count = block.size() / record;
      builder.decode(cursors[0], reinterpret_cast<const std::byte*>(block.data()), 0, count, done);
      done += count;
      progress.update(double(done) / double(rows), "decoding points");
    }
    job.done();
    builder.finish(cursors, result);
  } catch (const DecodeFault& fault) {
    fail(fault.what());
  }
  return result;
}

}  // namespace sfumato::io
