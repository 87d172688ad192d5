// A Scene as text for fingerprints. See canonical.h.
//
// Every struct is taken apart by a structured binding: a member that is added to scene.h and not here doesn't
// compile.
#include "core/scene/canonical.h"

#include <concepts>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/scene/names.h"
#include "core/scene/text.h"

namespace pelagic {

namespace {

std::string text_of(bool value) {
    return value ? "true" : "false";
}
std::string text_of(double value) {
    return number_text(value);
}
std::string text_of(const std::optional<double>& value) {
    return value ? number_text(*value) : "default";
}
std::string text_of(const std::string& value) {
    return quoted_text(value);
}
std::string text_of(const glm::dvec3& v) {
    return number_text(v.x) + ' ' + number_text(v.y) + ' ' + number_text(v.z);
}
std::string text_of(const glm::ivec2& v) {
    return std::to_string(v.x) + ' ' + std::to_string(v.y);
}

template <std::integral Integer>
requires(!std::same_as<Integer, bool>) std::string text_of(Integer value) {
    return std::to_string(value);
}

template <class Choice>
requires std::is_enum_v<Choice> std::string text_of(Choice value) {
    return std::string(word_of(value));
}

template <class Choice>
requires std::is_enum_v<Choice> std::string text_of(const std::vector<Choice>& list) {
    std::string out;
    for (const Choice value : list) out += std::string(out.empty() ? "" : " ") + text_of(value);
    return out;
}

class Writer {
  public:
    template <class... Values>
    void line(std::string_view key, const Values&... values) {
        text_ += key;
        text_ += " =";
        ((text_ += ' ', text_ += text_of(values)), ...);
        text_ += '\n';
    }

    std::string take() { return std::move(text_); }

  private:
    std::string text_;
};

void write(Writer& out, const Shot& shot) {
    const auto& [name, first_frame, last_frame, fps, seed, loop_s] = shot;
    static_cast<void>(first_frame), static_cast<void>(last_frame);  // left out on purpose: see canonical.h
    out.line("shot.name", name);
    out.line("shot.fps", fps);
    out.line("shot.seed", seed);
    out.line("shot.loop_s", loop_s);
}

void write(Writer& out, const MeasuredSpectrum& measured) {
    const auto& [bins, station, time] = measured;
    out.line("sea.measured", station, time);
    for (const MeasuredSpectrum::Bin& bin : bins) {
        const auto& [frequency_hz, density, c1_re, c1_im, c2_re, c2_im, has_direction] = bin;
        out.line("sea.measured.bin", frequency_hz, density, c1_re, c1_im, c2_re, c2_im, has_direction);
    }
}

void write(Writer& out, const SeaState& sea) {
    const auto& [wind_speed, wind_direction, fetch, depth, spectrum, spreading, swells, measured] = sea;
    out.line("sea.wind_speed_mps", wind_speed);
    out.line("sea.wind_direction_deg", wind_direction);
    out.line("sea.fetch_m", fetch);
    out.line("sea.depth_m", depth);
    out.line("sea.spectrum", spectrum);
    out.line("sea.spreading", spreading);
    for (const Swell& swell : swells) {
        const auto& [height, period, direction] = swell;
        out.line("sea.swell", height, period, direction);
    }
    if (measured) write(out, *measured);
}

void write(Writer& out, const Waves& waves) {
    const auto& [model, choppiness, cascades, trains, shortest, longest] = waves;
    out.line("waves.model", model);
    out.line("waves.choppiness", choppiness);
    for (const CascadeSize& cascade : cascades) {
        const auto& [size, resolution] = cascade;
        out.line("waves.cascade", size, resolution);
    }
    out.line("waves.trains", trains);
    out.line("waves.shortest_m", shortest);
    out.line("waves.longest_m", longest);
}

void write(Writer& out, const Surface& surface) {
    const auto& [kind, size, resolution, cell] = surface;
    out.line("surface.kind", kind);
    out.line("surface.size_m", size);
    out.line("surface.resolution", resolution);
    out.line("surface.cell_px", cell);
}

void write(Writer& out, const Camera& camera) {
    const auto& [position, look_at, keys, fov, resolution] = camera;
    out.line("camera.position_m", position);
    out.line("camera.look_at_m", look_at);
    for (const CameraKey& key : keys) {
        const auto& [frame, key_position, key_look_at] = key;
        out.line("camera.key", frame, key_position, key_look_at);
    }
    out.line("camera.fov_deg", fov);
    out.line("camera.resolution", resolution);
}

void write(Writer& out, const Light& light) {
    const auto& [elevation, azimuth, sky, turbidity] = light;
    out.line("light.sun_elevation_deg", elevation);
    out.line("light.sun_azimuth_deg", azimuth);
    out.line("light.sky", sky);
    out.line("light.turbidity", turbidity);
}

void write(Writer& out, const Water& water) {
    const auto& [type, chlorophyll] = water;
    out.line("water.type", type);
    out.line("water.chlorophyll_mg_m3", chlorophyll);
}

void write(Writer& out, const Effects& effects) {
    const auto& [whitecaps, spray, spray_gain] = effects;
    out.line("effects.whitecaps", whitecaps);
    out.line("effects.spray", spray);
    out.line("effects.spray_gain", spray_gain);
}

void write(Writer& out, const Quality& quality) {
    const auto& [level] = quality;
    out.line("quality.level", level);
}

void write(Writer& out, const Output& output) {
    const auto& [mesh, attributes, maps, map_resolution, cascade_tiles, mesh_scheme, volumes, voxel] = output;
    out.line("output.mesh", mesh);
    out.line("output.attributes", attributes);
    out.line("output.maps", maps);
    out.line("output.map_resolution", map_resolution);
    out.line("output.cascade_tiles", cascade_tiles);
    out.line("output.mesh_scheme", mesh_scheme);
    out.line("output.volumes", volumes);
    out.line("output.voxel_m", voxel);
}

}  // namespace

std::string canonical(const Scene& scene) {
    const auto& [shot, sea, waves, surface, camera, light, water, effects, quality, output] = scene;
    Writer out;
    write(out, shot);
    write(out, sea);
    write(out, waves);
    write(out, surface);
    write(out, camera);
    write(out, light);
    write(out, water);
    write(out, effects);
    write(out, quality);
    write(out, output);
    return out.take();
}

}  // namespace pelagic
