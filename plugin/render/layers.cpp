#include "plugin/render/layers.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace pelagic {

PictureLayerSet light_layers() {
    PictureLayerSet layers;
    for (const PictureLayerRow& row : kPictureLayers) layers[index(row.layer)] = is_light(row);
    return layers;
}

PictureLayerSet layers_of(bool has_objects, PictureLayerSet layers) {
    for (const PictureLayerRow& row : kPictureLayers)
        if (row.of_objects && !has_objects) layers.reset(index(row.layer));
    return layers;
}

PictureLayerSet parse_picture_layers(const std::string& text) {
    PictureLayerSet layers;
    if (text == "none") return layers;
    if (text == "all") return layers.set();
    std::istringstream words(text + ',');  // an empty text is a word that is none
    for (std::string word; std::getline(words, word, ',');) {
        const auto row = std::find_if(kPictureLayers.begin(), kPictureLayers.end(),
                                      [&](const PictureLayerRow& layer) { return layer.name == word; });
        if (row == kPictureLayers.end()) {
            std::string names;
            for (const PictureLayerRow& layer : kPictureLayers)
                names += (names.empty() ? "" : ", ") + std::string(layer.name);
            throw std::invalid_argument("layers \"" + text + "\": \"" + word +
                                        "\" is none; accepted: any of " + names +
                                        " with commas between, or all, or none");
        }
        layers.set(index(row->layer));
    }
    return layers;
}

std::size_t data_components(PictureLayerSet layers) {
    std::size_t components = 0;
    for (const PictureLayerRow& row : kPictureLayers)
        if (!is_light(row) && layers[index(row.layer)]) components += row.components;
    return components;
}

bool needs_motion(PictureLayerSet layers) {
    return layers[index(PictureLayer::Motion)] || layers[index(PictureLayer::Vector)];
}

}  // namespace pelagic
