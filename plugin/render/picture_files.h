// Pictures as the bytes of files: HDR with its layers, and as a screen shows it.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/plan/plan.h"
#include "pelagic/scene.h"
#include "plugin/render/render.h"

namespace pelagic {

// NAME.0012.exr: of the shot's name and a frame.
std::string picture_file(const Shot& shot, int frame, const char* extension);

// The colours of the files: PNGs by a studio's display transform, and EXRs of other primaries.
struct PictureColours {
    // From linear Rec. 709, exposed, to display values, in place; null: display_bytes(). Any thread.
    std::function<void(std::span<glm::vec3>)> show{};
    std::string shown_by{};  // what that depends on, for fingerprints
    bool acescg = false;
};

inline const PictureColours kOwnColours{};

struct PictureContext {
    const Scene& scene;
    const RenderOptions& options;
    const Sky& sky;
    std::string made_of;  // PictureFingerprint::of(the frame)
    float exposure;       // shot_exposure() (plugin/light/exposure.h)
    const PictureColours& colours = kOwnColours;
    std::string chosen{};         // RunOptions::chosen (plugin/run/run.h), in the EXR's header
    const Scene* shot = nullptr;  // where `scene` is a frame's of a shot with keys: the sea is that of them
};

// Raised by hand when pictures of the same source get other bits; then none that is there counts as whole.
// tests/plugin/bake/golden_test.cpp notices bits that change without it.
inline constexpr int kPictureRevision = 23;
// The same for pictures of shots with objects alone.
inline constexpr int kObjectsRevision = 3;
// And where some of them glow.
inline constexpr int kLampsRevision = 1;

// What the two files of a frame are made of: the keys on which pictures depend, the camera's pose, the resolved plan,
// the sky's picture, the samples, terms and lookups of the light, the shutter, alpha, the layers, and the exposure.
// Pictures with the same are the same, byte for byte, on one kind of CPU; each file carries it.
struct PictureSource {
    const Scene& scene;  // its resolution is the picture's
    const RenderOptions& options;
    std::string picture_content;  // picture_content(scene)
    double exposure_stops = 0.0;
    bool drawn_by_gpu = false;
    const PictureColours& colours = kOwnColours;
};
class PictureFingerprint {
  public:
    explicit PictureFingerprint(const PictureSource& source);
    std::string of(int frame) const;  // 16 hexadecimal digits

  private:
    Shot shot_;
    Camera camera_;
    RenderOptions options_;
    std::optional<Plan> weather_;  // of a sea that changes
    Scene keyed_;                  // the shot's numbers that have keys, and nothing else of it
    std::string source_;
};

// EXR: scan lines; R, G, B, with alpha A, and the layers that the options name (kPictureLayers), those of the light in
// the sky's units; halves where no value that the light can give is beyond their range, floats for the others. The
// header says the colours' primaries, the luminance of (1, 1, 1) where it is known, what each layer holds, and what
// the picture was made of, and has a checksum of the whole file. The light's layers add up to R, G, B.
// With PictureColours::acescg all light is that of ACEScg's primaries.
// PNG: display_bytes() of the whole at the context's exposure, or what PictureColours::show makes of it; with alpha of the light
// divided by it, as the format wants.
std::string encode_exr(const PictureContext& context, const Picture& picture, int frame);
// NAME.deep.0012.exr: deep scan lines; R, G, B, A, from Z to ZBack, and id, a Cryptomatte's identifiers, whose names are in `manifest`.
std::string deep_file(const Shot& shot, int frame);
std::string encode_deep(const PictureContext& context, const Picture& picture, int frame);
std::string encode_png(const PictureContext& context, const Picture& picture, int frame);

// A picture's light with the lens' glare, in linear Rec. 709; empty where it has none.
std::vector<glm::vec3> glaring_light(const Camera& camera, const Picture& picture, int frame);

}  // namespace pelagic
