#include "plugin/format/usd/drops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "plugin/format/usd/crate_file.h"
#include "plugin/format/usd/page.h"

namespace pelagic::usd {
namespace {

struct DropsAttribute {
    std::string_view name, type;
    bool is_primvar = false;  // which says its interpolation
};
// Sorted by name, as the files of other layers.
constexpr std::array kDropsAttributes = std::to_array<DropsAttribute>({
    {"extent", "float3[]"},
    {"ids", "int64[]"},
    {"points", "point3f[]"},
    {"primvars:displayOpacity", "float[]", true},
    {"primvars:extinctionSection", "float[]", true},
    {"velocities", "vector3f[]"},
    {"widths", "float[]", true},
});
constexpr std::string_view kVertex = "vertex";

void check(const DropsSample& sample) {
    check_rate(sample.fps);
    const std::size_t count = sample.points.size();
    if (sample.velocities.size() != count || sample.widths.size() != count ||
        sample.opacities.size() != count || sample.sections.size() != count || sample.ids.size() != count)
        throw std::invalid_argument("USD: drops' arrays must have a value for each point");
    const auto is_finite = [](const glm::vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    const auto is_number = [](float number) { return std::isfinite(number); };
    if (!std::ranges::all_of(sample.points, is_finite) ||
        !std::ranges::all_of(sample.velocities, is_finite) ||
        !std::ranges::all_of(sample.widths, is_number) || !std::ranges::all_of(sample.opacities, is_number) ||
        !std::ranges::all_of(sample.sections, is_number))
        throw std::invalid_argument("USD: drops must be finite");
}

// Round the parcels, not their middles alone.
Extent extent_of(const DropsSample& sample) {
    Extent extent = usd::extent_of(sample.points);
    float widest = 0.0f;
    for (const float width : sample.widths) widest = std::max(widest, width);
    extent[0] -= 0.5f * widest;
    extent[1] += 0.5f * widest;
    return extent;
}

}  // namespace

std::string drops_file(std::string_view shot_name) {
    return std::string(shot_name) + ".drops.usda";
}
std::string drops_manifest_file(std::string_view shot_name) {
    return "drops/" + std::string(shot_name) + ".manifest.usda";
}
std::string drops_frame_prefix(std::string_view shot_name) {
    return "drops/" + std::string(shot_name) + '.';
}

std::string drops_text(const DropsShot& shot) {
    Page page;
    page.open({"("});
    write_head(page, {.default_prim = kDropsName,
                      .fps = shot.fps,
                      .first_frame = shot.first_frame,
                      .last_frame = shot.last_frame});
    page.close(")");
    page.gap();
    page.open({"def Points \"", kDropsName, "\" ("});
    page.open({"clips = {"});
    page.open({"dictionary default = {"});
    page.line({"asset manifestAssetPath = @./", drops_manifest_file(shot.name), "@"});
    page.line({"string primPath = \"/", kDropsName, "\""});
    page.line({"string templateAssetPath = \"./", drops_frame_prefix(shot.name), "####.usdc\""});
    page.line({"double templateEndTime = ", number(shot.last_frame)});
    page.line({"double templateStartTime = ", number(shot.first_frame)});
    page.line({"double templateStride = 1"});
    page.close("}");
    page.close("}");
    page.line(
        {"doc = \"Drops of spray as parcels. Each frame has points of its own, ids say which are the same: blur by velocities.\""});
    page.close(")");
    page.open({"{"});
    // Clips ignore metadata: it is declared here. A value would hide those of the clips.
    for (const DropsAttribute& attribute : kDropsAttributes)
        page.line({attribute.type, " ", attribute.name,
                   attribute.is_primvar ? " (interpolation = \"vertex\")" : ""});
    page.line({"color3f[] primvars:displayColor = [(1, 1, 1)] (interpolation = \"constant\")"});
    page.close("}");
    return page.text();
}

std::string drops_manifest_text(const DropsShot& shot) {
    Page page;
    write_timeless_head(page, shot.fps);
    page.prim("over", kDropsName);
    for (const DropsAttribute& attribute : kDropsAttributes) page.line({attribute.type, " ", attribute.name});
    page.close("}");
    return page.text();
}

void write_drops_crate(const DropsSample& sample, const Sink& sink) {
    check(sample);
    const Extent extent = extent_of(sample);
    Crate crate;
    crate.add_frame_layer(kDropsName, sample.fps, sample.frame, sample.fingerprint);
    const Crate::Fields vertex{{"interpolation", crate.token(kVertex)}};
    const std::size_t count = sample.points.size();
    const std::array arrays{crate.array(ValueType::Vec3f, std::span<const glm::vec3>(extent), extent.size()),
                            crate.array(ValueType::Int64, sample.ids, count),
                            crate.array(ValueType::Vec3f, sample.points, count),
                            crate.array(ValueType::Float, sample.opacities, count),
                            crate.array(ValueType::Float, sample.sections, count),
                            crate.array(ValueType::Vec3f, sample.velocities, count),
                            crate.array(ValueType::Float, sample.widths, count)};
    static_assert(arrays.size() == kDropsAttributes.size());
    std::vector<Crate::Attribute> attributes;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        Crate::Fields more = kDropsAttributes[i].is_primvar ? vertex : Crate::Fields{};
        more.push_back({"timeSamples", crate.time_samples(sample.frame, arrays[i])});
        attributes.push_back(
            {.name = kDropsAttributes[i].name, .type = std::string(kDropsAttributes[i].type), .more = more});
    }
    crate.add_prim(kDropsName,
                   {{"specifier", crate.specifier(Specifier::Def)}, {"typeName", crate.token("Points")}},
                   attributes);
    crate.finish();
    crate.write(sink);
}

}  // namespace pelagic::usd
