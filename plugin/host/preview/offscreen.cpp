#include "plugin/host/preview/offscreen.h"

#include <epoxy/egl.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace pelagic {
namespace {

bool has(const char* extensions, std::string_view wanted) {
    return extensions &&
           (" " + std::string(extensions) + " ").find(" " + std::string(wanted) + " ") != std::string::npos;
}

// Possible EGL displays, fastest first: each graphics card, then Mesa without one.
std::vector<EGLDisplay> displays() {
    std::vector<EGLDisplay> found;
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (has(client, "EGL_EXT_platform_device") && has(client, "EGL_EXT_device_enumeration")) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
        for (int i = 0; i < count; ++i) {
            if (has(eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software"))
                continue;
            found.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
        }
    }
    if (has(client, "EGL_MESA_platform_surfaceless"))
        found.push_back(
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    return found;
}

}  // namespace

struct OffscreenContext::Implementation {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;

    // Makes a context and makes it current. Returns whether that succeeded.
    bool make(EGLDisplay on) {
        if (on == EGL_NO_DISPLAY || !eglInitialize(on, nullptr, nullptr)) return false;
        constexpr std::array kConfig{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT,
                                     EGL_NONE};
        constexpr std::array kContext{EGL_CONTEXT_MAJOR_VERSION,
                                      3,
                                      EGL_CONTEXT_MINOR_VERSION,
                                      3,
                                      EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                      EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        eglBindAPI(EGL_OPENGL_API);
        eglChooseConfig(on, kConfig.data(), &config, 1, &count);
        display = on;
        context = eglCreateContext(on, count > 0 ? config : nullptr, EGL_NO_CONTEXT, kContext.data());
        if (context != EGL_NO_CONTEXT && eglMakeCurrent(on, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
            return true;
        release();
        return false;
    }
    void release() {
        if (display == EGL_NO_DISPLAY) return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
        eglTerminate(display);
        display = EGL_NO_DISPLAY;
        context = EGL_NO_CONTEXT;
    }
};

OffscreenContext::OffscreenContext() : implementation_(std::make_unique<Implementation>()) {
    for (const EGLDisplay display : displays())
        if (implementation_->make(display)) return;
    throw PreviewError(
        "no OpenGL 3.3 without a display: EGL finds no driver that gives one. On Debian: apt install libegl1 "
        "libgl1-mesa-dri; or use pelagic render, which needs none");
}

OffscreenContext::~OffscreenContext() {
    implementation_->release();
}

}  // namespace pelagic
