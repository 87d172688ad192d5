#include "plugin/render/render_files.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/number_keys.h"
#include "plugin/files/files.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/render/picture_files.h"
#include "plugin/run/work.h"

namespace pelagic {
namespace {

struct PictureSlot : RunSlot {
    Picture picture;
    std::array<std::string, 3> files;  // by part
    // Of a shot whose numbers have keys, the frame's own.
    std::optional<Scene> scene;
    std::optional<Sky> sky;
    float exposure = 0.0f;
};
constexpr std::size_t kPng = 0, kExr = 1, kDeep = 2;  // parts; the last one where it is asked for

std::string file_of(const Shot& shot, std::size_t part, int frame) {
    return part == kDeep ? deep_file(shot, frame) : picture_file(shot, frame, part == kPng ? "png" : "exr");
}

class Pictures final : public Sequence {
  public:
    Pictures(const PictureOrder& order, const PictureFingerprint& made_of, std::string chosen,
             std::span<const int> frames, const std::function<BuildWatch(RunStage)>& watch)
        : order_(order),
          made_of_(made_of),
          chosen_(std::move(chosen)),
          cancel_(watch(RunStage::Building).cancel),
          renderer_(order.scene, order.options, make_sky(scene_at(order.scene, frames.front())), frames,
                    watch(RunStage::Building)),
          exposure_(order.scene.keyed.empty()
                        ? shot_exposure(order.scene, renderer_.sky(), order.exposure_stops)
                        : 0.0f) {
        renderer_.check_cameras(frames, watch(RunStage::Looking));
    }

    std::unique_ptr<RunSlot> make_slot() const override { return std::make_unique<PictureSlot>(); }

    void compute(int frame, RunSlot& any, const std::function<void(double)>& progress) override {
        PictureSlot& slot = static_cast<PictureSlot&>(any);
        slot.frame = frame;
        renderer_.render(frame, slot.picture, {.progress = progress, .cancel = cancel_});
        slot.exposure = exposure_;
        if (order_.scene.keyed.empty()) return;
        slot.scene = scene_at(order_.scene, frame);
        slot.sky = renderer_.sky();
        slot.exposure = shot_exposure(*slot.scene, *slot.sky, order_.exposure_stops);
    }

    void encode(RunSlot& any) const override {
        PictureSlot& slot = static_cast<PictureSlot&>(any);
        const PictureContext context{.scene = slot.scene ? *slot.scene : order_.scene,
                                     .options = order_.options,
                                     .sky = slot.sky ? *slot.sky : renderer_.sky(),
                                     .made_of = made_of_.of(slot.frame),
                                     .exposure = slot.exposure,
                                     .colours = order_.colours,
                                     .chosen = chosen_,
                                     .shot = &order_.scene};
        if (slot.wants(kPng)) slot.files[kPng] = encode_png(context, slot.picture, slot.frame);
        if (slot.wants(kExr)) slot.files[kExr] = encode_exr(context, slot.picture, slot.frame);
        if (wants_deep(slot)) slot.files[kDeep] = encode_deep(context, slot.picture, slot.frame);
    }

    void write(RunSlot& any, const FileSink& sink) const override {
        const PictureSlot& slot = static_cast<const PictureSlot&>(any);
        // Others are looked at to see whether a frame is there: the deep one is there before them.
        for (const std::size_t part : {kDeep, kPng, kExr})
            if (part == kDeep ? wants_deep(slot) : slot.wants(part))
                sink({file_of(order_.scene.shot, part, slot.frame),
                      [&](const auto& take) { take(slot.files[part]); }});
    }

  private:
    bool wants_deep(const PictureSlot& slot) const { return order_.options.deep && slot.wants(kDeep); }

    const PictureOrder& order_;
    const PictureFingerprint& made_of_;
    std::string chosen_;
    const std::atomic<bool>* cancel_;
    Renderer renderer_;
    float exposure_;
};

}  // namespace

PictureFingerprint picture_fingerprint(const PictureOrder& order) {
    return PictureFingerprint({.scene = order.scene,
                               .options = order.options,
                               .picture_content = picture_content(order.scene),
                               .exposure_stops = order.exposure_stops,
                               .colours = order.colours});
}

RunReport render_files(const PictureOrder& order, const RunOptions& options) {
    const Shot& shot = order.scene.shot;
    std::optional<PictureFingerprint> made_of;
    std::vector<RunPart> parts;
    return run({.shot = shot,
                .in_flight = kPicturesInFlight,
                .plan =
                    [&](std::span<const int>) {
                        check_render(order.scene, order.options);
                        made_of.emplace(picture_fingerprint(order));
                        for (const char* suffix : {".png", ".exr"})
                            parts.push_back(
                                {{shot.name + '.', suffix}, [&](int frame) { return made_of->of(frame); }});
                        if (order.options.deep)
                            parts.push_back({{shot.name + ".deep.", ".exr"},
                                             [&](int frame) { return made_of->of(frame); }});
                        return parts;
                    },
                .build = [&](std::span<const int> frames, const auto& watch) -> std::unique_ptr<Sequence> {
                    require_memory(render_memory(order.scene, order.options, frames,
                                                 std::min(static_cast<int>(frames.size()), kPicturesInFlight),
                                                 tbb::this_task_arena::max_concurrency()),
                                   machine::memory_limit_or(options.max_memory_bytes), "this picture");
                    files::check_folder(options.out);
                    auto pictures =
                        std::make_unique<Pictures>(order, *made_of, options.chosen, frames, watch);
                    prepare_folders(options.out, parts);  // whatever is refused has left none behind
                    return pictures;
                }},
               options);
}

}  // namespace pelagic
