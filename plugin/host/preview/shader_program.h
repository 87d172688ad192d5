// A vertex and a fragment shader, compiled and linked.
#pragma once

#include <string>
#include <vector>

#include "plugin/host/gpu/shader_source.h"
#include "plugin/host/gpu/uniforms.h"
#include "plugin/host/preview/gl_objects.h"

namespace pelagic {

class ShaderProgram {
  public:
    // Throws PreviewError with the driver's messages by file and line.
    ShaderProgram(const ShaderSource& vertex, const ShaderSource& fragment);

    void use() const { glUseProgram(program_.name()); }
    // −1, which OpenGL ignores, for a uniform that this variant doesn't use.
    GLint uniform(const char* name) const { return glGetUniformLocation(program_.name(), name); }
    GLuint name() const { return program_.name(); }

  private:
    GlProgram program_;
};

// Sets those uniforms that the program has; it must be in use.
void set_uniforms(const ShaderProgram& program, const std::vector<Uniform>& uniforms);

}  // namespace pelagic
