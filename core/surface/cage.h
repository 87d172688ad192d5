// The surface of a cage: points at rest on its limit surface (cage_limit.h), uniformly or as finely as a camera sees it.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/surface/cage_limit.h"
#include "core/surface/rest_surface.h"

namespace pelagic {

// How many segments each part of a cage gets so that they are about as long as a cell on the screen. A segment is judged by its
// length over the distance from the eye, wherever the eye looks: nothing changes when a camera turns, and what is behind
// it or seen from the side is as fine. All of an edge is as fine as its nearest place needs, and the inside of a face
// likewise: a large face near the eye is fine as a whole.
class CageAdaption {
  public:
    // cell_px: as long as segments may be on the screen [pixels]. significant_height_m: of the waves, which come nearer to
    // the eye than the surface at rest.
    CageAdaption(const CageLimit& limit, std::span<const glm::dvec3> points_m, double cell_px,
                 double significant_height_m);

    struct Result {
        CageRates rates;
        double points = 0.0;    // about; of a uniform cage 0
        double finest_m = 0.0;  // half the shortest segment, as if each edge's were equally long
    };
    Result at(const View& view) const;
    Result uniform(int segments) const;

    static constexpr int kMostSegments = 1024;                        // of an edge
    static constexpr std::size_t kMostPoints = std::size_t{1} << 27;  // of a frame

  private:
    double distance_m(const glm::dvec3& eye_m, std::size_t face) const;
    double finest_of(const CageRates& rates) const;

    const CageLimit& limit_;
    double cell_px_, half_height_m_;
    std::vector<glm::dvec3> points_, middles_,
        centres_;  // on the limit surface: of points, edges and faces [m]
};

class CageSurface final : public RestSurface {
  public:
    CageSurface(const Scene& scene, const Extent& extent);

    std::string describe() const override;
    std::string remedy() const override;
    bool is_constant() const override { return !level_.is_adaptive; }
    bool has_constant_faces() const override { return !level_.is_adaptive; }
    bool has_origin() const override;
    bool origin_follows_camera() const override { return false; }
    bool has_st_of_corners() const override { return limit_.has_seams(); }
    bool is_even() const override { return false; }
    std::optional<View> shaped_by(int frame) const override;
    KeyPartSet key_parts() const override;
    SurfaceNeeds needs(std::span<const int> frames) const override;
    void points_at(int frame, RestPoints<float>& points) const override { lay_out(frame, points); }
    void points_at(int frame, RestPoints<double>& points) const override { lay_out(frame, points); }
    void faces_at(int frame, Faces& faces) const override;
    SurfaceBytes bytes(std::size_t points, std::size_t scalar) const override;

  private:
    // What a pose gives, kept until another pose is asked for: while neither cage nor camera move, frames cost nothing.
    struct Laid {
        std::optional<View> view;
        std::vector<glm::dvec3> places_m, normals;
        std::vector<double> cell_m;
        Faces faces;
    };
    std::shared_ptr<const Laid> laid_at(int frame) const;
    // The rates that this pose asks for, and how many points they make; kept likewise.
    struct Fineness {
        std::optional<View> view;
        CageAdaption::Result rates;
        std::size_t points = 0;
    };
    // Throws std::invalid_argument for more than CageAdaption::kMostPoints.
    Fineness made_fineness(int frame) const;
    std::shared_ptr<const Fineness> fineness_at(int frame) const;
    template <class T>
    void lay_out(int frame, RestPoints<T>& points) const;

    std::shared_ptr<const Cage> cage_;
    CageLevel level_;
    Camera camera_;
    int first_frame_;
    double cell_px_;
    CageLimit limit_;
    CageAdaption adaption_;
    glm::dvec3 origin_m_;
    mutable std::mutex laid_mutex_, fineness_mutex_;
    mutable std::shared_ptr<const Laid> laid_;
    mutable std::shared_ptr<const Fineness> fineness_;
};

// As the table of surfaces asks for it.
std::unique_ptr<const RestSurface> make_cage_surface(const Scene& scene, const Extent& extent);

}  // namespace pelagic
