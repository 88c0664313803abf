#include "viewer/drop.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <chrono>
#include <functional>
#include <thread>

namespace sfumato::testing {
namespace {

class Source {
 public:
  Source() : display_(XOpenDisplay(nullptr)) {
    if (!display_) return;
    root_ = DefaultRootWindow(display_);
    own_ = XCreateSimpleWindow(display_, root_, -20, -20, 1, 1, 0, 0, 0);
  }
  ~Source() {
    if (display_) XCloseDisplay(display_);
  }

  std::string drop(const std::string& uris, int x, int y) {
    if (!display_) return "no display";
    target_ = aware_window_at(x, y);
    if (!target_) return "no window there that takes files";
    XSetSelectionOwner(display_, atom("XdndSelection"), own_, CurrentTime);
    const long version = 5;
    send("XdndEnter", {version << 24, long(atom("text/uri-list")), 0, 0});
    send("XdndPosition", {0, long(x) << 16 | y, CurrentTime, long(atom("XdndActionCopy"))});
    bool accepted = false;
    if (!wait_for("XdndStatus", uris,
                  [&](const XClientMessageEvent& status) { accepted = status.data.l[1] & 1; }))
      return "no answer to XdndPosition";
    if (!accepted) return "the window does not take them";
    send("XdndDrop", {0, CurrentTime, 0, 0});
    if (!wait_for("XdndFinished", uris, [](const XClientMessageEvent&) {})) return "no end of the drop";
    return was_asked_ ? "" : "the window never asked for the files";
  }

 private:
  Atom atom(const char* name) { return XInternAtom(display_, name, False); }

  ::Window aware_window_at(int x, int y) {
    ::Window root = 0, parent = 0, *children = nullptr, found = 0;
    unsigned count = 0;
    XQueryTree(display_, root_, &root, &parent, &children, &count);
    for (unsigned i = 0; i < count; ++i) {
      XWindowAttributes at;
      if (!XGetWindowAttributes(display_, children[i], &at) || at.map_state != IsViewable) continue;
      if (x < at.x || y < at.y || x >= at.x + at.width || y >= at.y + at.height) continue;
      Atom type = 0;
      int format = 0;
      unsigned long items = 0, rest = 0;
      unsigned char* data = nullptr;
      XGetWindowProperty(display_, children[i], atom("XdndAware"), 0, 1, False, AnyPropertyType, &type,
                         &format, &items, &rest, &data);
      if (data) XFree(data);
      if (type != None) found = children[i];  // the last is on top
    }
    if (children) XFree(children);
    return found;
  }

  void send(const char* type, const std::vector<long>& rest) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.display = display_;
    event.xclient.window = target_;
    event.xclient.message_type = atom(type);
    event.xclient.format = 32;
    event.xclient.data.l[0] = long(own_);
    for (std::size_t i = 0; i < rest.size(); ++i) event.xclient.data.l[i + 1] = rest[i];
    XSendEvent(display_, target_, False, NoEventMask, &event);
    XFlush(display_);
  }

  /// Gives the files to whoever asks for them meanwhile.
  bool wait_for(const char* type, const std::string& uris,
                const std::function<void(const XClientMessageEvent&)>& take) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < end) {
      if (!XPending(display_)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        continue;
      }
      XEvent event;
      XNextEvent(display_, &event);
      if (event.type == ClientMessage && event.xclient.message_type == atom(type)) {
        take(event.xclient);
        return true;
      }
      if (event.type == SelectionRequest) answer(event.xselectionrequest, uris);
    }
    return false;
  }

  void answer(const XSelectionRequestEvent& request, const std::string& uris) {
    was_asked_ = true;
    XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(uris.data()), int(uris.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = request.requestor;
    event.xselection.selection = request.selection;
    event.xselection.target = request.target;
    event.xselection.property = request.property;
    event.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &event);
    XFlush(display_);
  }

  Display* display_ = nullptr;
  ::Window root_ = 0, own_ = 0, target_ = 0;
  bool was_asked_ = false;
};

}  // namespace

std::string drop_files(const std::vector<std::string>& paths, int x, int y) {
  std::string uris;
  for (const std::string& path : paths) uris += "file://" + path + "\r\n";
  return Source().drop(uris, x, y);
}

}  // namespace sfumato::testing
