// The sky for hosts without mip levels: sky_atlas.glsl over sky_atlas() against the map itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/lighting/sky_map.h"
#include "plugin/host/gpu/sky_atlas.h"
#include "tests/plugin/host/preview/gpu.h"

namespace pelagic {
namespace {

SkyMap noise(int size) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> value(0.0f, 10.0f);
    std::vector<glm::vec3> texels(static_cast<std::size_t>(size) * size);
    for (glm::vec3& texel : texels) texel = {value(random), value(random), value(random)};
    return SkyMap(size, std::move(texels));
}

TEST(SkyAtlas, IsReadAsTheMapIs) {
    gpu::need_context();
    constexpr int kSize = 32, kUnit = 3;
    const SkyMap map = noise(kSize);
    const SkyAtlas atlas = sky_atlas(map);
    ShaderSource source;
    source.add_constants("const float kSkyMapSize = 32.0;\n");
    source.add_file("core/lighting/special.glsl");
    source.add_file("plugin/host/gpu/sky_atlas.glsl");
    source.add_file("core/lighting/sky_map.glsl");
    const ShaderProgram program =
        gpu::program_of(gpu::caller(source, "", "answer = vec4(mapped_sky(given(0).xy, given(0).z), 1.0);"));
    program.use();
    const GlTexture texture;
    glActiveTexture(GL_TEXTURE0 + kUnit);
    glBindTexture(GL_TEXTURE_2D, texture.name());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, atlas.size.x, atlas.size.y, 0, GL_RGBA, GL_FLOAT,
                 atlas.texels.data());
    glUniform1i(program.uniform("sky_map"), kUnit);

    // Places beyond the map and levels beyond the last are held to the edge.
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(-1.6f, 1.6f), level(-1.0f, 7.0f);
    std::vector<glm::vec4> given(20000);
    for (glm::vec4& at : given) at = {place(random), place(random), level(random), 0.0f};
    const auto answers = gpu::run(program, given, 1);
    float worst = 0.0f;
    for (std::size_t i = 0; i < given.size(); ++i) {
        const glm::vec3 expected = map.radiance(glm::vec2(given[i]), given[i].z);
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(answers[i][c] - expected[c]));
    }
    EXPECT_LT(worst, 1e-4f);  // of 10
}

}  // namespace
}  // namespace pelagic
