// sfumato --version: what to put into a report of something that went wrong.
#include <fmt/format.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include "commands.h"
#include "commit.h"
#include "core/error.h"
#include "core/version.h"
#include "gl/context.h"
#include "help_text.h"
#include "io/libraries.h"

namespace sfumato::cli {

std::string version_text() {
  std::string text = fmt::format("sfumato {}\n", version());
  const auto row = [&](const std::string& key, const std::string& value) {
    text += fmt::format("{:<10}{}\n", key, value);
  };
  row("commit", SFUMATO_COMMIT);
  try {
    const auto context = gl::Context::create_headless();
    row("OpenGL", context->limits().version + ", " + context->limits().renderer);
  } catch (const Error&) {
    row("OpenGL", "none that can be used (sfumato doctor says why)");
  }
  std::string libraries;
  for (const auto& [name, version] : io::library_versions()) libraries += name + " " + version + ", ";
  libraries += fmt::format("FreeType {}.{}.{}, fmt {}.{}.{}", FREETYPE_MAJOR, FREETYPE_MINOR, FREETYPE_PATCH,
                           FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100);
  text += wrap("libraries " + libraries, terminal_width(), 10) + "\n";
  return text;
}

}  // namespace sfumato::cli
