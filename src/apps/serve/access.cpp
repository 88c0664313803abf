#include "access.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "core/error.h"
#include "core/lower_case.h"

namespace sfumato::serve {
namespace {

constexpr std::size_t token_digits = 32, most_bytes = 4096;

std::optional<std::string> decoded(std::string_view text, bool is_query) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char c = static_cast<unsigned char>(text[i]);
    if (c == '%') {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = digit(text[i + 1]), low = digit(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      c = static_cast<unsigned char>(16 * high + low);
      i += 2;
    } else if (c == '+' && is_query) {
      c = ' ';
    }
    if (c < 32 || c == 127) return std::nullopt;
    out += char(c);
  }
  return out;
}

bool looks_like_token(std::string_view text) {
  return text.size() == token_digits && std::all_of(text.begin(), text.end(), [](unsigned char c) {
           return std::isdigit(c) || (c >= 'a' && c <= 'f');
         });
}

}  // namespace

std::string new_token() {
  std::array<unsigned char, token_digits / 2> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
    throw Error(ErrorCode::io, "the system gives no random numbers (getrandom): there is no safe address");
  std::string text;
  for (const unsigned char byte : bytes)
    text += "0123456789abcdef"[byte >> 4], text += "0123456789abcdef"[byte & 15];
  return text;
}

bool is_token(std::string_view given, std::string_view token) {
  unsigned difference = unsigned(given.size() != token.size());
  for (std::size_t i = 0; i < token.size(); ++i)
    difference |= unsigned(static_cast<unsigned char>(token[i]) ^
                           (i < given.size() ? static_cast<unsigned char>(given[i]) : 0xffu));
  return difference == 0;
}

bool is_known_host(std::string_view host, const std::vector<std::string>& names) {
  if (host.empty() || host.size() > 300) return false;
  if (host.front() == '[') {  // an IPv6 address in numbers
    const std::size_t end = host.find(']');
    return end != host.npos && std::all_of(host.begin() + 1, host.begin() + long(end), [](unsigned char c) {
             return std::isxdigit(c) || c == ':' || c == '.';
           });
  }
  const std::string name = lower_case(host.substr(0, host.find(':')));
  if (name == "localhost") return true;
  // Four numbers; a browser resolves nothing for those.
  if (std::count(name.begin(), name.end(), '.') == 3 && name.front() != '.' && name.back() != '.' &&
      std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) || c == '.'; }))
    return true;
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& each) { return lower_case(each) == name; });
}

bool is_own_origin(std::string_view origin, std::string_view host) {
  if (origin.empty()) return true;
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme)) return lower_case(origin.substr(scheme.size())) == lower_case(host);
  return false;
}

std::optional<Target> parse_target(std::string_view target) {
  if (target.empty() || target.front() != '/' || target.size() > most_bytes) return std::nullopt;
  Target found;
  const std::size_t mark = target.find('?');
  const auto path = decoded(target.substr(0, mark), false);
  if (!path) return std::nullopt;
  found.path = *path;
  if (const std::size_t end = found.path.find('/', 1);
      end != found.path.npos && looks_like_token(std::string_view(found.path).substr(1, end - 1))) {
    found.token = found.path.substr(1, end - 1);
    found.path.erase(0, end);
  }
  std::string_view rest = mark == target.npos ? std::string_view() : target.substr(mark + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view pair = rest.substr(0, end);
    const std::size_t equals = pair.find('=');
    const auto name = decoded(pair.substr(0, equals), true),
               value = decoded(equals == pair.npos ? std::string_view() : pair.substr(equals + 1), true);
    if (!name || !value) return std::nullopt;
    if (*name == "token")
      found.token = *value;
    else if (!name->empty())
      found.query.emplace_back(*name, *value);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return found;
}

}  // namespace sfumato::serve
