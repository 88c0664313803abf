// Points in the OpenGL of a program of one's own: embed SCAN [TECHNIQUE]. A turning frame stands around and
// among the points, and hides and is hidden by them. Arrow keys turn the view.
#include <epoxy/gl.h>
#include <GLFW/glfw3.h>
#include <sfumato/embedded.h>
#include <sfumato/io.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace {

/// The twelve edges of a box, as thick bars of clear colours: whatever a program draws by itself.
void draw_frame(const sfumato::Bounds& box, const glm::dmat4& clip_from_world, int width, int height) {
  const glm::dvec3 corners[] = {box.min, box.max};
  glEnable(GL_SCISSOR_TEST);
  for (int step = 0; step <= 400; ++step)
    for (int edge = 0; edge < 12; ++edge) {
      const int axis = edge / 4, a = edge & 1, b = edge >> 1 & 1;
      glm::dvec3 p;
      p[axis] = glm::mix(box.min[axis], box.max[axis], step / 400.0);
      p[(axis + 1) % 3] = corners[a][(axis + 1) % 3], p[(axis + 2) % 3] = corners[b][(axis + 2) % 3];
      const glm::dvec4 clip = clip_from_world * glm::dvec4(p, 1);
      if (clip.w <= 0) continue;
      const float depth = float(0.5 + 0.5 * clip.z / clip.w);
      const int x = int((clip.x / clip.w + 1) * 0.5 * width), y = int((clip.y / clip.w + 1) * 0.5 * height);
      glScissor(x - 1, y - 1, 3, 3);
      const float orange[] = {1, 0.45f, 0, 1};
      glClearBufferfv(GL_COLOR, 0, orange);
      glClearBufferfi(GL_DEPTH_STENCIL, 0, depth, 0);
    }
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || !glfwInit()) {
    std::fprintf(stderr, "usage: embed SCAN [TECHNIQUE], with a display\n");
    return 1;
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow* window = glfwCreateWindow(960, 640, "points in a program of one's own", nullptr, nullptr);
  if (!window) {
    std::fprintf(stderr, "embed: no window with OpenGL 4.5\n");
    return 1;
  }
  glfwMakeContextCurrent(window);
  try {
    sfumato::PointCloud cloud = sfumato::io::read(argv[1]).cloud;
    const sfumato::Bounds box = sfumato::robust_bounds(cloud);
    const glm::dvec3 middle = 0.5 * (box.min + box.max);
    const double size = box.diagonal();
    sfumato::EmbeddedRenderer points;
    points.set_cloud(std::move(cloud));
    for (double turn = 0.6; !glfwWindowShouldClose(window); glfwPollEvents()) {
      turn += 0.02 * (glfwGetKey(window, GLFW_KEY_LEFT) - glfwGetKey(window, GLFW_KEY_RIGHT));
      int width = 0, height = 0;
      glfwGetFramebufferSize(window, &width, &height);
      if (width == 0 || height == 0) continue;
      const glm::dvec3 eye = middle + size * glm::dvec3(std::cos(turn), std::sin(turn), 0.5);
      const sfumato::HostView view{glm::lookAt(eye, middle, glm::dvec3(0, 0, 1)),
                                   glm::perspective(0.8, double(width) / height, 0.05 * size, 4 * size),
                                   width, height};
      points.request(argc > 2 ? argv[2] : "splats", view);
      points.wait(0.05);  // an interactive program would not wait, and show the picture before
      const sfumato::HostView shown =
          points.drawn().width == width && points.drawn().height == height ? points.drawn() : view;
      const float background[] = {0.1f, 0.12f, 0.15f, 1};
      glViewport(0, 0, width, height);
      glClearBufferfv(GL_COLOR, 0, background);
      glClearBufferfi(GL_DEPTH_STENCIL, 0, 1, 0);
      draw_frame(box, shown.projection * shown.view, width,
                 height);  // what stands together is seen from one place
      points.draw(0, {0, 0, width, height});
      glfwSwapBuffers(window);
    }
    points.release();
  } catch (const sfumato::Error& error) {
    std::fprintf(stderr, "embed: %s\n", error.what());
    return int(error.code());
  }
  glfwTerminate();
}
