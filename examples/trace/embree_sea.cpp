#include "embree_sea.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace {

constexpr unsigned kBatch = 16;  // rays that are asked for at once: Embree's largest packet

}  // namespace

// Rays of a packet that are still looked for, side by side.
struct EmbreeSea::Batch {
    unsigned count = 0;
    std::array<unsigned, kBatch> index;  // in the packet
    std::array<float, 3 * kBatch> offset_m, direction, normal;
    std::array<float, 2 * kBatch> rest_m;
    std::array<float, kBatch> nearest, farthest, time_s, footprint_m, spread, distance, hit_footprint_m;

    pelagic_rays rays(const Options& options) const {
        pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
        std::copy_n(options.origin_m, 3, rays.origin_m);
        rays.count = count;
        rays.offset_m = offset_m.data();
        rays.direction = direction.data();
        rays.near = nearest.data();
        rays.far = farthest.data();
        rays.time_s = time_s.data();
        rays.footprint_m = footprint_m.data();
        rays.spread = spread.data();
        rays.tolerance = options.tolerance;
        rays.on_earth = options.on_earth ? 1 : 0;
        return rays;
    }
    float length(unsigned i) const {
        return std::hypot(direction[3 * i], direction[3 * i + 1], direction[3 * i + 2]);
    }
    // Drops ray i, whose place another one takes: those of arrays that go in.
    void drop(unsigned i) {
        const unsigned last = --count;
        index[i] = index[last];
        for (std::array<float, 3 * kBatch>* of : {&offset_m, &direction})
            std::copy_n(of->data() + 3 * last, 3, of->data() + 3 * i);
        for (std::array<float, kBatch>* of : {&nearest, &farthest, &time_s, &footprint_m, &spread})
            (*of)[i] = (*of)[last];
    }
};

EmbreeSea::EmbreeSea(RTCDevice device, const pelagic_frame* frame, const Options& options)
    : frame_(frame), options_(options) {
    if (!(options.reach_m >= 1.0 && options.reach_m <= 1e7))
        throw std::runtime_error("reach_m is outside the range; accepted: 1 to 1e7 m");
    find_bounds();
    geometry_ = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    if (!geometry_) throw std::runtime_error("Embree has no memory for a geometry");
    rtcSetGeometryUserPrimitiveCount(geometry_, 1);
    rtcSetGeometryUserData(geometry_, this);
    rtcSetGeometryBoundsFunction(
        geometry_,
        [](const RTCBoundsFunctionArguments* arguments) {
            *arguments->bounds_o = static_cast<const EmbreeSea*>(arguments->geometryUserPtr)->bounds_;
        },
        nullptr);
    rtcSetGeometryIntersectFunction(geometry_, [](const RTCIntersectFunctionNArguments* arguments) {
        static_cast<EmbreeSea*>(arguments->geometryUserPtr)->intersect(*arguments);
    });
    rtcSetGeometryOccludedFunction(geometry_, [](const RTCOccludedFunctionNArguments* arguments) {
        static_cast<EmbreeSea*>(arguments->geometryUserPtr)->occluded(*arguments);
    });
    rtcCommitGeometry(geometry_);
}

EmbreeSea::~EmbreeSea() {
    rtcReleaseGeometry(geometry_);
}

void EmbreeSea::refresh(double shutter_s) {
    options_.shutter_s = shutter_s;
    status_ = PELAGIC_OK;  // of the frame before
    find_bounds();
    rtcCommitGeometry(geometry_);
}

void EmbreeSea::set_filters(RTCFilterFunctionN intersection, RTCFilterFunctionN occlusion) {
    rtcSetGeometryIntersectFilterFunction(geometry_, intersection);
    rtcSetGeometryOccludedFilterFunction(geometry_, occlusion);
    has_occlusion_filter_ = occlusion != nullptr;
    rtcCommitGeometry(geometry_);
}

void EmbreeSea::find_bounds() {
    pelagic_region region = PELAGIC_INIT(pelagic_region);
    for (int axis = 0; axis < 2; ++axis) {
        region.min_m[axis] = options_.origin_m[axis] - options_.reach_m;
        region.max_m[axis] = options_.origin_m[axis] + options_.reach_m;
    }
    pelagic_box box = PELAGIC_INIT(pelagic_box);
    pelagic_error error;
    if (pelagic_bounds(frame_, &region, &box, &error) != PELAGIC_OK) throw std::runtime_error(error.message);
    // On the earth a place at the distance s lies s²/2R lower at most, and no farther from the origin; crests lean outwards,
    // by less than their height.
    double lower_m = 0.0, outwards_m = 0.0;
    if (options_.on_earth) {
        constexpr double kSmallestRadius_m = 6.3e6;
        double corner2 = 0.0;
        for (int axis = 0; axis < 2; ++axis) {
            const double farthest_m = std::max(std::abs(box.min_m[axis] - options_.origin_m[axis]),
                                               std::abs(box.max_m[axis] - options_.origin_m[axis]));
            corner2 += farthest_m * farthest_m;
        }
        lower_m = corner2 / (2.0 * kSmallestRadius_m);
        outwards_m = std::max(std::abs(box.min_m[2]), std::abs(box.max_m[2]));
    }
    // Rounded outwards, by more than single precision needs; and hits lie within the tolerance of the surface.
    const auto low = [&](int axis, double more_m) {
        const double at_m = box.min_m[axis] - options_.origin_m[axis] - more_m;
        return static_cast<float>(at_m - 1e-6 * std::abs(at_m) - 1e-3);
    };
    const auto high = [&](int axis, double more_m) {
        const double at_m = box.max_m[axis] - options_.origin_m[axis] + more_m;
        return static_cast<float>(at_m + 1e-6 * std::abs(at_m) + 1e-3);
    };
    bounds_.lower_x = low(0, outwards_m);
    bounds_.lower_y = low(1, outwards_m);
    bounds_.lower_z = low(2, lower_m);
    bounds_.upper_x = high(0, outwards_m);
    bounds_.upper_y = high(1, outwards_m);
    bounds_.upper_z = high(2, 0.0);
}

void EmbreeSea::keep(pelagic_status status, const pelagic_error& error) {
    const std::lock_guard<std::mutex> lock(error_lock_);
    if (status_ != PELAGIC_OK) return;
    error_ = error;
    status_ = status;
}

template <class Arguments>
EmbreeSea::Batch EmbreeSea::batch_of(const Arguments& arguments, RTCRayN* rays, unsigned first) const {
    const auto& context = *reinterpret_cast<const SeaRayContext*>(arguments.context);
    const unsigned n = arguments.N;
    Batch batch;
    for (unsigned i = first; i < std::min(first + kBatch, n); ++i) {
        if (arguments.valid[i] == 0) continue;
        const unsigned at = batch.count++;
        batch.index[at] = i;
        batch.offset_m[3 * at] = RTCRayN_org_x(rays, n, i);
        batch.offset_m[3 * at + 1] = RTCRayN_org_y(rays, n, i);
        batch.offset_m[3 * at + 2] = RTCRayN_org_z(rays, n, i);
        batch.direction[3 * at] = RTCRayN_dir_x(rays, n, i);
        batch.direction[3 * at + 1] = RTCRayN_dir_y(rays, n, i);
        batch.direction[3 * at + 2] = RTCRayN_dir_z(rays, n, i);
        batch.nearest[at] = RTCRayN_tnear(rays, n, i);
        batch.farthest[at] = RTCRayN_tfar(rays, n, i);
        batch.time_s[at] = RTCRayN_time(rays, n, i) * static_cast<float>(options_.shutter_s);
        const RayWidth width = context.widths ? context.widths[RTCRayN_id(rays, n, i)] : context.width;
        batch.footprint_m[at] = width.footprint_m;
        batch.spread[at] = width.spread;
    }
    return batch;
}

namespace {

// Where a search goes on behind a hit that was rejected: nearer hits may be the same place once more.
float behind(float distance, float footprint_m, double finest_cell_m, double tolerance, float length) {
    const float width_m = std::max(footprint_m, static_cast<float>(finest_cell_m));
    const auto step_m = static_cast<float>(tolerance > 0.0 ? tolerance : 0.5) * width_m;
    return std::max(distance + step_m / std::max(length, std::numeric_limits<float>::min()),
                    std::nextafter(distance, std::numeric_limits<float>::infinity()));
}

// One ray of a packet with a hit, for filters: they take packets of one.
struct Candidate {
    template <class Arguments>
    Candidate(const Arguments& from, RTCRayN* rays, unsigned index, float distance)
        : ray(rtcGetRayFromRayN(rays, from.N, index)) {
        ray.tfar = distance;
    }
    RTCFilterFunctionNArguments arguments(void* user, RTCIntersectContext* context) {
        return {.valid = &valid,
                .geometryUserPtr = user,
                .context = context,
                .ray = reinterpret_cast<RTCRayN*>(&ray),
                .hit = reinterpret_cast<RTCHitN*>(&hit),
                .N = 1};
    }

    int valid = -1;
    RTCRay ray;
    RTCHit hit;
};

template <class Arguments>
RTCHit hit_of(const float* normal, const float* rest_m, const Arguments& arguments) {
    RTCHit hit;
    hit.Ng_x = normal[0];
    hit.Ng_y = normal[1];
    hit.Ng_z = normal[2];
    hit.u = rest_m[0];
    hit.v = rest_m[1];
    hit.primID = arguments.primID;
    hit.geomID = arguments.geomID;
    std::copy_n(arguments.context->instID, RTC_MAX_INSTANCE_LEVEL_COUNT, hit.instID);
    return hit;
}

}  // namespace

// Asks for the first hit of each ray, and where `accepts` refuses one for the next behind it.
template <class Accepts>
void EmbreeSea::search(Batch& batch, const Accepts& accepts) {
    while (batch.count > 0) {
        pelagic_values values = PELAGIC_INIT(pelagic_values);
        values.normal = batch.normal.data();
        pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
        hits.distance = batch.distance.data();
        hits.rest_m = batch.rest_m.data();
        hits.footprint_m = batch.hit_footprint_m.data();
        hits.values = &values;
        const pelagic_rays rays = batch.rays(options_);
        pelagic_error error;
        if (const pelagic_status status = pelagic_intersect(frame_, &rays, &hits, &error);
            status != PELAGIC_OK)
            return keep(status, error);
        // From the last on: dropping one moves only those behind it.
        for (unsigned i = batch.count; i-- > 0;) {
            if (!(batch.distance[i] < batch.farthest[i]) || accepts(i))
                batch.drop(i);
            else
                batch.nearest[i] = behind(batch.distance[i], batch.hit_footprint_m[i], options_.finest_cell_m,
                                          options_.tolerance, batch.length(i));
        }
    }
}

void EmbreeSea::intersect(const RTCIntersectFunctionNArguments& arguments) {
    RTCRayN* rays = RTCRayHitN_RayN(arguments.rayhit, arguments.N);
    RTCHitN* hits = RTCRayHitN_HitN(arguments.rayhit, arguments.N);
    for (unsigned first = 0; first < arguments.N; first += kBatch) {
        Batch batch = batch_of(arguments, rays, first);
        search(batch, [&](unsigned i) {
            Candidate candidate(arguments, rays, batch.index[i], batch.distance[i]);
            candidate.hit = hit_of(&batch.normal[3 * i], &batch.rest_m[2 * i], arguments);
            const RTCFilterFunctionNArguments filtered = candidate.arguments(this, arguments.context);
            rtcFilterIntersection(&arguments, &filtered);
            if (candidate.valid == 0) return false;
            RTCRayN_tfar(rays, arguments.N, batch.index[i]) = candidate.ray.tfar;
            rtcCopyHitToHitN(hits, &candidate.hit, arguments.N, batch.index[i]);
            return true;
        });
    }
}

void EmbreeSea::occluded(const RTCOccludedFunctionNArguments& arguments) {
    const bool is_filtered = arguments.context->filter || has_occlusion_filter_;
    const auto block = [&](unsigned ray) {
        RTCRayN_tfar(arguments.ray, arguments.N, ray) = -std::numeric_limits<float>::infinity();
    };
    for (unsigned first = 0; first < arguments.N; first += kBatch) {
        Batch batch = batch_of(arguments, arguments.ray, first);
        if (!is_filtered) {
            std::array<unsigned char, kBatch> meets{};
            const pelagic_rays rays = batch.rays(options_);
            pelagic_error error;
            if (const pelagic_status status = pelagic_occluded(frame_, &rays, meets.data(), &error);
                status != PELAGIC_OK)
                return keep(status, error);
            for (unsigned i = 0; i < batch.count; ++i)
                if (meets[i]) block(batch.index[i]);
            continue;
        }
        search(batch, [&](unsigned i) {
            Candidate candidate(arguments, arguments.ray, batch.index[i], batch.distance[i]);
            candidate.hit = hit_of(&batch.normal[3 * i], &batch.rest_m[2 * i], arguments);
            const RTCFilterFunctionNArguments filtered = candidate.arguments(this, arguments.context);
            rtcFilterOcclusion(&arguments, &filtered);
            if (candidate.valid != 0) block(batch.index[i]);
            return candidate.valid != 0;
        });
    }
}
