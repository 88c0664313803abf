// What is around the picture and over it: panels, status, help, messages. Draws with Dear ImGui and changes
// the view model.
#pragma once

#include <deque>
#include <future>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/furniture.h"
#include "view/controls.h"
#include "view/histogram.h"
#include "view/keys.h"
#include "view/view_model.h"
#include "window.h"

namespace sfumato::viewer {

class Interface {
 public:
  Interface(Window& window, view::ViewModel& model);

  /// One frame; call between Window::begin_frame and end_frame.
  void draw(double now_ms);
  void act(view::Action action);
  void drop(const std::vector<std::string>& files, bool add);
  /// Something on the screen moves by itself: the next frame is due after so long.
  std::optional<double> wait_ms(double now_ms) const;

 private:
  void draw_view(double now_ms, float width, float height);
  void draw_marks(float x, float y);
  void draw_box(float x, float y);
  void draw_light_ball(float x, float y);
  void draw_panels(float x, float width, float height);
  void walk_here();
  void draw_status(float y, float width, float height);
  void draw_help();
  void draw_messages(double now_ms, float height);
  void navigate(double now_ms, float x, float y, bool hovered);
  void take_saved();
  void take_preset(const std::string& file);
  void save_look(bool with_files);
  void show_picture();

  // Panels, in *_panel.cpp and *_panels.cpp.
  void technique_panel();
  void parameter_panel();
  void item_panel();
  void color_panel();
  void histogram(const Coloring& coloring);
  bool has_swatches() const;
  void class_panel();
  void light_panel();
  void clip_panel();
  void camera_panel();
  void path_panel();
  void scene_panel();
  void file_list();
  void measure_panel();
  void timing_panel();
  void draw_profile(float width, float height);
  double line_length() const;
  float corridor() const;
  /// Draws one and changes the request where a hand changed it.
  void control(view::Control control);
  void controls(const std::vector<view::Control>& all);
  /// What a parameter is now: of an automatic one, what the last picture found.
  std::string resolved(const std::string& parameter) const;
  void set(const std::string& parameter, const std::string& value);
  /// A heading that opens; whether it is open.
  bool heading(const char* title, bool open);
  const view::Picture* picture() const { return model_.picture().get(); }

  struct Toast {
    view::Message message;
    double until_ms;
  };

  Window& window_;
  view::ViewModel& model_;
  std::unique_ptr<Look> look_;  ///< of the request, for its list of parameters
  view::ViewRequest look_of_;   ///< what `look_` is of
  std::shared_ptr<const view::Picture> uploaded_;
  Furniture uploaded_furniture_;
  std::deque<Toast> toasts_;
  std::vector<std::future<view::Message>> writers_;
  std::string search_, preset_name_, path_name_, screenshot_size_;
  bool panels_ = true, help_ = false, clip_ = false;
  view::Drag drag_ = view::Drag::none;
  dvec3 pivot_{0};
  int slice_axis_ = 2;
  float corridor_ = 0;                             ///< width, scene units; 0: not chosen yet
  std::tuple<std::uint64_t, int, int> plotted_{};  ///< profile and size of the plot in the window's texture
  view::Histogram histogram_;
  std::weak_ptr<const PointCloud> histogram_cloud_;
  std::string histogram_source_;
  float histogram_from_ = 0;
  double drag_px_ = 0, last_fly_ms_ = 0, now_ms_ = 0;
  bool swallow_click_ = false;
};

/// A name that no file has yet: "sfumato_0001.png".
std::string free_name(const std::string& stem, const std::string& extension);

}  // namespace sfumato::viewer
