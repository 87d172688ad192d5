#include "plugin/format/shot/object_image_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/gtc/packing.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "plugin/format/exr/read.h"
#include "plugin/format/png/png.h"
#include "plugin/format/shot/text_file.h"

namespace pelagic {
namespace {

constexpr std::size_t kMostImageBytes = std::size_t{1} << 30;
constexpr const char* kPicture = "a PNG or an OpenEXR";

std::string most_text() {
    return "pictures of at most " + std::to_string(limits::kObjectImageSide) + " texels a side, " +
           std::to_string(limits::kObjectTexels >> 20) + " Mi of all the mesh's together";
}

// IEC 61966-2-1.
double srgb_decoded(double display) {
    return display <= 0.04045 ? display / 12.92 : std::pow((display + 0.055) / 1.055, 2.4);
}

// Numbers of a row's place among rows from the bottom.
std::size_t place_of_row(int y, int width, int height) {
    return 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height - 1 - y);
}

void check_sides(int width, int height, std::size_t most_texels) {
    if (width > limits::kObjectImageSide || height > limits::kObjectImageSide ||
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > most_texels)
        throw PictureRefused{"has " + std::to_string(width) + " x " + std::to_string(height) + " texels",
                             most_text()};
}

std::shared_ptr<const ObjectImage> from_png(std::string_view bytes, std::size_t most_texels) {
    const png::Pixels pixels = png::decode(bytes, most_texels);
    check_sides(pixels.width, pixels.height, most_texels);
    std::array<std::uint16_t, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i)
        linear[i] = glm::packHalf1x16(static_cast<float>(srgb_decoded(static_cast<double>(i) / 255.0)));
    std::vector<std::uint16_t> rgb(pixels.rgb.size());
    const std::size_t row = 3 * static_cast<std::size_t>(pixels.width);
    for (int y = 0; y < pixels.height; ++y)
        std::transform(
            pixels.rgb.begin() + static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(y)),
            pixels.rgb.begin() + static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(y + 1)),
            rgb.begin() + static_cast<std::ptrdiff_t>(place_of_row(y, pixels.width, pixels.height)),
            [&](std::uint8_t byte) { return linear[byte]; });
    return std::make_shared<const ObjectImage>(pixels.width, pixels.height, std::move(rgb));
}

std::shared_ptr<const ObjectImage> from_exr(const std::filesystem::path& file, std::size_t most_texels) {
    const exr::RgbFile picture(file);
    const int width = picture.width(), height = picture.height();
    check_sides(width, height, most_texels);
    std::vector<std::uint16_t> rgb(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    std::vector<float> read(3 * static_cast<std::size_t>(width) *
                            static_cast<std::size_t>(picture.rows_in_piece()));
    for (int first = 0; first < height; first += picture.rows_in_piece()) {
        const int rows = std::min(picture.rows_in_piece(), height - first);
        const std::size_t a_row = 3 * static_cast<std::size_t>(width);
        picture.read(first, std::span(read).first(a_row * static_cast<std::size_t>(rows)));
        for (int y = 0; y < rows; ++y)
            for (std::size_t i = 0; i < a_row; ++i) {
                const float number = read[a_row * static_cast<std::size_t>(y) + i];
                if (std::isnan(number))
                    throw PictureRefused{"has NaN in line " + std::to_string(first + y + 1), "numbers"};
                rgb[place_of_row(first + y, width, height) + i] =
                    glm::packHalf1x16(std::clamp(number, 0.0f, 1.0f) + 0.0f);
            }
    }
    return std::make_shared<const ObjectImage>(width, height, std::move(rgb));
}

}  // namespace

std::shared_ptr<const ObjectImage> read_object_image(const std::filesystem::path& file,
                                                     std::size_t most_texels) {
    const std::string name = file.filename().string();
    if (has_ending(name, ".jpg") || has_ending(name, ".jpeg"))
        throw PictureRefused{"is a JPEG", std::string(kPicture) + ": convert it"};
    try {
        if (has_ending(name, ".exr")) return from_exr(file, most_texels);
        if (has_ending(name, ".png")) return from_png(read_text_file(file, kMostImageBytes), most_texels);
    } catch (const exr::ReadError& error) {
        throw PictureRefused{error.problem(), error.accepted()};
    } catch (const png::ReadError& error) {
        throw PictureRefused{error.what(), most_text()};
    } catch (const TextFileError& error) {
        throw PictureRefused{error.what(), kPicture};
    }
    throw PictureRefused{"is neither PNG nor OpenEXR", std::string(kPicture) + ": convert it"};
}

}  // namespace pelagic
