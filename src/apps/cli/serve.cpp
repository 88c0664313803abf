// sfumato serve FILE...: the same scene, look and first view in a browser.
#ifdef SFUMATO_SERVE
#include "../serve/server.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "commands.h"
#include "console.h"
#include "core/error.h"
#include "core/param.h"
#include "render_request.h"

namespace sfumato::cli {
namespace {

bool is_parameter(const std::string& option) {
  std::string name = option.substr(std::min(option.size(), option.find('.') + 1));
  if (!techniques_with(name).empty()) return true;
  Choice choice("points");
  std::replace(name.begin(), name.end(), '-', '_');
  return !choice.find(name).empty();
}

/// Of options that are served, and of parameters of techniques and of the analysis.
Words words_of(const serve::Query& query) {
  Words words;
  for (const auto& [name, value] : query) {
    const Option* option = find_option(name);
    if (!(option && option->served) && !is_parameter(name))
      throw Error(ErrorCode::usage,
                  "'" + name + "' is no option of a picture that is asked for here; see openapi.json");
    words.push_back("--" + name + (value.empty() ? "" : "=" + value));
  }
  return words;
}

/// Parsed and checked, as of a command that begins with these files.
std::unique_ptr<RenderRequest> request_of(Words words, const Words& files, const std::string& preset) {
  words.insert(words.begin(), files.begin(), files.end());
  if (!preset.empty()) words.push_back("--preset=" + preset);
  auto request = std::make_unique<RenderRequest>(words);
  request->parse(words);
  request->check();
  return request;
}

}  // namespace

int serve_command(const Words& words) {
  RenderRequest request(words, "sfumato serve", "Shows point clouds in browsers, rendered on this machine.");
  RenderOptions& options = request.options;
  CommandLine& line = request.line;
  serve::Settings settings;
  std::string port = "8080", clients = "16", selections = "4";
  bool is_open = false;
  line.group("Serving");
  line.text("--port", port, "N", "TCP port; 0 takes a free one (8080)");
  line.text("--bind", settings.address, "ADDRESS",
            "interface, as an IP address; 0.0.0.0: reachable from other machines (127.0.0.1)");
  line.texts("--host", settings.hosts, "NAME",
             "an additional host name that requests may use, as behind a proxy");
  line.flag("--open", is_open, "open the address in a browser of this machine");
  line.flag("--share", settings.share, "all pages share one view and show each other's pointers");
  line.text("--clients", clients, "N", "most pages at a time (16)");
  line.text("--selections", selections, "N",
            "most selections of points (classes, boxes, items) in memory at a time (4)");
  line.usage("sfumato serve FILE... [--port N] [--open] [-t TECHNIQUE]");
  line.footer(
      "It prints one address, with the token that gives access. Other machines reach it through\n"
      "  ssh -L 8080:127.0.0.1:8080 SERVER\n"
      "and the same address. docs/serve.md has more.");
  request.exclude({"output",        "output-panels", "output-depth", "depth-unit", "output-index",
                   "output-normal", "output-camera", "world-file",   "quality",    "path",
                   "frames",        "degrees",       "sequence",     "each",       "watch",
                   "panorama",      "save-preset",   "save-scene",   "json",       "timings"},
                  "serve, which shows one scene in browsers, whose page saves pictures");
  if (!request.parse(words)) return 0;
  settings.port = int(parse_whole("--port", port, 0));
  if (settings.port > 65535) throw Error(ErrorCode::usage, "--port: " + port + " is more than 65535");
  settings.clients = std::size_t(std::min(1000L, parse_whole("--clients", clients, 1)));
  settings.selections = std::size_t(std::min(100L, parse_whole("--selections", selections, 1)));
  settings.opens_browser = is_open;
  settings.verbose = options.common.verbose;
  settings.token = serve::new_token();
  char name[256] = "";
  if (::gethostname(name, sizeof name - 1) == 0 && settings.address != "127.0.0.1")
    settings.hosts.push_back(name);
  if (options.files.empty() && options.scene.empty())
    throw Error(ErrorCode::usage, "serve what? name a file: sfumato serve FILE...");
  request.check();
  Console console(options.common);
  serve::Sources sources;
  sources.announce = [](const std::string& address) { print(address + "\n"), std::fflush(stdout); };
  sources.say = [&](const std::string& text) { console.say("sfumato: " + text); };
  sources.start = view_start(options, request.choice);
  sources.picture = [&](const serve::Query& query) {
    const auto asked = request_of(words_of(query), options.files, options.preset);
    serve::PictureRequest wanted;
    wanted.start = view_start(asked->options, asked->choice);
    wanted.start.request.placed = sources.start.request.placed;
    if (const auto& size = asked->options.view.size) std::tie(wanted.width, wanted.height) = *size;
    const int most = settings.limits.saved_side_px;
    if (wanted.width > most || wanted.height > most)
      throw Error(ErrorCode::usage, fmt::format("resolution: at most {0}x{0}", most));
    return wanted;
  };
  const int code = serve::run(settings, sources);
  if (!view::Loader::has_left_work()) return code;
  std::fflush(nullptr);
  std::_Exit(code);
}

}  // namespace sfumato::cli
#endif
