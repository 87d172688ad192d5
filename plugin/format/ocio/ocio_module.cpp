#include "plugin/format/ocio/ocio_module.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

namespace pelagic::ocio {
namespace {

namespace OCIO = OCIO_NAMESPACE;

std::string listed(const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return list;
}

// The asked one, or the default of an empty one.
std::string chosen(const std::string& asked, const char* usual, const char* what,
                   std::vector<std::string> known) {
    const std::string name = asked.empty() && usual ? usual : asked;
    if (std::find(known.begin(), known.end(), name) == known.end())
        throw std::invalid_argument("has no " + std::string(what) + " \"" + name +
                                    "\"; accepted: " + listed(known));
    return name;
}

// What configurations call linear Rec. 709, where they have no interchange role: the Academy's of both generations, and Blender's.
constexpr std::array kUsualSpaces{"Linear Rec.709 (sRGB)", "lin_rec709", "Utility - Linear - Rec.709",
                                  "Linear Rec.709",        "lin_srgb",   "Linear"};

class OcioView final : public View {
  public:
    explicit OcioView(const ViewChoice& choice) {
        const OCIO::ConstConfigRcPtr config = OCIO::Config::CreateFromFile(choice.config.c_str());
        config->validate();
        std::vector<std::string> displays, views;
        for (int i = 0; i < config->getNumDisplays(); ++i) displays.emplace_back(config->getDisplay(i));
        const std::string display =
            chosen(choice.display, config->getDefaultDisplay(), "display", std::move(displays));
        for (int i = 0; i < config->getNumViews(display.c_str()); ++i)
            views.emplace_back(config->getView(display.c_str(), i));
        const std::string view =
            chosen(choice.view, config->getDefaultView(display.c_str()), "view", std::move(views));
        name_ = display + ", " + view;

        const auto shown = OCIO::DisplayViewTransform::Create();
        shown->setDisplay(display.c_str());
        shown->setView(view.c_str());
        const auto group = OCIO::GroupTransform::Create();
        std::string space = choice.space;
        if (space.empty() && config->hasRole(OCIO::ROLE_INTERCHANGE_SCENE)) {
            std::array<double, 16> matrix{};
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column)
                    matrix[static_cast<std::size_t>(4 * row + column)] =
                        static_cast<double>(choice.aces_of_rec709[column][row]);
            matrix[15] = 1.0;
            const auto to_aces = OCIO::MatrixTransform::Create();
            to_aces->setMatrix(matrix.data());
            group->appendTransform(to_aces);
            space = OCIO::ROLE_INTERCHANGE_SCENE;
        }
        for (const char* usual : kUsualSpaces)
            if (space.empty() && config->getColorSpace(usual)) space = usual;
        if (space.empty() || !config->getColorSpace(space.c_str()))
            throw std::invalid_argument(
                (space.empty()
                     ? "has neither the role aces_interchange nor a colour space of a usual name for linear Rec. 709"
                     : "has no colour space \"" + space + "\"") +
                std::string("; accepted: --ocio-space with one of ") + listed(spaces_of(*config)));
        shown->setSrc(space.c_str());
        group->appendTransform(shown);
        const OCIO::ConstProcessorRcPtr way = config->getProcessor(group);
        content_ = way->getCacheID();
        processor_ = way->getDefaultCPUProcessor();
    }

    void apply(std::span<glm::vec3> colours) const override {
        if (colours.empty()) return;
        OCIO::PackedImageDesc image(&colours.front().x, static_cast<long>(colours.size()), 1, 3);
        processor_->apply(image);
        // A table may have no number for what is far beyond it.
        for (glm::vec3& colour : colours)
            for (int c = 0; c < 3; ++c)
                if (!std::isfinite(colour[c])) colour[c] = colour[c] > 0.0f ? 1.0f : 0.0f;
    }
    const std::string& content() const override { return content_; }
    const std::string& name() const override { return name_; }

  private:
    static std::vector<std::string> spaces_of(const OCIO::Config& config) {
        std::vector<std::string> names;
        for (int i = 0; i < config.getNumColorSpaces(); ++i)
            names.emplace_back(config.getColorSpaceNameByIndex(i));
        return names;
    }

    std::string content_, name_;
    OCIO::ConstCPUProcessorRcPtr processor_;
};

}  // namespace
}  // namespace pelagic::ocio

const pelagic::ocio::View* pelagic_ocio_view(const pelagic::ocio::ViewChoice& choice) {
    try {
        return new pelagic::ocio::OcioView(choice);
    } catch (const OCIO_NAMESPACE::Exception& error) {
        throw std::invalid_argument(std::string("isn't a configuration that OpenColorIO reads: ") +
                                    error.what() + "; accepted: the path of a config.ocio");
    }
}
