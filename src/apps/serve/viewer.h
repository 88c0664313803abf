// One person at the server: a view model of their own, what their page says, and the pictures that go there.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "pace.h"
#include "protocol.h"
#include "view/view_model.h"

namespace sfumato::serve {

/// What a viewer needs of the server.
struct Outside {
  std::function<void(std::string)> send_text;
  std::function<void(std::string)> send_bytes;
  /// Runs the first on another thread, then the second on this one.
  std::function<void(std::function<void()>, std::function<void()>)> in_background;
  std::function<bool(const view::SceneKey&)> may_show;  ///< whether there is memory for those points
  Limits limits;
};

class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(view::Start start, Outside outside) : outside_(std::move(outside)), start_(std::move(start)) {}

  /// Scenes may be read and drawn from now on, also after a driver was lost: the request stays.
  void begin(std::shared_ptr<view::SharedScenes> shared);
  /// A message of the page. Throws Error(usage), Error(bad_input) for what is none.
  void hear(std::string_view text, double now_ms);
  void tick(double now_ms);
  std::optional<double> wait_ms(double now_ms) const;
  const std::optional<view::Failure>& fatal() const;
  const view::ViewModel* model() const { return model_.get(); }
  const Hand& hand() const { return hand_; }
  /// Looks as somebody else does, from there.
  void follow(const view::ViewRequest& request);

 private:
  void send_state(double now_ms);
  void send_camera();
  void send_picture(double now_ms);
  void send_saved();
  void send(nlohmann::ordered_json header, const std::string& image, const std::string& depth = {});

  Outside outside_;
  view::Start start_;
  std::unique_ptr<view::ViewModel> model_;
  Hand hand_;
  Pace pace_;
  std::string size_message_;  ///< the last, for a view model that begins later
  std::shared_ptr<const view::Picture> sent_;
  std::string sent_camera_;
  Furniture sent_furniture_;
  bool sent_exactly_ = false, is_encoding_ = false;
  std::uint64_t next_id_ = 1, heard_ = 0;  ///< heard_: messages of the page; a picture says how many it knows
  std::map<std::string, std::string> told_;  ///< parts of the state as they were sent
  double told_ms_ = -1e9;
};

}  // namespace sfumato::serve
