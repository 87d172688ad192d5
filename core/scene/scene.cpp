#include "pelagic/scene.h"

#include <cmath>
#include <filesystem>

namespace pelagic {

double Shot::time_s(double frame) const {
    const double round_frames = std::round(loop_s * fps);
    double frames = frame - 1.0;
    if (round_frames > 0.0) {
        frames = std::fmod(frames, round_frames);  // exact
        if (frames < 0.0) frames += round_frames;
    }
    return time_offset_s + time_scale * (frames / fps);
}

double Shot::exact_loop_s() const {
    return std::round(loop_s * fps) / fps;
}

double Shot::sea_loop_s() const {
    return time_scale * exact_loop_s();
}

std::string SceneObject::called() const {
    return name.empty() ? std::filesystem::path(file).stem().string() : name;
}

}  // namespace pelagic
