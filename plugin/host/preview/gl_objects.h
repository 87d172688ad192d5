// OpenGL objects as C++ values. The context must be current when they are made and deleted.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace pelagic {

template <class Maker>
class GlObject {
  public:
    GlObject() : name_(Maker::make()) {}
    ~GlObject() {
        if (name_ != 0) Maker::remove(name_);
    }
    GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    GLuint name() const { return name_; }

  private:
    GLuint name_;
};

struct GlTextureMaker {
    static GLuint make() {
        GLuint name = 0;
        glGenTextures(1, &name);
        return name;
    }
    static void remove(GLuint name) { glDeleteTextures(1, &name); }
};
struct GlBufferMaker {
    static GLuint make() {
        GLuint name = 0;
        glGenBuffers(1, &name);
        return name;
    }
    static void remove(GLuint name) { glDeleteBuffers(1, &name); }
};
struct GlVertexArrayMaker {
    static GLuint make() {
        GLuint name = 0;
        glGenVertexArrays(1, &name);
        return name;
    }
    static void remove(GLuint name) { glDeleteVertexArrays(1, &name); }
};
struct GlFramebufferMaker {
    static GLuint make() {
        GLuint name = 0;
        glGenFramebuffers(1, &name);
        return name;
    }
    static void remove(GLuint name) { glDeleteFramebuffers(1, &name); }
};
struct GlQueryMaker {
    static GLuint make() {
        GLuint name = 0;
        glGenQueries(1, &name);
        return name;
    }
    static void remove(GLuint name) { glDeleteQueries(1, &name); }
};
struct GlSamplerMaker {
    static GLuint make() {
        GLuint name = 0;
        glGenSamplers(1, &name);
        return name;
    }
    static void remove(GLuint name) { glDeleteSamplers(1, &name); }
};
struct GlProgramMaker {
    static GLuint make() { return glCreateProgram(); }
    static void remove(GLuint name) { glDeleteProgram(name); }
};

using GlTexture = GlObject<GlTextureMaker>;
using GlBuffer = GlObject<GlBufferMaker>;
using GlVertexArray = GlObject<GlVertexArrayMaker>;
using GlFramebuffer = GlObject<GlFramebufferMaker>;
using GlQuery = GlObject<GlQueryMaker>;
using GlSampler = GlObject<GlSamplerMaker>;
using GlProgram = GlObject<GlProgramMaker>;

}  // namespace pelagic
