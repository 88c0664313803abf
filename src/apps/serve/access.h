// Who may ask for what: tokens, hosts, origins and addresses. Nothing of the network in it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sfumato::serve {

/// 128 bits of the system's randomness, in hexadecimal digits.
std::string new_token();
/// In a time that does not tell how much of it is right.
bool is_token(std::string_view given, std::string_view token);

/// Whether `host` ("name:port", as a browser sends it) is one that this server goes by: an address in
/// numbers, localhost, or one of `names`. Other names may be a stranger's, that resolve to this machine
/// (DNS rebinding).
bool is_known_host(std::string_view host, const std::vector<std::string>& names);
/// Whether a page of `origin` is ours: it came from `host` itself. No origin: no browser's page asks.
bool is_own_origin(std::string_view origin, std::string_view host);

using Query = std::vector<std::pair<std::string, std::string>>;

/// What an address asks for, taken apart and decoded.
struct Target {
  std::string token;  ///< its first folder, or of ?token=
  std::string path;   ///< without the token, begins with a slash
  Query query;        ///< without the token
};
/// Nothing for what is no address of ours: escapes that are broken, bytes of control, more than 4096 bytes.
std::optional<Target> parse_target(std::string_view target);

}  // namespace sfumato::serve
