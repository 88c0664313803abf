// A front end of lines: each line of standard input is a message as the page of `sfumato serve` sends it, or
// one of those below that name files; pictures are written, and the answer to a line is a line of JSON. It
// does all that the window does with a scene, by the same state.
#include <chrono>
#include <cstdio>
#include <iostream>
#include <thread>

#include "apps/cli/render_request.h"
#include "apps/picture/shot.h"
#include "apps/serve/protocol.h"
#include "apps/serve/viewer.h"
#include "core/error.h"
#include "view/workbench.h"

namespace {

using namespace sfumato;
using Json = nlohmann::ordered_json;

class Lines {
 public:
  explicit Lines(view::Start start) : bench_(std::move(start)) {
    bench_.set_size(320, 200);
    settle();
  }

  Json obey_line(const std::string& line) {
    const Json said = Json::parse(line);
    const std::string what = said.value("do", "");
    const auto text = [&](const char* name) { return said.value(name, ""); };
    if (what == "open") {
      bench_.open(said["files"].get<std::vector<std::string>>(), said.value("add", false));
    } else if (what == "preset") {
      bench_.change(what, [&](view::Wishes& next) { next.take(load_preset(text("file"))); });
    } else if (what == "save") {
      bench_.wishes().save(text("file"),
                           said.value("with_files", false) ? std::optional(bench_.camera()) : std::nullopt);
    } else if (what == "option") {
      bench_.change(text("name"), [&](view::Wishes& next) { set(next, text("name"), text("value")); });
    } else if (what == "frame") {
      bench_.show_frame(said.value("number", std::size_t(0)));
    } else if (what == "path_file") {
      said.value("save", false) ? bench_.path.save(text("file"), bench_.width(), bench_.height())
                                : bench_.path.load(text("file"));
    } else if (what != "state") {
      serve::obey(bench_, hand_, line, {});
    }
    settle();
    Json answer{{"did", what}};
    for (view::Shot& shot : bench_.shots.take()) {
      const io::PngTexts texts = finish(shot, text("file"));
      io::write_png(text("file"), shot.picture.image, false, texts);
      shot.words.insert(shot.words.begin(), "sfumato");
      shot.words.insert(shot.words.end(), {"-o", text("file")});
      answer["command"] = shot.words;
    }
    if (what == "state") answer["state"] = serve::state_of(bench_);
    for (const view::Message& each : bench_.take_messages())
      answer[each.is_error ? "errors" : "messages"].push_back(each.text);
    return answer;
  }

 private:
  /// Until everything that was asked for is shown, or refused.
  void settle() {
    using Clock = std::chrono::steady_clock;
    const auto is_there = [&] {
      return bench_.settled() && !bench_.shots.pending() && !bench_.playing() &&
             bench_.wishes().scene_key() == bench_.scene.key();
    };
    do {
      bench_.tick(1e3 * std::chrono::duration<double>(Clock::now() - began_).count());
      if (bench_.fatal()) throw Error(bench_.fatal()->code, bench_.fatal()->message);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    } while (!is_there());
  }

  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  view::Workbench bench_;
  serve::Hand hand_;
};

}  // namespace

/// The words are those of the command, without -o.
int main(int count, char** given) try {
  const cli::Words words(given + 1, given + count);
  cli::RenderRequest request(words);
  if (!request.parse(words)) return 0;
  request.check();
  view::Start start = cli::view_start(request.options, request.choice);
  start.wake = [] {};
  Lines lines(std::move(start));
  for (std::string line; std::getline(std::cin, line);) {
    Json answer;
    try {
      answer = lines.obey_line(line);
    } catch (const std::exception& error) {
      answer = {{"errors", {error.what()}}};
    }
    std::cout << answer.dump() << std::endl;
  }
} catch (const sfumato::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return int(error.code());
}
