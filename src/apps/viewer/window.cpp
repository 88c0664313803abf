#include "window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "core/error.h"
#include "view/keys.h"

// DejaVu Sans, embedded by text.cpp.
extern "C" const unsigned char sfumato_font_begin[], sfumato_font_end[];

namespace sfumato::viewer {
namespace {

static_assert(view::key::escape == GLFW_KEY_ESCAPE && view::key::tab == GLFW_KEY_TAB &&
              view::key::f1 == GLFW_KEY_F1 && view::key::f9 == GLFW_KEY_F9 &&
              view::key::f11 == GLFW_KEY_F11 && view::key::keypad_1 == GLFW_KEY_KP_1 &&
              view::key::keypad_add == GLFW_KEY_KP_ADD &&
              view::key::keypad_subtract == GLFW_KEY_KP_SUBTRACT && view::key::equal == GLFW_KEY_EQUAL &&
              view::key::minus == GLFW_KEY_MINUS && 'R' == GLFW_KEY_R);

std::string& last_error() {
  static std::string text;
  return text;
}

ImVec4 color(int rgb, float alpha = 1) {
  return {float(rgb >> 16 & 255) / 255, float(rgb >> 8 & 255) / 255, float(rgb & 255) / 255, alpha};
}

}  // namespace

struct Window::Callbacks {
  static Window& of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }
  static void key(GLFWwindow* window, int key, int, int action, int mods) {
    Window& self = of(window);
    if (action == GLFW_PRESS) self.pressed_.push_back(key);
    if (action == GLFW_RELEASE && std::count(self.pressed_.begin(), self.pressed_.end(), key))
      self.short_keys_.push_back(key);
    // Where the keyboard walks through the panels, these are the panels' own.
    const bool walks = key == GLFW_KEY_SPACE || key == GLFW_KEY_ESCAPE;
    if (walks && ImGui::GetIO().NavVisible) return;
    if (action == GLFW_RELEASE || ImGui::GetIO().WantTextInput || !of(window).on_key) return;
    of(window).on_key(
        key, (mods & GLFW_MOD_SHIFT ? view::shift : 0) | (mods & GLFW_MOD_CONTROL ? view::control : 0));
  }
  static void drop(GLFWwindow* window, int count, const char** names) {
    const bool add = glfwGetKey(window, GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS;
    if (of(window).on_drop) of(window).on_drop(std::vector<std::string>(names, names + count), add);
  }
};

Window::Window(int width, int height, const std::string& title) {
  const std::string advice = "; sfumato FILE... -o OUT.png writes a picture without one";
  glfwSetErrorCallback([](int, const char* text) { last_error() = text; });
  // Asked without a display, GLFW 3.4 lets libwayland complain on standard error.
  const char* const displays[] = {"DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"};
  if (std::none_of(std::begin(displays), std::end(displays),
                   [](const char* name) { return std::getenv(name); }))
    throw Error(ErrorCode::no_gl,
                "no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set)" + advice);
  if (!glfwInit())
    throw Error(ErrorCode::no_gl, "no display to open a window on (" + last_error() + ")" + advice);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHintString(GLFW_X11_CLASS_NAME, "sfumato");
  glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "sfumato");
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!window_) {
    glfwTerminate();
    throw Error(ErrorCode::no_gl,
                "no window: the display offers no OpenGL 3.3 (" + last_error() + ")" + advice);
  }
  glfwSetWindowUserPointer(window_, this);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetKeyCallback(window_, Callbacks::key);
  glfwSetDropCallback(window_, Callbacks::drop);
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // nothing stored unless asked
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  ImGui_ImplGlfw_InitForOpenGL(window_, true);  // after ours, which it calls first
  ImGui_ImplOpenGL3_Init("#version 330");
  has_interface_ = true;
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  user_scale_ = std::clamp(std::max(x, y), 1.0f, 4.0f);
  for (const char* name : {"llvmpipe", "softpipe", "SWR", "SwiftShader"})
    is_software_ = is_software_ || gl::WindowPicture::renderer_name().find(name) != std::string::npos;
}

Window::~Window() {
  if (has_interface_) {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  if (window_) glfwDestroyWindow(window_);
  glfwTerminate();
}

bool Window::closing() const { return glfwWindowShouldClose(window_); }
void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
void Window::wake() { glfwPostEmptyEvent(); }
bool Window::is_down(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }
void Window::copy(const std::string& text) { glfwSetClipboardString(window_, text.c_str()); }

std::string Window::pasted() const {
  const char* text = glfwGetClipboardString(window_);
  return text ? text : "";
}

void Window::zoom_interface(float factor) {
  user_scale_ = std::clamp(user_scale_ * factor, 0.75f, 4.0f);
  restyle_ = true;
}

void Window::resize(int width, int height) { glfwSetWindowSize(window_, width, height); }

void Window::toggle_fullscreen() {
  is_full_ = !is_full_;
  if (!is_full_) return glfwSetWindowMonitor(window_, nullptr, place_[0], place_[1], place_[2], place_[3], 0);
  glfwGetWindowPos(window_, &place_[0], &place_[1]);
  glfwGetWindowSize(window_, &place_[2], &place_[3]);
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
  if (mode) glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

/// Calm greys, one accent.
void Window::style() {
  restyle_ = false;
  scale_ = user_scale_;
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  ImFontConfig config;
  config.FontDataOwnedByAtlas = false;
  config.OversampleH = 2, config.OversampleV = 1;
  // Latin, Greek for symbols of papers, super- and subscripts, arrows and signs.
  static const ImWchar ranges[] = {0x20,   0x17f,  0x2b0,  0x2ff,  0x370,  0x3ff,  0x2010, 0x205e, 0x2070,
                                   0x209f, 0x2190, 0x21ff, 0x2200, 0x22ff, 0x25a0, 0x25ff, 0};
  io.Fonts->AddFontFromMemoryTTF(const_cast<unsigned char*>(sfumato_font_begin),
                                 int(sfumato_font_end - sfumato_font_begin), std::round(14.0f * scale_),
                                 &config, ranges);
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();

  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  if (dark_)
    ImGui::StyleColorsDark();
  else
    ImGui::StyleColorsLight();
  const auto set = [&](ImGuiCol what, int dark, int light, float alpha = 1) {
    style.Colors[what] = color(dark_ ? dark : light, alpha);
  };
  const int accent = 0x4d8fbf, accent_light = 0x2f78ad;
  set(ImGuiCol_WindowBg, 0x1f2226, 0xf4f4f2);
  set(ImGuiCol_PopupBg, 0x262a2f, 0xffffff, 0.98f);
  set(ImGuiCol_Border, 0x363b42, 0xd2d2ce);
  set(ImGuiCol_Text, 0xdadde1, 0x23262a);
  set(ImGuiCol_TextDisabled, 0x858b93, 0x767b82);
  set(ImGuiCol_FrameBg, 0x2c3137, 0xe4e4e0);
  set(ImGuiCol_FrameBgHovered, 0x363c44, 0xdadad5);
  set(ImGuiCol_FrameBgActive, 0x3d444d, 0xd0d0ca);
  set(ImGuiCol_Button, 0x30363d, 0xdededa);
  set(ImGuiCol_ButtonHovered, 0x3b434c, 0xd2d2cc);
  set(ImGuiCol_ButtonActive, accent, accent_light);
  set(ImGuiCol_Header, 0x2a2f35, 0xe6e6e2);
  set(ImGuiCol_HeaderHovered, 0x353b43, 0xdcdcd7);
  set(ImGuiCol_HeaderActive, 0x3d444d, 0xd0d0ca);
  set(ImGuiCol_SliderGrab, accent, accent_light);
  set(ImGuiCol_SliderGrabActive, 0x6aa9d6, 0x1d6090);
  set(ImGuiCol_CheckMark, 0x6aa9d6, accent_light);
  set(ImGuiCol_Separator, 0x363b42, 0xd2d2ce);
  set(ImGuiCol_PlotHistogram, accent, accent_light);
  set(ImGuiCol_NavHighlight, accent, accent_light);
  set(ImGuiCol_TitleBg, 0x262a2f, 0xe6e6e2);
  set(ImGuiCol_TitleBgActive, 0x2c3137, 0xdededa);
  set(ImGuiCol_ModalWindowDimBg, 0x101214, 0x606060, 0.4f);
  set(ImGuiCol_ScrollbarBg, 0x1f2226, 0xf4f4f2, 0);
  style.WindowRounding = 0, style.FrameRounding = 3, style.GrabRounding = 3, style.PopupRounding = 4;
  style.WindowBorderSize = 0, style.FrameBorderSize = 0, style.ScrollbarSize = 11;
  style.WindowPadding = {10, 8}, style.FramePadding = {6, 3}, style.ItemSpacing = {7, 5},
  style.IndentSpacing = 12;
  style.ScaleAllSizes(scale_);
}

/// Dear ImGui before 1.87 looks at keys once a frame: one that went down and up in between is held down for
/// it until the next.
void Window::hold_short_keys() {
#if IMGUI_VERSION_NUM < 18700
  ImGuiIO& io = ImGui::GetIO();
  const auto set = [&](const std::vector<int>& keys, bool down) {
    for (const int key : keys)
      if (key >= 0 && key < int(std::size(io.KeysDown))) io.KeysDown[key] = down;
  };
  std::erase_if(held_, [&](int key) { return is_down(key); });
  set(held_, false);
  set(short_keys_, true);
  held_ = short_keys_;
  io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL] || io.KeysDown[GLFW_KEY_RIGHT_CONTROL];
  io.KeyShift = io.KeysDown[GLFW_KEY_LEFT_SHIFT] || io.KeysDown[GLFW_KEY_RIGHT_SHIFT];
#endif
  pressed_.clear();
  short_keys_.clear();
}

void Window::begin_frame(double wait_s) {
  if (wait_s > 0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
  if (restyle_) style();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  hold_short_keys();
  if (on_input) on_input();
  ImGui::NewFrame();
}

std::optional<double> Window::owed_ms(double now_ms) const {
  if (!owes_frame_) return std::nullopt;
  return std::max(0.0, shown_ms_ + pause_ms_ - now_ms);
}

void Window::end_frame(double now_ms, bool in_motion) {
  ImGui::Render();
  pause_ms_ = in_motion && !is_new_ ? pause_in_motion_ms : software_pause_ms;
  owes_frame_ = is_software_ && now_ms - shown_ms_ < pause_ms_;
  if (owes_frame_) return;
  is_new_ = false;
  shown_ms_ = now_ms;
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  const ImVec4 ground = ImGui::GetStyle().Colors[ImGuiCol_WindowBg];
  picture_.show(width, height, {ground.x, ground.y, ground.z}, picture_size_[0], picture_size_[1], is_exact_);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
}

void Window::upload(const Image<Rgba8>& image, bool exact) {
  is_exact_ = exact;
  is_new_ = true;
  picture_.upload(image);
}

void* Window::plot() const { return reinterpret_cast<void*>(std::uintptr_t(plot_.texture())); }

}  // namespace sfumato::viewer
