// Each frame's sky, where the light changes. It stands alone: a frame costs its own sky and no other's.
#include "plugin/bake/sky_part.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <mutex>

#include "core/plan/fingerprint.h"
#include "core/scene/canonical.h"
#include "core/scene/keys.h"
#include "core/scene/number_keys.h"
#include "pelagic/version.h"
#include "plugin/bake/output_part.h"
#include "plugin/format/exr/exr.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

// A third of a degree a pixel: as fine as the texels of the sky's map near the horizon, where they are finest.
constexpr int kDomeWidth = 1024;

// What a half holds to a thousandth wherever the picture isn't black beside its brightest part. Nights are darker, and
// pictures of skies may have any unit.
bool fits_halves(const LatLong& picture) {
    float largest = 0.0f;
    for (const glm::vec3& radiance : picture.radiance)
        largest = std::max({largest, radiance.x, radiance.y, radiance.z});
    return largest > 0.1f && largest < 65504.0f;
}

}  // namespace

std::string dome_file(const Scene& scene, const Sky& sky) {
    const LatLong picture = lat_long(sky, kDomeWidth);
    exr::Image image{.width = picture.width, .height = picture.height, .channels = {}};
    // The encoder's rows rise: they begin with the last one.
    const glm::vec3* bottom =
        &picture.radiance[picture.radiance.size() - static_cast<std::size_t>(picture.width)];
    constexpr std::array kNames{"R", "G", "B"};
    for (int c = 0; c < 3; ++c)
        image.channels.push_back(
            {.name = kNames[c],
             .data = &bottom->x + c,
             .pixel_stride_bytes = sizeof(glm::vec3),
             .row_stride_bytes = -picture.width * std::ptrdiff_t{sizeof(glm::vec3)},
             .type = fits_halves(picture) ? exr::PixelType::Half : exr::PixelType::Float});
    exr::Header header{
        .attributes = {{"content", std::string("radiance of the sky without the sun's disc")},
                       {"projection",
                        std::string("lat-long: the middle column is +x, azimuth grows to the left, "
                                    "the top row is +z; below the horizon what the sea reflects")},
                       {"software", std::string("pelagic " PELAGIC_VERSION)}},
        .compression = exr::Compression::Zip};
    for (exr::Attribute& attribute : radiance_attributes(scene))
        header.attributes.push_back(std::move(attribute));
    describe(portable(scene), key_parts(KeyPart::Light), header.attributes);
    return exr::encode_scanline(header, image);
}

FilePattern dome_pattern(const Shot& shot) {
    return {shot.name + ".sky.", ".exr"};
}

namespace {

struct SkySlot final : OutputSlot {
    std::string file;
};

class SkyPart final : public OutputPart {
  public:
    using OutputPart::OutputPart;

    FilePattern pattern() const override { return dome_pattern(scene().shot); }
    std::string fingerprint(int frame) const override {
        std::call_once(picture_read_, [&] { picture_ = sky_content(scene()); });
        return Fingerprint()
            .add(base_)
            .add(canonical(portable(scene_at(scene(), frame)), key_parts(KeyPart::Light)))
            .add(picture_)
            .text();
    }
    std::unique_ptr<OutputSlot> make_slot() const override { return std::make_unique<SkySlot>(); }

    void compute(const SeaAtTime<float>&, int, OutputSlot&, const BuildWatch&) override {}
    void compute(const SeaAtTime<double>&, int, OutputSlot&, const BuildWatch&) override {}

    OutputMemory memory() const override {
        constexpr std::size_t kPixels = std::size_t{kDomeWidth} * kDomeWidth / 2, kTexel = 200,
                              kTexels = std::size_t{256} * 256;  // of the sky's map while it is made
        constexpr std::size_t kFile = kPixels * 3 * sizeof(float);
        return {.slot = kFile,
                .encoding = kPixels * sizeof(glm::vec3) + kFile + kTexels * kTexel,
                .remedy = "give light no keys"};
    }

    void encode(int frame, OutputSlot& slot) const override {
        const Scene now = scene_at(scene(), frame);
        static_cast<SkySlot&>(slot).file = dome_file(now, make_sky(now));
    }
    void write(int frame, const OutputSlot& slot, const FileSink& sink) const override {
        const std::string& bytes = static_cast<const SkySlot&>(slot).file;
        sink({.path = file(frame), .content = [&](const auto& take) { take(bytes); }});
    }

  private:
    mutable std::once_flag picture_read_;
    mutable std::string picture_;  // its content, where the sky is one
};

}  // namespace

std::unique_ptr<OutputPart> make_sky_part(const Plan& plan, const PlannedOutput& output,
                                          const std::shared_ptr<SquareCache>&) {
    return std::make_unique<SkyPart>(plan, output);
}

}  // namespace pelagic
