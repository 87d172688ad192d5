// Each frame's sky, where the light changes. It stands alone: a frame costs its own sky and no other's.
#include "plugin/bake/sky_part.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "core/plan/fingerprint.h"
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

// The keys of the light's table. Exposure, and what else is of the light of pictures, is none of a sky's.
std::vector<DescribedKey> keys_of_sky(const Scene& scene) {
    std::vector<DescribedKey> keys = described(portable(scene), key_parts(KeyPart::Light));
    std::erase_if(keys, [](const DescribedKey& key) { return !key.path.starts_with("light."); });
    return keys;
}

}  // namespace

std::string sky_fingerprint(const Scene& scene, const std::string& content) {
    static const int revision =
        std::ranges::find(output_table(), OutputKind::Sky, &OutputRow::kind)->revision;
    std::string text;
    for (const DescribedKey& key : keys_of_sky(scene)) text += key.path + " = " + key.text + '\n';
    return Fingerprint().add("sky revision " + std::to_string(revision)).add(text).add(content).text();
}

std::string dome_file(const Scene& scene, const Sky& sky, std::string_view fingerprint) {
    const LatLong picture = lat_long(sky, kDomeWidth);
    const exr::PixelType type = fits_halves(picture) ? exr::PixelType::Half : exr::PixelType::Float;
    exr::Image image{.width = picture.width, .height = picture.height, .channels = {}};
    // The encoder's rows rise: they begin with the last one.
    const glm::vec3* bottom =
        &picture.radiance[picture.radiance.size() - static_cast<std::size_t>(picture.width)];
    constexpr std::array kNames{"R", "G", "B"};
    for (int c = 0; c < 3; ++c)
        image.channels.push_back({.name = kNames[c],
                                  .data = &bottom->x + c,
                                  .pixel_stride_bytes = sizeof(glm::vec3),
                                  .row_stride_bytes = -picture.width * std::ptrdiff_t{sizeof(glm::vec3)},
                                  .type = type});
    exr::Header header{
        .attributes = {{"content", std::string("radiance of the sky without the sun's disc")},
                       {"projection",
                        std::string("lat-long: the middle column is +x, azimuth grows to the left, "
                                    "the top row is +z; below the horizon what the sea reflects")},
                       {"software", std::string("pelagic " PELAGIC_VERSION)}},
        .compression = exr::Compression::Zip};
    for (exr::Attribute& attribute : radiance_attributes(scene))
        header.attributes.push_back(std::move(attribute));
    header.attributes.push_back({"fingerprint", std::string(fingerprint)});
    describe(keys_of_sky(scene), header.attributes);
    return exr::encode_scanline(header, image);
}

FilePattern dome_pattern(const Shot& shot) {
    return {shot.name + ".sky.", ".exr"};
}

namespace {

struct SkySlot final : OutputSlot {
    std::shared_ptr<const std::string> file;
};

class SkyPart final : public OutputPart {
  public:
    using OutputPart::OutputPart;

    FilePattern pattern() const override { return dome_pattern(scene().shot); }
    std::string fingerprint(int frame) const override {
        std::call_once(picture_read_, [&] { picture_ = sky_content(scene()); });
        return sky_fingerprint(scene_at(scene(), frame), picture_);
    }
    std::unique_ptr<OutputSlot> make_slot() const override { return std::make_unique<SkySlot>(); }

    void compute(const SeaAtTime<float>&, int, OutputSlot&, const BuildWatch&) override {}
    void compute(const SeaAtTime<double>&, int, OutputSlot&, const BuildWatch&) override {}

    OutputMemory memory() const override {
        constexpr std::size_t kPixels = std::size_t{kDomeWidth} * kDomeWidth / 2,
                              kFile = kPixels * 3 * sizeof(float);
        // The map while it is made, of a picture the largest, with the rows that are held (core/lighting/picture_sky.cpp); of daylight
        // what the air's suns scatter, which is kept.
        constexpr std::size_t kTexel = 100, kMiB = 1 << 20;  // [bytes]
        const bool is_picture = has_sky_picture(scene());
        const std::size_t texels = is_picture ? 1024 * 1024 : 256 * 256, rows = is_picture ? 48 * kMiB : 0;
        return {.once = is_picture ? 0 : 12 * kMiB,
                .slot = kFile,
                .encoding = kPixels * sizeof(glm::vec3) + kFile + texels * kTexel + rows,
                .remedy = "give light no keys"};
    }

    void encode(int frame, OutputSlot& slot) const override {
        std::shared_ptr<const std::string>& file = static_cast<SkySlot&>(slot).file;
        const std::string made_of = fingerprint(frame);
        {
            const std::lock_guard lock(mutex_);
            if (last_made_of_ == made_of) {
                file = last_;
                return;
            }
        }
        const Scene now = scene_at(scene(), frame);
        file = std::make_shared<const std::string>(dome_file(now, make_sky(now), made_of));
        const std::lock_guard lock(mutex_);
        last_made_of_ = made_of;
        last_ = file;
    }
    void write(int frame, const OutputSlot& slot, const FileSink& sink) const override {
        const std::string& bytes = *static_cast<const SkySlot&>(slot).file;
        sink({.path = file(frame), .content = [&](const auto& take) { take(bytes); }});
    }

  private:
    mutable std::once_flag picture_read_;
    mutable std::string picture_;  // its content, where the sky is one
    // Where the light rests frames have the same.
    mutable std::mutex mutex_;
    mutable std::string last_made_of_;
    mutable std::shared_ptr<const std::string> last_;
};

}  // namespace

std::unique_ptr<OutputPart> make_sky_part(const Plan& plan, const PlannedOutput& output,
                                          const std::shared_ptr<SquareCache>&) {
    return std::make_unique<SkyPart>(plan, output);
}

}  // namespace pelagic
