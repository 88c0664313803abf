// A page at the other end of a WebSocket. Only server.cpp includes this, and with it Boost.
#pragma once

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <set>

#include "core/error.h"
#include "server.h"

namespace sfumato::serve {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Json = nlohmann::ordered_json;
using Code = boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::size_t most_header_bytes = 8192, most_message_bytes = 32 * 1024,
                      most_waiting_bytes = 128 << 20;
constexpr std::chrono::seconds http_patience(10), socket_patience(30), render_patience(300);
constexpr double messages_a_second = 400, most_renders = 2;
constexpr std::size_t spare_connections = 32;  ///< beside pages: for files, pictures and who is turned away

double now_ms() {
  static const Clock::time_point start = Clock::now();
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Calls `tick` of a view model when it is due; `wake` from any thread.
class Ticker : public std::enable_shared_from_this<Ticker> {
 public:
  Ticker(asio::io_context& io, std::function<void()> tick, std::function<std::optional<double>()> wait)
      : io_(io), timer_(io), tick_(std::move(tick)), wait_(std::move(wait)) {}
  std::function<void()> waker() {
    return [weak = weak_from_this()] {
      if (const auto self = weak.lock()) self->wake();
    };
  }
  void wake() {
    if (is_posted_.exchange(true)) return;
    asio::post(io_, [weak = weak_from_this()] {
      if (const auto self = weak.lock()) self->is_posted_ = false, self->run();
    });
  }
  void run() {
    if (!tick_) return;
    tick_();
    if (!tick_) return;
    const std::optional<double> wait = wait_();
    if (!wait) return void(timer_.cancel());
    timer_.expires_after(std::chrono::microseconds(long(1000 * std::clamp(*wait, 1.0, 1e6))));
    timer_.async_wait([weak = weak_from_this()](const Code& error) {
      if (const auto self = weak.lock(); self && !error) self->run();
    });
  }
  void stop() { tick_ = nullptr, timer_.cancel(); }

 private:
  asio::io_context& io_;
  asio::steady_timer timer_;
  std::function<void()> tick_;
  std::function<std::optional<double>()> wait_;
  std::atomic<bool> is_posted_{false};
};

class Page;

class Server {
 public:
  Server(const Settings& settings, const Sources& sources);
  int run();
  ~Server();

  const Settings& settings;
  const Sources& sources;
  asio::io_context io{1};
  std::set<Page*> pages;
  std::size_t connections = 0, renders = 0;
  std::shared_ptr<view::SharedScenes> shared;
  std::optional<view::ViewRequest> look;  ///< of all pages, where they look together
  std::uint64_t next_page = 1;

  const view::ViewModel& keeper() const { return *keeper_; }
  bool is_ready() const { return is_ready_; }
  Outside outside();
  void in_background(std::function<void()> work, std::function<void()> then);
  void lost(const view::Failure& failure);

 private:
  void accept();
  void begin();
  void tick_keeper();

  tcp::acceptor acceptor_{io};
  asio::thread_pool encoders_{2};
  std::unique_ptr<view::ViewModel> keeper_;
  std::shared_ptr<Ticker> ticker_;
  bool is_ready_ = false;
  std::optional<view::Failure> failure_;
  std::deque<double> losses_ms_;
};

/// A WebSocket and the viewer behind it.
class Page : public std::enable_shared_from_this<Page> {
 public:
  Page(Server& server, beast::tcp_stream&& stream)
      : id(server.next_page++), server_(server), socket_(std::move(stream)) {}
  ~Page() { close(); }

  const std::uint64_t id;

  template <class Asked>
  void open(Asked asked) {
    websocket::stream_base::timeout times{http_patience, socket_patience, true};
    socket_.set_option(times);
    socket_.read_message_max(most_message_bytes);
    socket_.auto_fragment(false);
    auto request = std::make_shared<Asked>(std::move(asked));
    socket_.async_accept(*request, [self = shared_from_this(), request](const Code& error) {
      if (!error) self->begin();
    });
  }
  void close() {
    if (ticker_) ticker_->stop();
    if (server_.pages.erase(this) && server_.settings.share) point({});
    viewer_.reset();
  }
  /// Points can be shown from now on.
  void begin_viewer() {
    if (!viewer_) return;
    viewer_->begin(server_.shared);
    ticker_->run();
  }
  void tell_activity(const std::string& text, double fraction) {
    say_text(Json{{"state", {{"activity", {{"text", text}, {"fraction", fraction}}}}}}.dump());
  }
  const view::ViewModel* model() const { return viewer_ ? viewer_->model() : nullptr; }

 private:
  struct Out {
    bool is_text;
    std::string bytes;
  };

  void begin() {
    server_.pages.insert(this);
    const std::weak_ptr<Page> weak = weak_from_this();
    ticker_ = std::make_shared<Ticker>(
        server_.io,
        [weak] {
          if (const auto self = weak.lock()) self->tick();
        },
        [weak]() -> std::optional<double> {
          const auto self = weak.lock();
          return self && self->viewer_ ? self->viewer_->wait_ms(now_ms()) : std::nullopt;
        });
    view::Start start = server_.sources.start;
    start.wake = ticker_->waker();
    if (server_.look) start.request = *server_.look;
    // What was chosen for the whole scan is not chosen again, from what a page happens to see of it.
    if (start.request.technique.empty() && server_.is_ready())
      start.request.technique = server_.keeper().request().technique;
    known_ = start.request;
    Outside outside = server_.outside();
    outside.send_text = [weak](std::string text) {
      if (const auto self = weak.lock()) self->say_text(std::move(text));
    };
    outside.send_bytes = [weak](std::string bytes) {
      if (const auto self = weak.lock()) self->put({false, std::move(bytes)});
    };
    viewer_ = std::make_shared<Viewer>(std::move(start), std::move(outside));
    if (server_.is_ready()) begin_viewer();
    if (server_.settings.share) say_text(Json{{"share", {{"me", id}}}}.dump());
    read();
  }

  /// What this page changed is what all look at.
  void look_together() {
    if (!server_.settings.share || !model() || model()->request().frame_on_load ||
        model()->request() == known_)
      return;
    server_.look = known_ = model()->request();
    for (Page* other : server_.pages)
      if (other != this && other->viewer_) {
        other->known_ = known_;
        other->viewer_->follow(known_);
        if (other->ticker_) other->ticker_->wake();
      }
  }
  /// The others see where the hand of this page points.
  void point(const std::optional<dvec3>& at) {
    Json place = at ? Json::array({at->x, at->y, at->z}) : Json();
    const std::string text = Json{{"pointer", {{"id", id}, {"at", place}}}}.dump();
    for (Page* other : server_.pages)
      if (other != this) other->say_text(text);
  }

  void tick() {
    if (!viewer_) return;
    viewer_->tick(now_ms());
    look_together();
    if (const auto& fatal = viewer_->fatal()) server_.lost(*fatal);
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](const Code& error, std::size_t) {
      if (error) return self->close();
      self->hear();
    });
  }

  void hear() {
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    const double now = now_ms();
    allowance_ = std::min(messages_a_second, allowance_ + (now - heard_ms_) * messages_a_second / 1000) - 1;
    heard_ms_ = now;
    if (allowance_ < 0) return shut(websocket::close_code::policy_error, "too many messages");
    if (!socket_.got_text()) return shut(websocket::close_code::unknown_data, "messages are text");
    try {
      if (viewer_) viewer_->hear(text, now);
      look_together();
      if (viewer_ && viewer_->hand().pointed && server_.settings.share) point(viewer_->hand().pointer);
    } catch (const Error& error) {
      return shut(websocket::close_code::policy_error, error.what());
    }
    if (ticker_) ticker_->wake();
    read();
  }

  void shut(websocket::close_code code, const std::string& why) {
    if (server_.settings.verbose) server_.sources.say("a page is closed: " + why);
    close();
    socket_.async_close({code, why.substr(0, 100)}, [self = shared_from_this()](const Code&) {});
  }

  void say_text(std::string text) { put({true, std::move(text)}); }

  void put(Out out) {
    waiting_bytes_ += out.bytes.size();
    if (waiting_bytes_ > most_waiting_bytes)
      return shut(websocket::close_code::policy_error, "the page takes nothing");
    waiting_.push_back(std::move(out));
    if (waiting_.size() == 1) write();
  }

  void write() {
    socket_.text(waiting_.front().is_text);
    socket_.async_write(asio::buffer(waiting_.front().bytes),
                        [self = shared_from_this()](const Code& error, std::size_t) {
                          if (error) return self->close();
                          self->waiting_bytes_ -= self->waiting_.front().bytes.size();
                          self->waiting_.pop_front();
                          if (!self->waiting_.empty()) self->write();
                        });
  }

  Server& server_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_{most_message_bytes};
  std::deque<Out> waiting_;
  std::size_t waiting_bytes_ = 0;
  double allowance_ = messages_a_second, heard_ms_ = 0;
  std::shared_ptr<Viewer> viewer_;
  std::shared_ptr<Ticker> ticker_;
  view::ViewRequest known_;  ///< what this page showed when pages last agreed
};

}  // namespace
}  // namespace sfumato::serve
