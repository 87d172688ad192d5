// Every key of a shot file. See keys.h; the types of rows are in key_rows.h.
#include "core/scene/keys.h"

#include "core/scene/key_rows.h"

namespace pelagic {

namespace {

constexpr Range kEach_m = limits::kCameraCoordinate_m;
constexpr SoftRange kTurn{-180.0, 180.0};

struct Built {
    std::vector<KeyTable> tables;
    std::vector<Key> keys;
};

void add_shot(Built& out) {
    const auto frames_of = [](const Shot& shot) {
        return MemberValue<std::array<int, 2>>::value({shot.first_frame, shot.last_frame});
    };
    const auto set_frames = [](Shot& shot, const KeyValue& value) {
        std::array<int, 2> frames{};
        if (!MemberValue<std::array<int, 2>>::take(value, frames)) return false;
        shot.first_frame = frames[0];
        shot.last_frame = frames[1];
        return true;
    };
    const Row<Shot, 2> frames{
        key_of_member<std::array<int, 2>>(
            {.name = "frames",
             .help = "both included; frame f shows t = time_offset_s + time_scale (f - 1)/fps, "
                     "whatever the range, in a loop t of its first round",
             .range = limits::kFrame,
             .form = "[first, last], two integers of ",
             .key_parts = key_parts(KeyPart::Range)}),
        frames_of, set_frames};
    add_table<&Scene::shot>(
        out.tables, out.keys, {"shot", "what is made", {}, {}},
        row<&Shot::edition>(
            {.name = "edition",
             .help =
                 "whose defaults count where the file doesn't say; one that should look the same for years names it",
             .range = limits::kEdition,
             .key_parts = key_parts(KeyPart::Choice)}),  // what follows from it are other keys' values
        row<&Shot::name>({.name = "name",
                          .help = "names the files and the stage's root prim",
                          .accepted = "a string, of letters, digits, _ and -, at most 200",
                          .key_parts = key_parts(KeyPart::Name)}),
        frames,
        row<&Shot::fps>({.name = "fps",
                         .help = "frames a second",
                         .unit = "1/s",
                         .range = limits::kFps,
                         .soft = SoftRange{1.0, 120.0},
                         .key_parts = key_parts(KeyPart::Clock)}),
        row<&Shot::seed>({.name = "seed",
                          .help = "another seed, another sea of the same weather",
                          .accepted = "an integer, 0 … 9223372036854775807",
                          .key_parts = key_parts(KeyPart::Waves)}),
        row<&Shot::loop_s>(
            {.name = "loop_s",
             .help = "above 0: the sea repeats exactly after this long, a whole number of frames",
             .unit = "s",
             .range = limits::kLoop_s,
             .soft = SoftRange{0.0, 60.0},
             .key_parts = key_parts(KeyPart::Waves)}),
        row<&Shot::time_scale>(
            {.name = "time_scale",
             .help = "seconds of the sea in a second on the screen: 0.5 is slow motion, 0 stands still",
             .range = limits::kTimeScale,
             .soft = SoftRange{0.0, 4.0},
             .key_parts = key_parts(KeyPart::Clock)}),
        row<&Shot::time_offset_s>({.name = "time_offset_s",
                                   .help = "the sea's time at frame 1",
                                   .unit = "s",
                                   .range = limits::kTimeOffset_s,
                                   .soft = SoftRange{0.0, 600.0},
                                   .key_parts = key_parts(KeyPart::Clock)}));
}

void add_sea(Built& out) {
    constexpr KeyPartSet kWaves = key_parts(KeyPart::Waves);
    // A measured spectrum is one member and two keys. The host that reads the file sets it.
    Row<SeaState, 1> file{
        key_about({.name = "spectrum_file",
                   .help = "with spectrum = \"file\": the densities; the files d, i, j and k lie beside it",
                   .accepted = "a string, the path of NDBC's w file, from the shot file's folder",
                   .key_parts = kWaves},
                  KeyType::DataFile),
        [](const SeaState& sea) { return sea.measured ? KeyValue(sea.measured->file) : KeyValue(); },
        {}};
    // A zone has to be said: the buoys' times are UTC, and a time without one would be taken for local time
    // by many.
    Row<SeaState, 0> time{
        key_about({.name = "spectrum_time",
                   .help = "with spectrum = \"file\": one of the file's times, which are UTC",
                   .accepted = "a date and time with its zone, such as 2019-02-06T00:40:00Z",
                   .key_parts = kWaves},
                  KeyType::DataTime),
        [](const SeaState& sea) { return sea.measured ? KeyValue(sea.measured->time) : KeyValue(); },
        {}};
    file.key.is_optional = time.key.is_optional = true;
    add_table<&Scene::sea>(
        out.tables, out.keys, {"sea", "the weather", {}, {}},
        row<&SeaState::wind_speed_mps>({.name = "wind_speed_mps",
                                        .help = "10 m above the sea",
                                        .unit = "m/s",
                                        .range = limits::kWindSpeed_mps,
                                        .soft = SoftRange{0.0, 40.0},
                                        .key_parts = kWaves,
                                        .may_have_keys = true}),
        row<&SeaState::wind_direction_deg>({.name = "wind_direction_deg",
                                            .help = "blowing towards, counter-clockwise from +x (east)",
                                            .unit = "degrees",
                                            .range = limits::kAngle_deg,
                                            .soft = kTurn,
                                            .key_parts = kWaves,
                                            .may_have_keys = true,
                                            .is_angle = true}),
        row<&SeaState::fetch_m>(
            {.name = "fetch_m",
             .help = "how far the wind has blown over water: little gives a short, steep sea",
             .unit = "m",
             .range = limits::kFetch_m,
             .soft = SoftRange{1e3, 3e6, true},
             .key_parts = kWaves,
             .may_have_keys = true}),
        row<&SeaState::depth_m>({.name = "depth_m",
                                 .help = "of the water",
                                 .unit = "m",
                                 .range = limits::kDepth_m,
                                 .soft = SoftRange{1.0, 1e4, true},
                                 .key_parts = kWaves,
                                 .may_be_infinite = true,
                                 .may_have_keys = true}),
        row<&SeaState::depth_file>(
            {.name = "depth_file",
             .help =
                 "how deep the floor lies that is seen, in metres: a picture of depths from above, north at its top, grey or its red, "
                 "or a mesh of the floor, z up, which lies where it lies in the world; beyond it the floor goes to depth_m. Waves are those of depth_m, and feel it with waves.coast",
             .accepted = "\"none\", or the path of an .exr or .obj, from the shot file's folder",
             .key_parts = key_parts(KeyPart::Water),
             .is_picture = true,
             .may_be_mesh = true}),
        row<&SeaState::depth_size_m>({.name = "depth_size_m",
                                      .help = "from west to east of that picture; a mesh has none",
                                      .unit = "m",
                                      .range = limits::kSurfaceSize_m,
                                      .soft = SoftRange{10.0, 1e4, true},
                                      .key_parts = key_parts(KeyPart::Water),
                                      .of_picture = "sea.depth_file"}),
        row<&SeaState::depth_east_m>({.name = "depth_east_m",
                                      .help = "where its middle is, towards +x",
                                      .unit = "m",
                                      .range = limits::kCameraCoordinate_m,
                                      .soft = SoftRange{-1e3, 1e3},
                                      .key_parts = key_parts(KeyPart::Water),
                                      .of_picture = "sea.depth_file"}),
        row<&SeaState::depth_north_m>({.name = "depth_north_m",
                                       .help = "the same towards +y",
                                       .unit = "m",
                                       .range = limits::kCameraCoordinate_m,
                                       .soft = SoftRange{-1e3, 1e3},
                                       .key_parts = key_parts(KeyPart::Water),
                                       .of_picture = "sea.depth_file"}),
        row<&SeaState::spectrum>({.name = "spectrum",
                                  .help =
                                      "how the energy is shared among the wavelengths. pierson-moskowitz: a "
                                      "sea as grown as its wind lets it; jonswap: one that the wind raises "
                                      "over the fetch, its peak the sharper the younger it is; "
                                      "jonswap-1973: the same with the numbers of 1973; tma: jonswap in "
                                      "shallow water; elfouhaily: one law from the peak to ripples; "
                                      "omega-2: a bare tail that ends at the peak; phillips: as in "
                                      "Tessendorf's notes, for people who come from there; file: a buoy's, "
                                      "of spectrum_file",
                                  .key_parts = kWaves}),
        row<&SeaState::growth>(
            {.name = "growth",
             .help = "of the wind's waves. height-and-peak: both are the growth law's, the peak goes with "
                     "significant_height_m, and what the sun's glitter shows of short waves is left to the "
                     "wind; height: the height is the growth law's and the spectrum's shape gives the peak, "
                     "which then keeps its place",
             .key_parts = kWaves}),
        row<&SeaState::short_waves>(
            {.name = "short_waves",
             .help = "beyond a few peak wavenumbers. elfouhaily: the tail and the spreading that have the "
                     "slopes of sun glitter; none: the spectrum's own",
             .key_parts = kWaves}),
        row<&SeaState::significant_height_m>(
            {.name = "significant_height_m",
             .help =
                 "of the wind sea or the measured one, without swell. Without it: what wind, fetch and depth give",
             .unit = "m",
             .range = limits::kSignificantHeight_m,
             .soft = SoftRange{0.0, 15.0},
             .key_parts = kWaves,
             .may_have_keys = true}),
        row<&SeaState::spreading>(
            {.name = "spreading",
             .help =
                 "how it is shared among the directions. hasselmann: narrowest at the peak, as measured in "
                 "the North Sea; donelan-banner: as measured on Lake Ontario; cosine: as wide for all wavelengths; elfouhaily: the spectrum's of this name, "
                 "down to ripples",
             .key_parts = kWaves}),
        row<&SeaState::directionality>(
            {.name = "directionality",
             .help =
                 "of long and short waves, swell too: 1, the spreadings' own; 2, about half as wide; below 1, so much of "
                 "each, and the rest from all directions alike",
             .range = limits::kDirectionality,
             .soft = SoftRange{0.1, 10.0, true},
             .key_parts = kWaves,
             .may_have_keys = true}),
        row<&SeaState::gust_strength>(
            {.name = "gust_strength",
             .help =
                 "how much the wind varies over the surface, in patches that drift with it: 0, not at all; 1, from calm "
                 "to twice its speed. Ripples too small to be shown and foam follow; over area both stay as much",
             .range = limits::kGustStrength,
             .key_parts = key_parts(KeyPart::Gusts),
             .may_have_keys = true}),
        row<&SeaState::gust_size_m>({.name = "gust_size_m",
                                     .help = "of those patches; along the wind they are longer",
                                     .unit = "m",
                                     .range = limits::kGustSize_m,
                                     .soft = SoftRange{10.0, 3000.0, true},
                                     .key_parts = key_parts(KeyPart::Gusts)}),
        entries<&SeaState::gust_fronts>(
            {.name = "gust_fronts",
             .help =
                 "cat's paws and squall lines, at a place in a frame: patches of another wind that cross the sea. Ripples too small to be "
                 "shown and foam follow it, waves that are shown don't. Their edges are as ragged as the pattern of gust_size_m",
             .key_parts = key_parts(KeyPart::Gusts),
             .is_silent_off = true,
             .most_entries = limits::kGustFronts,
             .are_entries_independent = false,
             .entry_name = "GustFront"},
            required<&GustFront::frame>(
                {.name = "frame",
                 .help = "when it is there; it may lie between frames, and outside the range",
                 .range = limits::kFrame}),
            required<&GustFront::east_m>({.name = "east_m",
                                          .help = "its middle, then",
                                          .unit = "m",
                                          .range = kEach_m,
                                          .soft = SoftRange{-100.0, 100.0}}),
            required<&GustFront::north_m>({.name = "north_m",
                                           .help = "its middle, then",
                                           .unit = "m",
                                           .range = kEach_m,
                                           .soft = SoftRange{-100.0, 100.0}}),
            row<&GustFront::direction_deg>({.name = "direction_deg",
                                            .help = "travelling towards, counter-clockwise from +x",
                                            .unit = "degrees",
                                            .range = limits::kAngle_deg,
                                            .soft = kTurn}),
            row<&GustFront::speed_mps>({.name = "speed_mps",
                                        .help = "of its way, in the sea's seconds",
                                        .unit = "m/s",
                                        .range = limits::kFrontSpeed_mps,
                                        .soft = SoftRange{0.0, 25.0}}),
            row<&GustFront::length_m>({.name = "length_m",
                                       .help = "along its way, of the ellipse within which the wind is whole",
                                       .unit = "m",
                                       .range = limits::kFrontSize_m,
                                       .soft = SoftRange{10.0, 2000.0, true}}),
            row<&GustFront::width_m>({.name = "width_m",
                                      .help = "across",
                                      .unit = "m",
                                      .range = limits::kFrontSize_m,
                                      .soft = SoftRange{10.0, 10000.0, true}}),
            row<&GustFront::edge_m>({.name = "edge_m",
                                     .help = "round the ellipse: over it the wind goes over into the sea's",
                                     .unit = "m",
                                     .range = limits::kFrontEdge_m,
                                     .soft = SoftRange{1.0, 500.0, true}}),
            row<&GustFront::wind>(
                {.name = "wind",
                 .help =
                     "times the sea's wind: more than 1 is a gust, less a lull. A calm has a tenth: the sea's long waves go on",
                 .range = limits::kFrontWind})),
        row<&SeaState::rain_mm_h>(
            {.name = "rain_mm_h",
             .help =
                 "on the sea: rings of its drops, which dull what the water mirrors, and a wind sea with less of its waves "
                 "below a few metres, in a light wind of nearly all: 2, drizzle; 10, steady rain; 50, a cloudburst. What falls "
                 "through the air isn't drawn",
             .unit = "mm/h",
             .range = limits::kRain_mm_h,
             .soft = SoftRange{0.0, 50.0},
             .key_parts = kWaves,
             .may_have_keys = true,
             .is_silent_off = true}),
        entries<&SeaState::swell>(
            {.name = "swell",
             .help =
                 "waves of far storms, each a narrow spectrum of its own. Its groups come back, half as strong, after about the side of the "
                 "largest tile of waves over their speed (g times the period / 4π in deep water): 446 s of a swell of 14 s by default; larger "
                 "waves.cascades make that longer",
             .key_parts = kWaves,
             .most_entries = limits::kSwells,
             .entry_name = "Swell"},
            required<&Swell::height_m>({.name = "height_m",
                                        .help = "significant height, 4 times the root of the variance",
                                        .unit = "m",
                                        .range = limits::kSwellHeight_m,
                                        .soft = SoftRange{0.0, 10.0},
                                        .may_have_keys = true}),
            required<&Swell::period_s>({.name = "period_s",
                                        .help = "period of the peak",
                                        .unit = "s",
                                        .range = limits::kSwellPeriod_s,
                                        .soft = SoftRange{3.0, 25.0},
                                        .may_have_keys = true}),
            required<&Swell::direction_deg>({.name = "direction_deg",
                                             .help = "travelling towards, counter-clockwise from +x",
                                             .unit = "degrees",
                                             .range = limits::kAngle_deg,
                                             .soft = kTurn,
                                             .may_have_keys = true,
                                             .is_angle = true})),
        file, time);
}

void add_waves(Built& out) {
    constexpr KeyPartSet kWaves = key_parts(KeyPart::Waves);
    add_table<&Scene::waves>(
        out.tables, out.keys, {"waves", "how waves are made from it", {}, {}},
        row<&Waves::model>({.name = "model",
                            .help = "how waves are made. fft: tiles of waves; trochoid: a sum of wave trains",
                            .key_parts = kWaves}),
        row<&Waves::choppiness>(
            {.name = "choppiness",
             .help =
                 "sharpness of the crests; 1 is the trochoid's own, 0 leaves them round, as does less than 0.0001",
             .range = limits::kChoppiness,
             .soft = SoftRange{0.0, 2.0},
             .key_parts = kWaves,
             .may_have_keys = true}),
        row<&Waves::lean_deg>(
            {.name = "lean_deg",
             .help =
                 "how far the sideways displacement runs ahead of the waves in phase, with fft: fronts are steeper than backs, and "
                 "foam breaks on them; 0 is the trochoid's symmetry",
             .unit = "degrees",
             .range = limits::kLean_deg,
             .soft = SoftRange{0.0, 40.0},
             .key_parts = kWaves,
             .may_have_keys = true}),
        row<&Waves::second_order>(
            {.name = "second_order",
             .help =
                 "of what pairs of waves add to the surface, with fft: 1 is nature's, which raises the groups of high waves so "
                 "that crests are some 10 % higher than troughs are deep; 0, as high. As the displacement, it goes with choppiness",
             .range = limits::kSecondOrder,
             .key_parts = kWaves,
             .may_have_keys = true}),
        entries<&Waves::cascades>(
            {.name = "cascades",
             .help = "the tiles; auto: four, from the spectrum's peak down, and none with trochoid. "
                     "Their bands depend on the sizes alone; a resolution that leaves a gap is refused",
             .key_parts = kWaves,
             .other_word = "auto",
             .most_entries = limits::kCascades,
             .are_entries_independent = false,
             .entry_name = "CascadeSize"},
            required<&CascadeSize::size_m>({.name = "size_m",
                                            .help = "of the tile; all sizes differ",
                                            .unit = "m",
                                            .range = limits::kCascadeSize_m,
                                            .soft = SoftRange{1.0, 4000.0, true}}),
            required<&CascadeSize::resolution>({.name = "resolution",
                                                .help = "samples a side, even",
                                                .range = limits::kCascadeResolution,
                                                .soft = SoftRange{16.0, 2048.0, true}}),
            row<&CascadeSize::choppiness>(
                {.name = "choppiness",
                 .help =
                     "of its waves, instead of waves.choppiness; with model = \"fft\". Waves of 0 don't break, unless "
                     "all have 0",
                 .range = limits::kChoppiness,
                 .soft = SoftRange{0.0, 2.0}})),
        row<&Waves::tiling>(
            {.name = "tiling",
             .help = "of the cascades. random: copies of each tile at random offsets, blended, so that no "
                     "pattern is seen from the air; periodic: each tile repeats after its size",
             .key_parts = kWaves}),
        entries<&Waves::band_gains>(
            {.name = "band_gains",
             .help =
                 "amplitudes by wavelength, on top of all else: heights, slopes and foam follow. Edges are smooth, a third "
                 "of an octave wide; where bands overlap, their gains multiply",
             .key_parts = kWaves,
             .most_entries = limits::kBandGains,
             .entry_name = "BandGain"},
            required<&BandGain::from_m>({.name = "from_m",
                                         .help = "the wavelength at one edge",
                                         .unit = "m",
                                         .range = limits::kBandEdge_m,
                                         .soft = SoftRange{0.01, 1000.0, true}}),
            required<&BandGain::to_m>({.name = "to_m",
                                       .help = "at the other",
                                       .unit = "m",
                                       .range = limits::kBandEdge_m,
                                       .soft = SoftRange{0.01, 1000.0, true}}),
            required<&BandGain::gain>({.name = "gain",
                                       .help = "of their amplitudes: 0 leaves them out, 2 doubles them",
                                       .range = limits::kBandGain,
                                       .soft = SoftRange{0.0, 3.0},
                                       .may_have_keys = true})),
        entries<&Waves::heroes>(
            {.name = "heroes",
             .help =
                 "crests that stand at a place in a frame, in the sea as it is: the sea round each, before and after it, is what "
                 "such a sea most likely has round a crest of that height",
             .key_parts = kWaves,
             .most_entries = limits::kHeroes,
             .are_entries_independent = false,
             .entry_name = "HeroWave"},
            required<&HeroWave::frame>({.name = "frame",
                                        .help = "when; it may lie between frames, and outside the range",
                                        .range = limits::kFrame}),
            required<&HeroWave::east_m>({.name = "east_m",
                                         .help = "where",
                                         .unit = "m",
                                         .range = kEach_m,
                                         .soft = SoftRange{-100.0, 100.0}}),
            required<&HeroWave::north_m>({.name = "north_m",
                                          .help = "where",
                                          .unit = "m",
                                          .range = kEach_m,
                                          .soft = SoftRange{-100.0, 100.0}}),
            required<&HeroWave::height_m>({.name = "height_m",
                                           .help = "of the crest over the mean level; below 0, of a trough",
                                           .unit = "m",
                                           .range = limits::kHeroHeight_m,
                                           .soft = SoftRange{0.0, 20.0}})),
        with_data(entries<&Waves::masks>(
            {.name = "masks",
             .help =
                 "calm and rough places: ellipses of the world with a soft edge, or pictures, and gains of the sea within them. Where they "
                 "overlap, their gains multiply",
             .key_parts = kWaves,
             .most_entries = limits::kMasks,
             .are_entries_independent = false,
             .entry_name = "WaveMask"},
            required<&WaveMask::east_m>({.name = "east_m",
                                         .help = "the middle",
                                         .unit = "m",
                                         .range = kEach_m,
                                         .soft = SoftRange{-100.0, 100.0}}),
            required<&WaveMask::north_m>({.name = "north_m",
                                          .help = "the middle",
                                          .unit = "m",
                                          .range = kEach_m,
                                          .soft = SoftRange{-100.0, 100.0}}),
            row<&WaveMask::length_m>(
                {.name = "length_m",
                 .help = "of the ellipse within which the gains hold whole, or of the picture",
                 .unit = "m",
                 .range = limits::kMaskSize_m,
                 .soft = SoftRange{10.0, 2000.0, true}}),
            row<&WaveMask::width_m>({.name = "width_m",
                                     .help = "across",
                                     .unit = "m",
                                     .range = limits::kMaskSize_m,
                                     .soft = SoftRange{10.0, 2000.0, true}}),
            row<&WaveMask::direction_deg>({.name = "direction_deg",
                                           .help = "of its length, counter-clockwise from +x",
                                           .unit = "degrees",
                                           .range = limits::kAngle_deg,
                                           .soft = kTurn}),
            row<&WaveMask::edge_m>(
                {.name = "edge_m",
                 .help =
                     "round the ellipse: over it the gains fade to 1, and those of a picture across its borders and within. Waves want one of half "
                     "their length",
                 .unit = "m",
                 .range = limits::kMaskEdge_m,
                 .soft = SoftRange{1.0, 500.0, true}}),
            row<&WaveMask::waves>(
                {.name = "waves",
                 .help = "of all waves' amplitudes: a lee has less than 1, a rough place more",
                 .range = limits::kMaskWaves,
                 .soft = SoftRange{0.0, 2.0}}),
            row<&WaveMask::ripples>(
                {.name = "ripples",
                 .help =
                     "of the amplitudes of short waves, whole below 25 cm and fading up to 50 cm: 0 is a slick",
                 .range = limits::kMaskShare,
                 .soft = SoftRange{0.0, 1.0}}),
            row<&WaveMask::foam>(
                {.name = "foam",
                 .help = "of what breaks, and so of what it leaves: 0 has no foam of its own",
                 .range = limits::kMaskShare,
                 .soft = SoftRange{0.0, 1.0}}),
            row<&WaveMask::picture>(
                {.name = "picture",
                 .help =
                     "where it holds, in place of the ellipse: a picture from above, 0 … 1, grey or the mean of its colours, whose "
                     "width lies along the length. It is smoothed over the edge; beyond it nothing holds",
                 .accepted =
                     "a string, the path of an .exr of 2 … 4096 pixels a side, from the shot file's folder",
                 .is_picture = true}))),
        entries<&Waves::vessels>(
            {.name = "vessels",
             .help =
                 "what makes wakes: hulls that move, whose waves lie on the sea; they themselves aren't drawn",
             .key_parts = kWaves,
             .most_entries = limits::kVessels,
             .are_entries_independent = false,
             .entry_name = "Vessel"},
            required<&Vessel::path>(
                {.name = "path",
                 .help =
                     "where its middle is: frame, east and north in metres of each key. Before the first it comes along its "
                     "first course, after the last it goes on",
                 .accepted = "a string, \"frame east north, frame east north, …\", of two keys or more"}),
            row<&Vessel::interpolation>(
                {.name = "interpolation",
                 .help = "of the path between keys. linear: straight; smooth: round"}),
            row<&Vessel::length_m>({.name = "length_m",
                                    .help = "of the hull at the water",
                                    .unit = "m",
                                    .range = limits::kVesselSize_m,
                                    .soft = SoftRange{1.0, 400.0, true}}),
            row<&Vessel::beam_m>({.name = "beam_m",
                                  .help = "its width",
                                  .unit = "m",
                                  .range = limits::kVesselSize_m,
                                  .soft = SoftRange{0.5, 60.0, true}}),
            row<&Vessel::draught_m>({.name = "draught_m",
                                     .help = "its depth in the water",
                                     .unit = "m",
                                     .range = limits::kVesselSize_m,
                                     .soft = SoftRange{0.1, 20.0, true}}),
            row<&Vessel::waves>(
                {.name = "waves",
                 .help = "of its waves' amplitude: theory has too much of slow and of planing hulls",
                 .range = limits::kVesselWaves,
                 .soft = SoftRange{0.01, 2.0}}),
            row<&Vessel::foam>({.name = "foam",
                                .help = "of the coverage of the foam at its bow and behind its stern",
                                .range = limits::kMaskShare,
                                .soft = SoftRange{0.0, 1.0}})),
        row<&Waves::trains>(
            {.name = "trains",
             .help = "with trochoid: how many, one from each bin of a geometric progression of wavelengths",
             .range = limits::kTrains,
             .soft = SoftRange{1.0, 1000.0, true},
             .key_parts = kWaves}),
        row<&Waves::shortest_m>(
            {.name = "shortest_m",
             .help =
                 "with trochoid: the shortest train; what is shorter counts as variance, or is left to the "
                 "cascades if there are any. Without it: 2 cm, or shorter so that ten trains are below a "
                 "pixel; with cascades an eighth of the largest tile; at most a tenth of longest_m",
             .unit = "m",
             .range = limits::kTrain_m,
             .soft = SoftRange{1e-3, 10.0, true},
             .key_parts = kWaves}),
        row<&Waves::longest_m>(
            {.name = "longest_m",
             .help = "with trochoid: the longest train; what is longer is not on the surface and counts as "
                     "variance. Without it: all but 0.1 % of the energy is shorter; at least ten times "
                     "shortest_m",
             .unit = "m",
             .range = limits::kTrain_m,
             .soft = SoftRange{1.0, 2000.0, true},
             .key_parts = kWaves}),
        with_data(row<&Waves::coast>(
            {.name = "coast",
             .help =
                 "whether waves feel the floor of sea.depth_file. They come from sea.depth_m, lose height where they break, and end at the "
                 "shore. With trochoid they also turn, shorten and rise, and lees fill without the pattern of diffraction; tiles (fft) are "
                 "as high as the depth lets them be, and neither turn nor shorten. Beyond the map waves are those of depth_m again. There is "
                 "no reflection and no run-up, and no crest overturns",
             .key_parts = kWaves,
             .is_silent_off = true,
             .may_be_mesh = true,
             .of_picture = "sea.depth_file"})));
}

void add_surface(Built& out) {
    constexpr KeyPartSet kSurface = key_parts(KeyPart::Surface);
    // A cage is two members and one key. The host that reads the file sets them.
    Row<Surface, 2> cage_file{
        key_about(
            {.name = "cage_file",
             .help = "with kind = \"cage\": the mesh whose limit surface (Catmull–Clark) the sea lies on",
             .accepted = "a string, the path of a Wavefront OBJ, from the shot file's folder",
             .key_parts = key_parts(KeyPart::Cage)},
            KeyType::DataFile),
        [](const Surface& surface) { return surface.cage ? KeyValue(surface.cage_file) : KeyValue(); },
        {}};
    cage_file.key.is_optional = true;
    add_table<&Scene::surface>(
        out.tables, out.keys, {"surface", "where the sea is looked at", {}, {}},
        row<&Surface::kind>(
            {.name = "kind",
             .help =
                 "what is baked. patch: a square; projected-grid: what the camera sees, in cells of its "
                 "pixels; near-far: a mesh round the camera that is fine below it and goes to the horizon "
                 "with faces that stay; cage: the limit surface of a cage; planet: the projected grid on a "
                 "sphere that touches z = 0 at the origin. Pictures show the open sea to the horizon, of a "
                 "planet with the camera's z as its height, unless beyond says otherwise; cages as they "
                 "stand",
             .key_parts = key_parts(KeyPart::Surface, KeyPart::Mesh)}),
        row<&Surface::size_m>(
            {.name = "size_m",
             .help = "side of the patch, centred on the origin, and of maps and volumes; with near-far of "
                     "the finest part, below the camera",
             .unit = "m",
             .range = limits::kSurfaceSize_m,
             .soft = SoftRange{10.0, 5000.0, true},
             .key_parts = key_parts(KeyPart::Surface, KeyPart::Maps, KeyPart::Volumes)}),
        row<&Surface::resolution>({.name = "resolution",
                                   .help = "quads a side; with near-far of the finest part, at most 4096",
                                   .range = limits::kSurfaceResolution,
                                   .soft = SoftRange{1.0, 2048.0, true},
                                   .key_parts = kSurface}),
        row<&Surface::cell_px>({.name = "cell_px",
                                .help = "side of the projected grid's cells, in pictures and bakes: smaller "
                                        "shows finer silhouettes, and is slower",
                                .unit = "pixels",
                                .range = limits::kCell_px,
                                .soft = SoftRange{2.0, 32.0},
                                .key_parts = key_parts(KeyPart::Grid)}),
        row<&Surface::earth_curvature>(
            {.name = "earth_curvature",
             .help = "whether the projected grid, or near-far, lies on the earth's sphere: the far "
                     "sea bends away, and the horizon has its dip",
             .key_parts = key_parts(KeyPart::Grid, KeyPart::Surface)}),
        cage_file,
        row<&Surface::cage_level>(
            {.name = "cage_level",
             .help = "of a cage: how often each of its edges is halved, or adaptive: as finely as the camera "
                     "sees it, in cells of cell_px",
             .range = limits::kCageLevel,
             .key_parts = key_parts(KeyPart::Cage)}),
        row<&Surface::beyond>(
            {.name = "beyond",
             .help = "in pictures, what lies round the patch or the cage. by-kind: the sea for a patch and "
                     "nothing for a cage; sea: the open sea to the horizon, at z = 0; nothing: the sky is "
                     "behind it. The other kinds reach the horizon themselves. Meshes and maps don't know it",
             // What pictures draw is in their fingerprints (plugin/render/drawn_sea.h), where it makes a difference.
             .key_parts = key_parts(KeyPart::Choice)}));
}

void add_camera(Built& out) {
    constexpr KeyPartSet kView = key_parts(KeyPart::View);
    // No member: the host that reads the file makes `keys` of it.
    Row<Camera, 0> file{
        key_about(
            {.name = "file",
             .help =
                 "in a shot file, instead of keys: a camera's path from another program, a line for each frame, "
                 "\"frame x y z rx ry rz [fov]\". Metres, y up; degrees about x, y and z, applied in the "
                 "order z, x, y; fov is the vertical angle of view. Without it the lens is the camera's",
             .accepted = "a string, the path of a .chan, from the shot file's folder",
             .key_parts = kView},
            KeyType::DataFile),
        [](const Camera&) { return KeyValue(); },
        {}};
    file.key.is_optional = true;
    add_table<&Scene::camera>(
        out.tables, out.keys, {"camera", "from where", {}, {}},
        row<&Camera::position_m>(
            {.name = "position_m", .help = "z is up", .unit = "m", .range = kEach_m, .key_parts = kView}),
        row<&Camera::look_at_m>({.name = "look_at_m",
                                 .help = "up is z; looking along z, +y",
                                 .unit = "m",
                                 .range = kEach_m,
                                 .key_parts = kView}),
        entries<&Camera::keys>(
            {.name = "keys",
             .help = "for a moving camera: between them as interpolation says, still outside",
             .key_parts = kView,
             .are_entries_independent = false,
             .entry_name = "CameraKey"},
            required<&CameraKey::frame>(
                {.name = "frame", .help = "rising from key to key", .range = limits::kFrame}),
            required<&CameraKey::position_m>(
                {.name = "position_m", .help = "as above", .unit = "m", .range = kEach_m}),
            required<&CameraKey::look_at_m>(
                {.name = "look_at_m", .help = "as above", .unit = "m", .range = kEach_m}),
            row<&CameraKey::fov_deg>({.name = "fov_deg",
                                      .help = "horizontal angle of view; without it the camera's fov_deg",
                                      .unit = "degrees",
                                      .range = limits::kFov_deg}),
            row<&CameraKey::roll_deg>(
                {.name = "roll_deg",
                 .help = "about the line of sight; above 0 the camera's right side goes down",
                 .unit = "degrees",
                 .range = limits::kAngle_deg,
                 .soft = kTurn})),
        file,
        row<&Camera::interpolation>({.name = "interpolation",
                                     .help = "between keys: straight from one to the next, or a smooth curve "
                                             "through all of them",
                                     .key_parts = kView}),
        row<&Camera::fov_deg>({.name = "fov_deg",
                               .help = "horizontal angle of view",
                               .unit = "degrees",
                               .range = limits::kFov_deg,
                               .soft = SoftRange{5.0, 120.0},
                               .key_parts = kView}),
        row<&Camera::focal_length_mm>(
            {.name = "focal_length_mm",
             .help = "instead of fov_deg, which then says nothing: the angle of view is that of this lens "
                     "before a film of sensor_width_mm. A key's own fov_deg still counts",
             .unit = "mm",
             .range = limits::kFocalLength_mm,
             .soft = SoftRange{10.0, 300.0, true},
             .key_parts = kView}),
        row<&Camera::sensor_width_mm>(
            {.name = "sensor_width_mm",
             .help = "of the film or sensor: with focal_length_mm it gives the angle of view, with f_stop "
                     "the size of the aperture",
             .unit = "mm",
             .range = limits::kSensorWidth_mm,
             .soft = SoftRange{4.0, 70.0, true},
             .key_parts = kView}),
        row<&Camera::shift_x>(
            {.name = "shift_x",
             .help = "moves the picture to the right of the lens' axis, without turning the camera: in "
                     "widths of the picture, as in Blender",
             .range = limits::kLensShift,
             .soft = SoftRange{-0.5, 0.5},
             .key_parts = kView}),
        row<&Camera::shift_y>(
            {.name = "shift_y",
             .help = "the same upwards, in widths of the picture too: verticals stay parallel",
             .range = limits::kLensShift,
             .soft = SoftRange{-0.5, 0.5},
             .key_parts = kView}),
        row<&Camera::f_stop>(
            {.name = "f_stop",
             .help =
                 "the lens' opening, its focal length over this wide: what is nearer or farther than "
                 "focus_distance_m is blurred in pelagic render, by its samples; take more of them. 0 is a "
                 "pinhole, as the preview always is",
             .range = limits::kFStop,
             .soft = SoftRange{0.0, 22.0},
             .accepted = "0, or 0.5 … 1000",
             .key_parts = key_parts(KeyPart::Light)}),
        row<&Camera::focus_distance_m>(
            {.name = "focus_distance_m",
             .help =
                 "with f_stop: how far away the lens is sharp, along its axis; more than its focal length",
             .unit = "m",
             .range = limits::kFocus_m,
             .soft = SoftRange{0.5, 1000.0, true},
             .key_parts = key_parts(KeyPart::Light)}),
        row<&Camera::resolution>({.name = "resolution",
                                  .help = "of the picture",
                                  .unit = "pixels",
                                  .range = limits::kImageResolution,
                                  .form = "[width, height], two integers, each ",
                                  .key_parts = kView}),
        row<&Camera::exposure_ev>(
            {.name = "exposure_ev",
             .help = "of pictures on a screen: so many stops brighter; EXRs hold the light itself",
             .unit = "stops",
             .range = limits::kExposure_ev,
             .soft = SoftRange{-4.0, 4.0},
             .key_parts = key_parts(KeyPart::Light),
             .may_have_keys = true}),
        row<&Camera::ev100>(
            {.name = "ev100",
             .help =
                 "the exposure that a photographer's meter shows at ISO 100: 15 in full sun, 12 at sunset, 5 in deep dusk. "
                 "Without it the shot's views are metered",
             .unit = "stops",
             .range = limits::kEv100,
             .soft = SoftRange{0.0, 17.0},
             .key_parts = key_parts(KeyPart::Light),
             .may_have_keys = true}),
        row<&Camera::white_balance_k>(
            {.name = "white_balance_k",
             .help =
                 "of pictures on a screen: light of this colour temperature is shown as white; less makes a "
                 "picture bluer. 5500 is that of film for daylight, 6500 leaves colours as they are. EXRs hold the light itself",
             .unit = "K",
             .range = limits::kWhiteBalance_k,
             .soft = SoftRange{2000.0, 12000.0, true},
             .key_parts = key_parts(KeyPart::Light),
             .may_have_keys = true}),
        row<&Camera::glare>(
            {.name = "glare",
             .help = "of PNGs: the share of the light that the lens scatters round where it belongs, as the "
                     "eye does: 0.1 is a clean lens. The preview has none, and EXRs hold the light itself",
             .range = limits::kGlare,
             .soft = SoftRange{0.0, 0.5},
             .key_parts = key_parts(KeyPart::Light),
             .may_have_keys = true}));
}

void add_light_and_water(Built& out) {
    constexpr KeyPartSet kLight = key_parts(KeyPart::Light), kWater = key_parts(KeyPart::Water);
    add_table<&Scene::light>(
        out.tables, out.keys, {"light", "sun and sky", {}, {}},
        row<&Light::sun_elevation_deg>(
            {.name = "sun_elevation_deg",
             .help =
                 "of the sun's middle above the horizon: the true (geometric) one, which is also where it's "
                 "seen, since the air here refracts nothing; real air shows a setting sun half a degree higher",
             .unit = "degrees",
             .range = limits::kSunElevation_deg,
             .soft = SoftRange{-10.0, 90.0},
             .key_parts = kLight,
             .may_have_keys = true}),
        row<&Light::sun_azimuth_deg>({.name = "sun_azimuth_deg",
                                      .help = "towards the sun, counter-clockwise from +x (east)",
                                      .unit = "degrees",
                                      .range = limits::kAngle_deg,
                                      .soft = kTurn,
                                      .key_parts = kLight,
                                      .may_have_keys = true,
                                      .is_angle = true}),
        row<&Light::sky>({.name = "sky",
                          .help =
                              "clear daylight, or a picture of a sky: lat-long, middle column +x, azimuth "
                              "growing to the left, top row the zenith; its sun is found in it",
                          .accepted = "\"daylight\", or the path of an .exr, from the shot file's folder",
                          .key_parts = kLight,
                          .is_picture = true}),
        row<&Light::turbidity>(
            {.name = "turbidity",
             .help = "haze of the daylight's air; 2 is the open sea's, 3 land's, 6 is hazy",
             .range = limits::kTurbidity,
             .key_parts = kLight,
             .may_have_keys = true}),
        row<&Light::visibility_km>(
            {.name = "visibility_km",
             .help = "with a picture of a sky: how far one sees through its air; without it "
                     "the air is clear",
             .unit = "km",
             .range = limits::kVisibility_km,
             .soft = SoftRange{1.0, 200.0, true},
             .key_parts = kLight,
             .may_have_keys = true}),
        row<&Light::sky_rotation_deg>(
            {.name = "sky_rotation_deg",
             .help = "turns a picture of a sky and its sun, counter-clockwise from above",
             .unit = "degrees",
             .range = limits::kAngle_deg,
             .soft = kTurn,
             .key_parts = kLight,
             .may_have_keys = true,
             .is_angle = true,
             .of_picture = "light.sky"}),
        row<&Light::sky_gain>({.name = "sky_gain",
                               .help = "multiplies the radiance of a picture of a sky and its sun",
                               .range = limits::kSkyGain,
                               .soft = SoftRange{0.01, 100.0, true},
                               .key_parts = kLight,
                               .may_have_keys = true,
                               .of_picture = "light.sky"}));
    add_table<&Scene::water>(
        out.tables, out.keys, {"water", "the water body", {}, {}},
        row<&Water::type>(
            {.name = "type",
             .help =
                 "what the water holds besides plankton. ocean: nothing; coastal: some silt; turbid: much "
                 "of it; jerlov-I: the clearest of Jerlov's types of the open sea; jerlov-III: the murkiest "
                 "of them; jerlov-1C: the clearest of his types of coasts; jerlov-9C: the murkiest of them",
             .key_parts = kWater}),
        row<&Water::chlorophyll_mg_m3>({.name = "chlorophyll_mg_m3",
                                        .help = "plankton: greens the water",
                                        .unit = "mg/m³",
                                        .range = limits::kChlorophyll_mg_m3,
                                        .soft = SoftRange{0.01, 30.0, true},
                                        .key_parts = kWater,
                                        .may_have_keys = true}),
        row<&Water::body>(
            {.name = "body",
             .help = "light in the water by the ways of sun and eye, with the floor at sea.depth_m; off: one "
                     "colour for the whole sea",
             .key_parts = kWater}),
        row<&Water::floor_colour>(
            {.name = "floor_colour",
             .help = "what the floor reflects: red, green, blue; pale sand, 0.36, 0.31, 0.23",
             .range = limits::kFloorColour,
             .key_parts = kWater}),
        row<&Water::floor_pattern>(
            {.name = "floor_pattern",
             .help =
                 "what the floor looks like near, times its colour: plain, or a picture that tiles, its top to the north",
             .accepted =
                 "\"plain\", or the path of an .exr, square, with a side of 1, 2 ... 1024 pixels, from the shot file's folder",
             .key_parts = kWater,
             .is_picture = true}),
        row<&Water::floor_pattern_m>({.name = "floor_pattern_m",
                                      .help = "the side of that picture on the floor",
                                      .unit = "m",
                                      .range = limits::kFoamPattern_m,
                                      .soft = SoftRange{0.5, 50.0, true},
                                      .key_parts = kWater,
                                      .of_picture = "water.floor_pattern"}),
        row<&Water::crest_light>(
            {.name = "crest_light",
             .help =
                 "how much waves shape the light in the water: a low sun shines through crests, and their far sides "
                 "are dark; 1 is as computed, 0 none",
             .range = limits::kWaterGain,
             .soft = SoftRange{0.0, 3.0},
             .key_parts = kWater,
             .may_have_keys = true}),
        row<&Water::bubbles>(
            {.name = "bubbles",
             .help = "how much the bubbles under foam brighten the water; 1 is as computed, 0 none",
             .range = limits::kWaterGain,
             .soft = SoftRange{0.0, 3.0},
             .key_parts = kWater,
             .may_have_keys = true}),
        row<&Water::caustics>(
            {.name = "caustics",
             .help =
                 "how much waves gather the sun's light, on a floor that is seen and in shafts under water; 1 is as computed, 0 even light",
             .range = limits::kWaterGain,
             .soft = SoftRange{0.0, 3.0},
             .key_parts = kWater,
             .may_have_keys = true}));
}

void add_effects_and_quality(Built& out) {
    constexpr KeyPartSet kQuality = key_parts(KeyPart::Quality);
    add_table<&Scene::effects>(
        out.tables, out.keys, {"effects", "what comes on top of the waves; off costs nothing", {}, {}},
        row<&Effects::whitecaps>(
            {.name = "whitecaps",
             .help = "foam where waves break; off, no output has coverage and none is computed",
             .key_parts = key_parts(KeyPart::Foam)}),
        row<&Effects::whitecap_law>(
            {.name = "whitecap_law",
             .help = "how much foam a wind makes. monahan-1980: much in storms; monahan-1986: goes with "
                     "sea_minus_air_c as well; callaghan-2008: stays at 8 % beyond 23 m/s",
             .key_parts = key_parts(KeyPart::Foam)}),
        row<&Effects::sea_minus_air_c>(
            {.name = "sea_minus_air_c",
             .help = "with monahan-1986: how much warmer the sea is than the air; a warm one foams more",
             .unit = "°C",
             .range = limits::kSeaMinusAir_c,
             .soft = SoftRange{-10.0, 10.0},
             .key_parts = key_parts(KeyPart::Foam)}),
        row<&Effects::whitecap_amount>({.name = "whitecap_amount",
                                        .help = "times the law's foam; 0: none",
                                        .range = limits::kWhitecapAmount,
                                        .soft = SoftRange{0.0, 4.0},
                                        .key_parts = key_parts(KeyPart::Foam)}),
        row<&Effects::breaking_from_m>(
            {.name = "breaking_from_m",
             .help = "the shortest waves that break; 0: ripples break as well, and foam is a veil",
             .unit = "m",
             .range = limits::kBreakingFrom_m,
             .soft = SoftRange{0.1, 20.0, true},
             .key_parts = key_parts(KeyPart::Foam)}),
        row<&Effects::foam_decay_s>(
            {.name = "foam_decay_s",
             .help =
                 "how long the foam that breaking leaves lives, to 1/e of it; 0: foam only where waves break now",
             .unit = "s",
             .range = limits::kFoamDecay_s,
             .soft = SoftRange{0.0, 10.0},
             .key_parts = key_parts(KeyPart::Foam)}),
        row<&Effects::foam_drift>(
            {.name = "foam_drift",
             .help = "how fast the wind carries that foam along, as a share of its speed",
             .range = limits::kFoamDrift,
             .soft = SoftRange{0.0, 0.05},
             .key_parts = key_parts(KeyPart::Foam)}),
        row<&Effects::foam_structure>(
            {.name = "foam_structure",
             .help =
                 "in pictures: 0 shows foam as smooth coverage, 1 as holes and lace; its mean is the same",
             .range = limits::kFoamStructure,
             .key_parts = key_parts(KeyPart::Water),
             .may_have_keys = true}),
        row<&Effects::foam_streaks>(
            {.name = "foam_streaks",
             .help =
                 "how far a wind of 15 m/s draws that lace out along it; less blows less, a storm twice as far",
             .range = limits::kFoamStreaks,
             .key_parts = key_parts(KeyPart::Water),
             .may_have_keys = true}),
        row<&Effects::foam_pattern>(
            {.name = "foam_pattern",
             .help =
                 "what foam looks like near: lace, or a picture that tiles, brightest where foam is thickest, the wind blowing "
                 "to its right; its mean is the same",
             .accepted =
                 "\"lace\", or the path of an .exr, square, with a side of 16, 32 ... 4096 pixels, from the shot file's "
                 "folder",
             .key_parts = key_parts(KeyPart::Water),
             .is_picture = true}),
        row<&Effects::foam_pattern_m>({.name = "foam_pattern_m",
                                       .help = "the side of that picture on the water",
                                       .unit = "m",
                                       .range = limits::kFoamPattern_m,
                                       .soft = SoftRange{2.0, 50.0, true},
                                       .key_parts = key_parts(KeyPart::Water),
                                       .of_picture = "effects.foam_pattern"}),
        row<&Effects::foam_new_albedo>(
            {.name = "foam_new_albedo",
             .help =
                 "what foam reflects where waves break, as far as it hides the water; 0.55 is measured (Whitlock 1982)",
             .range = limits::kFoamAlbedo,
             .key_parts = key_parts(KeyPart::Water),
             .may_have_keys = true}),
        row<&Effects::foam_old_albedo>({.name = "foam_old_albedo",
                                        .help = "the same for the foam that breaking has left",
                                        .range = limits::kFoamAlbedo,
                                        .key_parts = key_parts(KeyPart::Water),
                                        .may_have_keys = true}),
        row<&Effects::foam_new_opaque>(
            {.name = "foam_new_opaque",
             .help =
                 "the share of its area that foam hides where waves break; 0: such that the mean over all foam is "
                 "0.4, which is measured (Koepke 1984)",
             .range = limits::kFoamOpacity,
             .key_parts = key_parts(KeyPart::Water),
             .may_have_keys = true}),
        row<&Effects::foam_old_opaque>({.name = "foam_old_opaque",
                                        .help = "the same for the foam that breaking has left",
                                        .range = limits::kFoamOpacity,
                                        .key_parts = key_parts(KeyPart::Water),
                                        .may_have_keys = true}),
        row<&Effects::spray>({.name = "spray",
                              .help = "droplets over breaking crests; none without whitecaps",
                              .key_parts = key_parts(KeyPart::Spray)}),
        row<&Effects::spray_law>(
            {.name = "spray_law",
             .help = "how much spray a wind makes. andreas-1998: drops torn off crests, seen in a gale; "
                     "monahan-1986: the bubbles' alone, too thin to be seen",
             .key_parts = key_parts(KeyPart::Spray)}),
        row<&Effects::spray_gain>({.name = "spray_gain",
                                   .help = "how much spray there is; 1 is the law's",
                                   .range = limits::kSprayGain,
                                   .soft = SoftRange{1.0, 100.0, true},
                                   .key_parts = key_parts(KeyPart::Spray)}),
        row<&Effects::spray_drops>(
            {.name = "spray_drops",
             .help =
                 "the large drops of that spray as particles that fly off crests: in pictures, near the camera, in Blender and "
                 "in output.drops; volumes hold the rest. Only by andreas-1998",
             .key_parts = key_parts(KeyPart::Spray)}));
    add_table<&Scene::quality>(
        out.tables, out.keys, {"quality", "accuracy against time", {}, {}},
        row<&Quality::level>(
            {.name = "level",
             .help = "how much time accuracy may take. draft: for finding the view; preview: finer; "
                     "final: for pictures that move; reference: what the others are compared with",
             .key_parts = kQuality}),
        row<&Quality::max_error>(
            {.name = "max_error",
             .help =
                 "instead of level: the cheapest settings that hold it. Of a mesh, the distance from the sea over the "
                 "significant height (RMS); of pictures, the relative error of radiance that 95 % of the water's pixels "
                 "don't exceed",
             .range = limits::kMaxError,
             .soft = SoftRange{1e-3, 0.3, true},
             .key_parts = kQuality}),
        row<&Quality::frame_ms>(
            {.name = "frame_ms",
             .help =
                 "instead of level: the most accurate settings that compute a frame of a run "
                 "in this time: of files on the machine that begins them (pelagic calibrate), in Blender on two recorded cores",
             .unit = "ms",
             .range = limits::kFrame_ms,
             .soft = SoftRange{1.0, 1e4, true},
             .key_parts = kQuality}));
}

void add_objects(Built& out) {
    Row<SceneObject, 2> file{
        key_of_member<std::string>(
            {.name = "file",
             .help =
                 "its mesh, a Wavefront OBJ in metres, z up, its bow along +x and 0 at the waterline, or a USD crate; a path "
                 "from the shot file's folder",
             .accepted = "a string, the path of an .obj or a .usdc"}),
        [](const SceneObject& object) { return KeyValue(object.file); },
        [](SceneObject& object, const KeyValue& value) {
            return MemberValue<std::string>::take(value, object.file);
        }};
    file.key.is_required = true;
    auto made = entries<&Scene::objects>(
        {.name = "objects",
         .help =
             "bodies in the light of the sea: seen, shadowing, mirrored in pictures; no sea is in their hulls, in files either. Their wakes are waves.vessels",
         .key_parts = key_parts(KeyPart::Objects),
         .is_silent_off = true,
         .most_entries = limits::kObjects,
         .are_entries_independent = false,
         .entry_name = "SceneObject"},
        file,
        row<&SceneObject::name>(
            {.name = "name",
             .help =
                 "as mattes and messages call it, each another; \"\": as its file, without folder and ending",
             .accepted = "a string, at most 100 bytes of UTF-8"}),
        row<&SceneObject::path>(
            {.name = "path",
             .help =
                 "where its origin is, as waves.vessels[].path: frame, east and north in metres of each key; its bow goes ahead. "
                 "Where two neighbours are one place it stands there. Frames are the camera's, also where the sea stands still",
             .accepted =
                 "a string, \"frame east north, frame east north, …\"; \"\": it stands at east_m and north_m"}),
        row<&SceneObject::interpolation>(
            {.name = "interpolation", .help = "of the path between keys: straight, or smooth"}),
        row<&SceneObject::vessel>(
            {.name = "vessel",
             .help =
                 "it is the hull of that one of waves.vessels, counted from 1, and goes where its wake is; 0: of none",
             .range = Range{0.0, limits::kVessels}}),
        row<&SceneObject::east_m>(
            {.name = "east_m",
             .help = "of its origin, along +x; with a path or a vessel, from there along its course",
             .unit = "m",
             .range = kEach_m,
             .soft = SoftRange{-200.0, 200.0}}),
        row<&SceneObject::north_m>(
            {.name = "north_m",
             .help = "of its origin, along +y; with a path or a vessel, from there to port",
             .unit = "m",
             .range = kEach_m,
             .soft = SoftRange{-200.0, 200.0}}),
        row<&SceneObject::up_m>({.name = "up_m",
                                 .help = "of its origin over the calm sea",
                                 .unit = "m",
                                 .range = limits::kObjectUp_m,
                                 .soft = SoftRange{-20.0, 100.0}}),
        row<&SceneObject::heading_deg>(
            {.name = "heading_deg",
             .help =
                 "of its +x, counter-clockwise from +x of the sea; with a path or a vessel, from its course",
             .unit = "degrees",
             .range = limits::kAngle_deg,
             .soft = kTurn}),
        row<&SceneObject::pitch_deg>({.name = "pitch_deg",
                                      .help = "its bow up",
                                      .unit = "degrees",
                                      .range = limits::kAngle_deg,
                                      .soft = kTurn}),
        row<&SceneObject::roll_deg>({.name = "roll_deg",
                                     .help = "its starboard side down",
                                     .unit = "degrees",
                                     .range = limits::kAngle_deg,
                                     .soft = kTurn}),
        row<&SceneObject::scale>({.name = "scale",
                                  .help = "of its mesh: 0.01 for one in centimetres",
                                  .range = limits::kObjectScale,
                                  .soft = SoftRange{0.01, 100.0, true}}),
        row<&SceneObject::floats>(
            {.name = "floats",
             .help =
                 "heaves, pitches and rolls with the waves that are as long as it is, or as buoyancy has it"}),
        row<&SceneObject::buoyancy>(
            {.name = "buoyancy",
             .help =
                 "of what floats: plane: it lies on the water under it; response: it moves by its mass as well, late, and rolls on, as linear "
                 "theory has a ship as long, wide and deep"}),
        row<&SceneObject::roll_damping>(
            {.name = "roll_damping",
             .help =
                 "of what floats by response, over the damping that lets it swing no more: a bare hull has 0.05, one with bilge keels 0.1, a "
                 "yacht under sail 0.4",
             .range = limits::kRollDamping,
             .soft = SoftRange{0.02, 1.0}}),
        row<&SceneObject::foam>(
            {.name = "foam",
             .help =
                 "of the coverage of the foam along its hull, where hull and water meet at speed; its wake's is its vessel's",
             .range = limits::kMaskShare,
             .soft = SoftRange{0.0, 1.0}}),
        row<&SceneObject::colour>({.name = "colour",
                                   .help = "times its materials' colours, linear Rec. 709",
                                   .range = limits::kObjectColour}),
        row<&SceneObject::glow_cd_m2>(
            {.name = "glow_cd_m2",
             .help =
                 "luminance of its materials that glow (Ke of 1): a lit window has some 500, a lamp's glass 10000",
             .unit = "cd/m²",
             .range = limits::kObjectGlow_cd_m2,
             .soft = SoftRange{1.0, 1e5, true}}),
        row<&SceneObject::caustics>(
            {.name = "caustics",
             .help =
                 "how much waves gather the sun's light that they mirror onto it; 1 is as computed, 0 their mean light, and over 1 the mean rises, as no light is less than none",
             .range = limits::kWaterGain,
             .soft = SoftRange{0.0, 3.0},
             .is_silent_off = true}),
        row<&SceneObject::holdout>(
            {.name = "holdout",
             .help =
                 "it is rendered elsewhere: where it stands is nothing, of alpha 0, and it shadows and is mirrored all the same"}));
    // A mesh is no value: who has read a file keeps it.
    made.set = [set = std::move(made.set)](Scene& scene, const KeyValue& value) {
        const std::vector<SceneObject> before = scene.objects;
        if (!set(scene, value)) return false;
        for (SceneObject& object : scene.objects)
            if (const auto same = std::ranges::find(before, object.file, &SceneObject::file);
                same != before.end())
                object.mesh = same->mesh;
        return true;
    };
    add_list<&Scene::objects>(out.tables, out.keys, std::move(made));
}

void add_output(Built& out) {
    constexpr KeyPartSet kMesh = key_parts(KeyPart::Mesh), kChoice = key_parts(KeyPart::Choice);
    add_table<&Scene::output>(
        out.tables, out.keys, {"output", "what a bake writes", {}, {}},
        row<&Output::mesh>(
            {.name = "mesh",
             .help = "how the mesh is written. usda: as text; usdc: as binary crates; none: not",
             .key_parts = kMesh}),
        row<&Output::attributes>(
            {.name = "attributes",
             .help =
                 "what the mesh carries per vertex. Velocities are the waves' orbital ones, by linear theory: no Stokes drift is in them",
             .key_parts = kMesh}),
        row<&Output::maps>(
            {.name = "maps", .help = "images over the patch, a file a frame", .key_parts = kChoice}),
        row<&Output::map_resolution>({.name = "map_resolution",
                                      .help = "of the maps, a side",
                                      .unit = "pixels",
                                      .range = limits::kMapResolution,
                                      .soft = SoftRange{16.0, 4096.0, true},
                                      .key_parts = key_parts(KeyPart::Maps)}),
        row<&Output::cascade_tiles>({.name = "cascade_tiles",
                                     .help = "each cascade's own periodic tile as well",
                                     .key_parts = kChoice}),
        row<&Output::mesh_scheme>({.name = "mesh_scheme",
                                   .help =
                                       "what the mesh is. none: every vertex lies on the sea; catmullClark: "
                                       "of a patch, a cage whose limit surface is the sea, without normals",
                                   .key_parts = kMesh}),
        row<&Output::volumes>(
            {.name = "volumes",
             .help = "OpenVDB files over the patch's square, one a frame: spray, and the sea as a level set",
             .key_parts = kChoice}),
        row<&Output::voxel_m>({.name = "voxel_m",
                               .help = "side of the volumes' voxels",
                               .unit = "m",
                               .range = limits::kVoxel_m,
                               .soft = SoftRange{0.05, 10.0, true},
                               .key_parts = key_parts(KeyPart::Volumes)}),
        row<&Output::drops>(
            {.name = "drops",
             .help =
                 "USD points over the patch's square, a file a frame: the particles of effects.spray_drops",
             .key_parts = kChoice}));
}

Built build() {
    Built out;
    add_shot(out);
    add_sea(out);
    add_waves(out);
    add_surface(out);
    add_camera(out);
    add_light_and_water(out);
    add_effects_and_quality(out);
    add_output(out);
    add_objects(out);
    static_assert(member_count<Scene>() == 12, "a table without keys: add it above");
    // All keys of a table are neighbours in the list.
    for (KeyTable& table : out.tables) {
        const auto of_table = [&](const Key& key) {
            return key.path == table.name || key.path.starts_with(table.name + '.');
        };
        const auto first = std::find_if(out.keys.begin(), out.keys.end(), of_table);
        const auto last = std::find_if_not(first, out.keys.end(), of_table);
        table.keys = std::span<const Key>(first, last);
    }
    return out;
}

const Built& built() {
    static const Built all = build();
    return all;
}

}  // namespace

std::span<const KeyTable> key_tables() {
    return built().tables;
}

std::span<const Key> keys() {
    return built().keys;
}

}  // namespace pelagic
