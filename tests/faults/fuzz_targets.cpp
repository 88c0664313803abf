#include "faults/fuzz_targets.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>

#include "commands.h"
#include "core/error.h"
#include "faults/input.h"
#include "io/camera_json.h"
#include "io/io.h"
#include "session/preset.h"

namespace sfumato::test {
#ifdef SFUMATO_SERVE
void read_request(std::string_view bytes);
void read_messages(std::string_view bytes);
#endif

namespace {

[[noreturn]] void fault(const char* what) {
  std::fprintf(stderr, "FAULT: %s\n", what);
  std::abort();
}

/// An answer is a result, or one line of an error that is the input's fault.
void answer(const std::function<void()>& work, bool may_be_usage = false) {
  try {
    work();
  } catch (const Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos)
      fault("an error of several lines");
    if (error.code() == ErrorCode::bad_input) return;
    const bool is_other =
        error.code() == ErrorCode::usage || error.code() == ErrorCode::io || error.code() == ErrorCode::no_gl;
    if (may_be_usage && is_other) return;  // words that make no sense, files that are not there, no window
    fault(error.what());
  } catch (const std::exception& error) {
    fault(error.what());
  }
}

// Files of one process have one folder; it stays empty but for them.
const MemoryFolder& folder() {
  static const MemoryFolder kept;
  return kept;
}

template <const char* extension>
void read_cloud(std::string_view bytes) {
  static const MemoryFolder::File file(folder(), std::string("input") + extension);
  file.set(bytes);
  answer([] { io::read(file.path()); });
}

constexpr char las[] = ".las", laz[] = ".laz", copc[] = ".copc.laz", ply[] = ".ply", pcd[] = ".pcd",
               obj[] = ".obj", off[] = ".off", stl[] = ".stl", vtk[] = ".vtk", vtp[] = ".vtp", e57[] = ".e57",
               ptx[] = ".ptx", pts[] = ".pts", expe[] = ".pts", text[] = ".xyz", npy[] = ".npy",
               npz[] = ".npz", draco[] = ".drc", kitti[] = ".bin", grid[] = ".asc", colmap[] = ".bin",
               splat[] = ".splat", ksplat[] = ".ksplat", spz[] = ".spz", nvm[] = ".nvm";

void read_mesh(std::string_view bytes) {
  // Text tells its format itself.
  static const MemoryFolder::File ply_file(folder(), "mesh.ply"), obj_file(folder(), "mesh.obj"),
      stl_file(folder(), "mesh.stl"), drc_file(folder(), "mesh.drc");
  const MemoryFolder::File& file = bytes.starts_with("ply")                     ? ply_file
                                   : bytes.starts_with("DRACO")                 ? drc_file
                                   : bytes.find('\0') != std::string_view::npos ? stl_file
                                                                                : obj_file;
  file.set(bytes);
  answer([&] { io::read_mesh(file.path()); });
}

// Up to the first zero byte the description, behind it the picture.
void read_depth(std::string_view bytes) {
  static const MemoryFolder::File file(folder(), "depth.json"), picture(folder(), "d.png");
  const std::size_t cut = std::min(bytes.find('\0'), bytes.size());
  file.set(bytes.substr(0, cut));
  picture.set(bytes.substr(std::min(cut + 1, bytes.size())));
  answer([] { io::read(file.path()); }, true);  // other pictures that it names are not there
}

void read_exr(std::string_view bytes) {
  static const MemoryFolder::File file(folder(), "exr.json"), picture(folder(), "d.exr");
  file.set(R"({"depth": "d.exr", "fx": 2, "fy": 4, "cx": 1, "cy": 0})");
  picture.set(bytes);
  answer([] { io::read(file.path()); });
}

void read_camera(std::string_view bytes) {
  static const MemoryFolder::File file(folder(), "path.json");
  answer([&] { io::camera_from_json(bytes, "camera"); });
  file.set(bytes);
  answer([] { io::read_camera_path(file.path()); });
}

void read_preset(std::string_view bytes) {
  static const MemoryFolder::File file(folder(), "preset.json");
  file.set(bytes);
  answer([] { load_preset(file.path()); });
}

// A word a line; no word names a file that is there, so that nothing is drawn.
void read_command_line(std::string_view bytes) {
  static const bool is_quiet = [] {
    setenv("SFUMATO_CONFIG", "", 1);
    return std::freopen("/dev/null", "w", stdout) != nullptr;
  }();
  if (!is_quiet || bytes.find('/') != std::string_view::npos) return;
  static const MemoryFolder::File nothing(folder(), "nothing");
  if (chdir(nothing.path().parent_path().c_str()) != 0) fault("no folder to stand in");
  cli::Words words;
  while (!bytes.empty() && words.size() < 64) {
    const std::size_t cut = std::min(bytes.find('\n'), bytes.size());
    words.emplace_back(bytes.substr(0, cut));
    bytes.remove_prefix(std::min(cut + 1, bytes.size()));
  }
  const bool is_info = !words.empty() && words[0] == "info",
             is_convert = !words.empty() && words[0] == "convert";
  if (is_info || is_convert) words.erase(words.begin());
  for (const std::string& word : words)
    if (word.find('-') == 0 && word.size() == 1) return;  // standard input
  words.insert(words.begin(), "absent.ply");
  answer(
      [&] {
        is_info      ? cli::info_command(words)
        : is_convert ? cli::convert_command(words)
                     : cli::render_command(words);
      },
      true);
}

}  // namespace

const std::map<std::string, FuzzTarget>& fuzz_targets() {
  static const std::map<std::string, FuzzTarget> all = {{"las", read_cloud<las>},
                                                        {"laz", read_cloud<laz>},
                                                        {"copc", read_cloud<copc>},
                                                        {"ply", read_cloud<ply>},
                                                        {"pcd", read_cloud<pcd>},
                                                        {"obj", read_cloud<obj>},
                                                        {"off", read_cloud<off>},
                                                        {"stl", read_cloud<stl>},
                                                        {"vtk", read_cloud<vtk>},
                                                        {"vtp", read_cloud<vtp>},
                                                        {"e57", read_cloud<e57>},
                                                        {"ptx", read_cloud<ptx>},
                                                        {"pts", read_cloud<pts>},
                                                        {"expe", read_cloud<expe>},
                                                        {"text", read_cloud<text>},
                                                        {"npy", read_cloud<npy>},
                                                        {"kitti", read_cloud<kitti>},
                                                        {"grid", read_cloud<grid>},
                                                        {"colmap", read_cloud<colmap>},
                                                        {"splat", read_cloud<splat>},
                                                        {"ksplat", read_cloud<ksplat>},
                                                        {"spz", read_cloud<spz>},
                                                        {"nvm", read_cloud<nvm>},
                                                        {"npz", read_cloud<npz>},
                                                        {"draco", read_cloud<draco>},
                                                        {"mesh", read_mesh},
                                                        {"depth", read_depth},
                                                        {"exr", read_exr},
                                                        {"camera", read_camera},
                                                        {"preset", read_preset},
#ifdef SFUMATO_SERVE
                                                        {"http", read_request},
                                                        {"websocket", read_messages},
#endif
                                                        {"command_line", read_command_line}};
  return all;
}

}  // namespace sfumato::test
