// What a format brings to the table in io.cpp, and what the readers share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/file.h"
#include "io/io.h"

namespace sfumato::io {

using ReadFunction = ReadResult (*)(const std::filesystem::path&, const ReadOptions&, Progress&);
using ExcerptFunction = std::optional<ReadResult> (*)(const std::filesystem::path&, std::size_t,
                                                      const ReadOptions&, Progress&);
/// `ReadOptions::part`, or nothing where the file cannot be cut so.
using PartFunction = std::optional<ReadResult> (*)(const std::filesystem::path&, const ReadOptions&,
                                                   Progress&);
using WriteFunction = WriteReport (*)(const std::filesystem::path&, const PointCloud&, Progress&);
/// Whether a file that begins with `head` (its first 4096 bytes, or all of it) has this format.
using SniffFunction = bool (*)(std::string_view head);

/// One row of the table in io.cpp.
struct Format {
  std::string name;
  std::vector<std::string> extensions;  ///< lower case, with the dot
  std::string description;
  SniffFunction sniff = nullptr;  ///< null: known by its extension only
  ReadFunction read = nullptr;
  WriteFunction write = nullptr;
  ExcerptFunction excerpt = nullptr;
  PartFunction read_part = nullptr;  ///< null: parts are cut from what `read` gives
  bool has_faces = false;            ///< `read` fills `ReadOptions::faces`
};

/// Whether the extension of a file's name is that of a cloud.
bool has_cloud_name(const std::string& name);

/// Points by which is decided what holds for a whole file of which only a part is read: of colours beyond a
/// depth, which one in a hundred decides, they tell 1 % as .88 to 1.12 % (three standard errors).
inline constexpr std::size_t sample_points = 65'536;
/// Files of fewer are read whole for any part of them: the sample would take as long.
inline constexpr std::uint64_t least_cut_points = 4 * sample_points;

/// Error(bad_input) with the one line every reader owes its user: file, place, what is wrong, what to do.
[[noreturn]] void bad_input(const std::filesystem::path& file, const std::string& place,
                            const std::string& what);

/// Of the points that a header declares, those that the file holds where it ends early: what it lacks is
/// damage (ReadReport). Error(bad_input) where it holds none.
std::uint64_t held_points(const File& file, const std::string& place, std::uint64_t held,
                          std::uint64_t declared, ReadReport& report);

// Each of these is one file of this folder. Readers return file order and fill report.points... bounds and
// attributes; `read` fills in file and format, and subsamples.
bool is_ply(std::string_view head);
ReadResult read_ply(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);
WriteReport write_ply(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress);

bool is_pcd(std::string_view head);
ReadResult read_pcd(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);
WriteReport write_pcd(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress);

bool is_obj(std::string_view head);
ReadResult read_obj(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_stl(std::string_view head);
ReadResult read_stl(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_off(std::string_view head);
ReadResult read_off(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_expe(std::string_view head);
ReadResult read_expe(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_e57(std::string_view head);
ReadResult read_e57(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_ptx(std::string_view head);
ReadResult read_ptx(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_npy(std::string_view head);
ReadResult read_npy_points(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);
ReadResult read_floats(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_colmap_points(std::string_view head);
ReadResult read_colmap_points(const std::filesystem::path& file, const ReadOptions& options,
                              Progress& progress);

bool is_height_grid(std::string_view head);
ReadResult read_height_grid(const std::filesystem::path& file, const ReadOptions& options,
                            Progress& progress);

bool is_npz(std::string_view head);
ReadResult read_npz(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_draco(std::string_view head);
ReadResult read_draco(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_depth_image(std::string_view head);
ReadResult read_depth_image(const std::filesystem::path& file, const ReadOptions& options,
                            Progress& progress);

bool is_ept(std::string_view head);
ReadResult read_ept(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);
bool is_potree(std::string_view head);
ReadResult read_potree(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);
/// Of EPT and Potree, by tiles.
std::optional<ReadResult> read_part_of_tiles(const std::filesystem::path& file, const ReadOptions& options,
                                             Progress& progress);
bool is_vpc(std::string_view head);
ReadResult read_vpc(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

bool is_text(std::string_view head);
ReadResult read_text(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);
WriteReport write_text(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress);

WriteReport write_npy_cloud(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress);

}  // namespace sfumato::io
