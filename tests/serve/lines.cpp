// A front end of lines: each line of standard input is a message as the page of `sfumato serve` sends it, or
// one of those below that name files; pictures are written, and the answer to a line is a line of JSON. It
// does all that the window does with a scene, by the same state.
#include <chrono>
#include <cstdio>
#include <iostream>
#include <thread>

#include "apps/cli/render_request.h"
#include "apps/picture/saved_picture.h"
#include "apps/serve/protocol.h"
#include "apps/serve/viewer.h"
#include "core/error.h"
#include "view/view_model.h"

namespace {

using namespace sfumato;
using Json = nlohmann::ordered_json;

class Lines {
 public:
  explicit Lines(view::Start start) : model_(std::move(start)) {
    model_.set_size(320, 200);
    settle();
  }

  Json obey_line(const std::string& line) {
    const Json said = Json::parse(line);
    const std::string what = said.value("do", "");
    const auto text = [&](const char* name) { return said.value(name, ""); };
    if (what == "open") {
      model_.open(said["files"].get<std::vector<std::string>>(), said.value("add", false));
    } else if (what == "preset") {
      model_.change(what, [&](view::ViewRequest& next) { next.take(load_preset(text("file"))); });
    } else if (what == "save") {
      model_.request().save(text("file"),
                            said.value("with_files", false) ? std::optional(model_.camera()) : std::nullopt);
    } else if (what == "option") {
      model_.change(text("name"), [&](view::ViewRequest& next) { set(next, text("name"), text("value")); });
    } else if (what == "frame") {
      model_.show_frame(said.value("number", std::size_t(0)));
    } else if (what == "path_file") {
      said.value("save", false) ? model_.path.save(text("file"), model_.width(), model_.height())
                                : model_.path.load(text("file"));
    } else if (what != "state") {
      serve::obey(model_, hand_, line, {});
    }
    settle();
    Json answer{{"did", what}};
    for (view::SavedPicture& shot : model_.saved_pictures.take()) {
      const io::PngTexts texts = finish(shot, text("file"));
      io::write_png(text("file"), shot.picture.image, false, texts);
      shot.words.insert(shot.words.begin(), "sfumato");
      shot.words.insert(shot.words.end(), {"-o", text("file")});
      answer["command"] = shot.words;
    }
    if (what == "state") answer["state"] = serve::state_of(model_);
    for (const view::Message& each : model_.take_messages())
      answer[each.is_error ? "errors" : "messages"].push_back(each.text);
    return answer;
  }

 private:
  /// Until everything that was asked for is shown, or refused.
  void settle() {
    using Clock = std::chrono::steady_clock;
    const auto is_there = [&] {
      return model_.settled() && !model_.saved_pictures.pending() && !model_.playing() &&
             model_.request().scene_key() == model_.scene.key();
    };
    do {
      model_.tick(1e3 * std::chrono::duration<double>(Clock::now() - began_).count());
      if (model_.fatal()) throw Error(model_.fatal()->code, model_.fatal()->message);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    } while (!is_there());
  }

  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  view::ViewModel model_;
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
