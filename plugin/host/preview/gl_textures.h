// Textures of floats that shaders read with texelFetch().
#pragma once

#include "plugin/host/preview/gl_objects.h"

namespace pelagic {

inline void bind_texture(int unit, const GlTexture& texture) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_2D, texture.name());
}

// Binds a texture for changes, on a unit that every draw call binds again.
inline void edit_texture(const GlTexture& texture) {
    bind_texture(0, texture);
}

struct TexelFormat {
    GLenum internal, format;
};
inline TexelFormat float_texels(int channels) {
    switch (channels) {
        case 1:
            return {GL_R32F, GL_RED};
        case 2:
            return {GL_RG32F, GL_RG};
        default:
            return {GL_RGBA32F, GL_RGBA};
    }
}

inline void texels_as_they_are() {
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
}

}  // namespace pelagic
