// sfumato doctor: what the graphics driver can do, and what to do when something lacks.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "core/version.h"
#include "gl/context.h"
#include "passes/screen_pass.h"

namespace sfumato::cli {

int doctor_command(const Words& words) {
  bool json = false;
  CommandLine line("sfumato doctor", "Checks the graphics driver. Exit code 4 when no OpenGL 4.5 is usable.");
  line.flag("--json", json, "machine-readable");
  if (!line.parse(words)) return 0;
  const auto context = gl::Context::create_headless();
  const gl::Limits& l = context->limits();
  if (json) {
    const nlohmann::ordered_json report = {
        {"version", version()},
        {"gl_version", l.version},
        {"renderer", l.renderer},
        {"vendor", l.vendor},
        {"software", l.software},
        {"max_texture_size", l.max_texture_size},
        {"max_texture_buffer_size", l.max_texture_buffer_size},
        {"max_storage_block_size", l.max_storage_block_size},
        {"max_work_groups", l.max_work_groups},
        {"float_atomics", l.float_atomics},
        {"screen_filters", default_screen_pass_kind() == ScreenPassKind::compute ? "compute" : "fragment"}};
    print(report.dump(2) + "\n");
    return 0;
  }
  std::string text;
  auto row = [&](const char* key, const std::string& value) {
    text += fmt::format("{:<26}{}\n", key, value);
  };
  row("sfumato", version());
  row("GL version", l.version);
  row("renderer", l.renderer);
  row("vendor", l.vendor);
  row("kind", l.software ? "software (every technique works; a GPU driver would be faster)" : "GPU");
  row("largest texture", fmt::format("{} px", l.max_texture_size));
  row("largest texture buffer", fmt::format("{} texels", l.max_texture_buffer_size));
  row("largest storage buffer", fmt::format("{:.0f} MiB", double(l.max_storage_block_size) / (1 << 20)));
  row("work groups per axis", std::to_string(l.max_work_groups));
  row("fast: float atomics",
      l.float_atomics ? "yes, used by --fast where a technique can" : "no, --fast has no effect");
  row("fast: screen filters",
      default_screen_pass_kind() == ScreenPassKind::compute ? "compute passes" : "fragment passes");
  if (l.software)
    text +=
        "\nTo use a GPU: install its driver (Mesa: libgl1-mesa-dri and libegl-mesa0; NVIDIA: libnvidia-egl "
        "or the\n"
        "vendor's package with EGL) and give this user access to /dev/dri/renderD* (groups render, video).\n";
  print(text);
  return 0;
}

}  // namespace sfumato::cli
