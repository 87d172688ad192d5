// The C interface: calls in any order with any arguments. Each answers with a status, and a sentence where it isn't OK;
// what is refused leaves the results as they were; what is answered is finite where what was asked is.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "pelagic/procedural.h"
#include "tests/fuzz/fuzz.h"

using namespace pelagic;
using fuzz::hold;
using fuzz::Numbers;

namespace {

constexpr std::size_t kMostCalls = 8, kMostPoints = 6;
// A mesh takes time, and a larger one goes no other way.
constexpr std::size_t kMostMeshPoints = 20000;
constexpr float kUntouched = -77.25f;

// A structure in memory of exactly the size that it says it has: a sanitizer sees who reads or writes beyond.
template <class S>
class Sized {
  public:
    Sized(Numbers& numbers, const S& value) {
        constexpr std::array<std::size_t, 6> kWrong{
            0, 1, sizeof(std::size_t), sizeof(S) - 8, sizeof(S) + 8, sizeof(S) + 24};
        const std::size_t size = numbers.one_in(12) ? kWrong[numbers.below(kWrong.size())] : sizeof(S);
        // A shorter one is still a structure of an earlier version: no caller has less than its size member.
        const std::size_t room = std::max(size, sizeof(std::size_t));
        memory_.resize((room + sizeof(std::max_align_t) - 1) / sizeof(std::max_align_t));
        bytes_ = room;
        std::memcpy(memory_.data(), &value, std::min(room, sizeof(S)));
        std::memcpy(memory_.data(), &size, sizeof size);
        if (size > sizeof(S) && numbers.one_in(3))
            reinterpret_cast<unsigned char*>(memory_.data())[size - 1] = 1;
        is_null_ = numbers.one_in(32);
    }
    S* pointer() { return is_null_ ? nullptr : reinterpret_cast<S*>(memory_.data()); }
    S value() const {
        S known{};
        std::memcpy(&known, memory_.data(), std::min(bytes_, sizeof(S)));
        return known;
    }
    std::vector<unsigned char> bytes() const {
        const auto* first = reinterpret_cast<const unsigned char*>(memory_.data());
        return {first, first + bytes_};
    }
    // Whether all members that the structure has now are there.
    bool is_whole() const { return bytes_ >= sizeof(S); }

  private:
    std::vector<std::max_align_t> memory_;
    std::size_t bytes_ = 0;
    bool is_null_ = false;
};

void expect_answer(pelagic_status status, const pelagic_error& error) {
    hold(status >= PELAGIC_OK && status <= PELAGIC_FAILED, "a status is one of the list");
    const bool ends = std::memchr(error.message, 0, sizeof error.message) != nullptr;
    hold(ends, "a message ends");
    if (status == PELAGIC_OK)
        hold(error.message[0] == '\0', "no message where nothing is wrong", error.message);
    else
        hold(error.message[0] != '\0', "a message where something is wrong");
    hold(status != PELAGIC_FAILED, "nothing fails without a reason that has a status of its own",
         error.message);
}

bool is_refusal(pelagic_status status) {
    return status == PELAGIC_INVALID_ARGUMENT || status == PELAGIC_SHOT_REFUSED ||
           status == PELAGIC_TOO_SMALL;
}

bool are_finite(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}
bool are_untouched(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return value == kUntouched; });
}

// Buffers for so many points, some of them not wanted.
struct Buffers {
    std::vector<float> position, normal, velocity, variance, coverage;

    Buffers(Numbers& numbers, std::size_t points) {
        const std::uint8_t unwanted = numbers.one_in(4) ? numbers.byte() : std::uint8_t{0};
        const auto make = [&](std::vector<float>& values, int bit, std::size_t components) {
            if ((unwanted >> bit & 1) == 0) values.assign(points * components, kUntouched);
        };
        make(position, 0, 3), make(normal, 1, 3), make(velocity, 2, 3), make(variance, 3, 3),
            make(coverage, 4, 1);
    }
    pelagic_values values() {
        const auto at = [](std::vector<float>& values) { return values.empty() ? nullptr : values.data(); };
        pelagic_values values = PELAGIC_INIT(pelagic_values);
        values.position_m = at(position);
        values.normal = at(normal);
        values.velocity_mps = at(velocity);
        values.slope_variance = at(variance);
        values.coverage = at(coverage);
        return values;
    }
    bool has_untouched() const {
        return are_untouched(position) && are_untouched(normal) && are_untouched(velocity) &&
               are_untouched(variance) && are_untouched(coverage);
    }
    void expect_good() const {
        hold(are_finite(position), "positions are finite");
        hold(are_finite(velocity), "velocities are finite");
        hold(are_finite(variance), "slope variances are finite");
        for (std::size_t i = 0; i + 2 < normal.size(); i += 3) {
            const float length = std::hypot(normal[i], normal[i + 1], normal[i + 2]);
            hold(length == 0.0f || std::abs(length - 1.0f) < 1e-3f, "normals have the length 1",
                 std::to_string(normal[i]) + ' ' + std::to_string(normal[i + 1]) + ' ' +
                     std::to_string(normal[i + 2]));
        }
        for (const float value : coverage) hold(value >= 0.0f && value <= 1.0f, "coverage is 0 to 1");
    }
};

std::vector<float> numbers_of(Numbers& numbers, std::size_t count) {
    std::vector<float> values(count);
    for (float& value : values) value = numbers.single();
    return values;
}
const float* pointer_to(const std::vector<float>& values) {
    return values.empty() ? nullptr : values.data();
}

constexpr const char* kSmall =
    "[camera]\nposition_m = [0.0, -30.0, 6.0]\nresolution = [16, 9]\n[quality]\nlevel = \"draft\"\n";
constexpr const char* kTiles =
    "[waves]\ncascades = [ { size_m = 100.0, resolution = 48 }, { size_m = 40.0, resolution = 32 } ]\n";

pelagic_sea* opened(const std::string& text) {
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = text.c_str();
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.finest_cell_m = options.finest_pixel_m = 0.5;
    options.threads = 1;
    options.ray_cache_bytes = std::size_t{1} << 22;
    pelagic_sea* sea = nullptr;
    pelagic_error error{};
    hold(pelagic_open(&source, &options, &sea, &error) == PELAGIC_OK, "the shots of this test are shots",
         error.message);
    return sea;
}

// One after another of an input's calls.
class Calls {
  public:
    Calls(const std::uint8_t* data, std::size_t size) : numbers_(data, size) {}
    ~Calls() { pelagic_frame_release(frame_); }
    Calls(const Calls&) = delete;
    Calls& operator=(const Calls&) = delete;

    void run() {
        static const std::array<pelagic_sea*, 4> seas{
            opened(std::string(kSmall) + kTiles),
            opened(std::string(kSmall) + "[waves]\nmodel = \"trochoid\"\ntrains = 8\n"),
            opened(std::string(kSmall) + kTiles + "[sea]\nwind_speed_mps = 0.0\n[shot]\nloop_s = 10.0\n"),
            opened(std::string(kSmall) + kTiles +
                   "choppiness = 6.0\n[sea]\nwind_speed_mps = 40.0\ngust_strength = 1.0\ndepth_m = 5.0\n")};
        sea_ = seas[numbers_.below(seas.size())];
        hold(pelagic_frame_create(sea_, 1.0, 1.0 + open_for_s_, &frame_, &error_) == PELAGIC_OK, "a frame",
             error_.message);
        camera_ = PELAGIC_INIT(pelagic_camera);
        hold(pelagic_shot_camera(sea_, 1.0, &camera_, &error_) == PELAGIC_OK, "a camera", error_.message);
        for (std::size_t call = 0; call < kMostCalls && !numbers_.is_over(); ++call) one();
    }

  private:
    void one() {
        switch (numbers_.below(10)) {
            case 0:
                return info();
            case 1:
                return camera();
            case 2:
                return create();
            case 3:
                return set();
            case 4:
                return bounds();
            case 5:
            case 6:
                return evaluate();
            case 7:
                return rays();
            case 8:
                return expand();
            default:
                return open();
        }
    }

    const pelagic_sea* sea() { return numbers_.one_in(32) ? nullptr : sea_; }
    pelagic_frame* frame() { return numbers_.one_in(32) ? nullptr : frame_; }

    // Of calls that fill one structure: what it has after a refusal is what it had.
    template <class S, class Call>
    pelagic_status asked_for(Sized<S>& result, const Call& call) {
        const auto before = result.bytes();
        error_.message[0] = 1;
        const pelagic_status status = call(result.pointer(), &error_);
        expect_answer(status, error_);
        if (is_refusal(status)) hold(result.bytes() == before, "what is refused leaves the result as it was");
        return status;
    }

    void info() {
        Sized<pelagic_info> about(numbers_, {});
        const pelagic_sea* of = sea();
        if (asked_for(about, [&](auto* to, auto* error) { return pelagic_get_info(of, to, error); }) ==
                PELAGIC_OK &&
            about.is_whole()) {
            const pelagic_info has = about.value();
            for (const double value :
                 {has.frames_per_second, has.time_scale, has.loop_s, has.significant_height_m,
                  has.peak_wavelength_m, has.finest_cell_m, has.finest_pixel_m})
                hold(std::isfinite(value) && value >= 0.0, "what is said of a sea is finite");
        }
        double time_s = kUntouched;
        const double at = numbers_.number();
        const pelagic_status status = pelagic_time_of_frame(of, at, &time_s, &error_);
        expect_answer(status, error_);
        hold(status == PELAGIC_OK ? std::isfinite(time_s) : time_s == double{kUntouched}, "a time is finite");
    }

    void camera() {
        Sized<pelagic_camera> made(numbers_, {});
        const pelagic_sea* of = sea();
        const double at = numbers_.number();
        if (asked_for(made, [&](auto* to, auto* error) { return pelagic_shot_camera(of, at, to, error); }) ==
                PELAGIC_OK &&
            made.is_whole())
            camera_ = made.value();
        Sized<pelagic_vessel> vessel(numbers_, {});
        const std::size_t which = numbers_.below(3);
        if (asked_for(vessel,
                      [&](auto* to, auto* error) { return pelagic_vessel_at(of, which, at, to, error); }) ==
                PELAGIC_OK &&
            vessel.is_whole()) {
            const pelagic_vessel there = vessel.value();
            for (const double value : {there.position_m[0], there.position_m[1], there.ahead[0],
                                       there.port[1], there.velocity_mps[0]})
                hold(std::isfinite(value), "where a vessel is is finite");
        }
    }

    void create() {
        pelagic_frame* made = nullptr;
        const pelagic_sea* of = sea();
        const double open_s = numbers_.number(), close_s = numbers_.one_in(2) ? numbers_.number() : open_s;
        const pelagic_status status = pelagic_frame_create(of, open_s, close_s, &made, &error_);
        expect_answer(status, error_);
        hold((status == PELAGIC_OK) == (made != nullptr), "a frame, or a reason");
        if (!made) return;
        hold_shutter(open_s, close_s);
        pelagic_frame_release(frame_);
        frame_ = made;
    }

    void hold_shutter(double open_s, double close_s) {
        open_for_s_ = close_s - open_s;
        hold(std::isfinite(open_s) && std::isfinite(close_s), "a shutter that is taken is finite");
        hold(close_s >= open_s && close_s - open_s <= 1.0,
             "a shutter that is taken is open for a second at most");
    }

    void set() {
        const double open_s = numbers_.number(), close_s = numbers_.one_in(2) ? numbers_.number() : open_s;
        pelagic_frame* const of = frame();
        const pelagic_status status = pelagic_frame_set(of, open_s, close_s, &error_);
        expect_answer(status, error_);
        hold(status == PELAGIC_OK || is_refusal(status), "a frame that is there can be set", error_.message);
        if (status != PELAGIC_OK) return;
        hold_shutter(open_s, close_s);
    }

    void bounds() {
        pelagic_region region = PELAGIC_INIT(pelagic_region);
        for (int axis = 0; axis < 2; ++axis) {
            region.min_m[axis] = numbers_.number();
            region.max_m[axis] =
                numbers_.one_in(3) ? numbers_.number() : region.min_m[axis] + numbers_.byte();
        }
        region.finest_cell_m = numbers_.one_in(2) ? 0.0 : numbers_.number();
        region.coarsest_cell_m = numbers_.one_in(2) ? 0.0 : numbers_.number();
        Sized<pelagic_region> asked(numbers_, region);
        Sized<pelagic_box> found(numbers_, {});
        const pelagic_frame* of = frame();
        if (asked_for(found, [&](auto* to,
                                 auto* error) { return pelagic_bounds(of, asked.pointer(), to, error); }) !=
                PELAGIC_OK ||
            !found.is_whole() || !asked.is_whole())
            return;
        const pelagic_box box = found.value();
        for (int axis = 0; axis < 3; ++axis)
            hold(std::isfinite(box.min_m[axis]) && std::isfinite(box.max_m[axis]) &&
                     box.min_m[axis] <= box.max_m[axis],
                 "a box is finite, and its ends stand in order");
        expect_inside(region, box);
    }

    // Corners of the region, displaced.
    void expect_inside(const pelagic_region& region, const pelagic_box& box) {
        for (const double x : {region.min_m[0], region.max_m[0]})
            for (const double y : {region.min_m[1], region.max_m[1]}) {
                const std::array<float, 2> rest{0.0f, 0.0f};
                const auto cell_m = static_cast<float>(std::max(region.finest_cell_m, 0.0));
                if (!std::isfinite(cell_m)) return;
                std::array<float, 3> position{};
                pelagic_points points = PELAGIC_INIT(pelagic_points);
                points.origin_m[0] = x, points.origin_m[1] = y;
                points.count = 1;
                points.rest_m = rest.data();
                points.cell_m = &cell_m;
                pelagic_values values = PELAGIC_INIT(pelagic_values);
                values.position_m = position.data();
                hold(pelagic_evaluate(frame_, &points, &values, &error_) == PELAGIC_OK,
                     "a place of a region is a place", error_.message);
                for (int axis = 0; axis < 3; ++axis) {
                    const double at = (axis < 2 ? points.origin_m[axis] : 0.0) + double{position[axis]};
                    const double slack_m = 1e-4 + 1e-15 * std::abs(at);
                    hold(at >= box.min_m[axis] - slack_m && at <= box.max_m[axis] + slack_m,
                         "a displaced point is in its region's box",
                         std::to_string(at) + " of " + std::to_string(box.min_m[axis]) + " … " +
                             std::to_string(box.max_m[axis]));
                }
            }
    }

    // Finite ones within the shutter: others are refused, as are those that aren't finite.
    std::vector<float> while_open(std::vector<float> times_s) const {
        for (float& time_s : times_s)
            if (std::isfinite(time_s)) time_s = std::clamp(time_s, 0.0f, static_cast<float>(open_for_s_));
        return times_s;
    }

    void evaluate() {
        const std::size_t count = numbers_.below(kMostPoints + 1);
        const auto rest = numbers_of(numbers_, 2 * count);
        const auto some = [&] {
            return numbers_.one_in(2) ? numbers_of(numbers_, count) : std::vector<float>();
        };
        const auto cell = some(), pixel = some(), time = while_open(some());
        pelagic_points points = PELAGIC_INIT(pelagic_points);
        for (double& metres : points.origin_m) metres = numbers_.one_in(3) ? numbers_.number() : 0.0;
        points.count = count;
        points.rest_m = pointer_to(rest);
        points.cell_m = pointer_to(cell);
        points.pixel_m = pointer_to(pixel);
        points.time_s = pointer_to(time);
        Sized<pelagic_points> asked(numbers_, points);
        Buffers buffers(numbers_, count);
        Sized<pelagic_values> into(numbers_, buffers.values());
        const pelagic_status status = pelagic_evaluate(frame(), asked.pointer(), into.pointer(), &error_);
        expect_answer(status, error_);
        if (is_refusal(status))
            hold(buffers.has_untouched(), "what is refused leaves the results as they were");
        if (status == PELAGIC_OK && are_finite(rest)) buffers.expect_good();
    }

    void rays() {
        const std::size_t count = numbers_.below(has_gone_far_ ? kMostPoints + 1 : 3);
        const auto direction = numbers_of(numbers_, 3 * count);
        const auto some = [&](std::size_t components) {
            return numbers_.one_in(3) ? numbers_of(numbers_, components * count) : std::vector<float>();
        };
        const auto offset = some(3), near = some(1), time = while_open(some(1)), footprint = some(1),
                   spread = some(1);
        // One small batch of an input goes on without end: 32 km among the waves, each metre of which is looked at.
        auto far = has_gone_far_ ? std::vector<float>(count, 1.0f) : some(1);
        for (std::size_t i = 0; i < count && has_gone_far_; ++i)
            if (!(std::hypot(direction[3 * i], direction[3 * i + 1], direction[3 * i + 2]) < 100.0f))
                far[i] = 1e-3f;
        has_gone_far_ = true;
        pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
        rays.origin_m[2] = numbers_.byte() / 8.0 - 4.0;
        if (numbers_.one_in(3))
            for (double& metres : rays.origin_m) metres = numbers_.number();
        rays.count = count;
        rays.offset_m = pointer_to(offset);
        rays.direction = pointer_to(direction);
        rays.near = pointer_to(near);
        rays.far = pointer_to(far);
        rays.time_s = pointer_to(time);
        rays.footprint_m = pointer_to(footprint);
        rays.spread = pointer_to(spread);
        rays.tolerance = numbers_.one_in(3) ? numbers_.number() : 0.0;
        rays.on_earth = static_cast<int>(numbers_.below(2));
        Sized<pelagic_rays> asked(numbers_, rays);
        Buffers buffers(numbers_, count);
        Sized<pelagic_values> into(numbers_, buffers.values());
        std::vector<float> distance(count, kUntouched), rest(2 * count, kUntouched), width(count, kUntouched);
        pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
        hits.distance = distance.data();
        hits.rest_m = rest.data();
        hits.footprint_m = width.data();
        hits.values = into.pointer();
        Sized<pelagic_hits> given(numbers_, hits);
        pelagic_frame* const of = frame();
        const pelagic_status status = pelagic_intersect(of, asked.pointer(), given.pointer(), &error_);
        expect_answer(status, error_);
        if (is_refusal(status))
            hold(buffers.has_untouched() && are_untouched(distance) && are_untouched(rest) &&
                     are_untouched(width),
                 "what is refused leaves the results as they were");
        std::vector<unsigned char> occluded(count, 7);
        const pelagic_status shadow = pelagic_occluded(of, asked.pointer(), occluded.data(), &error_);
        expect_answer(shadow, error_);
        for (const unsigned char value : occluded)
            hold(value == (shadow == PELAGIC_OK ? value & 1 : 7), "occluded is 0 or 1, or as it was");
        if (status != PELAGIC_OK || !given.is_whole()) return;
        if (into.pointer())
            buffers.expect_good();
        else
            hold(buffers.has_untouched(), "no values where none are wanted");
        hold(are_finite(rest) && are_finite(width), "places and footprints of hits are finite");
        for (std::size_t i = 0; i < count; ++i) {
            hold(!std::isnan(distance[i]) && distance[i] >= 0.0f,
                 "a distance is 0 or more, or there is no hit");
            if (shadow == PELAGIC_OK && count > 0)
                hold(occluded[i] == (std::isfinite(distance[i]) ? 1 : 0), "what is hit is occluded");
        }
    }

    void expand() {
        pelagic_camera view = camera_;
        if (numbers_.one_in(2))
            for (double& metres : view.position_m) metres = numbers_.number();
        if (numbers_.one_in(4)) view.tan_half_width = numbers_.number();
        if (numbers_.one_in(8))
            for (double& part : view.right) part = numbers_.number();
        if (numbers_.one_in(8)) view.width = static_cast<int>(numbers_.byte()) - 2;
        pelagic_expand_options options = PELAGIC_INIT(pelagic_expand_options);
        options.cell_px = numbers_.one_in(3) ? numbers_.number() : 2.0;
        if (numbers_.one_in(8)) options.error_px = numbers_.number();
        options.triangles = static_cast<int>(numbers_.below(2));
        options.on_earth = static_cast<int>(numbers_.below(2));
        Sized<pelagic_camera> camera(numbers_, view);
        Sized<pelagic_expand_options> asked(numbers_, options);
        Sized<pelagic_mesh_size> size(numbers_, {});
        const pelagic_frame* const of = frame();
        const pelagic_status sized = asked_for(size, [&](auto* to, auto* error) {
            return pelagic_expand_size(of, camera.pointer(), asked.pointer(), to, error);
        });
        const pelagic_mesh_size needed = size.value();
        if (sized == PELAGIC_OK && (!size.is_whole() || needed.points > kMostMeshPoints)) return;
        // A little less than is needed now and then; where there is no size, some.
        const std::size_t less = numbers_.one_in(6) ? 1 : 0;
        const std::size_t points = sized == PELAGIC_OK ? needed.points - std::min(needed.points, less) : 4,
                          corners = sized == PELAGIC_OK ? needed.corners : 4;
        Buffers buffers(numbers_, points);
        std::vector<float> rest(2 * points, kUntouched);
        std::vector<std::uint32_t> corner(corners, 77);
        Sized<pelagic_values> into(numbers_, buffers.values());
        pelagic_mesh_buffers mesh = PELAGIC_INIT(pelagic_mesh_buffers);
        mesh.points = points;
        mesh.corners = corners;
        mesh.corner = corner.data();
        mesh.rest_m = rest.data();
        mesh.values = into.pointer();
        Sized<pelagic_mesh_buffers> given(numbers_, mesh);
        const pelagic_status status = asked_for(given, [&](auto* to, auto* error) {
            return pelagic_expand(of, camera.pointer(), asked.pointer(), to, error);
        });
        if (is_refusal(status))
            hold(buffers.has_untouched() && are_untouched(rest),
                 "what is refused leaves the results as they were");
        if (status != PELAGIC_OK || sized != PELAGIC_OK || !given.is_whole()) return;
        const pelagic_mesh_buffers filled = given.value();
        hold(filled.points == needed.points && filled.corners == needed.corners,
             "a mesh is as large as was said");
        hold(are_finite(rest), "places at rest are finite");
        if (into.pointer())
            buffers.expect_good();
        else
            hold(buffers.has_untouched(), "no values where none are wanted");
        for (const std::uint32_t index : corner) hold(index < needed.points, "corners are points");
    }

    void open() {
        if (has_opened_) return;  // for time
        has_opened_ = true;
        pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
        // No finer than a decimetre: what a sea takes rises with it.
        options.finest_cell_m = numbers_.one_in(2) ? 0.5 : std::max(numbers_.number(), 0.1);
        options.finest_pixel_m = numbers_.one_in(2) ? 0.5 : std::max(numbers_.number(), 0.1);
        options.threads = numbers_.one_in(8) ? static_cast<int>(numbers_.byte()) - 100 : 1;
        options.ray_cache_bytes = numbers_.byte();
        int calls_left = numbers_.byte();
        if (numbers_.one_in(2)) {
            options.user = &calls_left;
            options.progress = [](double done, void* user) {
                hold(done >= 0.0 && done <= 1.0, "progress is 0 to 1");
                return (*static_cast<int*>(user))-- == 0 ? 1 : 0;
            };
        }
        Sized<pelagic_open_options> asked(numbers_, options);
        const std::string text = std::string(kSmall) + kTiles + std::string(numbers_.rest(200));
        pelagic_source source = PELAGIC_INIT(pelagic_source);
        source.text = text.data();
        source.text_length = text.size();
        Sized<pelagic_source> from(numbers_, source);
        if (!from.is_whole()) return;  // its text may have no end
        pelagic_sea* made = nullptr;
        const pelagic_status status = pelagic_open(from.pointer(), asked.pointer(), &made, &error_);
        expect_answer(status, error_);
        hold((status == PELAGIC_OK) == (made != nullptr), "a sea, or a reason");
        pelagic_close(made);
    }

    Numbers numbers_;
    const pelagic_sea* sea_ = nullptr;
    pelagic_frame* frame_ = nullptr;
    pelagic_camera camera_{};
    pelagic_error error_{};
    double open_for_s_ = 1.0 / 48.0;
    bool has_opened_ = false, has_gone_far_ = false;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Calls(data, size).run();
    return 0;
}
