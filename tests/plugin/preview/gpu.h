// Functions of the shaders, called by the batch on whatever OpenGL there is without a display.
#pragma once

#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/preview/sea_renderer.h"
#include "plugin/preview/shader_program.h"

namespace pelagic::gpu {

// One context for the whole program, current on its only thread. Throws PreviewError where there is none, so
// that tests fail and say so.
void need_context();

// A fragment shader that answers, for element i of a batch, `body`'s expression (a vec4) of the i-th
// `texels` inputs, input(0) … input(texels − 1). `declarations` come before it.
ShaderSource caller(ShaderSource source, std::string_view declarations, std::string_view body);

// Runs a caller's program over inputs, `texels` for each element.
std::vector<glm::vec4> run(const ShaderProgram& program, std::span<const glm::vec4> inputs, int texels);
ShaderProgram program_of(const ShaderSource& fragment);

}  // namespace pelagic::gpu
