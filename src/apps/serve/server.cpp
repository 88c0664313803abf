#include "page.h"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>

#include "../picture/saved_picture.h"
#include "core/error.h"

namespace sfumato::serve {
namespace {

/// A connection, until it becomes a page or ends.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Server& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {
    ++server_.connections;
  }
  ~Connection() { --server_.connections; }

  void read() {
    parser_.emplace();
    parser_->header_limit(most_header_bytes);
    parser_->body_limit(0);
    stream_.expires_after(http_patience);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](const Code& error, std::size_t) {
      if (error == http::error::end_of_stream || error == beast::error::timeout) return;
      if (error.category() == http::make_error_code(http::error::bad_method).category())
        return self->refuse(error == http::error::header_limit ? 431
                            : error == http::error::body_limit ? 413
                                                               : 400,
                            error.message(), true);
      if (!error) self->answer();
    });
  }

 private:
  using Request = http::request<http::empty_body>;

  void answer() {
    const Request& asked = parser_->get();
    const Settings& settings = server_.settings;
    const auto field = [&](http::field name) { return std::string(asked[name]); };
    is_head_ = asked.method() == http::verb::head;
    keeps_ = asked.keep_alive();
    version_ = asked.version();
    if (asked.method() != http::verb::get && !is_head_) return refuse(405, "only GET is served");
    const std::string host = field(http::field::host);
    if (!is_known_host(host, settings.hosts))
      return refuse(421,
                    "this server does not go by that name; start it with --host NAME to be reached by one");
    if (!is_own_origin(field(http::field::origin), host))
      return refuse(403, "pages of other origins are refused");
    const std::string text(asked.target());
    const auto target = parse_target(text);
    if (!target) return refuse(400, "that is no address");
    std::string token = target->token;
    if (const std::string bearer = field(http::field::authorization); bearer.starts_with("Bearer "))
      token = bearer.substr(7);
    if (!is_token(token, settings.token))
      return refuse(403, "use the whole address that the server printed when it was started");
    if (websocket::is_upgrade(asked)) {
      if (target->path != "/socket") return refuse(404, "there is no such socket");
      if (server_.pages.size() >= settings.clients)
        return refuse(503, "this server shows its scan to " + std::to_string(settings.clients) +
                               " pages already (--clients)");
      stream_.expires_never();
      return std::make_shared<Page>(server_, std::move(stream_))->open(parser_->release());
    }
    route(*target);
  }

  void route(const Target& target) {
    const std::string name = target.path == "/" ? "index.html" : target.path.substr(1);
    for (const PageFile& file : page_files)
      if (file.name == name) return send(200, file.type, file.text);
    if (name == "info") {
      if (!server_.is_ready()) return refuse(503, "the files are being read");
      return send(200, "application/json",
                  info_of(server_.keeper()).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    }
    if (name == "render") return render(target.query);
    refuse(404, "there is nothing of that name");
  }

  void render(const Query& query) {
    if (!server_.is_ready()) return refuse(503, "the files are being read");
    if (double(server_.renders) >= most_renders)
      return refuse(503, "other pictures are being made: try again");
    PictureRequest wanted;
    try {
      wanted = server_.sources.picture(query);
    } catch (const Error& error) {
      return refuse(400, error.what());
    }
    wanted.start.shared = server_.shared;
    if (!server_.outside().may_show(wanted.start.request.scene_key()))
      return refuse(503, "the server's limit of selections of points is reached (--selections)");
    const auto self = shared_from_this();
    ticker_ = std::make_shared<Ticker>(
        server_.io,
        [weak = weak_from_this()] {
          if (const auto me = weak.lock()) me->tick_render();
        },
        [weak = weak_from_this()]() -> std::optional<double> {
          const auto me = weak.lock();
          return me && me->model_ ? std::min(me->model_->wait_ms(now_ms()).value_or(1000), 1000.0)
                                  : std::optional<double>();
        });
    wanted.start.wake = ticker_->waker();
    model_ = std::make_unique<view::ViewModel>(wanted.start);
    model_->set_size(wanted.width, wanted.height);
    model_->save_picture(wanted.width, wanted.height);
    ++server_.renders;
    render_until_ = Clock::now() + render_patience;
    stream_.expires_never();
    itself_ = self;  // until the picture is there
    ticker_->run();
  }

  void end_render() {
    if (ticker_) ticker_->stop();
    model_.reset();
    --server_.renders;
  }

  void tick_render() {
    if (!model_) return;
    const auto self = std::exchange(itself_, nullptr);
    model_->tick(now_ms());
    std::vector<view::SavedPicture> finished = model_->saved_pictures.take();
    std::string complaint;
    for (const view::Message& each : model_->take_messages())
      if (each.is_error) complaint = each.text;
    if (model_->fatal()) complaint = model_->fatal()->message;
    if (!finished.empty()) {
      end_render();
      auto encoded = std::make_shared<std::string>();
      const std::string line = command_of(finished.front().words, "picture.png");
      server_.in_background(
          [encoded, saved = std::move(finished.front())]() mutable {
            *encoded = io::png_bytes(saved.picture.image, false, finish(saved, "picture.png"));
          },
          [self, encoded, line] { self->send(200, "image/png", std::move(*encoded), line); });
    } else if (!complaint.empty() || Clock::now() > render_until_) {
      const bool is_ours = complaint.empty();
      end_render();
      refuse(is_ours ? 504 : 400, is_ours ? "the picture took too long" : complaint);
    } else {
      itself_ = self;
    }
  }

  void refuse(int status, const std::string& why, bool ends = false) {
    if (ends) keeps_ = false;
    send(status, "application/json",
         Json{{"error", why}}.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
  }

  void send(int status, const std::string& type, std::string body, const std::string& command = {}) {
    auto response = std::make_shared<http::response<http::string_body>>();
    response->version(version_);
    response->result(unsigned(status));
    response->set(http::field::content_type, type);
    response->set(http::field::cache_control, "no-store");
    response->set("X-Content-Type-Options", "nosniff");
    response->set("Referrer-Policy", "no-referrer");
    response->set("Cross-Origin-Resource-Policy", "same-site");
    response->set("Content-Security-Policy",
                  "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src "
                  "'self' blob: data:; "
                  "base-uri 'none'; form-action 'none'");
    if (!command.empty() &&
        std::all_of(command.begin(), command.end(), [](unsigned char c) { return c >= 32 && c < 127; }))
      response->set("X-Sfumato-Command", command);
    if (status == 405) response->set(http::field::allow, "GET, HEAD");
    response->keep_alive(keeps_);
    response->body() = std::move(body);
    response->prepare_payload();
    if (is_head_) response->body().clear();
    stream_.expires_after(socket_patience);
    auto serializer = std::make_shared<http::response_serializer<http::string_body>>(*response);
    serializer->split(is_head_);
    const auto done = [self = shared_from_this(), response, serializer](const Code& error, std::size_t) {
      if (error) return;
      if (self->keeps_) return self->read();
      Code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    };
    if (is_head_)
      http::async_write_header(stream_, *serializer, done);
    else
      http::async_write(stream_, *serializer, done);
  }

  Server& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{most_header_bytes + 1024};
  std::optional<http::request_parser<http::empty_body>> parser_;
  bool is_head_ = false, keeps_ = false;
  unsigned version_ = 11;
  std::unique_ptr<view::ViewModel> model_;
  std::shared_ptr<Ticker> ticker_;
  std::shared_ptr<Connection> itself_;
  Clock::time_point render_until_;
};

Server::Server(const Settings& the_settings, const Sources& the_sources)
    : settings(the_settings), sources(the_sources) {
  Code error;
  const auto address = asio::ip::make_address(settings.address, error);
  if (error)
    throw Error(ErrorCode::usage, "--bind: '" + settings.address +
                                      "' is no address in numbers, such as 127.0.0.1, 0.0.0.0 or ::1");
  const tcp::endpoint end(address, static_cast<unsigned short>(settings.port));
  const auto expect = [&](const char* what) {
    if (!error) return;
    throw Error(ErrorCode::io, std::string(what) + " " + settings.address + " port " +
                                   std::to_string(settings.port) + ": " + error.message() +
                                   "; give another one with --port N, or --port 0 for one that is free");
  };
  acceptor_.open(end.protocol(), error), expect("cannot open");
  acceptor_.set_option(tcp::acceptor::reuse_address(true), error), expect("cannot open");
  acceptor_.bind(end, error), expect("cannot bind");
  acceptor_.listen(64, error), expect("cannot listen at");
}

Server::~Server() {
  if (ticker_) ticker_->stop();
  encoders_.join();
}

Outside Server::outside() {
  Outside outside;
  outside.limits = settings.limits;
  outside.in_background = [this](std::function<void()> work, std::function<void()> then) {
    in_background(std::move(work), std::move(then));
  };
  outside.may_show = [this](const view::SceneKey& key) {
    std::vector<std::optional<view::SceneKey>> keys{key};
    const auto add = [&](const std::optional<view::SceneKey>& another) {
      if (std::find(keys.begin(), keys.end(), another) == keys.end()) keys.push_back(another);
    };
    add(keeper_->request().scene_key());
    for (const Page* page : pages)
      if (page->model()) add(page->model()->scene.key());
    return keys.size() <= settings.selections;
  };
  return outside;
}

void Server::in_background(std::function<void()> work, std::function<void()> then) {
  asio::post(encoders_, [this, work = std::move(work), then = std::move(then)]() mutable {
    try {
      work();
    } catch (const std::exception&) {  // nothing came of it: an empty picture is shown by nobody
    }
    asio::post(io, std::move(then));
  });
}

/// The driver is gone, with all that it held: everything begins anew, with the same requests.
void Server::lost(const view::Failure& failure) {
  if (failure.id != 0 && !is_ready_) {
    failure_ = failure;
    return io.stop();
  }
  losses_ms_.push_back(now_ms());
  if (losses_ms_.size() > 3) losses_ms_.pop_front();
  if (!is_ready_ || (losses_ms_.size() == 3 && losses_ms_.back() - losses_ms_.front() < 60'000)) {
    failure_ = failure;
    return io.stop();
  }
  sources.say(failure.message + "; beginning again");
  is_ready_ = false;
  asio::post(io, [this] { begin(); });
}

/// Holds the scan for whoever comes, and knows what there is.
void Server::begin() {
  if (ticker_) ticker_->stop();
  keeper_.reset();
  shared = std::make_shared<view::SharedScenes>();
  ticker_ = std::make_shared<Ticker>(
      io, [this] { tick_keeper(); },
      [this]() -> std::optional<double> {
        const std::optional<double> wait = keeper_->wait_ms(now_ms());
        if (!is_ready_) return std::min(wait.value_or(100), 100.0);
        // Of files with levels a technique is chosen with the first view, after the coarse levels are there.
        return keeper_->request().technique.empty() ? wait : std::nullopt;
      });
  view::Start start = sources.start;
  start.wake = ticker_->waker();
  start.shared = shared;
  keeper_ = std::make_unique<view::ViewModel>(start);
  keeper_->set_size(16, 16);
  ticker_->run();
}

void Server::tick_keeper() {
  keeper_->tick(now_ms());
  for (const view::Message& each : keeper_->take_messages()) sources.say(each.text);
  if (keeper_->fatal()) return lost(*keeper_->fatal());
  if (is_ready_) return;
  if (keeper_->scene.is_ready()) {
    is_ready_ = true;
    const std::set<Page*> all = pages;
    for (Page* page : all) page->begin_viewer();
  } else if (!keeper_->activity().text.empty()) {
    for (Page* page : pages) page->tell_activity(keeper_->activity().text, keeper_->activity().fraction);
  }
}

void Server::accept() {
  acceptor_.async_accept([this](const Code& error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      socket.set_option(tcp::no_delay(true));
      if (connections < settings.clients + spare_connections)
        std::make_shared<Connection>(*this, std::move(socket))->read();
    }
    accept();
  });
}

void open_browser(const std::string& address) {
  std::string program = "xdg-open", word = address;
  char* words[] = {program.data(), word.data(), nullptr};
  ::pid_t child = 0;
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, 2, "/dev/null", O_WRONLY, 0);
  ::posix_spawnp(&child, program.c_str(), &quiet, nullptr, words, environ);
  posix_spawn_file_actions_destroy(&quiet);
}

int Server::run() {
  asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([this](const Code& error, int) {
    if (!error) io.stop();
  });
  const tcp::endpoint end = acceptor_.local_endpoint();
  const std::string host =
      end.address().is_v6() ? "[" + end.address().to_string() + "]" : end.address().to_string();
  const std::string address =
      "http://" + host + ":" + std::to_string(end.port()) + "/" + settings.token + "/";
  begin();
  accept();
  sources.announce(address);
  if (settings.opens_browser) open_browser(address);
  io.run();
  Code ignored;
  acceptor_.close(ignored);
  ticker_->stop();
  const std::set<Page*> all = pages;
  for (Page* page : all) page->close();
  keeper_.reset();
  if (failure_) throw Error(failure_->code, failure_->message);
  return 0;
}

}  // namespace

int run(const Settings& settings, const Sources& sources) {
  Server server(settings, sources);
  return server.run();
}

}  // namespace sfumato::serve
