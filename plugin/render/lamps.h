// What glows of the bodies of a scene, as lights: their places are drawn by chance, by how much light they send.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelagic/scene.h"
#include "plugin/render/ray_scene.h"

namespace pelagic {

inline constexpr std::size_t kMostLamps = 64;

inline float mean_of(const glm::vec3& colour) {
    return (colour.x + colour.y + colour.z) / 3.0f;
}

// Which lamp a place is drawn on, by weights ≥ 0.
class LampChoice {
  public:
    void add(float weight) { upto_[count_++] = all_ += weight; }
    bool empty() const { return !(all_ > 0.0f); }
    float all() const { return all_; }
    float chance(std::size_t lamp) const {
        return (upto_[lamp] - (lamp > 0 ? upto_[lamp - 1] : 0.0f)) / all_;
    }
    // number: 0 … 1, which then is even in the lamp that it names.
    std::size_t pick(float& number) const;

  private:
    std::array<float, kMostLamps> upto_;
    std::size_t count_ = 0;
    float all_ = 0.0f;
};

class Lamps {
  public:
    // The scene, with objects whose meshes are there, must outlive it.
    explicit Lamps(const Scene& scene);
    // Where the bodies are, as RayScene has it.
    void place(std::span<const glm::mat4x3> bodies);

    // Triangles that glow, near each other: at most kMostLamps.
    struct Lamp {
        glm::vec3 centre{0.0f};
        float radius = 0.0f;
        float power = 0.0f;  // area times mean radiance of its colours
    };
    std::span<const Lamp> all() const { return placed_; }

    // A place on a lamp, by its power, as a light at another place. Triangles shine to the side from which they are
    // counter-clockwise.
    struct Light {
        std::size_t body = 0;
        glm::vec3 towards{0.0f, 0.0f, 1.0f};  // unit
        float distance_m = 0.0f;
        glm::vec3 radiance{0.0f};  // 0: its back
        float density = 0.0f;      // of such places on the lamp, by solid angle [1/sr]; > 0 but for its back
    };
    Light light(std::size_t lamp, const glm::vec3& place, glm::vec2 number) const;

    // What a ray has met: no lamp, where it doesn't glow to this side.
    struct Met {
        int lamp = -1;
        glm::vec3 radiance{0.0f};
        float density = 0.0f;  // light()'s there
    };
    Met met(const Ray& ray, const RayHit& hit) const;

    // What it holds at most [bytes].
    static std::size_t bytes(const Scene& scene);

  private:
    struct Part {
        std::uint32_t triangle;
        float upto;  // of its lamp's power, with the parts before it
    };
    struct Group {
        std::size_t body, first, last;  // of parts_
        Lamp lamp;                      // in the body's own axes
        bool is_whole = false;          // can't be split
    };
    static bool has_some(const SceneObject& object);
    glm::vec3 radiance_of(std::size_t body, std::uint32_t triangle) const;
    std::array<glm::vec3, 3> corners_of(std::size_t body, std::uint32_t triangle) const;
    float power_of(std::size_t body, std::uint32_t triangle) const;  // as Lamp::power
    void find_bounds(Group& group) const;
    bool split_widest();

    const Scene& scene_;
    std::vector<Part> parts_;
    std::vector<Group> groups_;
    std::vector<std::vector<std::uint8_t>>
        lamp_of_;  // by body and triangle; empty: of a body that doesn't glow
    std::vector<glm::mat4x3> bodies_;
    std::vector<Lamp> placed_;
};

}  // namespace pelagic
