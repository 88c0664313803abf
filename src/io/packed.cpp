// Files inside others: gzip, and zips of one cloud.
#include <sys/stat.h>
#include <zlib.h>

#include <mutex>
#include <new>

#include "io/format.h"
#include "io/zip.h"

namespace sfumato::io {
namespace {

/// Of any number of gzip streams behind each other, as `cat` makes them and bgzip does.
std::shared_ptr<ByteSource> gunzipped(const ByteSource& file, const std::filesystem::path& path) {
  const int handle = open_temporary();
  z_stream stream{};
  if (::inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, ::inflateEnd);
  std::shared_ptr<ByteSource> result = disk_source(handle, path);
  std::string in(1 << 20, '\0'), out(1 << 20, '\0');
  bool is_over = false;
  for (std::uint64_t done = 0; done < file.size;) {
    const auto count = std::size_t(std::min<std::uint64_t>(in.size(), file.size - done));
    file.read(done, std::as_writable_bytes(std::span(in.data(), count)));
    done += count;
    stream.next_in = reinterpret_cast<Bytef*>(in.data());
    stream.avail_in = uInt(count);
    while (stream.avail_in > 0) {
      if (is_over) {
        if (*stream.next_in == 0) {  // padding
          ++stream.next_in, --stream.avail_in;
          continue;
        }
        ::inflateReset(&stream), is_over = false;
      }
      stream.next_out = reinterpret_cast<Bytef*>(out.data());
      stream.avail_out = uInt(out.size());
      const int got = ::inflate(&stream, Z_NO_FLUSH);
      is_over = got == Z_STREAM_END;
      if (got != Z_OK && !is_over && got != Z_BUF_ERROR)
        bad_input(path, "byte " + std::to_string(done - stream.avail_in),
                  "found an impossible gzip stream; the file is damaged, fetch it again");
      append_to(handle, out.data(), out.size() - stream.avail_out);
      result->size += out.size() - stream.avail_out;
    }
  }
  if (!is_over)
    bad_input(path, "byte " + std::to_string(file.size),
              "the gzip stream ends in its middle; the file is truncated, fetch it again");
  return result;
}

std::shared_ptr<ByteSource> unzipped(const ByteSource& file, const std::filesystem::path& path) {
  const ZipMember* cloud = nullptr;
  std::string names;
  std::size_t count = 0;
  const std::vector<ZipMember> members = zip_members(file, path);
  for (const ZipMember& member : members) {
    if (member.name.ends_with(".npy")) return nullptr;  // .npz: arrays of one cloud
    if (!has_cloud_name(member.name)) continue;
    if (++count <= 3) names += (names.empty() ? "" : ", ") + member.name;
    cloud = &member;
  }
  if (count != 1)
    bad_input(path, "zip",
              count == 0 ? "holds no point cloud among its " + std::to_string(members.size()) +
                               " files; unpack it and name what is to be read"
                         : "holds " + std::to_string(count) + " point clouds (" + names +
                               (count > 3 ? " ..." : "") + "); unpack it and name them");
  const int handle = open_temporary();
  std::shared_ptr<ByteSource> result = disk_source(handle, path);
  unpack(file, path, *cloud, [&](std::span<const char> bytes) {
    append_to(handle, bytes.data(), bytes.size());
    result->size += bytes.size();
  });
  if (result->size != cloud->size)
    bad_input(path, "byte " + std::to_string(cloud->byte),
              "found " + std::to_string(result->size) + " bytes in '" + cloud->name + "', expected " +
                  std::to_string(cloud->size) + "; the file is damaged, fetch it again");
  result->name = cloud->name;
  return result;
}

/// The last one, by what tells the files apart.
struct Kept {
  std::mutex mutex;
  std::string key;
  std::shared_ptr<ByteSource> source;
};

}  // namespace

std::shared_ptr<ByteSource> unpacked_source(const std::shared_ptr<ByteSource>& file,
                                            const std::filesystem::path& path) {
  char head[4] = {};
  if (file->size < 22) return nullptr;
  file->read(0, std::as_writable_bytes(std::span(head)));
  const std::string_view begin(head, 4);
  const bool is_gzip = begin.starts_with("\x1f\x8b\x08"), is_zip = begin == "PK\3\4";
  if (!is_gzip && !is_zip) return nullptr;
  static Kept kept;
  const std::lock_guard lock(kept.mutex);
  struct stat info {};
  const bool known = ::stat(path.c_str(), &info) == 0 && !path.string().starts_with("/proc/");
  const std::string key =
      path.string() + ":" + std::to_string(file->size) +
      (known ? ":" + std::to_string(info.st_ino) + ":" + std::to_string(info.st_mtim.tv_sec) + "." +
                   std::to_string(info.st_mtim.tv_nsec)
             : std::string());
  if ((known || is_remote(path)) && kept.source && kept.key == key) return kept.source;
  kept.source.reset();  // room on the disk
  std::shared_ptr<ByteSource> source = is_gzip ? gunzipped(*file, path) : unzipped(*file, path);
  if (is_gzip) {
    const std::string name = file->name.string();
    source->name = name.ends_with(".gz") || name.ends_with(".GZ") ? name.substr(0, name.size() - 3) : name;
  }
  kept.key = key;
  return kept.source = source;
}

}  // namespace sfumato::io
