// Files at servers, by HTTP ranges. libcurl is loaded when a URL is read: whoever reads none does not wait
// for the libraries behind it.
#include <dlfcn.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "core/error.h"
#include "core/interruption.h"
#include "core/lower_case.h"
#include "io/byte_source.h"
#if __has_include(<curl/curl.h>)
#include <curl/curl.h>
#define SFUMATO_CURL
#endif

namespace sfumato::io {

bool is_remote(const std::filesystem::path& path) {
  const std::string& name = path.native();
  return name.starts_with("http://") || name.starts_with("https://");
}

#ifdef SFUMATO_CURL

namespace {

// Blocks of this size are fetched and kept for what is smaller, as headers and lists are read in bits.
constexpr std::uint64_t remote_block = 1 << 14;
constexpr std::size_t most_blocks = 1024;
constexpr int most_tries = 3;
constexpr long least_speed = 1000;  // bytes a second: a server that gives less counts as silent

struct Curl {
  decltype(&curl_easy_init) init = nullptr;
  decltype(&curl_easy_cleanup) cleanup = nullptr;
  decltype(&curl_easy_setopt) setopt = nullptr;
  decltype(&curl_easy_perform) perform = nullptr;
  decltype(&curl_easy_getinfo) getinfo = nullptr;
  decltype(&curl_easy_strerror) strerror = nullptr;

  static const Curl& get() {
    static const Curl curl = [] {
      Curl c;
      void* library = ::dlopen("libcurl.so.4", RTLD_NOW | RTLD_LOCAL);
      if (!library)
        throw Error(ErrorCode::io,
                    "files at servers are read by libcurl.so.4, which is not installed (package libcurl4)");
      const auto load = [&](auto& function, const char* name) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
        if (!function)
          throw Error(ErrorCode::io, std::string("libcurl.so.4 lacks ") + name + "; update libcurl");
      };
      decltype(&curl_global_init) start = nullptr;
      load(start, "curl_global_init"), load(c.init, "curl_easy_init"), load(c.cleanup, "curl_easy_cleanup");
      load(c.setopt, "curl_easy_setopt"), load(c.perform, "curl_easy_perform");
      load(c.getinfo, "curl_easy_getinfo"), load(c.strerror, "curl_easy_strerror");
      start(CURL_GLOBAL_DEFAULT);
      return c;
    }();
    return curl;
  }
};

/// Seconds that a server may be silent.
long patience() {
  const char* text = std::getenv("SFUMATO_HTTP_TIMEOUT");
  const long seconds = text ? std::strtol(text, nullptr, 10) : 0;
  return seconds >= 1 && seconds <= 3600 ? seconds : 15;
}

int on_progress(void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return interruption.load(std::memory_order_relaxed) ? 1 : 0;
}

/// Certificates that the user names, as for the program curl.
const char* trusted_file() {
  for (const char* name : {"CURL_CA_BUNDLE", "SSL_CERT_FILE"})
    if (const char* file = std::getenv(name); file && *file) return file;
  return nullptr;
}

void pause(std::chrono::milliseconds time) {
  for (; time.count() > 0; time -= std::chrono::milliseconds(50)) {
    if (interruption) throw Cancelled();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

/// One answer.
struct Answer {
  CURLcode code = CURLE_OK;
  long status = 0;
  std::optional<std::uint64_t> first, total;  ///< of Content-Range
  std::uint64_t taken = 0;                    ///< bytes of the body
  bool is_too_long = false;
  std::function<void(const char*, std::size_t)> take;
  std::uint64_t most = 0;  ///< of a body with ranges
  bool takes_all = false;  ///< also a whole file, where the server has no ranges
  std::exception_ptr error;
  char detail[CURL_ERROR_SIZE] = {};
};

std::string reason_of(const Answer& answer) {
  return answer.detail[0] ? answer.detail : Curl::get().strerror(answer.code);
}

std::size_t on_header(char* bytes, std::size_t one, std::size_t count, void* user) {
  auto& answer = *static_cast<Answer*>(user);
  const std::string line = lower_case({bytes, one * count});
  if (line.starts_with("http/")) {  // of the next answer, behind a redirection
    answer.first.reset(), answer.total.reset();
    const std::size_t blank = line.find(' ');
    answer.status = blank == std::string::npos ? 0 : std::strtol(line.c_str() + blank, nullptr, 10);
  }
  if (!line.starts_with("content-range:")) return one * count;
  const std::size_t at = line.find("bytes ");
  unsigned long long first = 0, last = 0, total = 0;
  if (at != std::string::npos &&
      std::sscanf(line.c_str() + at, "bytes %llu-%llu/%llu", &first, &last, &total) == 3)
    answer.first = first, answer.total = total;
  return one * count;
}

std::size_t on_body(char* bytes, std::size_t one, std::size_t count, void* user) {
  auto& answer = *static_cast<Answer*>(user);
  const std::size_t size = one * count;
  if (answer.status != 206 && !(answer.status == 200 && answer.takes_all))
    return answer.status >= 200 && answer.status < 300 ? 0 : size;  // pages of errors are passed over
  if (answer.status == 206 && answer.taken + size > answer.most) {
    answer.is_too_long = true;
    return 0;
  }
  try {
    answer.take(bytes, size);
  } catch (...) {
    answer.error = std::current_exception();
    return 0;
  }
  answer.taken += size;
  return size;
}

class RemoteSource final : public ByteSource {
 public:
  explicit RemoteSource(std::string url) : url_(std::move(url)) {
    name = url_.substr(0, url_.find_first_of("?#"));
    open();
  }
  ~RemoteSource() override {
    for (CURL* handle : idle_) Curl::get().cleanup(handle);
  }

  void read(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (whole_) return whole_->read(offset, bytes);
    if (bytes.size() >= remote_block) return fetch(offset, bytes);
    while (!bytes.empty()) {
      const std::uint64_t block = offset / remote_block, begin = offset - block * remote_block;
      const std::size_t count = std::size_t(std::min<std::uint64_t>(bytes.size(), remote_block - begin));
      const std::shared_ptr<const std::string> held = block_at(block);
      std::memcpy(bytes.data(), held->data() + begin, count);
      bytes = bytes.subspan(count), offset += count;
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ErrorCode::io, url_ + ": " + what); }

  /// Asks for [offset, offset + count), again where it may help.
  Answer ask(std::uint64_t offset, std::uint64_t count, bool takes_all, const std::function<void()>& restart,
             std::function<void(const char*, std::size_t)> take) const {
    const Curl& curl = Curl::get();
    const std::string range = std::to_string(offset) + "-" + std::to_string(offset + count - 1);
    std::string problem;
    for (int n = 0; n < most_tries; ++n) {
      if (n > 0) pause(std::chrono::milliseconds(250 << n));
      restart();
      Answer answer;
      answer.take = take, answer.most = count, answer.takes_all = takes_all;
      CURL* const handle = take_handle();
      curl.setopt(handle, CURLOPT_URL, url_.c_str());
      curl.setopt(handle, CURLOPT_RANGE, range.c_str());
      curl.setopt(handle, CURLOPT_HEADERFUNCTION, &on_header);
      curl.setopt(handle, CURLOPT_HEADERDATA, static_cast<void*>(&answer));
      curl.setopt(handle, CURLOPT_WRITEFUNCTION, &on_body);
      curl.setopt(handle, CURLOPT_WRITEDATA, static_cast<void*>(&answer));
      curl.setopt(handle, CURLOPT_FOLLOWLOCATION, 1L);
      curl.setopt(handle, CURLOPT_MAXREDIRS, 5L);
      curl.setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
      curl.setopt(handle, CURLOPT_REDIR_PROTOCOLS_STR, url_.starts_with("https") ? "https" : "http,https");
      if (const char* file = trusted_file()) curl.setopt(handle, CURLOPT_CAINFO, file);
      curl.setopt(handle, CURLOPT_ERRORBUFFER, answer.detail);
      curl.setopt(handle, CURLOPT_NOPROGRESS, 0L);
      curl.setopt(handle, CURLOPT_XFERINFOFUNCTION, &on_progress);
      curl.setopt(handle, CURLOPT_NOSIGNAL, 1L);
      curl.setopt(handle, CURLOPT_CONNECTTIMEOUT, patience());
      curl.setopt(handle, CURLOPT_LOW_SPEED_LIMIT, least_speed);
      curl.setopt(handle, CURLOPT_LOW_SPEED_TIME, patience());
      curl.setopt(handle, CURLOPT_USERAGENT, "sfumato");
      answer.code = curl.perform(handle);
      curl.getinfo(handle, CURLINFO_RESPONSE_CODE, &answer.status);
      curl.setopt(handle, CURLOPT_ERRORBUFFER, nullptr);
      give_handle(handle);
      if (answer.code == CURLE_ABORTED_BY_CALLBACK) throw Cancelled();
      if (answer.code == CURLE_PEER_FAILED_VERIFICATION || answer.code == CURLE_SSL_CACERT_BADFILE)
        fail("the server's certificate is not trusted (" + reason_of(answer) +
             "); SSL_CERT_FILE names a file of those to trust");
      if (answer.error) std::rethrow_exception(answer.error);
      if (answer.status >= 400 && answer.status < 500 && answer.status != 429 && answer.status != 408)
        fail("the server answers " + std::to_string(answer.status) +
             (answer.status == 404   ? " (no such file); check the address"
              : answer.status == 416 ? " (no such range): the file is shorter than it said"
                                     : "; check the address and whether it is open to all"));
      if (answer.is_too_long) fail("the server sends more than the bytes asked for");
      if (answer.status == 200 && !takes_all) fail("the server stopped sending parts of the file; try again");
      if (answer.code == CURLE_OK && (answer.status == 206 || answer.status == 200)) return answer;
      problem = answer.code == CURLE_OPERATION_TIMEDOUT
                    ? "the server is silent for " + std::to_string(patience()) + " s"
                : answer.code == CURLE_PARTIAL_FILE ? "the server cuts the connection off"
                : answer.code != CURLE_OK           ? reason_of(answer)
                                                    : "the server answers " + std::to_string(answer.status);
      if (answer.code == CURLE_TOO_MANY_REDIRECTS || answer.code == CURLE_UNSUPPORTED_PROTOCOL ||
          answer.code == CURLE_URL_MALFORMAT)
        fail(problem + "; check the address");
    }
    fail(problem + " (" + std::to_string(most_tries) + " tries); check the address and the network");
  }

  /// The size, and all of the file where the server has no ranges.
  void open() {
    std::shared_ptr<ByteSource> whole;
    std::string beginning;
    int handle = -1;
    const Answer answer = ask(
        0, remote_block, true, [&] { beginning.clear(), whole.reset(), handle = -1; },
        [&](const char* bytes, std::size_t count) {
          // What comes beyond a block can only be all of it.
          if (beginning.size() + count <= remote_block && handle < 0) {
            beginning.append(bytes, count);
            return;
          }
          if (handle < 0) {
            handle = open_temporary(), whole = disk_source(handle, url_);
            append_to(handle, beginning.data(), beginning.size());
          }
          append_to(handle, bytes, count);
        });
    if (answer.status == 206) {
      if (!answer.total || answer.first != std::optional<std::uint64_t>(0))
        fail("the server does not say how large the file is");
      size = *answer.total;
      if (beginning.size() != std::min<std::uint64_t>(remote_block, size))
        fail("the server sends " + std::to_string(beginning.size()) + " bytes of a file that it says has " +
             std::to_string(size));
      keep(0, std::make_shared<const std::string>(std::move(beginning)));
      return;
    }
    if (handle < 0) {
      handle = open_temporary(), whole = disk_source(handle, url_);
      append_to(handle, beginning.data(), beginning.size());
    }
    whole_ = whole, size = answer.taken;
  }

  void fetch(std::uint64_t offset, std::span<std::byte> bytes) const {
    std::size_t done = 0;
    const Answer answer = ask(
        offset, bytes.size(), false, [&] { done = 0; },
        [&](const char* from, std::size_t count) {  // no more than asked for, by `most`
          std::memcpy(bytes.data() + done, from, count), done += count;
        });
    if (answer.total != std::optional(size)) fail("the file has changed at the server; read it again");
    if (answer.first != std::optional(offset) || done != bytes.size())
      fail("the server sends " + std::to_string(done) + " of " + std::to_string(bytes.size()) +
           " bytes from byte " + std::to_string(offset));
  }

  std::shared_ptr<const std::string> block_at(std::uint64_t block) const {
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = blocks_.find(block); found != blocks_.end()) return found->second;
    }
    std::string bytes(std::size_t(std::min(remote_block, size - block * remote_block)), '\0');
    fetch(block * remote_block, std::as_writable_bytes(std::span(bytes)));
    return keep(block, std::make_shared<const std::string>(std::move(bytes)));
  }
  std::shared_ptr<const std::string> keep(std::uint64_t block,
                                          std::shared_ptr<const std::string> bytes) const {
    const std::lock_guard lock(mutex_);
    if (blocks_.emplace(block, bytes).second) order_.push_back(block);
    if (order_.size() > most_blocks) blocks_.erase(order_.front()), order_.pop_front();
    return bytes;
  }

  CURL* take_handle() const {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) {
      CURL* const handle = Curl::get().init();
      if (!handle) throw Error(ErrorCode::out_of_memory, url_ + ": libcurl is out of memory");
      return handle;
    }
    CURL* const handle = idle_.back();
    idle_.pop_back();
    return handle;
  }
  void give_handle(CURL* handle) const {  // with its connection
    const std::lock_guard lock(mutex_);
    idle_.push_back(handle);
  }

  std::string url_;
  std::shared_ptr<const ByteSource> whole_;  ///< where there are no ranges
  mutable std::mutex mutex_;
  mutable std::vector<CURL*> idle_;
  mutable std::map<std::uint64_t, std::shared_ptr<const std::string>> blocks_;
  mutable std::list<std::uint64_t> order_;
};

}  // namespace

std::shared_ptr<ByteSource> remote_source(const std::filesystem::path& url) {
  // A file is opened several times while it is read; what is kept of the last is used again.
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<RemoteSource>> open;
  static std::shared_ptr<RemoteSource> last;
  const auto keep = [&](std::shared_ptr<RemoteSource> source) {
    if (source) last = source;
    return source;
  };
  {
    const std::lock_guard lock(mutex);
    std::erase_if(open, [](const auto& each) { return each.second.expired(); });
    if (const auto found = open.find(url.native()); found != open.end())
      if (auto source = keep(found->second.lock())) return source;
  }
  auto source = std::make_shared<RemoteSource>(url.native());  // others are opened meanwhile
  const std::lock_guard lock(mutex);
  open[url.native()] = source;
  return keep(source);
}

#else

std::shared_ptr<ByteSource> remote_source(const std::filesystem::path& url) {
  throw Error(
      ErrorCode::io,
      url.string() + ": this sfumato is built without libcurl (libcurl4-openssl-dev); fetch the file first");
}

#endif

}  // namespace sfumato::io
