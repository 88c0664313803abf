#include "viewer.h"

#include <algorithm>

#include "../picture/saved_picture.h"
#include "../publish/depth_text.h"
#include "core/color.h"
#include "io/image_file.h"

namespace sfumato::serve {
namespace {

using Json = nlohmann::ordered_json;

/// Panels need no more; every picture comes with what it is.
constexpr double state_ms = 60;
/// Between the corners of the sheet that a page bends until the next picture comes.
constexpr int depth_step_px = 8;

/// Means of so many pixels by so many.
Image<Rgba8> smaller(const Image<Rgba8>& image, int by) {
  if (by <= 1 || image.width() < by || image.height() < by) return image;
  Image<Rgba8> out(image.width() / by, image.height() / by);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      int r = 0, g = 0, b = 0;
      for (int k = 0; k < by * by; ++k) {
        const Rgba8& c = image.at(x * by + k % by, y * by + k / by);
        r += c.r, g += c.g, b += c.b;
      }
      const int n = by * by;
      out.at(x, y) = {std::uint8_t(r / n), std::uint8_t(g / n), std::uint8_t(b / n), 255};
    }
  return out;
}

}  // namespace

void Viewer::begin(std::shared_ptr<view::SharedScenes> shared) {
  if (model_) start_.request = model_->request();
  model_.reset();
  sent_.reset();
  start_.shared = std::move(shared);
  start_.depth_step = depth_step_px;
  model_ = std::make_unique<view::ViewModel>(start_);
  if (!size_message_.empty()) obey(*model_, hand_, size_message_, outside_.limits);
}

void Viewer::hear(std::string_view text, double now_ms) {
  ++heard_;
  if (text.starts_with(R"({"do":"size")")) size_message_ = text;
  if (!model_) return;  // what is pressed before there is a picture has nothing to act on
  const view::ViewRequest before = model_->request();
  hand_.confirmed = 0, hand_.wants_command = hand_.pointed = false;
  obey(*model_, hand_, text, outside_.limits);
  if (hand_.confirmed) pace_.confirmed(hand_.confirmed, now_ms);
  if (hand_.wants_command) {
    const std::vector<std::string> words = model_->request().words(model_->width(), model_->height());
    outside_.send_text(Json{{"command", command_of(words, "picture.png")}}.dump());
  }
  const view::SceneKey key = model_->request().scene_key();
  if (key != before.scene_key() && !outside_.may_show(key)) {
    model_->change("refused", [&](view::ViewRequest& next) { next = before; });
    model_->say("the server's limit of selections of points is reached (--selections); undo one, or wait",
                true);
  }
}

void Viewer::follow(const view::ViewRequest& request) {
  if (!model_) return void(start_.request = request);
  model_->change("together", [&](view::ViewRequest& next) { next = request; });
  model_->repaint();
}

const std::optional<view::Failure>& Viewer::fatal() const {
  static const std::optional<view::Failure> none;
  return model_ ? model_->fatal() : none;
}

std::optional<double> Viewer::wait_ms(double now_ms) const {
  if (!model_) return std::nullopt;
  std::optional<double> wait = model_->wait_ms(now_ms);
  if (now_ms - told_ms_ < state_ms) wait = std::min(wait.value_or(state_ms), state_ms);
  return wait;
}

void Viewer::tick(double now_ms) {
  if (!model_) return;
  model_->tick(now_ms);
  for (const view::Message& each : model_->take_messages())
    outside_.send_text(Json{{"say", each.text}, {"error", each.is_error}}.dump(
        -1, ' ', false, Json::error_handler_t::replace));
  send_camera();
  send_picture(now_ms);
  send_saved();
  send_state(now_ms);
}

void Viewer::send_state(double now_ms) {
  if (now_ms - told_ms_ < state_ms) return;
  told_ms_ = now_ms;
  Json news = Json::object();
  const Json state = state_of(*model_);
  for (const auto& [part, value] : state.items()) {
    std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (std::string& told = told_[part]; told != text) {
      told = std::move(text);
      news[part] = value;
    }
  }
  if (!news.empty())
    outside_.send_text(Json{{"state", news}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// At once, so that the page can show its last picture from there.
void Viewer::send_camera() {
  if (model_->request().frame_on_load || model_->width() == 0) return;
  std::string text = Json{{"camera", camera_json(model_->camera())}}.dump();
  if (text == sent_camera_) return;
  outside_.send_text(sent_camera_ = std::move(text));
}

void Viewer::send(Json header, const std::string& image, const std::string& depth) {
  const std::string text = header.dump();
  std::string bytes;
  bytes.reserve(4 + text.size() + depth.size() + image.size());
  for (int shift = 0; shift < 32; shift += 8) bytes += char(text.size() >> shift & 255);
  bytes += text;
  bytes += depth;
  bytes += image;
  outside_.send_bytes(std::move(bytes));
}

void Viewer::send_picture(double now_ms) {
  const std::shared_ptr<const view::Picture> picture = model_->picture();
  const Furniture& furniture = model_->request().furniture;
  if (!picture || is_encoding_ || !pace_.may_send()) return;
  const bool is_final = model_->settled();
  if (picture == sent_ && furniture == sent_furniture_ && (sent_exactly_ || !is_final)) return;
  // A slow line gets a picture that it can carry at once, and then the exact one.
  const bool is_first_of_final = is_final && picture != sent_;
  const bool exact = is_final && !(is_first_of_final && pace_.is_slow_for(picture->image.size()));
  sent_ = picture, sent_furniture_ = furniture, sent_exactly_ = exact;
  is_encoding_ = true;
  struct Encoded {
    std::string bytes;
    publish::PackedDepth depth;
  };
  auto encoded = std::make_shared<Encoded>();
  const bool draws_furniture = !furniture.empty() && picture->image.width() == model_->width() &&
                               picture->image.height() == model_->height();
  const int quality = is_final ? Pace::most_quality : pace_.quality(), shrink = exact ? 1 : pace_.shrink();
  Json header{{"kind", "picture"},
              {"type", exact ? "image/png" : "image/jpeg"},
              {"camera", camera_json(picture->camera)},
              {"technique", picture->technique},
              {"exact", exact},
              {"heard", heard_},
              {"background", hex_of(to_rgba8(picture->background))}};
  outside_.in_background(
      [encoded, picture, draws_furniture, furniture = furniture, up = model_->scene.up(),
       crs = model_->scene.crs(), exact, quality, shrink] {
        Image<Rgba8> image = smaller(picture->image, shrink);
        if (draws_furniture && shrink == 1) draw_furniture(image, *picture, furniture, up, crs);
        if (!picture->depth.empty()) encoded->depth = publish::packed(picture->depth);
        encoded->bytes = exact ? io::png_bytes(image, false) : io::jpeg_bytes(image, quality);
      },
      [self = shared_from_this(), encoded, picture, header, exact, now_ms]() mutable {
        self->is_encoding_ = false;
        const publish::PackedDepth& depth = encoded->depth;
        if (!depth.bytes.empty())
          header["depth"] = {{"width", picture->depth.width()},
                             {"height", picture->depth.height()},
                             {"near", depth.near},
                             {"far", depth.far},
                             {"bytes", depth.bytes.size()}};
        const std::uint64_t id = self->next_id_++;
        header["id"] = id;
        self->pace_.sent(id, encoded->bytes.size() + depth.bytes.size(), !exact, now_ms);
        self->send(std::move(header), encoded->bytes, depth.bytes);
      });
}

void Viewer::send_saved() {
  for (view::SavedPicture& saved : model_->saved_pictures.take()) {
    auto encoded = std::make_shared<std::string>();
    const int width = saved.picture.image.width(), height = saved.picture.image.height();
    outside_.in_background(
        [encoded, saved = std::move(saved)]() mutable {
          *encoded = io::png_bytes(saved.picture.image, false, finish(saved, "picture.png"));
        },
        [self = shared_from_this(), encoded, width, height] {
          self->send({{"kind", "shot"},
                      {"type", "image/png"},
                      {"name", "picture.png"},
                      {"width", width},
                      {"height", height}},
                     *encoded);
        });
  }
}

}  // namespace sfumato::serve
