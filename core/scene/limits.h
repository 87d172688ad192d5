// The ranges that validate() accepts and that the shot file's help names: stated once.
//
// Where the shot file's description only says "> 0", the bounds here are what keeps the arithmetic finite
// with digits to spare; each is far outside what a shot wants.
#pragma once

#include <cstddef>
#include <string>

#include "core/scene/cascade_bands.h"
#include "pelagic/scene.h"

namespace pelagic {

// Both ends included.
struct Range {
    double low;
    double high;

    constexpr bool holds(double value) const { return value >= low && value <= high; }  // never a NaN
};

// "0 … 80"
std::string text_of(Range range);

namespace limits {

inline constexpr int kNameLength = 200;  // file systems stop at 255 bytes, and a bake's suffixes need some

inline constexpr Range kEdition{1.0, kNewestEdition};
inline constexpr Range kFrame{-1e8, 1e8};  // a time (frame − 1)/fps that a double still holds to 1e-5 s
inline constexpr Range kFps{1e-3, 1e4};    // a frame a quarter of an hour … high-speed camera
inline constexpr Range kLoop_s{0.0, 1e7};  // four months
inline constexpr Range kTimeScale{0.0, 1e3};
inline constexpr Range kTimeOffset_s{-1e7, 1e7};
inline constexpr Range kTime_s{-1e12,
                               1e12};  // the sea's; a phase in cycles still has four digits after the point
inline constexpr double kSlowestLoopScale =
    1e-6;  // each wave goes round in a loop, however short that is for the sea
inline constexpr double kLoopTolerance_frames =
    1e-4;  // a loop written with seven digits: 4 µs at 24 frames a second

inline constexpr Range kWindSpeed_mps{0.0, 80.0};
inline constexpr Range kAngle_deg{-1e6, 1e6};  // any number of turns that leaves ten digits of the angle
inline constexpr Range kFetch_m{1.0, 1e8};
inline constexpr Range kSignificantHeight_m{0.0, 50.0};
inline constexpr Range kDirectionality{0.01, 20.0};  // from all directions alike to needles
inline constexpr Range kGustStrength{0.0, 1.0};
inline constexpr Range kGustSize_m{1.0, 1e5};
inline constexpr int kGustFronts = 8;  // each is looked at for every point
inline constexpr Range kFrontSpeed_mps{0.0, 100.0};
inline constexpr Range kFrontSize_m{1.0, 1e5};
inline constexpr Range kFrontEdge_m{1.0, 1e5};
inline constexpr Range kFrontWind{0.1, 4.0};  // in a calm the sea's long waves go on
inline constexpr Range kRain_mm_h{0.0, 300.0};
inline constexpr Range kDepth_m{0.01, 1e6};  // or infinite
inline constexpr int kSwells = 64;           // each is a spectrum of its own in every integral
inline constexpr Range kSwellHeight_m{0.0, 50.0};
inline constexpr Range kSwellPeriod_s{0.1, 100.0};  // 1.6 cm … 16 km long in deep water
inline constexpr Range kMeasuredFrequency_hz{1e-4, 100.0};

inline constexpr Range kChoppiness{0.0, 10.0};  // waves fold over near 1 … 2
inline constexpr Range kLean_deg{0.0, 60.0};
inline constexpr Range kSecondOrder{0.0, 2.0};
inline constexpr int kCascades = 16;
inline constexpr Range kCascadeSize_m{0.01, 1e6};
inline constexpr Range kCascadeResolution{kMinCascadeResolution, kMaxCascadeResolution};
inline constexpr int kBandGains = 32;
inline constexpr Range kBandEdge_m{1e-3, 1e5};
inline constexpr Range kBandGain{0.0, 10.0};
inline constexpr int kHeroes = 8;  // each has trains of its own
inline constexpr Range kHeroHeight_m{-50.0, 50.0};
inline constexpr int kMasks = 16;  // each is looked at for every point
inline constexpr Range kMaskSize_m{1.0, 1e5};
inline constexpr Range kMaskEdge_m{1.0, 1e5};
inline constexpr Range kMaskWaves{0.0, 4.0};
inline constexpr Range kMaskShare{0.0, 1.0};
inline constexpr Range kMaskPicture{2.0, 4096.0};  // pixels a side
inline constexpr int kMaskRows = 16384;  // of all pictures together: they are one texture of the preview's
inline constexpr int kVessels = 16;      // each has a tile of its own
inline constexpr Range kVesselSize_m{0.1, 1000.0};
inline constexpr Range kVesselWaves{0.01, 4.0};
inline constexpr double kVesselSpeed_mps = 100.0;  // of the sea's seconds
inline constexpr int kVesselKeys = 1000;
inline constexpr double kVesselDepthFroude =
    0.8;  // nearer to √(g d) waves pile up, which linear theory has without an end
inline constexpr Range kTrains{1, 10000};
inline constexpr Range kTrain_m{1e-3,
                                1e6};  // the spectra end at a millimetre (core/spectrum/viscous_cutoff.h)

inline constexpr Range kFoamDecay_s{0.0, 30.0};  // a history of a thousand steps; 0.5 … 8 s are observed
inline constexpr Range kFoamDrift{0.0, 1.0};
inline constexpr Range kSeaMinusAir_c{-40.0, 40.0};
inline constexpr Range kWhitecapAmount{0.0, 100.0};
inline constexpr Range kBreakingFrom_m{0.0, 1e3};

inline constexpr Range kSurfaceSize_m{0.01, 1e6};
inline constexpr Range kSurfaceResolution{1, 8192};
inline constexpr int kNearFarResolution = 4096;  // with any size_m its faces' corners number less than 2^31
inline constexpr Range kCell_px{1.0, 256.0};
inline constexpr std::size_t kCageFaces = 1000000;
inline constexpr std::size_t kCageCorners =
    256;  // of a face, and faces round a point: work goes with the square
inline constexpr std::size_t kCagePoints = 4000000;  // and texture coordinates: four for each face
inline constexpr std::size_t kCageAllCorners = 8000000;
inline constexpr Range kCagePoint_m{-1e6, 1e6};
inline constexpr Range kCageTexture{-1e6, 1e6};
inline constexpr Range kCageLevel{0, 6};

inline constexpr Range kCameraCoordinate_m{-1e9, 1e9};  // beyond any orbit we draw
inline constexpr double kOnTarget_m = 1e-6;  // nearer than this, rounding decides where a camera looks
inline constexpr Range kFov_deg{1.0, 179.0};
inline constexpr Range kFocalLength_mm{0.2, 2e3};  // kFov_deg before a film of 36 mm
inline constexpr Range kSensorWidth_mm{0.1, 1e4};
inline constexpr Range kLensShift{-2.0, 2.0};
inline constexpr Range kFStop{0.0, 1e3};
inline constexpr double kLeastFStop = 0.5;  // of an aplanatic lens in air
inline constexpr Range kFocus_m{1e-3, 1e9};
inline constexpr Range kWhiteBalance_k{1500.0, 15000.0};  // Krystek's fit of Planck's locus ends there
inline constexpr Range kGlare{0.0, 1.0};
inline constexpr Range kExposure_ev{-20.0, 20.0};
inline constexpr Range kEv100{-20.0, 40.0};
inline constexpr Range kImageResolution{1, 65536};

inline constexpr Range kSunElevation_deg{-90.0, 90.0};
inline constexpr Range kVisibility_km{0.1, 1000.0};
inline constexpr Range kSkyGain{0.0, 1e6};
inline constexpr Range kFoamStructure{0.0, 1.0};
inline constexpr Range kFoamStreaks{0.0, 1.0};
inline constexpr Range kFoamPattern_m{0.1, 1e3};
inline constexpr Range kFoamAlbedo{0.0, 1.0};
inline constexpr Range kFoamOpacity{0.0, 1.0};
inline constexpr Range kTurbidity{1.7, 10.0};            // from the clearest air that there is to haze
inline constexpr Range kChlorophyll_mg_m3{0.01, 100.0};  // from the clearest gyres to a bloom
inline constexpr Range kFloorColour{0.0, 1.0};
inline constexpr Range kWaterGain{0.0, 10.0};
inline constexpr int kObjects = 64;                          // each has a colour in mattes, and its own pose
inline constexpr std::size_t kObjectTriangles = 20'000'000;  // of all bodies: some 2 GB with what rays need
inline constexpr std::size_t kObjectMaterials = 4096;        // of a body
inline constexpr int kObjectImageSide = 1 << 14;             // texels
inline constexpr std::size_t kObjectTexels = std::size_t{1} << 28;  // of a body's pictures: 2 GB
inline constexpr Range kObjectImageAt{-1e4, 1e4};    // repeats: a float holds a thousandth there
inline constexpr std::size_t kObjectCorners = 1000;  // of a face: to cut it goes with the square and more
inline constexpr Range kObjectPoint_m{-1e6, 1e6};    // a float holds 6 cm there
inline constexpr Range kObjectUp_m{-1e4, 1e5};
inline constexpr Range kRollDamping{0.01, 10.0};  // at 0 a swell of its own period would roll it over
inline constexpr Range kObjectScale{1e-4, 1e4};
inline constexpr Range kObjectColour{0.0, 1.0};
inline constexpr Range kObjectGlow_cd_m2{0.0, 1e9};  // the sun has 1.6e9
inline constexpr Range kMapResolution{1, 8192};
inline constexpr Range kVoxel_m{1e-3, 1e5};
inline constexpr double kVoxelsASide =
    1e5;  // ten kilometres in decimetres; counts of voxels stay far below 2⁶⁴
inline constexpr Range kMaxError{1e-6, 1.0};
inline constexpr Range kFrame_ms{1e-2, 1e7};
inline constexpr Range kSprayGain{0.0, 1e6};

}  // namespace limits

}  // namespace pelagic
