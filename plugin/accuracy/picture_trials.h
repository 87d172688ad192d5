// Pictures through the shot's camera as the settings of a row.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/lighting/sky.h"
#include "pelagic/scene.h"
#include "plugin/accuracy/accuracy.h"
#include "plugin/render/render.h"

namespace pelagic {

// The shot with pictures no wider than that [pixels]: so small that references take seconds.
inline constexpr int kSweepWidth = 320;
Scene with_small_pictures(Scene shot, int widest = kSweepWidth);

// Pictures of the shot: of its middle frame first, then with each run() of the next one, as in a sequence, where a frame's
// foam goes on from that of the frame before.
class SweepPicture {
  public:
    SweepPicture(const Scene& scene, const RenderOptions& options, const Sky& sky);
    void run();
    const Picture& picture() const { return picture_; }
    const Plan& plan() const { return renderer_->plan(); }
    PictureBytes encoded() const;  // at the exposure of the shot

  private:
    Scene scene_;
    RenderOptions options_;
    std::vector<int> frames_;  // one after another, and again from the first
    std::size_t runs_ = 0;
    std::unique_ptr<Renderer> renderer_;
    Picture picture_;
};

// relative_error() (plugin/budget/picture_errors.h): the 95th percentile and the mean.
std::vector<double> relative_errors(const Picture& picture, const Picture& reference);

struct PictureSetting {
    std::string name;
    bool is_shots;
    Scene scene;
    RenderOptions options;
};

enum class PictureErrors {
    OfReference,  // relative_errors() against it
    AlsoOfStep,   // and the 95th percentile of those against the setting before; 0 for the first one
};

// Each setting's trial, with its errors, of the first frame, against the picture of these. The reference may be one of the
// settings.
Trials against(const Scene& scene, const RenderOptions& options, std::vector<PictureSetting> settings,
               PictureErrors which = PictureErrors::OfReference);

}  // namespace pelagic
