#include "tests/plugin/host/preview/gpu.h"

#include <optional>
#include <stdexcept>

#include "plugin/host/preview/offscreen.h"

namespace pelagic::gpu {
namespace {

constexpr int kWidth = 256;  // elements per row
constexpr int kInputUnit = 15;

}  // namespace

void need_context() {
    static std::optional<OffscreenContext> context;
    if (!context) context.emplace();
}

bool is_software() {
    need_context();
    const std::string_view renderer(reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
    return renderer.find("llvmpipe") != std::string_view::npos ||
           renderer.find("softpipe") != std::string_view::npos;
}

ShaderSource caller(ShaderSource source, std::string_view declarations, std::string_view body) {
    source.add_constants(
        "uniform sampler2D input_texels;\n"
        "uniform int texels_each;\n"
        "layout(location = 0) out vec4 answer;\n"
        "vec4 given(int i) {\n"
        "    ivec2 texel = ivec2(int(gl_FragCoord.x) * texels_each + i, int(gl_FragCoord.y));\n"
        "    return texelFetch(input_texels, texel, 0);\n"
        "}\n" +
        std::string(declarations) + "\nvoid main() {\n" + std::string(body) + "\n}\n");
    return source;
}

ShaderProgram program_of(const ShaderSource& fragment) {
    need_context();
    ShaderSource vertex;
    vertex.add_constants(
        "void main() {\n"
        "    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
        "}\n");
    return {vertex, fragment};
}

std::vector<glm::vec4> run(const ShaderProgram& program, std::span<const glm::vec4> inputs, int texels) {
    need_context();
    const std::size_t count = inputs.size() / static_cast<std::size_t>(texels);
    const auto rows = static_cast<int>((count + kWidth - 1) / kWidth);
    std::vector<glm::vec4> padded(inputs.begin(), inputs.end());
    padded.resize(static_cast<std::size_t>(rows) * kWidth * static_cast<std::size_t>(texels));
    const GlTexture in, out;
    const auto texture = [](const GlTexture& of, int width, int height, const glm::vec4* data) {
        glActiveTexture(GL_TEXTURE0 + kInputUnit);
        glBindTexture(GL_TEXTURE_2D, of.name());
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, data);
    };
    texture(out, kWidth, rows, nullptr);
    texture(in, kWidth * texels, rows, padded.data());
    const GlFramebuffer framebuffer;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, out.name(), 0);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw std::runtime_error("no float framebuffer");
    const GlVertexArray no_array;
    glBindVertexArray(no_array.name());
    glViewport(0, 0, kWidth, rows);
    glDisable(GL_DEPTH_TEST);
    program.use();
    glUniform1i(program.uniform("input_texels"), kInputUnit);
    glUniform1i(program.uniform("texels_each"), texels);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    std::vector<glm::vec4> answers(static_cast<std::size_t>(rows) * kWidth);
    glReadPixels(0, 0, kWidth, rows, GL_RGBA, GL_FLOAT, answers.data());
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glBindVertexArray(0);
    if (glGetError() != GL_NO_ERROR) throw std::runtime_error("OpenGL reports an error");
    answers.resize(count);
    return answers;
}

}  // namespace pelagic::gpu
