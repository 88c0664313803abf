// What strangers send to `sfumato serve`: requests, and messages of a page.
#ifdef SFUMATO_SERVE
#include <boost/beast/http.hpp>
#include <cstdlib>

#include "apps/serve/access.h"
#include "apps/serve/protocol.h"
#include "core/error.h"
#include "faults/fuzz_targets.h"

namespace sfumato::test {

/// As a connection does: the head within its limit, then name, origin, address.
void read_request(std::string_view bytes) {
  namespace http = boost::beast::http;
  http::request_parser<http::empty_body> parser;
  parser.header_limit(8192);
  parser.body_limit(0);
  boost::system::error_code error;
  parser.put(boost::asio::buffer(bytes.data(), bytes.size()), error);
  if (error || !parser.is_header_done()) return;
  const auto& asked = parser.get();
  const std::string host(asked[http::field::host]), origin(asked[http::field::origin]);
  (void)serve::is_known_host(host, {"scan.example"});
  (void)serve::is_own_origin(origin, host);
  const auto target = serve::parse_target({asked.target().data(), asked.target().size()});
  if (!target) return;
  (void)serve::is_token(target->token, "0123456789abcdef0123456789abcdef");
  if (!target->path.starts_with('/')) std::abort();
  for (const auto& [name, value] : target->query)
    if (name.empty() || (name + value + target->path).find('\0') != std::string::npos) std::abort();
}

/// A message a line, to a view model that has no files: what is wrong is refused in one line.
void read_messages(std::string_view bytes) {
  static view::ViewModel model = [] {
    view::Start start;
    start.request.files = {"/absent.ply"};
    start.wake = [] {};
    return view::ViewModel(start);
  }();
  serve::Hand hand;
  while (!bytes.empty()) {
    const std::size_t cut = std::min(bytes.find('\n'), bytes.size());
    try {
      serve::obey(model, hand, bytes.substr(0, cut), {});
    } catch (const Error& error) {
      const bool is_theirs = error.code() == ErrorCode::usage || error.code() == ErrorCode::bad_input;
      if (!is_theirs || std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    }
    (void)model.take_messages();
    (void)model.saved_pictures.take();
    bytes.remove_prefix(std::min(cut + 1, bytes.size()));
  }
  (void)serve::state_of(model).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace sfumato::test
#endif
