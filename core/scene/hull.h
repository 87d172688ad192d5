// Where a body keeps the water out, from its mesh alone: no rays, so that bakes and hosts without Embree have the same answer everywhere.
//
// A place is in a hull if hull is below it, along the body's own -z, and on most sides of it within the body's box: of eight ways along its
// own x and y six meet some. So a boat may be open above, a load in it stands for its hull, and two of the sides may have a gap.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pelagic/scene.h"

namespace pelagic {

// In the mesh's own axes and metres. Levels of signed distances: kLevels of them between the box's lowest and highest point, each over
// squares of cell_m(). Between levels and squares linear. Near straight sides the outline is right to a twentieth of a cell; what is thinner
// than a cell is missed, and the edge over which water would come in, a bulwark's, is right to half a level.
class Hull {
  public:
    static constexpr int kLevels = 96;

    explicit Hull(const ObjectMesh& mesh);

    bool keeps_water_out() const { return !distance_m_.empty(); }
    // Along x and y from the outline of the hull at that height, negative inside. Infinite above and below the box, and
    // farther from it than margin_m(); of what keeps no water out everywhere.
    double distance_m(const glm::dvec3& place) const;
    // Which way that grows, along x and y: unit, or 0 where no outline is near.
    glm::dvec2 outward(const glm::dvec3& place) const;
    // From the hull's bottom over or below a place, negative below it. Infinite where there is none, at the nearest node.
    double above_bottom_m(const glm::dvec3& place) const;

    // What distance_m() interpolates, for who does so elsewhere: nodes by level, row and column.
    std::span<const float> nodes_m() const { return distance_m_; }
    glm::ivec2 columns() const { return columns_; }
    glm::dvec2 first_m() const { return first_m_; }  // the first node's place
    double lowest_m() const { return lowest_m_; }

    double cell_m() const { return cell_m_; }
    double level_m() const { return level_m_; }
    double margin_m() const { return margin_m_; }
    // The box's smaller side.
    double beam_m() const { return beam_m_; }
    std::size_t bytes() const { return sizeof(float) * (distance_m_.size() + bottom_m_.size()); }

  private:
    double node(int level, int x, int y) const {
        return static_cast<double>(
            distance_m_[(static_cast<std::size_t>(level) * columns_.y + y) * columns_.x + x]);
    }

    double cell_m_ = 0.0, level_m_ = 0.0, margin_m_ = 0.0, beam_m_ = 0.0;
    double lowest_m_ = 0.0, highest_m_ = 0.0;
    glm::dvec2 first_m_{0.0};  // the first node's place
    glm::ivec2 columns_{0};
    std::vector<float> distance_m_;  // level, row, column
    std::vector<float> bottom_m_;    // row, column
};

// Made once of a mesh, which keeps it; equal meshes share it. Any thread.
std::shared_ptr<const Hull> hull_of(const ObjectMesh& mesh);

// The objects that keep water out, in their order: indices into Scene::objects.
std::vector<std::size_t> hulls_of(const Scene& scene);
// What the sea's files have of them: where they are and what they are like, but not how they look; has_foam: and their foam. Empty where none keeps water out.
std::string hulls_text(const Scene& scene, bool has_foam);

// What all of them hold [bytes].
std::size_t hulls_bytes(const Scene& scene);

// How wide the foam along its outline is in the world [m].
double contact_foam_m(const SceneObject& object, const Hull& hull);

}  // namespace pelagic
