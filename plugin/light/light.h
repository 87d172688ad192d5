// The light of a shot, and its water, as every room that lights the sea takes them.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "core/lighting/floor.h"
#include "core/lighting/foam_structure.h"
#include "core/lighting/sky.h"
#include "core/lighting/water.h"
#include "core/scene/problem.h"
#include "core/spectrum/directional_spectrum.h"
#include "pelagic/scene.h"
#include "plugin/format/exr/exr.h"

namespace pelagic {

// What is wrong with the picture that light.sky is the path of, as far as can be said without its pixels: the check
// of named files that hosts pass to load_shot().
std::vector<Problem> check_sky(const Scene& scene);
// The same, and impossible waves (core/spectrum/possible.h) where the scene is valid otherwise: all that hosts check
// of a shot.
std::vector<Problem> check_scene(const Scene& scene);
// Whether light.sky is the path of a picture.
bool has_sky_picture(const Scene& scene);
// Where it is none.
Daylight daylight_of(const Light& light);
// The shot's light: its daylight, or the picture that light.sky is the path of. A large picture is read in parts.
// Throws std::invalid_argument, naming the key and the file, for a picture that can't be read or isn't one of a sky. As what else here
// shows one moment it wants the scene of a frame (core/scene/number_keys.h), and throws where what it shows has keys.
Sky make_sky(const Scene& scene);
// The floor below a sea that rests at a height [m]: level at sea.depth_m, or as the pictures or the mesh say that sea.depth_file and water.floor_pattern
// are the paths of. Depths below a centimetre are one: land isn't seen. Throws std::invalid_argument, naming the key and the file, for a picture that
// can't be read or isn't one of a floor.
Floor make_floor(const Scene& scene, double rest_m = 0.0);
// What reading those pictures holds, at most, and the floor of them [bytes]; 0 without, and for those that can't be read.
std::size_t floor_bytes(const Scene& scene);
// What make_sky(), make_floor() and make_foam_picture() read besides the scene, as text for fingerprints: a hash of each picture's bytes; empty
// without any. Throws std::invalid_argument for a file that can't be read.
std::string picture_content(const Scene& scene);
// Of make_sky()'s alone.
std::string sky_content(const Scene& scene);
// The scene as files describe it, wherever they are made: pictures by their names without their folders.
Scene portable(Scene scene);
// The unit of the sky's radiance, as files say it.
std::string radiance_unit(const Scene& scene, bool acescg = false);
// What each EXR of the sky's radiance says of it: that unit, the primaries, and where it is known, in OpenEXR's own way,
// the luminance of (1, 1, 1).
std::vector<exr::Attribute> radiance_attributes(const Scene& scene, bool acescg = false);
// What is in the shot's water. Of a body some milliseconds, since it needs the sea's spectrum (prepare()); who has that passes it on.
WaterBody make_water(const Scene& scene);
WaterBody make_water(const Scene& scene, const DirectionalSpectrum& spectrum);
// What a body of water does to light, as text, at the six wavelengths of WaterBands: absorption, backscattering, and how fast the light of a high
// sun fades on its way down (Lee et al. 2005) [1/m]; empty without a body.
struct WaterText {
    std::string wavelengths_nm, absorption_per_m, backscatter_per_m, fading_per_m;
};
WaterText water_text(const WaterBody& water);
// What the light depends on, as text: while it stays the same, sky and make_foam_picture() do. Water and how foam looks are no part of it.
std::string light_content(const Scene& scene);
// Whether make_sky() gives both the same; quicker than light_content(), which has the exposure in it.
bool same_sky(const Scene& a, const Scene& b);
// The share of the law's foam that breaks now, in a sea in which earlier breaking has left that coverage; 1 without
// persistent foam.
double active_foam(const Scene& scene, double residual_coverage);
// The picture that effects.foam_pattern is the path of, or null. Throws std::invalid_argument, naming the key and the file, for one
// that can't be read or isn't one of foam.
std::shared_ptr<const FoamImage> make_foam_picture(const Scene& scene);
// The same, for hosts that make light again and again: the one that this function gave last, while somebody has it and its file is the
// same by its path, its size and the time of its change.
std::shared_ptr<const FoamImage> kept_foam_picture(const Scene& scene);
// How the foam of a shot looks. picture: make_foam_picture()'s, null where nobody asks for more than opacities. active: the share of
// active_foam(); the rest is what earlier breaking left. Where the shot doesn't say otherwise foam hides the water while it breaks, and
// what it leaves is thin (Darles et al. 2007: less with its age); all of the law's foam together has Koepke's opacity: in lighting by
// shares of area, whatever a pixel's size.
FoamLook make_foam(const Scene& scene, std::shared_ptr<const FoamImage> picture, double active = 1.0);

}  // namespace pelagic
