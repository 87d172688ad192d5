// What outputs ask for: of the frames that are to be baked, and of no others.
#include "core/plan/outputs.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <vector>

#include "core/plan/plan.h"

namespace pelagic {
namespace {

// A surface that counts the frames that it is asked about.
class CountingSurface final : public RestSurface {
  public:
    explicit CountingSurface(const Scene& scene)
        : surface_(make_surface(scene, {.height_m = 3.0, .reach_m = 2.0, .significant_height_m = 2.0})) {}
    std::string remedy() const override { return surface_->remedy(); }
    std::string describe() const override { return surface_->describe(); }
    bool is_constant() const override { return surface_->is_constant(); }
    bool has_constant_faces() const override { return surface_->has_constant_faces(); }
    bool is_even() const override { return surface_->is_even(); }
    std::optional<View> shaped_by(int frame) const override { return surface_->shaped_by(frame); }
    KeyPartSet key_parts() const override { return surface_->key_parts(); }
    SurfaceNeeds needs(std::span<const int> frames) const override {
        asked.insert(asked.end(), frames.begin(), frames.end());
        return surface_->needs(frames);
    }
    void points_at(int, RestPoints<float>&) const override { throw std::logic_error("points of a plan"); }
    void points_at(int, RestPoints<double>&) const override { throw std::logic_error("points of a plan"); }
    void faces_at(int, Faces&) const override { throw std::logic_error("faces of a plan"); }

    mutable std::vector<int> asked;

  private:
    std::unique_ptr<const RestSurface> surface_;
};

Scene endless_shot() {
    Scene scene;
    scene.shot.last_frame = 2'000'000;
    scene.surface.kind = SurfaceKind::ProjectedGrid;
    scene.camera.resolution = {160, 90};
    scene.camera.keys = {{.frame = 1, .position_m = {0.0, -60.0, 200.0}, .look_at_m = {0.0, 0.0, 2.0}},
                         {.frame = 2'000'000, .position_m = {0.0, -60.0, 3.0}, .look_at_m = {0.0, 0.0, 2.0}}};
    scene.output.maps = {MapKind::Normal};
    scene.output.map_resolution = 16;
    scene.output.cascade_tiles = true;
    return scene;
}

TEST(Outputs, OfOneFrameOfManyAskForThatFrameAlone) {
    const Scene scene = endless_shot();
    const auto prepared = prepare(scene);
    const CountingSurface surface(scene);
    const std::array frames{77};
    std::vector<OutputRequest> requests;
    for (const OutputRow& row : output_table())
        row.add(row, {.prepared = *prepared, .surface = surface, .frames = frames}, requests);
    EXPECT_GT(requests.size(), 2u);
    EXPECT_EQ(surface.asked, std::vector<int>{77});
}

// Who wants to know what a long shot is like looks at some of its frames.
TEST(Outputs, OfALongShotArePlannedFromSomeOfItsFrames) {
    Scene scene = endless_shot();
    const CountingSurface surface(scene);
    const std::vector<int> some = representative_frames(scene, 64);
    const SurfaceNeeds needs = surface.needs(some);
    EXPECT_LE(surface.asked.size(), 64u);
    const Plan plan = plan_bake(scene);
    const Plan of_some = plan_bake(prepare(scene), some);
    EXPECT_EQ(plan.queries.front().query.points, of_some.queries.front().query.points);
    EXPECT_EQ(plan.queries.front().query.pixel_m, of_some.queries.front().query.pixel_m);
    EXPECT_GT(needs.points, 0u);
}

}  // namespace
}  // namespace pelagic
