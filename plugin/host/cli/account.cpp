#include "plugin/host/cli/account.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/plan/memory.h"
#include "core/plan/products.h"
#include "core/scene/text.h"
#include "core/surface/rest_surface.h"
#include "plugin/bake/bake.h"
#include "plugin/render/batch.h"
#include "plugin/render/layers.h"

namespace pelagic::cli {

Rates rates_on(int threads) {
    constexpr double kRecordedThreads = 2.0;
    Rates rates = recorded_rates();
    for (double& rate : rates) rate *= kRecordedThreads / threads;
    return rates;
}

FrameAccount bake_account(const Plan& plan, int frames, int threads, const Rates& rates) {
    FrameAccount account{.seconds = 1e-3 * cost_ms(work_of(plan), rates)};
    for (const PlannedOutput& output : plan.outputs) {
        if (output.row->kind == OutputKind::Sky) {
            // Its work is none of the sea's. By daylight, as measured (tests/bench/README.md); a picture's goes by its size.
            constexpr double kProcessor_s = 0.06;
            constexpr std::size_t kPacked_bytes = 300'000;
            account.seconds += kProcessor_s / threads;
            account.bytes += kPacked_bytes;
        }
        const Query& query = plan.queries[output.query].query;
        for (const ProductRow& row : kProductTable)
            if (query.products[index(row.product)])
                account.bytes += query.points * row.components * sizeof(float);
    }
    account.memory_bytes =
        bake_memory(plan, static_cast<std::size_t>(std::min(frames, kFramesInFlight)), threads).bytes();
    return account;
}

FrameAccount picture_account(const Scene& scene, const RenderOptions& options, int threads,
                             const Rates& rates) {
    constexpr int kFrames = 64;  // that are looked at
    const std::vector<int> frames = representative_frames(scene, kFrames);
    const Plan plan = picture_plan(of_samples(scene, options.samples), frames, options);
    std::size_t channels = options.alpha ? 4 : 3;  // of the light
    const PictureLayerSet layers = layers_of(!scene.objects.empty(), options.layers);
    for (const PictureLayerRow& row : kPictureLayers)
        if (layers[index(row.layer)]) channels += row.components;
    const glm::ivec2 size = data_window(scene.camera.resolution, options).size();
    const auto pixels = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    return {.seconds = 1e-3 * cost_ms(picture_work(plan, frames, options), rates),
            .bytes = pixels * (channels * sizeof(float) + 3),  // and the PNG
            .memory_bytes = render_memory(scene, options, frames, kPicturesInFlight, threads).bytes()};
}

nlohmann::ordered_json json_of(const FrameAccount& account) {
    return {{"seconds_a_frame", account.seconds},
            {"bytes_a_frame", account.bytes},
            {"memory_bytes", account.memory_bytes}};
}

std::string text_of(const FrameAccount& account) {
    return "takes about " + rough_text(account.seconds) + " s of computing and " + bytes_text(account.bytes) +
           " in its files, before they are packed";
}

}  // namespace pelagic::cli
