// How a studio's OpenColorIO configuration shows light on a display.
//
// What is OpenColorIO's is a module of its own, pelagic_ocio.so, that is loaded for the first view: no program needs
// OpenColorIO to start.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>

namespace pelagic::ocio {

struct ViewChoice {
    std::string config{};           // the path of a config.ocio
    std::string display{}, view{};  // empty: the configuration's own default
    std::string
        space{};  // its name of linear Rec. 709; empty: found by its interchange role or by a usual name
    glm::mat3 aces_of_rec709{1.0f};  // from linear Rec. 709 to ACES 2065-1, the interchange role's
};

class View {
  public:
    virtual ~View() = default;
    // From linear Rec. 709, middle grey 0.18, to what the display is sent, in place. Any thread.
    virtual void apply(std::span<glm::vec3> colours) const = 0;
    // For fingerprints: of the whole way from light to display, tables included.
    virtual const std::string& content() const = 0;
    virtual const std::string& name() const = 0;  // "sRGB, Filmic"
};

// Throws std::invalid_argument, for a message after the option's name, for a configuration that can't be read or doesn't
// know such a display, view or space, with what it knows; std::system_error if OpenColorIO can't be loaded.
std::shared_ptr<const View> make_view(const ViewChoice& choice);

}  // namespace pelagic::ocio
