#include "plugin/host/preview/shader_program.h"

#include "plugin/host/preview/sea_renderer.h"

namespace pelagic {
namespace {

class Shader {
  public:
    Shader(GLenum stage, const ShaderSource& source) : name_(glCreateShader(stage)) {
        const char* text = source.text().c_str();
        glShaderSource(name_, 1, &text, nullptr);
        glCompileShader(name_);
        GLint ok = GL_FALSE, length = 0;
        glGetShaderiv(name_, GL_COMPILE_STATUS, &ok);
        if (ok == GL_TRUE) return;
        glGetShaderiv(name_, GL_INFO_LOG_LENGTH, &length);
        std::string messages(static_cast<std::size_t>(length) + 1, '\0');
        glGetShaderInfoLog(name_, length + 1, nullptr, messages.data());
        glDeleteShader(name_);
        throw PreviewError(
            "the driver does not compile a shader of the preview; "
            "update it, or use pelagic render:\n" +
            source.explain(messages.c_str()));
    }
    ~Shader() { glDeleteShader(name_); }
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;
    GLuint name() const { return name_; }

  private:
    GLuint name_;
};

}  // namespace

ShaderProgram::ShaderProgram(const ShaderSource& vertex, const ShaderSource& fragment) {
    const Shader first(GL_VERTEX_SHADER, vertex), second(GL_FRAGMENT_SHADER, fragment);
    glAttachShader(program_.name(), first.name());
    glAttachShader(program_.name(), second.name());
    glLinkProgram(program_.name());
    GLint ok = GL_FALSE, length = 0;
    glGetProgramiv(program_.name(), GL_LINK_STATUS, &ok);
    glDetachShader(program_.name(), first.name());
    glDetachShader(program_.name(), second.name());
    if (ok == GL_TRUE) return;
    glGetProgramiv(program_.name(), GL_INFO_LOG_LENGTH, &length);
    std::string messages(static_cast<std::size_t>(length) + 1, '\0');
    glGetProgramInfoLog(program_.name(), length + 1, nullptr, messages.data());
    throw PreviewError(std::string("the driver does not link a shader of the preview; "
                                   "update it, or use pelagic render:\n") +
                       messages.c_str());
}

void set_uniforms(const ShaderProgram& program, const std::vector<Uniform>& uniforms) {
    for (const Uniform& uniform : uniforms) {
        const GLint at = program.uniform(uniform.name.c_str());
        const glm::vec4& v = uniform.value;
        if (uniform.is_integer)
            glUniform1i(at, static_cast<GLint>(v.x));
        else if (uniform.components == 1)
            glUniform1f(at, v.x);
        else if (uniform.components == 2)
            glUniform2f(at, v.x, v.y);
        else if (uniform.components == 3)
            glUniform3f(at, v.x, v.y, v.z);
        else
            glUniform4f(at, v.x, v.y, v.z, v.w);
    }
}

}  // namespace pelagic
