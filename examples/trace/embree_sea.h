// A frame of the sea as a user geometry of Embree 3, over the C interface alone: to be copied into other hosts.
//
//   EmbreeSea sea(device, frame, {.finest_cell_m = info.finest_cell_m});
//   rtcAttachGeometry(scene, sea.geometry());
//   SeaRayContext context(width);
//   rtcIntersect1(scene, &context.embree, &ray);
//
// A hit's u and v are the place at rest [m], relative to the origin: what pelagic_evaluate() takes for the values there. Ng is the
// surface's normal with the ray's footprint, unit, up but for folds. Filters of the geometry and of the context may reject hits, as
// in a hull that keeps the water out; the ray then goes on behind them. The sea has no thickness: rays meet it from both sides.
#pragma once

#include <embree3/rtcore.h>
#include <pelagic/procedural.h>

#include <atomic>
#include <mutex>

// How wide a ray is where it begins [m], and how much wider in each metre.
struct RayWidth {
    float footprint_m = 0.0f, spread = 0.0f;
};

// What each call of a scene with a sea in it is given as its context.
struct SeaRayContext {
    explicit SeaRayContext(RayWidth of_all = {}) : width(of_all) { rtcInitIntersectContext(&embree); }

    RTCIntersectContext embree;        // the first member: Embree hands out a pointer to it
    RayWidth width;                    // of all rays
    const RayWidth* widths = nullptr;  // by the id of each ray; null: all have the same
    void* user = nullptr;              // for the host's filters
};

class EmbreeSea {
  public:
    struct Options {
        double origin_m[3] = {0.0, 0.0, 0.0};  // of the scene's coordinates, in the world
        double reach_m = 1e6;  // the scene has the sea so far from the origin along x and y; 1 … 1e7
        double finest_cell_m =
            0.0;  // pelagic_info has it: how far a ray goes on at least behind a hit that is rejected
        double shutter_s = 0.0;  // for which the frame's shutter is open: ray times 0 … 1 go over it
        double tolerance = 0.0;  // as in pelagic_rays
        bool on_earth = false;   // bent with the earth, which touches z = 0 at the origin
    };

    // The frame must outlive it, and it every scene with it in. Throws std::runtime_error where the frame has no bounds, or Embree no memory.
    EmbreeSea(RTCDevice device, const pelagic_frame* frame, const Options& options);
    ~EmbreeSea();
    EmbreeSea(const EmbreeSea&) = delete;
    EmbreeSea& operator=(const EmbreeSea&) = delete;

    RTCGeometry geometry() const { return geometry_; }
    // The geometry's own filters, as Embree's setters take them; their geometryUserPtr is this object. Null: none. Not while rays are
    // traced; the scene must be committed again.
    void set_filters(RTCFilterFunctionN intersection, RTCFilterFunctionN occlusion);
    // After pelagic_frame_set(); the scene must be committed again. Throws as the constructor.
    void refresh(double shutter_s);

    // The first call for rays that failed. Rays of calls that fail hit nothing: Embree's callbacks can't say so.
    pelagic_status status() const { return status_.load(); }
    // For people; empty where none failed. Not while rays are traced.
    const char* message() const { return error_.message; }

  private:
    struct Batch;
    template <class Arguments>
    Batch batch_of(const Arguments& arguments, RTCRayN* rays, unsigned first) const;
    void find_bounds();
    void keep(pelagic_status status, const pelagic_error& error);
    template <class Accepts>
    void search(Batch& batch, const Accepts& accepts);
    void intersect(const RTCIntersectFunctionNArguments& arguments);
    void occluded(const RTCOccludedFunctionNArguments& arguments);

    const pelagic_frame* frame_;
    Options options_;
    RTCBounds bounds_{};
    RTCGeometry geometry_ = nullptr;
    bool has_occlusion_filter_ = false;
    std::atomic<pelagic_status> status_{PELAGIC_OK};
    std::mutex error_lock_;
    pelagic_error error_{};
};
