// The root layer as text. See text.h.
#include <cmath>
#include <stdexcept>

#include "plugin/usd/page.h"
#include "plugin/usd/text.h"

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
        page.line(
            {"doc = \"Points are relative to ", kOrigin,
             ", which follows the camera in steps: far from the world's origin floats are too coarse for places. ",
             "A step is no motion; velocities leave it out.\""});
    page.line({"prepend references = @./", topology_file(stage.name, stage.topology_extension), "@"});
    page.close(")");
    page.open({"{"});
    page.line({"rel material:binding = <", material_path, ">"});
    page.close("}");
}

// A node of the material's network. Its result is its output "out".
void open_node(Page& page, std::string_view name, std::string_view id) {
    page.prim("def Shader", name);
    page.line({"uniform token info:id = \"", id, "\""});
}

void close_node(Page& page, std::string_view output_type) {
    page.line({output_type, " outputs:out"});
    page.close("}");
}

// UsdPreviewSurface has no node that mixes two colours, so it shows water without whitecaps.
void write_preview_surface(Page& page, const Material& material) {
    open_node(page, "Preview", "UsdPreviewSurface");
    page.line({"color3f inputs:diffuseColor = ", color("the water's colour", material.color)});
    page.line({"float inputs:ior = ", real32("the water's ior", material.ior)});
    page.line({"float inputs:metallic = 0"});
    page.line({"float inputs:opacity = ", real32("the water's opacity", material.opacity)});
    page.line({"float inputs:roughness = ", real32("the water's roughness", material.roughness)});
    page.line({"token outputs:surface"});
    page.close("}");
}

// MaterialX's standard_surface. It takes whitecaps and roughness from the mesh's primvars where the mesh has
// them.
void write_materialx_surface(Page& page, const Stage& stage, const std::string& path) {
    const Material& material = stage.material;
    const std::string water = color("the water's colour", material.color);
    const std::string foam = color("the whitecaps' colour", material.whitecap_color);
    open_node(page, "Surface", "ND_standard_surface_surfaceshader");
    page.line({"float inputs:base = 1"});
    if (stage.attributes.whitecap_coverage) {
        page.line({"color3f inputs:base_color.connect = <", path, "/BaseColor.outputs:out>"});
        page.line({"float inputs:specular.connect = <", path, "/Specular.outputs:out>"});
    } else {
        page.line({"color3f inputs:base_color = ", water});
        page.line({"float inputs:specular = 1"});
    }
    page.line({"float inputs:specular_IOR = ", real32("the water's ior", material.ior)});
    if (stage.attributes.slope_variance) {
        page.line({"float inputs:specular_roughness.connect = <", path, "/Roughness.outputs:out>"});
    } else {
        page.line(
            {"float inputs:specular_roughness = ", real32("the water's roughness", material.roughness)});
    }
    close_node(page, "token");

    if (stage.attributes.whitecap_coverage) {
        open_node(page, "Coverage", "ND_geompropvalue_float");
        page.line({"string inputs:geomprop = \"whitecapCoverage\""});
        close_node(page, "float");
        open_node(page, "BaseColor", "ND_mix_color3");
        page.line({"color3f inputs:bg = ", water});
        page.line({"color3f inputs:fg = ", foam});
        page.line({"float inputs:mix.connect = <", path, "/Coverage.outputs:out>"});
        close_node(page, "color3f");
        open_node(page, "Specular", "ND_mix_float");
        page.line({"float inputs:bg = 1"});
        page.line({"float inputs:fg = 0"});
        page.line({"float inputs:mix.connect = <", path, "/Coverage.outputs:out>"});
        close_node(page, "float");
    }
    if (stage.attributes.slope_variance) {
        // roughness = √α and α² = 2σ², where σ² is the mean of σxx and σyy: roughness = (σxx + σyy)^¼.
        open_node(page, "SlopeVariance", "ND_geompropvalue_vector3");
        page.line({"string inputs:geomprop = \"slopeVariance\""});
        close_node(page, "float3");
        open_node(page, "Alpha2", "ND_dotproduct_vector3");
        page.line({"float3 inputs:in1.connect = <", path, "/SlopeVariance.outputs:out>"});
        page.line({"float3 inputs:in2 = (1, 1, 0)"});
        close_node(page, "float");
        open_node(page, "Roughness", "ND_power_float");
        page.line({"float inputs:in1.connect = <", path, "/Alpha2.outputs:out>"});
        page.line({"float inputs:in2 = 0.25"});
        close_node(page, "float");
    }
}

void write_material(Page& page, const Stage& stage, const std::string& path) {
    page.prim("def Material", "Water");
    page.line({"token outputs:mtlx:surface.connect = <", path, "/Surface.outputs:out>"});
    page.line({"token outputs:surface.connect = <", path, "/Preview.outputs:surface>"});
    write_preview_surface(page, stage.material);
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

// A dome's image has +z in its middle, +x a quarter of the width further left, and +y at the top (OpenEXR's
// lat-long map). The rotation takes x to y, y to z and z to x: +x is then in the middle, +y a quarter to the
// left, and +z at the top.
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

void write_camera(Page& page, const Stage& stage) {
    page.gap();
    page.open({"def Camera \"", kCameraName, "\" ("});
    page.line({"prepend references = @./", camera_file(stage.name), "@"});
    page.close(")");
    page.line({"{"});
    page.line({"}"});
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
    page.prim("def Xform", root);
    write_mesh(page, stage, material);
    page.prim("def Scope", "Materials");
    write_material(page, stage, material);
    page.close("}");
    if (stage.sun) write_sun(page, *stage.sun);
    if (stage.sky) write_sky(page, *stage.sky);
    if (stage.has_camera) write_camera(page, stage);
    page.close("}");
    return page.text();
}

}  // namespace pelagic::usd
