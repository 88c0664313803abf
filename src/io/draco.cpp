// Draco point clouds and meshes (.drc). A decoder process does it (docs/adr/0130): the library has no place
// in ours.
#include <algorithm>
#include <charconv>
#include <optional>

#include "io/columns.h"
#include "io/decoder_pool.h"
#include "io/faces.h"
#include "io/file.h"
#include "io/format.h"
#include "io/number_at.h"

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

/// Decodes what is wanted of a file: `begin(columns, rows, is_mesh)`, then `take(bytes, count, first)` for
/// each block, of records as long as the columns say.
template <class Begin, class Take>
void decode_draco(const File& file, Decode what, Progress& progress, const Begin& begin, const Take& take) {
  DecoderJob job;
  const std::span<std::uint8_t> input = job.make_room(std::size_t(file.size()), block_size);
  file.read(0, std::as_writable_bytes(input));
  DecodeJob wanted;
  wanted.what = what;
  wanted.input_size = file.size();
  wanted.points = 10 * file.size();  // which bounds its time: most points take more than a tenth of a byte
  job.begin(wanted, least_memory + memory_of_byte * file.size());
  const DecodeReply reply = job.fields(progress);
  std::vector<Column> columns = columns_of(reply.text);
  if (columns.empty()) throw DecodeFault("a decoder out of step");
  const std::size_t record = columns.front().stride, most = block_size / record;
  if (reply.total > 0xFFFFFFFFull ||
      reply.total * record > std::max(trusted_bytes, trusted_ratio * file.size()))
    throw DecodeFault(std::to_string(reply.total) + " points or faces, more than its bytes can hold,");
  const auto rows = std::size_t(reply.total);
  begin(std::move(columns), rows, reply.points != 0);
  for (std::size_t done = 0; done < rows;) {
    const std::span<std::uint8_t> block = job.next(std::min(most, rows - done), record, progress);
    const std::size_t count = block.size() / record;
    take(reinterpret_cast<const std::byte*>(block.data()), count, done);
    done += count;
    progress.update(double(done) / double(rows),
                    what == Decode::draco ? "decoding points" : "decoding faces");
  }
  job.done();
}

[[noreturn]] void fail_draco(const std::filesystem::path& path, const std::string& what) {
  bad_input(path, "byte 0", "found " + what + " in a Draco file; it is truncated or damaged");
}

Faces read_draco_faces(const File& file, const ReadResult& vertices, std::uint64_t records,
                       Progress& progress) {
  FaceBuilder builder(vertices.cloud, kept_vertices(vertices.cloud, records));
  try {
    Polygon polygon;
    decode_draco(
        file, Decode::draco_faces, progress,
        [](const std::vector<Column>& columns, std::size_t, bool) {
          const bool are_places =
              columns.size() == 3 && std::all_of(columns.begin(), columns.end(), [](const Column& column) {
                return column.layout == StoredType::uint32;
              });
          if (!are_places) throw DecodeFault("a decoder out of step");
        },
        [&](const std::byte* bytes, std::size_t count, std::size_t) {
          for (std::size_t i = 0; i < count; ++i) {
            polygon.clear();
            for (std::size_t corner = 0; corner < 3; ++corner)
              polygon.vertices.push_back(
                  number_at<std::uint32_t>(bytes + (3 * i + corner) * sizeof(std::uint32_t)));
            builder.add(polygon, [] { return "byte 0"; });
          }
        });
  } catch (const DecodeFault& fault) {
    fail_draco(file.path(), fault.what());
  }
  return std::move(builder.faces);
}

}  // namespace

bool is_draco(std::string_view head) { return head.starts_with("DRACO"); }

ReadResult read_draco(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  const File file(path);
  if (const std::string reason = why_no_decoders(); !reason.empty())
    throw Error(ErrorCode::usage,
                path.string() + ": Draco needs a decoder process, and there is none: " + reason);
  ReadResult result;
  std::optional<CloudBuilder> builder;
  std::vector<CloudBuilder::Cursor> cursors;
  std::uint64_t records = 0;
  bool is_mesh = false;
  try {
    decode_draco(
        file, Decode::draco, progress,
        [&](std::vector<Column> columns, std::size_t rows, bool mesh) {
          if (!assign_roles(columns)) throw DecodeFault("no positions of three numbers");
          builder.emplace(std::move(columns), rows, false, mesh && options.faces);
          cursors.push_back(builder->cursor(0, rows));
          records = rows, is_mesh = mesh;
        },
        [&](const std::byte* bytes, std::size_t count, std::size_t first) {
          builder->decode(cursors[0], bytes, 0, count, first);
        });
  } catch (const DecodeFault& fault) {
    fail_draco(path, fault.what());
  }
  builder->finish(cursors, result);
  result.has_faces = is_mesh;
  if (is_mesh) result.cloud.up = UpAxis::pos_y, result.cloud.provenance = Provenance::model;
  if (is_mesh && options.faces)
    take_faces(file, options, result, [&] { return read_draco_faces(file, result, records, progress); });
  return result;
}

}  // namespace sfumato::io
