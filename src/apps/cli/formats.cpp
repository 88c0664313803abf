// sfumato formats: what is read and written.
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "help_text.h"
#include "io/io.h"

namespace sfumato::cli {

int formats_command(const Words& words) {
  bool json = false;
  CommandLine line("sfumato formats", "Lists the formats of clouds and pictures.");
  line.flag("--json", json, "machine-readable");
  if (!line.parse(words)) return 0;
  if (json) {
    auto list = nlohmann::ordered_json::array();
    for (const io::FormatInfo& format : io::formats())
      list.push_back({{"name", format.name},
                      {"extensions", split(format.extensions, ' ')},
                      {"read", format.can_read},
                      {"write", format.can_write},
                      {"description", format.description}});
    print(list.dump(2) + "\n");
    return 0;
  }
  const int width = terminal_width();
  std::vector<std::pair<std::string, std::string>> read, written;
  for (const io::FormatInfo& format : io::formats()) {
    if (format.can_read) read.emplace_back(format.extensions, format.description);
    if (format.can_write) written.emplace_back(format.extensions, format.description);
  }
  std::string text = "Clouds that are read (content decides before the extension)\n" + rows(read, width, 28);
  text += rows({{".gz .zip", "any of them packed; a zip of one"},
                {"http:// https://", "any of them at a server; of COPC only what the view shows"}},
               width, 28);
  text += "\nClouds that are written (sfumato convert IN... -o OUT)\n" + rows(written, width, 28);
  text += "\nPictures (-o)\n" + rows({{".png", "8-bit sRGB; with the command that made it inside"},
                                      {".jpg .jpeg .webp", "8-bit sRGB (--quality)"},
                                      {".tif .tiff", "8-bit sRGB, a plan as GeoTIFF"},
                                      {".exr", "32-bit float: linear colour, depth Z, normals N.X N.Y N.Z"},
                                      {".npy", "float32 array (height, width, 4), linear"}},
                                     width, 28);
  text +=
      "\nDepth (--output-depth)\n" +
      rows({{".npy", "float32 array (height, width), infinite where nothing is"},
            {".exr", "32-bit float channel Z"},
            {".png",
             "16-bit grey, 0 where nothing is, near 1 to far 65535; the texts DepthNear and DepthFar hold "
             "both ends in scene units; or steps of --depth-unit"}},
           width, 28);
  print(text);
  return 0;
}

}  // namespace sfumato::cli
