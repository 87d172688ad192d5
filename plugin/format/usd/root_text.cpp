// The root layer as text. See text.h.
#include <array>
#include <cmath>
#include <glm/exponential.hpp>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plugin/format/usd/drops.h"
#include "plugin/format/usd/page.h"
#include "plugin/format/usd/text.h"
#include "plugin/format/usd/volumes.h"

namespace pelagic::usd {

namespace {

std::string quoted(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            result += {'\\', c};
        } else if (c == '\n') {
            result += "\\n";
        } else if (c == '\t') {
            result += "\\t";
        } else if (byte < 0x20 || byte == 0x7f) {
            constexpr char kHex[] = "0123456789abcdef";
            result += {'\\', 'x', kHex[byte >> 4], kHex[byte & 15]};
        } else {
            result += c;
        }
    }
    return result + "\"";
}

// An asset path between @, or between @@@ if it contains @.
std::string asset(std::string_view path) {
    for (const char c : path) {
        if (static_cast<unsigned char>(c) < 0x20) {
            throw std::invalid_argument("USD: an asset path must not hold control characters");
        }
    }
    const std::string delimiter = path.find('@') == std::string_view::npos ? "@" : "@@@";
    if (path.find("@@@") != std::string_view::npos || path.back() == '@') {
        throw std::invalid_argument("USD: the asset path \"" + std::string(path) +
                                    "\" must not hold @@@, nor end in @; rename the file");
    }
    return delimiter + std::string(path) + delimiter;
}

bool is_identifier(std::string_view text) {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    if (text.empty() || !letter(text[0])) return false;
    for (const char c : text) {
        if (!letter(c) && !(c >= '0' && c <= '9')) return false;
    }
    return true;
}

struct CustomText {
    std::string operator()(bool value) const { return "bool " + key + " = " + (value ? "true" : "false"); }
    std::string operator()(std::int64_t value) const { return "int64 " + key + " = " + number(value); }
    std::string operator()(double value) const { return "double " + key + " = " + custom_real(value); }
    std::string operator()(const std::string& value) const { return "string " + key + " = " + quoted(value); }
    std::string operator()(const std::vector<double>& values) const {
        std::string text = "double[] " + key + " = [";
        for (std::size_t i = 0; i < values.size(); ++i) text += (i > 0 ? ", " : "") + custom_real(values[i]);
        return text + "]";
    }
    // to_chars spells infinity as USD does, "inf".
    std::string custom_real(double value) const {
        if (std::isnan(value))
            throw std::invalid_argument("USD: customLayerData's " + key + " is not a number");
        return number(value);
    }

    std::string key;
};

void write_custom_data(Page& page, const Stage& stage) {
    if (stage.custom_data.empty()) return;
    page.open({"customLayerData = {"});
    page.open({"dictionary pelagic = {"});
    for (const auto& [key, value] : stage.custom_data) {
        if (!is_identifier(key)) {
            throw std::invalid_argument("USD: customLayerData's key \"" + key +
                                        "\" must be letters, digits and _, and not begin with a digit");
        }
        page.line({std::visit(CustomText{key}, value)});
    }
    page.close("}");
    page.close("}");
}

// Where the origin of a mesh's points is from frame to frame.
std::string_view text_of_origin(const Stage& stage) {
    if (stage.origin_follows_camera)
        return "follows the camera in steps: far from the world's origin floats are too coarse for places. "
               "A step is no motion; velocities leave it out.";
    if (stage.points_follow_camera)
        return "stays near the mesh: far from the world's origin floats are too coarse for places. "
               "It may step where the cells grow, which is no motion; velocities leave it out.";
    return "is the same at all frames: far from the world's origin floats are too coarse for places.";
}

// A note for those who read the points of two frames, where a point of the next frame isn't the same place.
std::string_view text_of_points(const Stage& stage) {
    if (!stage.points_follow_camera) return "";
    if (stage.attributes.faces)
        return " Each frame has points and faces of its own, as its camera sees them: blur by velocities.";
    return " Points follow the camera in steps, too, from place to place of a sea that stays: "
           "blur by velocities.";
}

void write_mesh(Page& page, const Stage& stage, const std::string& material_path) {
    page.gap();
    page.open({"def Mesh \"", kMeshName, "\" ("});
    page.line({"prepend apiSchemas = [\"MaterialBindingAPI\"]"});
    page.open({"clips = {"});
    page.open({"dictionary default = {"});
    page.line({"asset manifestAssetPath = @./", manifest_file(stage.name), "@"});
    page.line({"string primPath = \"/", kMeshName, "\""});
    page.line(
        {"string templateAssetPath = \"./", frame_file_template(stage.name, stage.frame_extension), "\""});
    page.line({"double templateEndTime = ", number(stage.last_frame)});
    page.line({"double templateStartTime = ", number(stage.first_frame)});
    page.line({"double templateStride = 1"});
    page.close("}");
    page.close("}");
    if (stage.attributes.origin)
        page.line({"doc = \"Points are relative to ", kOrigin, ", which ", text_of_origin(stage),
                   text_of_points(stage), "\""});
    page.line({"prepend references = @./", topology_file(stage.name, stage.topology_extension), "@"});
    page.close(")");
    page.open({"{"});
    page.line({"rel material:binding = <", material_path, ">"});
    // For viewers that have no materials. Of the water alone: a colour at each vertex, with foam, would be a third of a frame's bytes.
    page.line({"color3f[] primvars:displayColor = [", color("the water's colour", stage.material.color),
               "] (interpolation = \"constant\")"});
    page.close("}");
}

// An input of a node: a value as USD writes it, or the name of the node whose output "out" it takes.
struct NodeInput {
    std::string_view type, name, value;
    bool is_node = false;
};

// The nodes of a material. Each has one output, "out".
class Network {
  public:
    Network(Page& page, const std::string& material_path) : page_(page), path_(material_path) {}

    void node(std::string_view name, std::string_view id, std::string_view output_type,
              std::span<const NodeInput> inputs) {
        page_.prim("def Shader", name);
        page_.line({"uniform token info:id = \"", id, "\""});
        for (const NodeInput& input : inputs) {
            if (input.is_node) {
                page_.line({input.type, " inputs:", input.name, ".connect = <", path_, "/", input.value,
                            ".outputs:out>"});
            } else {
                page_.line({input.type, " inputs:", input.name, " = ", input.value});
            }
        }
        page_.line({output_type, " outputs:out"});
        page_.close("}");
    }

    void node(std::string_view name, std::string_view id, std::string_view output_type,
              std::initializer_list<NodeInput> inputs) {
        node(name, id, output_type, std::span(inputs.begin(), inputs.size()));
    }

    // MaterialX's arithmetic with floats: of one node, of a node and a constant, and of two nodes.
    void of(std::string_view name, std::string_view operation, std::string_view node_in) {
        node(name, id_of(operation), "float", {{"float", "in", node_in, true}});
    }
    void with(std::string_view name, std::string_view operation, std::string_view node_in,
              std::string_view constant) {
        node(name, id_of(operation), "float", {{"float", "in1", node_in, true}, {"float", "in2", constant}});
    }
    void both(std::string_view name, std::string_view operation, std::string_view node_1,
              std::string_view node_2) {
        node(name, id_of(operation), "float",
             {{"float", "in1", node_1, true}, {"float", "in2", node_2, true}});
    }

  private:
    static std::string id_of(std::string_view operation) { return "ND_" + std::string(operation) + "_float"; }

    Page& page_;
    const std::string& path_;
};

// UsdPreviewSurface has no node that mixes two colours, so it shows water without whitecaps.
// An opacity below its threshold is a hole: nothing of the mesh is in a hull.
void write_preview_surface(Page& page, const Stage& stage, const std::string& path) {
    const Material& material = stage.material;
    if (stage.attributes.wet) {
        page.prim("def Shader", "WetReader");
        page.line({"uniform token info:id = \"UsdPrimvarReader_float\""});
        page.line({"float inputs:fallback = 1"});
        page.line({"string inputs:varname = \"wet\""});
        page.line({"float outputs:result"});
        page.close("}");
    }
    page.prim("def Shader", "Preview");
    page.line({"uniform token info:id = \"UsdPreviewSurface\""});
    page.line({"color3f inputs:diffuseColor = ", color("the water's colour", material.color)});
    page.line({"float inputs:ior = ", real32("the water's ior", material.ior)});
    page.line({"float inputs:metallic = 0"});
    if (stage.attributes.wet) {
        page.line({"float inputs:opacity.connect = <", path, "/WetReader.outputs:result>"});
        page.line({"float inputs:opacityThreshold = 0.5"});
    } else {
        page.line({"float inputs:opacity = ", real32("the water's opacity", material.opacity)});
    }
    page.line({"float inputs:roughness = ", real32("the water's roughness", material.roughness)});
    page.line({"token outputs:surface"});
    page.close("}");
}

// Roughness, anisotropy and tangent from the tensor of slope variance (σxx, σyy, σxy).
//
// Its eigenvalues are λ± = m ± d, with m = (σxx + σyy)/2 and d = |(h, σxy)|, h = (σxx − σyy)/2. Microfacets have
// α² = 2λ along each axis. MaterialX's roughness_anisotropy, which standard_surface uses, makes of roughness r and
// anisotropy a
//     α along the tangent = r²/√(1 − a),    α across it = r² √(1 − a),    with a ≤ 0.98.
// So a = 1 − √(λ₋/λ₊) and r = (4 λ₊ λ₋)^⅛. λ₋ is at least 0.02² λ₊, which is where a ends: α along the tangent then
// stays right.
//
// The tangent is along λ₊'s axis, which stands at the angle φ from x with (cos 2φ, sin 2φ) = (h, σxy)/d. Half-angle
// formulas need no atan2, whose inputs have other names in MaterialX 1.39 than in 1.38. specular_rotation would turn
// the mesh's own tangent, which hosts make in different ways, and not all of them to the same side.
// A calm sea has no axis: the least d and λ₊ keep everything finite. They are not smaller, since OpenUSD's Storm
// writes constants with six decimals. The tangent is in the axes of the mesh: whoever turns the whole stage turns the
// tangent with it.
void write_microfacets(Network& network) {
    network.node("SlopeVariance", "ND_geompropvalue_vector3", "float3",
                 {{"string", "geomprop", "\"slopeVariance\""}});
    const auto dot = [&](std::string_view name, std::string_view with) {
        network.node(name, "ND_dotproduct_vector3", "float",
                     {{"float3", "in1", "SlopeVariance", true}, {"float3", "in2", with}});
    };
    dot("Mean", "(0.5, 0.5, 0)");
    dot("HalfDifference", "(0.5, -0.5, 0)");
    dot("Covariance", "(0, 0, 1)");
    network.node("DoubleAngle", "ND_combine3_vector3", "float3",
                 {{"float", "in1", "HalfDifference", true},
                  {"float", "in2", "Covariance", true},
                  {"float", "in3", "0"}});
    network.node("Spread", "ND_magnitude_vector3", "float", {{"float3", "in", "DoubleAngle", true}});

    network.both("Sum", "add", "Mean", "Spread");
    network.with("Along", "max", "Sum", "0.000001");
    network.both("Difference", "subtract", "Mean", "Spread");
    network.with("LeastAcross", "multiply", "Along", "0.0004");
    network.both("Across", "max", "Difference", "LeastAcross");
    network.both("Product", "multiply", "Along", "Across");
    network.with("Alpha8", "multiply", "Product", "4");
    network.with("Roughness", "power", "Alpha8", "0.125");
    network.both("Ratio", "divide", "Across", "Along");
    network.of("Aspect", "sqrt", "Ratio");
    network.node("Anisotropy", "ND_subtract_float", "float",
                 {{"float", "in1", "1"}, {"float", "in2", "Aspect", true}});

    network.with("LeastSpread", "max", "Spread", "0.000001");
    network.both("Cosine", "divide", "HalfDifference", "LeastSpread");
    network.with("Cosine2", "multiply", "Cosine", "0.5");
    network.node("East2", "ND_add_float", "float",
                 {{"float", "in1", "Cosine2", true}, {"float", "in2", "0.5"}});
    network.node("North2", "ND_subtract_float", "float",
                 {{"float", "in1", "0.5"}, {"float", "in2", "Cosine2", true}});
    for (const auto& [squared, positive, name] : {std::array{"East2", "PositiveEast2", "East"},
                                                  std::array{"North2", "PositiveNorth2", "AbsoluteNorth"}}) {
        network.with(positive, "max", squared, "0");  // rounding
        network.of(name, "sqrt", positive);
    }
    // The covariance's sign, where that of 0 is 1.
    network.of("Sign", "sign", "Covariance");
    network.with("NonzeroSign", "add", "Sign", "0.5");
    network.of("Side", "sign", "NonzeroSign");
    network.both("North", "multiply", "AbsoluteNorth", "Side");
    network.node("Tangent", "ND_combine3_vector3", "float3",
                 {{"float", "in1", "East", true}, {"float", "in2", "North", true}, {"float", "in3", "0"}});
}

// MaterialX's standard_surface. It takes whitecaps, roughness and its axes from the mesh's primvars where the mesh
// has them. Its reflection lies over its diffuse base and takes its share away, as the sea's surface does. Foam has
// no surface over it. What the water does to light on its way waits for who sets transmission to 1 and base to 0.
void write_materialx_surface(Page& page, const Stage& stage, const std::string& path) {
    const Material& material = stage.material;
    const bool foam = stage.attributes.whitecap_coverage, slopes = stage.attributes.slope_variance;
    const std::string water_color = color("the water's colour", material.color);
    const std::string foam_color = color("the whitecaps' colour", material.whitecap_color);
    const std::string roughness = real32("the water's roughness", material.roughness);
    const std::string ior = real32("the water's ior", material.ior);
    Network network(page, path);
    std::vector<NodeInput> inputs{
        {"float", "base", "1"},
        foam ? NodeInput{"color3f", "base_color", "BaseColor", true}
             : NodeInput{"color3f", "base_color", water_color},
        foam ? NodeInput{"float", "specular", "Specular", true} : NodeInput{"float", "specular", "1"},
        {"float", "specular_IOR", ior},
        slopes ? NodeInput{"float", "specular_roughness", "Roughness", true}
               : NodeInput{"float", "specular_roughness", roughness}};
    if (slopes) {
        inputs.push_back({"float", "specular_anisotropy", "Anisotropy", true});
        inputs.push_back({"float3", "tangent", "Tangent", true});
    }
    // What is left after transmission_depth, 1 m; the part of the rest that is scattered, over that depth.
    const glm::vec3 extinction = material.absorption_per_m + material.scattering_per_m;
    const std::string left = color("what water lets through", glm::exp(-extinction));
    const std::string scattering = color("the water's scattering", material.scattering_per_m);
    if (extinction != glm::vec3(0.0f)) {
        inputs.push_back({"color3f", "transmission_color", left});
        inputs.push_back({"float", "transmission_depth", "1"});
        inputs.push_back({"color3f", "transmission_scatter", scattering});
    }
    if (stage.attributes.wet) inputs.push_back({"color3f", "opacity", "Opacity", true});
    network.node("Surface", "ND_standard_surface_surfaceshader", "token", inputs);

    if (foam) {
        network.node("Coverage", "ND_geompropvalue_float", "float",
                     {{"string", "geomprop", "\"whitecapCoverage\""}});
        network.node("BaseColor", "ND_mix_color3", "color3f",
                     {{"color3f", "bg", water_color},
                      {"color3f", "fg", foam_color},
                      {"float", "mix", "Coverage", true}});
        network.node("Specular", "ND_mix_float", "float",
                     {{"float", "bg", "1"}, {"float", "fg", "0"}, {"float", "mix", "Coverage", true}});
    }
    if (slopes) write_microfacets(network);
    if (stage.attributes.wet) {
        network.node("Wet", "ND_geompropvalue_float", "float",
                     {{"string", "geomprop", "\"wet\""}, {"float", "default", "1"}});
        network.node("Opacity", "ND_ifgreatereq_color3", "color3f",
                     {{"float", "value1", "Wet", true},
                      {"float", "value2", "0.5"},
                      {"color3f", "in1", "(1, 1, 1)"},
                      {"color3f", "in2", "(0, 0, 0)"}});
    }
}

void write_material(Page& page, const Stage& stage, const std::string& path) {
    page.prim("def Material", "Water");
    page.line({"token outputs:mtlx:surface.connect = <", path, "/Surface.outputs:out>"});
    page.line({"token outputs:surface.connect = <", path, "/Preview.outputs:surface>"});
    write_preview_surface(page, stage, path);
    write_materialx_surface(page, stage, path);
    page.close("}");
}

// A distant light shines along its −z, so its +z must point to the sun: turned about y from the zenith down
// to the sun's elevation, then about z to its azimuth.
void write_sun(Page& page, const Sun& sun) {
    page.prim("def DistantLight", "Sun");
    page.line({"float inputs:angle = ", real32("the sun's angle", sun.angle_deg)});
    page.line({"color3f inputs:color = ", color("the sun's colour", sun.color)});
    page.line({"float inputs:intensity = ", real32("the sun's intensity", sun.intensity)});
    page.line({"bool inputs:normalize = 1"});
    page.line({"float3 xformOp:rotateXYZ = (0, ", real32("the sun's elevation", 90.0 - sun.elevation_deg),
               ", ", real32("the sun's azimuth", sun.azimuth_deg), ")"});
    page.line({"uniform token[] xformOpOrder = [\"xformOp:rotateXYZ\"]"});
    page.close("}");
}

// In a DomeLight's own axes, whatever the stage's up axis, the image has +z in its middle, +x a quarter of the width
// further left, and +y at the top: UsdLux takes OpenEXR's lat-long map. (DomeLight_1, which has a poleAxis, is newer
// than most hosts.) The rotation takes x to y, y to z and z to x: +x is then in the middle, +y a quarter to the left,
// and +z at the top.
void write_sky(Page& page, const Sky& sky) {
    page.prim("def DomeLight", "Sky");
    page.line({"color3f inputs:color = ", color("the sky's colour", sky.color)});
    page.line({"float inputs:intensity = ", real32("the sky's intensity", sky.intensity)});
    if (!sky.lat_long_file.empty()) {
        page.line({"asset inputs:texture:file = ", asset(sky.lat_long_file)});
        page.line({"token inputs:texture:format = \"latlong\""});
    }
    page.line({"float3 xformOp:rotateXYZ = (90, 0, 90)"});
    page.line({"uniform token[] xformOpOrder = [\"xformOp:rotateXYZ\"]"});
    page.close("}");
}

// The values of what changes, by frame, but for those amid equal ones, and the first for who asks at no time.
template <class Text>
void write_samples(Page& page, const std::string& name, const std::vector<FrameLight>& light,
                   const Text& text) {
    page.line({name, " = ", text(light.front())});
    page.open({name, ".timeSamples = {"});
    std::string before, now = text(light.front());
    for (std::size_t i = 0; i < light.size(); ++i) {
        const bool is_end = i == 0 || i + 1 == light.size();
        std::string after = i + 1 < light.size() ? text(light[i + 1]) : "";
        if (is_end || now != before || now != after)
            page.line({number(std::int64_t{light[i].frame}), ": ", now, ","});
        before = std::exchange(now, std::move(after));
    }
    page.close("}");
}

void write_light(Page& page, const std::vector<FrameLight>& light) {
    page.prim("def DistantLight", "Sun");
    page.line({"float inputs:angle = ", real32("the sun's angle", light.front().sun.angle_deg)});
    write_samples(page, "color3f inputs:color", light,
                  [](const FrameLight& at) { return color("the sun's colour", at.sun.color); });
    write_samples(page, "float inputs:intensity", light,
                  [](const FrameLight& at) { return real32("the sun's intensity", at.sun.intensity); });
    page.line({"bool inputs:normalize = 1"});
    write_samples(page, "float3 xformOp:rotateXYZ", light, [](const FrameLight& at) {
        return "(0, " + real32("the sun's elevation", 90.0 - at.sun.elevation_deg) + ", " +
               real32("the sun's azimuth", at.sun.azimuth_deg) + ")";
    });
    page.line({"uniform token[] xformOpOrder = [\"xformOp:rotateXYZ\"]"});
    page.close("}");
    page.prim("def DomeLight", "Sky");
    write_samples(page, "asset inputs:texture:file", light,
                  [](const FrameLight& at) { return asset(at.sky.lat_long_file); });
    page.line({"token inputs:texture:format = \"latlong\""});
    page.line({"float3 xformOp:rotateXYZ = (90, 0, 90)"});
    page.line({"uniform token[] xformOpOrder = [\"xformOp:rotateXYZ\"]"});
    page.close("}");
}

void write_camera(Page& page, const Stage& stage) {
    page.gap();
    page.open({"def Camera \"", kCameraName, "\" ("});
    page.line({"prepend references = @./", camera_file(stage.name), "@"});
    page.close(")");
    page.line({"{"});
    page.line({"}"});
}

void write_volumes(Page& page, const Stage& stage) {
    page.gap();
    page.open({"def Scope \"", kVolumesName, "\" ("});
    page.line({"prepend references = @./", volumes_file(stage.name), "@"});
    page.close(")");
    page.line({"{"});
    page.line({"}"});
}

void write_drops(Page& page, const Stage& stage) {
    page.gap();
    page.open({"def Points \"", kDropsName, "\" ("});
    page.line({"prepend references = @./", drops_file(stage.name), "@"});
    page.close(")");
    page.line({"{"});
    page.line({"}"});
}

// An asset of its own: outliners take a component for one thing, and its hint as its size before they load more of it.
void open_root(Page& page, const Stage& stage, const std::string& root) {
    page.gap();
    page.open({"def Xform \"", root, "\" ("});
    if (stage.extents_hint) page.line({"prepend apiSchemas = [\"GeomModelAPI\"]"});
    page.open({"assetInfo = {"});
    page.line({"asset identifier = ", asset("./" + root_file(stage.name))});
    page.line({"string name = ", quoted(stage.name)});
    page.close("}");
    page.line({"kind = \"component\""});
    page.close(")");
    page.open({"{"});
    if (!stage.extents_hint) return;
    const auto corner = [](const glm::vec3& at) { return color("the sea's extent", at); };
    page.line({"float3[] extentsHint = [", corner((*stage.extents_hint)[0]), ", ",
               corner((*stage.extents_hint)[1]), "]"});
}

}  // namespace

std::string root_text(const Stage& stage) {
    if (stage.last_frame < stage.first_frame) {
        throw std::invalid_argument("USD: the last frame must not come before the first");
    }
    const std::string root = prim_name(stage.name);
    const std::string material = "/" + root + "/Materials/Water";
    Page page;
    page.open({"("});
    write_custom_data(page, stage);
    write_head(page, {.default_prim = root,
                      .fps = stage.fps,
                      .first_frame = stage.first_frame,
                      .last_frame = stage.last_frame});
    page.close(")");
    open_root(page, stage, root);
    write_mesh(page, stage, material);
    page.prim("def Scope", "Materials");
    write_material(page, stage, material);
    page.close("}");
    if (stage.sun) write_sun(page, *stage.sun);
    if (stage.sky) write_sky(page, *stage.sky);
    if (!stage.light.empty()) write_light(page, stage.light);
    if (stage.has_camera) write_camera(page, stage);
    if (stage.has_volumes) write_volumes(page, stage);
    if (stage.has_drops) write_drops(page, stage);
    page.close("}");
    return page.text();
}

}  // namespace pelagic::usd
