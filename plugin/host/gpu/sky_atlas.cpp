#include "plugin/host/gpu/sky_atlas.h"

#include <glm/vec3.hpp>

namespace pelagic {

SkyAtlas sky_atlas(const SkyMap& map) {
    const int whole = map.size();
    SkyAtlas atlas{.size = {whole + whole / 2, whole}, .texels = {}};
    atlas.texels.resize(static_cast<std::size_t>(atlas.size.x) * atlas.size.y,
                        glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    for (int level = 0; level < map.level_count(); ++level) {
        const int size = whole >> level;
        const glm::ivec2 first = level == 0 ? glm::ivec2(0) : glm::ivec2(whole, whole - 2 * size);
        const std::vector<glm::vec3>& from = map.level(level);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                atlas.texels[static_cast<std::size_t>(first.y + y) * atlas.size.x + first.x + x] =
                    glm::vec4(from[static_cast<std::size_t>(y) * size + x], 1.0f);
    }
    return atlas;
}

}  // namespace pelagic
