#include "gl/context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <sys/mman.h>

#include <cstring>
#include <utility>

#include "core/error.h"

namespace sfumato::gl {

namespace {

/// Of the context that is current on this thread.
struct Current {
  const Limits* limits = nullptr;
  Preferences* preferences = nullptr;
  Pacing* pacing = nullptr;
};
thread_local Current current;

const char* const advice =
    "; install an OpenGL 4.5 driver (on Debian: libegl1 libgl1-mesa-dri libopengl0, or the GPU vendor's)";

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::no_gl, what + advice); }

// Mesa takes 0.4 GB of address space before the first picture, and where it gets less it crashes or seems
// missing. So much is asked for first, and not touched.
void require_memory() {
  constexpr std::size_t least = 512 << 20;
  void* probe = ::mmap(nullptr, least, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (probe == MAP_FAILED)
    throw Error(ErrorCode::out_of_memory,
                "out of memory: OpenGL needs 512 MB of address space beside the points; "
                "raise the limit (ulimit -v) or use fewer points (--max-points)");
  ::munmap(probe, least);
}

bool has_extension(const char* list, const char* name) {
  for (const char* at = list; at && (at = std::strstr(at, name)); at += std::strlen(name)) {
    const char end = at[std::strlen(name)];
    if ((at == list || at[-1] == ' ') && (end == ' ' || end == 0)) return true;
  }
  return false;
}

void GLAPIENTRY on_message(GLenum source, GLenum, GLuint, GLenum severity, GLsizei length, const GLchar* text,
                           const void* user) {
  // Mesa reports compiler warnings as severe, and only while its shader cache is cold; errors are thrown
  // anyway.
  if (severity != GL_DEBUG_SEVERITY_HIGH || source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
  auto* messages = static_cast<std::vector<std::string>*>(const_cast<void*>(user));
  messages->emplace_back(text, length < 0 ? std::strlen(text) : std::size_t(length));
}

/// What is current on this thread, ours or not, to be put back.
class Before {
 public:
  EGLContext context() const { return context_; }
  /// `own`: a display of ours.
  void put_back(EGLDisplay own) const {
    eglBindAPI(api_);
    if (context_ == EGL_NO_CONTEXT)
      eglMakeCurrent(own, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    else
      eglMakeCurrent(display_, draw_, read_, context_);
    current = current_;
  }

 private:
  EGLenum api_ = eglQueryAPI();
  EGLDisplay display_ = eglGetCurrentDisplay();
  EGLContext context_ = eglGetCurrentContext();
  EGLSurface draw_ = eglGetCurrentSurface(EGL_DRAW), read_ = eglGetCurrentSurface(EGL_READ);
  Current current_ = current;
};

}  // namespace

struct Context::Egl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  bool open(EGLDisplay candidate, const char*& lacks, EGLContext shared = EGL_NO_CONTEXT);
  void close();
};

/// Makes a context of this display current; false, and a reason, when it cannot do what we need.
bool Context::Egl::open(EGLDisplay candidate, const char*& lacks, EGLContext shared) {
  // A display is one for the whole process, and stays: the program or another thread may use it, too.
  if (!eglInitialize(candidate, nullptr, nullptr)) return false;
  display = candidate;
  auto refuse = [&](const char* reason) {
    lacks = reason;
    close();
    return false;
  };
  if (!eglBindAPI(EGL_OPENGL_API)) return refuse("no OpenGL: this EGL offers OpenGL ES only");
  // Told of resets (gl/reset.h) where the driver can tell; the last attribute is left out where it cannot.
  EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                         4,
                         EGL_CONTEXT_MINOR_VERSION,
                         5,
                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                         EGL_CONTEXT_OPENGL_DEBUG,
                         EGL_TRUE,
                         EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                         EGL_LOSE_CONTEXT_ON_RESET,
                         EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_NONE};
  eglChooseConfig(display, wanted, &config, 1, &configs);
  const auto create = [&] {
    context = eglCreateContext(display, configs ? config : EGL_NO_CONFIG_KHR, shared, attributes);
    return context != EGL_NO_CONTEXT;
  };
  if (!create()) {
    attributes[8] = EGL_NONE;
    create();
  }
  if (context == EGL_NO_CONTEXT) return refuse("no OpenGL 4.5 core context: the driver is too old");
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
    return refuse("the OpenGL context cannot be used without a window");
  if (epoxy_gl_version() < 45) return refuse("OpenGL 4.5 is needed, the driver offers less");
  return true;
}

void Context::Egl::close() {
  if (display == EGL_NO_DISPLAY) return;
  if (context != EGL_NO_CONTEXT) {
    if (eglGetCurrentContext() == context)
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
  }
  display = EGL_NO_DISPLAY;
  context = EGL_NO_CONTEXT;
}

std::unique_ptr<Context> Context::create_headless(Preferences preferences, const Context* shared) {
  require_memory();
  // epoxy aborts the process where a library is missing, so look for them first.
  for (const char* library : {"libEGL.so.1", "libOpenGL.so.0"})
    if (!dlopen(library, RTLD_LAZY | RTLD_GLOBAL))
      fail(std::string("no OpenGL: ") + library + " is not installed");

  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!has_extension(client, "EGL_EXT_platform_base"))
    fail("no OpenGL: EGL cannot open a display by platform");

  const struct Return {
    Before before;
    ~Return() {
      if (before.context() != EGL_NO_CONTEXT) before.put_back(EGL_NO_DISPLAY);
    }
  } to_what_was_current;
  std::unique_ptr<Context> context(new Context);
  context->preferences_ = std::move(preferences);
  context->egl_ = std::make_unique<Egl>();
  // Devices first: on machines with a GPU the surfaceless platform of Mesa would find only software. A device
  // whose driver is too old is passed over for the next one, software included.
  std::vector<EGLDisplay> displays;
  if (shared) displays.push_back(shared->egl_->display);
  if (!shared && has_extension(client, "EGL_EXT_platform_device") &&
      has_extension(client, "EGL_EXT_device_enumeration")) {
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    eglQueryDevicesEXT(16, devices, &count);
    for (EGLint i = 0; i < count; ++i)
      displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
  }
  if (!shared && has_extension(client, "EGL_MESA_platform_surfaceless"))
    displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  const char* lacks = "no OpenGL: EGL found no driver";
  for (EGLDisplay display : displays)
    if (display != EGL_NO_DISPLAY &&
        context->egl_->open(display, lacks, shared ? shared->egl_->context : EGL_NO_CONTEXT))
      break;
  if (context->egl_->context == EGL_NO_CONTEXT) fail(lacks);

  glDebugMessageCallback(on_message, &context->messages_);
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);

  Limits& limits = context->limits_;
  auto text = [](GLenum name) { return std::string(reinterpret_cast<const char*>(glGetString(name))); };
  auto number = [](GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
  };
  limits.version = text(GL_VERSION);
  limits.renderer = text(GL_RENDERER);
  limits.vendor = text(GL_VENDOR);
  for (const char* name : {"llvmpipe", "softpipe", "SwiftShader"})
    limits.software |= limits.renderer.find(name) != std::string::npos;
  limits.max_texture_size = number(GL_MAX_TEXTURE_SIZE);
  limits.max_texture_buffer_size = number(GL_MAX_TEXTURE_BUFFER_SIZE);
  limits.max_storage_block_size = number(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
  GLint groups = 0;
  glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
  limits.max_work_groups = groups;
  GLfloat range[2] = {1, 1};
  glGetFloatv(GL_POINT_SIZE_RANGE, range);
  limits.max_point_size = range[1];
  // Mesa's zink (22.3) names the extension, and ends the process at the first shader that uses it.
  limits.float_atomics = epoxy_has_gl_extension("GL_NV_shader_atomic_float") &&
                         limits.renderer.find("zink") == std::string::npos;
  limits.int64_atomics = epoxy_has_gl_extension("GL_NV_shader_atomic_int64") &&
                         epoxy_has_gl_extension("GL_ARB_gpu_shader_int64");
  current = {&limits, &context->preferences_, &context->pacing_};

  // One vertex array without attributes serves every draw: shaders fetch points from texture buffers.
  GLuint array = 0;
  glCreateVertexArrays(1, &array);
  glBindVertexArray(array);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glEnable(GL_PROGRAM_POINT_SIZE);
  return context;
}

Context::~Context() {
  if (current.limits == &limits_) current = {};
  if (egl_) egl_->close();
}

struct Context::Use::Outside {
  EGLDisplay own;
  Before before;
};

Context::Use::Use(Context& context) {
  if (eglGetCurrentContext() == context.egl_->context) {
    current = {&context.limits_, &context.preferences_, &context.pacing_};
    return;
  }
  outside_ = std::make_unique<Outside>(Outside{context.egl_->display, {}});
  if (!eglMakeCurrent(context.egl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context.egl_->context))
    throw Error(ErrorCode::no_gl,
                "the OpenGL context is in use on another thread; give each thread a renderer of its own");
  current = {&context.limits_, &context.preferences_, &context.pacing_};
}

Context::Use::~Use() {
  if (outside_) outside_->before.put_back(outside_->own);
}

std::vector<std::string> Context::take_messages() {
  const Use use(*this);
  glFinish();
  return std::exchange(messages_, {});
}

const Limits& limits() {
  static const Limits none;
  return current.limits ? *current.limits : none;
}

Preferences& preferences() {
  if (current.preferences) return *current.preferences;
  thread_local Preferences without_context;
  without_context = Preferences::from_environment();
  return without_context;
}

Pacing* current_pacing() { return current.pacing; }

Place place_of_work(Place preferred) {
  if (preferred != Place::automatic) return preferred;
  // Who brings shaders wants to see them.
  return limits().software && preferences().shader_folder.empty() ? Place::cpu : Place::gpu;
}

void require(bool condition, const std::string& who, const std::string& needs) {
  if (condition) return;
  throw Error(ErrorCode::no_gl, who + " needs " + needs + ", which " + limits().renderer + " (OpenGL " +
                                    limits().version + ") does not have; try another technique or driver");
}

void check_memory(const std::string& what) {
  if (glGetError() != GL_OUT_OF_MEMORY) return;
  throw Error(ErrorCode::out_of_memory, "out of graphics memory while allocating " + what +
                                            "; try --max-points or a smaller --resolution");
}

}  // namespace sfumato::gl
