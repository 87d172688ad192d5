#include "plugin/accuracy/picture_trials.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plugin/accuracy/sea_answers.h"
#include "plugin/budget/picture_errors.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/render/picture_files.h"

namespace pelagic {

Scene with_small_pictures(Scene shot, int widest) {
    const int width = std::min(widest, shot.camera.resolution.x);
    const double shape = static_cast<double>(shot.camera.resolution.y) / shot.camera.resolution.x;
    shot.camera.resolution = {width, std::clamp(static_cast<int>(std::lround(shape * width)), 1, 4 * width)};
    return shot;
}

SweepPicture::SweepPicture(const Scene& scene, const RenderOptions& options, const Sky& sky)
    : scene_(scene), options_(options) {
    constexpr std::size_t kMost = 64;
    for (int frame = middle_frame(scene); frame <= scene.shot.last_frame && frames_.size() < kMost; ++frame)
        frames_.push_back(frame);
    renderer_ = std::make_unique<Renderer>(scene, options, sky, frames_);
}

void SweepPicture::run() {
    renderer_->render(frames_[runs_++ % frames_.size()], picture_);
}

PictureBytes SweepPicture::encoded() const {
    const int frame = frames_[(runs_ - 1) % frames_.size()];
    const PictureFingerprint fingerprint(
        {.scene = scene_, .options = options_, .picture_content = picture_content(scene_)});
    const PictureContext context{.scene = scene_,
                                 .options = options_,
                                 .sky = renderer_->sky(),
                                 .made_of = fingerprint.of(frame),
                                 .exposure = shot_exposure(scene_, renderer_->sky())};
    return {encode_exr(context, picture_, frame), encode_png(context, picture_, frame)};
}

std::vector<double> relative_errors(const Picture& picture, const Picture& reference) {
    const RelativeError error = relative_error(picture, reference);
    return {error.most, error.mean};
}

Trials against(const Scene& scene, const RenderOptions& options, std::vector<PictureSetting> settings,
               PictureErrors which) {
    const Sky sky = make_sky(scene);  // the same for all
    SweepPicture made(scene, options, sky);
    made.run();
    const auto reference = std::make_shared<const Picture>(made.picture());
    Trials trials;
    std::shared_ptr<const SweepPicture> before;
    for (PictureSetting& setting : settings) {
        const auto picture = std::make_shared<SweepPicture>(setting.scene, setting.options, sky);
        const Plan& plan = picture->plan();
        const auto errors = [=] {
            std::vector<double> of = relative_errors(picture->picture(), *reference);
            if (which == PictureErrors::AlsoOfStep)
                of.push_back(before ? relative_errors(picture->picture(), before->picture())[0] : 0.0);
            return of;
        };
        trials.trials.push_back({.setting = std::move(setting.name),
                                 .is_shots = setting.is_shots,
                                 .run = [picture] { picture->run(); },
                                 .errors = errors,
                                 .bytes = plan.sea_bytes() + plan.frame_bytes() + plan.effect_bytes(),
                                 .transforms = plan.transforms_per_frame(),
                                 .picture = [picture] { return picture->encoded(); }});
        before = picture;
    }
    return trials;
}

}  // namespace pelagic
