// Calls functions of the shaders in batches, on any OpenGL that works without a display.
#pragma once

#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/host/preview/sea_renderer.h"
#include "plugin/host/preview/shader_program.h"

namespace pelagic::gpu {

// Makes one context for the whole program, current on its only thread. Throws PreviewError if that fails, so
// that tests fail with its message.
void need_context();

// Whether Mesa draws on the CPU: it filters textures in floats and contracts no product with a sum. GPUs do, as OpenGL lets
// them, and their textures' weights have eight bits.
bool is_software();

// A fragment shader that evaluates, for element i of a batch, the expression in `body` (a vec4) from the i-th
// `texels` inputs, input(0) … input(texels − 1). `declarations` come before it.
ShaderSource caller(ShaderSource source, std::string_view declarations, std::string_view body);

// Runs such a program over inputs, `texels` for each element.
std::vector<glm::vec4> run(const ShaderProgram& program, std::span<const glm::vec4> inputs, int texels);
ShaderProgram program_of(const ShaderSource& fragment);

}  // namespace pelagic::gpu
