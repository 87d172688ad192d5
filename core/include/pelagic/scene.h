// What the artist asks for, as a plain value: the first link of Scene → Plan → Sea → Frame → evaluate. Nothing is computed in the
// headers that others have: with their compilers and flags the bits would be others.
//
// Each struct mirrors a table of the shot file, each member the key of the same name (scene/keys.h describes
// them); the defaults here *are* the shot file's defaults. Nothing in a Scene depends on a file: a measured
// spectrum and a cage are in it as data, already parsed. validate() (scene/validate.h) says whether the values make sense
// together.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pelagic/cage.h"
#include "pelagic/depth_map.h"
#include "pelagic/mask_picture.h"
#include "pelagic/object_mesh.h"
#include "pelagic/version.h"

namespace pelagic {
inline namespace PELAGIC_VERSION_NAMESPACE {

enum class SpectrumKind { PiersonMoskowitz, Jonswap, Jonswap1973, Tma, Elfouhaily, Omega2, Phillips, File };
enum class ShortWaves { Elfouhaily, None };
enum class GrowthLaw { HeightAndPeak, Height };
enum class WhitecapLaw { Monahan1980, Monahan1986, Callaghan2008 };
enum class SpraySource { Monahan1986, Andreas1998 };
enum class SpreadingKind { Hasselmann, DonelanBanner, Cosine, Elfouhaily };
enum class WaveModel { Fft, Trochoid };
// What floats lies on the water under it, or moves by its own mass as well (core/evaluate/floating_response.h).
enum class Buoyancy { Plane, Response };
enum class Tiling { Random, Periodic };
enum class SurfaceKind { Patch, ProjectedGrid, NearFar, Cage, Planet };
enum class Beyond { ByKind, Sea, Nothing };
enum class CameraInterpolation { Linear, Smooth };
enum class WaterType {
    Ocean,
    Coastal,
    Turbid,
    // Jerlov's types (1976): of the open sea, and of coasts.
    JerlovI,
    JerlovIA,
    JerlovIB,
    JerlovII,
    JerlovIII,
    Jerlov1C,
    Jerlov3C,
    Jerlov5C,
    Jerlov7C,
    Jerlov9C
};
enum class QualityLevel { Draft, Preview, Final, Reference };
enum class MeshFormat { Usda, Usdc, None };
enum class MeshAttribute { Normal, Velocity, SlopeVariance, Whitecaps };
enum class MapKind { Displacement, Normal, SlopeVariance, Whitecaps, Floor };
enum class MeshScheme { None, CatmullClark };
enum class VolumeKind { Spray, LevelSet };

// What an artist's shot means where it doesn't say: its defaults (core/scene/editions.h has what each edition changed).
inline constexpr int kNewestEdition = 3;

// [shot]
struct Shot {
    int edition = kNewestEdition;  // 1 … kNewestEdition
    std::string name = "sea";      // letters, digits, _ and -
    int first_frame = 1;           // both included; time_s() says what a frame shows
    int last_frame = 48;
    double fps = 24.0;           // > 0
    std::uint64_t seed = 1;      // 0 … 2^63 − 1
    double loop_s = 0.0;         // > 0: repeats exactly after this long, a whole number of frames; 0: no loop
    double time_scale = 1.0;     // seconds of the sea in a second on the screen, ≥ 0: 1/2 is slow motion
    double time_offset_s = 0.0;  // the sea's time at frame 1

    // The sea's time that a frame shows, also between two of them: t = offset + scale (f − 1)/fps. In a loop the
    // time in its first round: counted in whole frames, so that frames a loop apart show the same to the bit.
    double time_s(double frame) const;
    // loop_s as the whole number of frames that it is to within rounding; 0: no loop.
    double exact_loop_s() const;
    // The sea's own period: what it goes through in a loop. 0: no loop, or a sea that stands still.
    double sea_loop_s() const;
};

// A swell from a far storm: a second, narrow spectrum.
struct Swell {
    double height_m = 0.0;       // 4 √m0, ≥ 0
    double period_s = 10.0;      // peak period, > 0
    double direction_deg = 0.0;  // travelling towards, counter-clockwise from +x
};

// One hour of a directional buoy, in Pelagic's convention (not the buoy's): already turned to "towards,
// counter-clockwise from +x". c1, c2: the first and second Fourier coefficients ∫D e^{iθ} dθ and ∫D e^{2iθ}
// dθ.
struct MeasuredSpectrum {
    struct Bin {
        double frequency_hz;
        double density_m2_per_hz;  // ≥ 0
        double c1_re, c1_im;
        double c2_re, c2_im;
        bool has_direction;  // false: r1, α1, … were missing; only the density counts
    };
    std::vector<Bin> bins;  // by rising frequency, at least two
    std::string station;    // for messages and the record, e.g. "41010"
    std::string time;       // e.g. "2019-02-06T00:40:00Z"
    std::string file = {};  // where it was read; what a shot depends on is the content
};

// A patch of another wind that crosses the sea, as a cat's paw or a squall line (core/plan/gusts.h): an ellipse with a ragged edge.
struct GustFront {
    double frame = 1.0;                  // when it is there, on the shot's own clock
    double east_m = 0.0, north_m = 0.0;  // its middle, then
    double direction_deg = 0.0;          // travelling towards, counter-clockwise from +x
    double speed_mps = 6.0;              // ≥ 0
    double length_m = 100.0,
           width_m = 300.0;  // > 0, of the ellipse, where it blows whole: along its way and across
    double edge_m = 60.0;    // > 0: round the ellipse, where it fades
    double wind = 2.0;       // 0.1 … 4, times the sea's wind
};

// [sea]
struct SeaState {
    double wind_speed_mps = 10.0;                              // 10 m above the sea, 0 … 80
    double wind_direction_deg = 0.0;                           // blowing towards, counter-clockwise from +x
    double fetch_m = 300e3;                                    // > 0
    double depth_m = std::numeric_limits<double>::infinity();  // > 0
    // The floor that is seen where it isn't level: "none", or the path of a picture of depths [m], how wide it is and where its middle lies.
    // Waves are those of depth_m, and with Waves::coast come from there.
    std::string depth_file = "none";
    double depth_size_m = 100.0;  // > 0
    double depth_east_m = 0.0, depth_north_m = 0.0;
    SpectrumKind spectrum = SpectrumKind::Jonswap;
    GrowthLaw growth = GrowthLaw::HeightAndPeak;
    // The tail and the spreading that take the spectrum's place beyond a few peak wavenumbers.
    ShortWaves short_waves = ShortWaves::Elfouhaily;
    std::optional<double> significant_height_m;  // of the wind sea or the measured one, instead of its own
    double directionality = 1.0;                 // > 0: more than 1 is narrower than the spreadings' own
    double gust_strength = 0.0;                  // 0 … 1: how much the wind varies over the surface
    double gust_size_m = 300.0;                  // > 0
    std::vector<GustFront>
        gust_fronts;         // where they overlap winds multiply, up to the strongest and down to the weakest
    double rain_mm_h = 0.0;  // 0 … 300
    SpreadingKind spreading = SpreadingKind::Hasselmann;
    std::vector<Swell> swell;
    std::optional<MeasuredSpectrum> measured;  // with SpectrumKind::File
};

// Multiplies the amplitudes of waves of these lengths.
struct BandGain {
    double from_m = 1.0, to_m = 10.0;  // wavelengths at its edges, in either order
    double gain = 1.0;                 // of amplitudes, ≥ 0
};

// A crest that stands where and when a director wants it (core/waves/hero_waves.h).
struct HeroWave {
    double frame = 1.0;                  // when, on the shot's own clock
    double east_m = 0.0, north_m = 0.0;  // where
    double height_m = 5.0;               // of the crest over the mean level; below 0 a trough
};

// A calm or rough place of the world (core/plan/masks.h): an ellipse or a picture, and gains of the sea where it holds.
struct WaveMask {
    double east_m = 0.0, north_m = 0.0;        // its middle
    double length_m = 200.0, width_m = 200.0;  // > 0, of the ellipse, where it holds whole, or of the picture
    double direction_deg = 0.0;                // of its length, counter-clockwise from +x
    double edge_m = 50.0;                  // > 0: round the ellipse, where it fades; a picture is as smooth
    double waves = 1.0;                    // ≥ 0, times the amplitude of all waves
    double ripples = 1.0;                  // 0 … 1, times that of short waves: 0 is a slick
    double foam = 1.0;                     // 0 … 1, times the coverage of what breaks
    std::optional<std::string> picture{};  // in place of the ellipse: its name in Waves::mask_pictures
};

// What makes a wake (core/waves/vessel_waves.h). A list of keys of where its middle is: "1 0 0, 48 20 5", frame, east and north [m] of each.
struct Vessel {
    std::string path = "1 0 0, 48 10 0";
    CameraInterpolation interpolation = CameraInterpolation::Smooth;  // between keys
    double length_m = 25.0, beam_m = 7.0, draught_m = 3.0;            // > 0, of the hull in the water
    double waves = 1.0;  // ≥ 0, times the amplitude of its waves
    double foam = 1.0;   // 0 … 1, times the coverage of its foam
};

struct CascadeSize {
    double size_m = 400.0;               // period, > 0
    int resolution = 512;                // even, 16 … 8192
    std::optional<double> choppiness{};  // λ ≥ 0 of its waves; without: the shot's
};

// [waves]
struct Waves {
    WaveModel model = WaveModel::Fft;
    double choppiness = 1.0;  // λ ≥ 0
    // With WaveModel::Fft: how far in phase the displacement runs ahead of the waves.
    double lean_deg = 15.0;  // 0 … 60
    // With WaveModel::Fft: what pairs of waves add (core/spectrum/second_order.h), times this.
    double second_order = 1.0;  // 0 … 2
    // Largest first; empty: "auto", which is none with WaveModel::Trochoid. With both, the cascades hold the
    // waves that are shorter than the trains.
    std::vector<CascadeSize> cascades;
    Tiling tiling = Tiling::Random;    // of the cascades (core/plan/random_tiling.h)
    std::vector<BandGain> band_gains;  // where bands overlap, their gains multiply
    std::vector<HeroWave> heroes;
    std::vector<WaveMask> masks;  // where they overlap, their gains multiply
    // By the names that masks have for them, the paths of their files; what a shot depends on is the content.
    std::map<std::string, std::shared_ptr<const MaskPicture>> mask_pictures;
    std::vector<Vessel> vessels;
    // With WaveModel::Trochoid. One from each bin of a geometric progression; without a value, the range is the
    // spectrum's (core/plan/trains.h).
    int trains = 250;  // 1 … 10000
    std::optional<double> shortest_m, longest_m;
    // With WaveModel::Trochoid: whether trains feel the floor of SeaState::depth_file (core/waves/coast.h), and that floor, read.
    bool coast = false;
    std::shared_ptr<const DepthMap> coast_depths{};
};

// [surface]
struct Surface {
    SurfaceKind kind = SurfaceKind::Patch;
    double size_m = 200.0;  // > 0
    int resolution = 256;   // quads a side, 1 … 8192; (N+1)² vertices
    double cell_px = 8.0;   // of the projected grid, which pictures of the sea always use: a cell's side
    bool earth_curvature = true;  // of surfaces to the horizon: they lie on the earth's sphere
    std::string cage_file;        // where the cage was read, or empty; what a shot depends on is the content
    std::shared_ptr<const Cage> cage;  // with SurfaceKind::Cage
    CageLevel cage_level;
    Beyond beyond = Beyond::ByKind;  // in pictures: what lies round a patch or a cage
};

struct CameraKey {
    int frame = 1;
    glm::dvec3 position_m{0.0};
    glm::dvec3 look_at_m{0.0};
    std::optional<double> fov_deg{};  // without: the camera's
    double roll_deg = 0.0;            // about the line of sight; above 0 the camera's right side goes down
};

// [camera]
struct Camera {
    glm::dvec3 position_m{0.0, -60.0, 4.0};
    glm::dvec3 look_at_m{0.0, 0.0, 0.0};                              // up is z; looking along z, +y
    std::vector<CameraKey> keys;                                      // by rising frame, constant outside
    CameraInterpolation interpolation = CameraInterpolation::Linear;  // between keys
    double fov_deg = 50.0;                                            // horizontal, 1 … 179
    std::optional<double> focal_length_mm{};                          // the lens, instead of fov_deg
    double sensor_width_mm = 36.0;                                    // of the film behind it
    double shift_x = 0.0, shift_y = 0.0;  // of the picture's centre off the axis, in picture widths
    double f_stop = 0.0;                  // focal length over the aperture's diameter; 0: a pinhole
    double focus_distance_m = 10.0;       // along the axis
    glm::ivec2 resolution{1280, 720};     // 1 … 65536 each
    double exposure_ev = 0.0;             // stops brighter than metered, or than ev100
    std::optional<double>
        ev100{};  // the exposure, as a photographer's meter gives it at ISO 100; without: metered
    double white_balance_k =
        5500.0;          // the light's colour temperature that is shown as neutral: daylight film's
    double glare = 0.0;  // share of the light that the lens scatters
};

// [light]
struct Light {
    double sun_elevation_deg = 20.0;  // −90 … 90
    double sun_azimuth_deg = 90.0;    // towards the sun, counter-clockwise from +x
    // "daylight", or the path of a lat-long picture, as the host that loaded the scene finds it.
    std::string sky = "daylight";
    double turbidity = 2.0;  // of the daylight: 1.7 … 10, haze; 2 is the open sea's, 3 land's
    std::optional<double> visibility_km{};  // of the air under a picture's sky; without: clear
    double sky_rotation_deg = 0.0;          // of a picture's sky with its sun, counter-clockwise from above
    double sky_gain = 1.0;                  // ≥ 0, times a picture's radiance
};

// [water]
struct Water {
    WaterType type = WaterType::Ocean;
    double chlorophyll_mg_m3 = 0.1;  // 0.01 … 100; Jerlov's types have their own
    // Light in the water by the ways of sun and eye, with a floor at sea.depth_m; false: one colour for the whole sea.
    bool body = true;
    glm::dvec3 floor_colour{0.36, 0.31, 0.23};  // of that floor, 0 … 1, linear Rec. 709
    std::string floor_pattern = "plain";        // or the path of a picture, times that colour
    double floor_pattern_m = 4.0;               // the side of that picture, > 0
    double crest_light = 1.0;  // ≥ 0, times what waves' shape does to that light, crests above all
    double bubbles = 1.0;      // ≥ 0, times the bubbles below foam
    double caustics = 1.0;     // ≥ 0, times the pattern of the sun's light on the floor and in the water
};

// [effects]
struct Effects {
    bool whitecaps = true;
    double foam_decay_s = 4.0;  // e-folding time of what breaking leaves; 0: foam is only where waves break
    double foam_drift = 0.02;   // of the wind's speed, along the wind
    WhitecapLaw whitecap_law = WhitecapLaw::Callaghan2008;
    double sea_minus_air_c = 0.0;       // temperature of the sea less the air's, with Monahan1986
    double whitecap_amount = 1.0;       // ≥ 0, times the law
    double breaking_from_m = 1.0;       // the shortest waves that break; 0: all do
    double foam_structure = 1.0;        // 0: smooth coverage … 1: lace
    double foam_streaks = 0.5;          // 0 … 1, along the wind
    std::string foam_pattern = "lace";  // or the path of a picture
    double foam_pattern_m = 10.0;       // the side of that picture, > 0
    // Of foam where waves break and of what they leave: what it reflects where it hides the water (0 … 1), and the share of its
    // area that it hides (0 … 1; 0: such that the mean over the law's foam is 0.4).
    double foam_new_albedo = 0.55, foam_old_albedo = 0.55;
    double foam_new_opaque = 0.0, foam_old_opaque = 0.0;
    bool spray = false;
    SpraySource spray_law = SpraySource::Andreas1998;
    double spray_gain = 1.0;
    bool spray_drops = false;  // its large drops as particles, no longer in the veil
};

// A body in the light of the sea: it is seen, shadows the sea, mirrors itself in it and stands in its light. It makes no waves: those are
// of waves.vessels.
struct SceneObject {
    std::string name{};  // as mattes and messages call it; empty: its file's, without folder and extension
    std::string file{};  // where the mesh was read; what a shot depends on is the content
    std::shared_ptr<const ObjectMesh> mesh{};
    // Where its origin is: "1 0 0, 48 20 5", frame, east and north [m] of each key, as a vessel's path; empty: it stands.
    std::string path{};
    CameraInterpolation interpolation = CameraInterpolation::Smooth;  // of the path
    int vessel = 0;  // 1 …: it is that one of waves.vessels; 0: none
    double east_m = 0.0, north_m = 0.0,
           up_m = 0.0;  // of its origin; with a path or a vessel from there, along its course and to port
    double heading_deg =
        0.0;  // of its +x, counter-clockwise from east; with a path or a vessel from its course
    double pitch_deg = 0.0, roll_deg = 0.0;  // bow up; to starboard down
    double scale = 1.0;                      // > 0
    bool floats = false;                     // heaves, pitches and rolls with the waves
    Buoyancy buoyancy = Buoyancy::Plane;     // of what floats
    double roll_damping = 0.1;               // of Buoyancy::Response, over the critical; > 0
    double foam = 1.0;                       // times the foam where hull and water meet, 0 … 1
    glm::dvec3 colour{1.0};                  // times its materials', 0 … 1
    double glow_cd_m2 = 0.0;                 // luminance of materials that glow, ≥ 0
    double caustics = 0.0;  // ≥ 0, times the pattern of the sun's light that waves mirror onto it
    bool holdout =
        false;  // it is rendered elsewhere: nothing, with alpha 0, where it stands, but mirrored and shadowing

    // Its name, or its file's without folder and extension.
    std::string called() const;
};

// [quality]
struct Quality {
    QualityLevel level = QualityLevel::Final;
    // Instead of the level, one of the two (core/scene/budget.h); nothing that is planned has one.
    std::optional<double> max_error{};
    std::optional<double> frame_ms{};
};

// [output]
struct Output {
    MeshFormat mesh = MeshFormat::Usdc;
    std::vector<MeshAttribute> attributes{MeshAttribute::Normal, MeshAttribute::Velocity,
                                          MeshAttribute::SlopeVariance, MeshAttribute::Whitecaps};
    std::vector<MapKind> maps;
    int map_resolution = 512;  // 1 … 8192 pixels a side
    bool cascade_tiles = false;
    MeshScheme mesh_scheme = MeshScheme::None;
    std::vector<VolumeKind> volumes;
    double voxel_m = 0.5;  // > 0
    bool drops = false;    // effects.spray_drops' particles
};

// A number at some frames, and in between.
struct NumberKeys {
    struct Key {
        int frame = 1;
        double value = 0.0;
        bool operator==(const Key&) const = default;
    };
    std::vector<Key> keys;  // by rising frame, at least one
    CameraInterpolation interpolation = CameraInterpolation::Linear;
    bool operator==(const NumberKeys&) const = default;
};

// A number of the scene that changes over the shot.
struct KeyedNumber {
    std::string path;  // of its key: "light.sun_elevation_deg"
    NumberKeys keys;
};

struct Scene {
    Shot shot;
    SeaState sea;
    Waves waves;
    Surface surface;
    Camera camera;
    Light light;
    Water water;
    Effects effects;
    std::vector<SceneObject> objects;
    Quality quality;
    Output output;
    // Numbers that have keys (set_value() puts them here). A frame's own scene, without any, is scene_at()'s
    // (core/scene/number_keys.h); until then their members hold the largest of the keys, so that a plan has what some frame needs.
    std::vector<KeyedNumber> keyed;
};
}  // namespace PELAGIC_VERSION_NAMESPACE
}  // namespace pelagic
