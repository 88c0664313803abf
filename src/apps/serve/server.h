// The server: HTTP and WebSocket on one thread, viewers behind them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "access.h"
#include "viewer.h"

namespace sfumato::serve {

struct Settings {
  std::string address = "127.0.0.1";
  int port = 8080;                 ///< 0: one that is free
  std::vector<std::string> hosts;  ///< names that browsers may know this machine by
  std::string token;
  std::size_t clients = 16;    ///< pages at the same time
  std::size_t selections = 4;  ///< different selections of points in memory at the same time
  bool opens_browser = false, verbose = false;
  bool share = false;  ///< all pages show one view, and each other's pointers
  Limits limits;
};

/// A picture that a program asks for.
struct PictureRequest {
  view::Start start;
  int width = 1280, height = 720;
};

struct Sources {
  view::Start start;                                    ///< of a new page
  std::function<PictureRequest(const Query&)> picture;  ///< throws Error(usage) for what is no option
  std::function<void(const std::string&)> announce;     ///< the address, once it answers
  std::function<void(const std::string&)> say;
};

/// Serves until Ctrl-C or SIGTERM; returns 0. Throws Error(io) where the port is taken, and what the files or
/// the driver complain of before the first picture.
int run(const Settings& settings, const Sources& sources);

/// What the page is made of.
struct PageFile {
  std::string name, type, text;
};
extern const std::vector<PageFile> page_files;

}  // namespace sfumato::serve
