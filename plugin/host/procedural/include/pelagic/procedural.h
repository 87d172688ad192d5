/* The sea while a renderer asks for it: no mesh on disk, no cache. C99 and C++.
 *
 *   pelagic_sea *sea;      what a shot file describes, built once
 *   pelagic_frame *frame;  the sea while the shutter is open
 *
 *   pelagic_open(&source, NULL, &sea, &error);
 *   pelagic_vessel_at(sea, 0, frame_number, &vessel, &error);
 *   pelagic_frame_create(sea, open_s, close_s, &frame, &error);
 *   pelagic_bounds(frame, &region, &box, &error);
 *   pelagic_expand_size(frame, &camera, &options, &size, &error);
 *   pelagic_expand(frame, &camera, &options, &buffers, &error);
 *   pelagic_prepare(frame, &points, &error);
 *   pelagic_evaluate(frame, &points, &values, &error);
 *   pelagic_water_at(frame, places, count, footprint_m, water, &error);
 *   pelagic_intersect(frame, &rays, &hits, &error);
 *   pelagic_cancel(sea, 1, &error);  from another thread: the calls that run end
 *   pelagic_frame_release(frame);
 *   pelagic_close(sea);
 *
 * Units: metres, seconds of the sea, radians; z is up, and z = 0 is the sea at rest. Where a shot is in slow motion
 * (pelagic_info.time_scale isn't 1), a second on the screen is time_scale seconds of the sea: velocities of the picture are those here
 * times time_scale. Places in the world are doubles. Points of a batch
 * are floats, relative to an origin in double, so that a sea a million metres away loses nothing.
 *
 * At rest, and displaced. Waves move water to the side as well as up. A place at rest names a point of the surface: pelagic_evaluate()
 * says where it is. Regions and points are at rest wherever this header says so.
 *
 * Footprints. A place is asked for with the width of what will be seen of it [m]. Its cell is that of positions and velocities: the
 * distance to the neighbours in a mesh, or the width of a ray. Its pixel is that of normals, slope variance and coverage. Waves
 * that are too short for a footprint are left out of the shape; of the slopes they are in the variance.
 *
 * Motion. During the shutter each point moves in a straight line, with its velocity in the middle of the shutter. At the ends of 1/48 s that
 * differs from its way by g/2 (1/96 s)² times the slope of its wave at most: by 0.2 mm.
 *
 * Threads. Any number of seas and frames at once. A sea is immutable: any number of threads may use it. So is a frame, except while
 * pelagic_frame_set() or pelagic_frame_release() runs on it. pelagic_open(), pelagic_frame_create(), pelagic_frame_set(),
 * pelagic_prepare(), pelagic_expand_size() and pelagic_expand() use several threads (pelagic_open_options.threads); all others work on the calling thread
 * alone, because renderers bring their own. Values don't depend on the number of threads, nor on what was asked before. Where foam is
 * persistent, calls that want coverage or age_s look into its past one after another. FFTW's planner, of which a process has one, is
 * made safe between threads (fftwf_make_planner_thread_safe) by the first frame: a host that plans with FFTW itself shares its lock.
 * A thread that calls needs 1 MiB of stack: points are worked on in batches that lie there. Whatever rounding, flushing and trapping of
 * exceptions the calling thread has set (MXCSR), values are the same, and it has them again afterwards.
 *
 * Errors. Each function returns a status. Where it isn't PELAGIC_OK, `error`, which may be null, has a sentence for people. What is refused
 * (PELAGIC_INVALID_ARGUMENT, PELAGIC_SHOT_REFUSED, PELAGIC_TOO_SMALL) leaves all results as they were; after other failures what buffers
 * hold isn't known, and a frame that couldn't be set must be set again. No exception leaves a function. Nothing is kept between calls but
 * in the handles, and FFTW's own table of plans.
 *
 * Unloading. Once loaded the library stays in its process: threads that it has started wait in it for more to do. dlclose() is
 * allowed at any time, loads and unloads may follow each other, and handles that are open go on.
 *
 * Structures begin with their own size: set it by PELAGIC_INIT, so that a program and a later version of the library understand
 * each other. New members come at the end, and 0 in them means what earlier versions did. A program that asks for what only a later
 * version has is refused, and so is a size above 4096, which no version has.
 */
#ifndef PELAGIC_PROCEDURAL_H
#define PELAGIC_PROCEDURAL_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define PELAGIC_API
#else
#define PELAGIC_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* A structure with its size, and zeros in the rest: pelagic_camera camera = PELAGIC_INIT(pelagic_camera); */
#ifdef __cplusplus
#define PELAGIC_INIT(type)               \
    [] {                                 \
        type of_zeros{};                 \
        of_zeros.size = sizeof of_zeros; \
        return of_zeros;                 \
    }()
#else
#define PELAGIC_INIT(type) \
    { .size = sizeof(type) }
#endif

typedef enum pelagic_status {
    PELAGIC_OK = 0,
    PELAGIC_INVALID_ARGUMENT = 1, /* a null where there must be none, a number that isn't accepted */
    PELAGIC_SHOT_REFUSED = 2,     /* the shot file: the message has a line for each mistake, with its place */
    PELAGIC_TOO_SMALL = 3,        /* a buffer for what pelagic_expand() has to say */
    PELAGIC_OUT_OF_MEMORY = 4,
    PELAGIC_CANCELLED = 5,
    PELAGIC_FAILED = 6 /* anything else */
} pelagic_status;

/* Ends with a zero; cut where it is longer. */
typedef struct pelagic_error {
    char message[2048];
} pelagic_error;

typedef struct pelagic_sea pelagic_sea;
typedef struct pelagic_frame pelagic_frame;

/* "0.1.0": that of the library; pelagic/version.h has that of the headers. */
PELAGIC_API const char* pelagic_version(void);
/* "invalid argument", … */
PELAGIC_API const char* pelagic_status_text(pelagic_status status);

/* ---- A sea */

/* A shot: a file, or a text that is already in memory. */
typedef struct pelagic_source {
    size_t size;
    const char*
        path; /* UTF-8. With `text`: the name that messages use; files that the shot names are relative to its folder */
    const char* text;   /* null: the file is read */
    size_t text_length; /* 0: up to the text's own zero */
} pelagic_source;

typedef struct pelagic_open_options {
    size_t size;
    /* No finer cells and pixels will be asked for; those that are count as this. One alone stands for both. Both 0: as fine as the shot's own camera sees the
     * sea with cells of 2 pixels, or coarser where a frame of that would hold more than 256 MiB (pelagic_get_info() says what it is).
     * What a frame holds and takes rises with them. Pixels are no coarser than cells. */
    double finest_cell_m, finest_pixel_m;
    int threads; /* at most so many, and no more than the machine has; 0: all */
    /* Called while the sea is built, 0 … 1, one call at a time, from any thread; not 0 ends pelagic_open() with PELAGIC_CANCELLED.
     * It must return, and must not wait for the thread that called pelagic_open(). */
    int (*progress)(double done, void* user);
    void* user;
    size_t ray_cache_bytes; /* what a frame keeps for rays at most; 0: 256 MiB */
    /* A sea whose frame would hold more, with its foam's past as if coverage were asked for everywhere (pelagic_info.frame_bytes,
     * foam_bytes), is refused before any work, and the message says what takes how much; 0: what the machine has, or less where a container or a
     * limit allows less. What rays keep comes beside it. Coarser: finest_cell_m; no past: effects.foam_decay_s = 0 in the shot. */
    size_t max_memory_bytes;
    /* Called by pelagic_open(), on its thread, with each note on a shot that is fine but for something that its author may not have
     * meant: a sentence, and the shot's name before it; null: nobody is told. With `user`. */
    void (*note)(const char* sentence, void* user);
} pelagic_open_options;

/* Reads, validates and builds: from milliseconds to seconds. `options` may be null. */
PELAGIC_API pelagic_status pelagic_open(const pelagic_source* source, const pelagic_open_options* options,
                                        pelagic_sea** sea, pelagic_error* error);
/* Not 0: calls that run on the sea's frames, or begin, end with PELAGIC_CANCELLED as soon as they can, until it is set back to 0; what they were to write is
 * worthless, and a frame that was being set has no time until it is set again: whatever is asked of it is PELAGIC_INVALID_ARGUMENT until then. Any thread may call it, while others use the sea. Bounds
 * are short and go on. Frames of a sea that is closed stay as it was when it was. */
PELAGIC_API pelagic_status pelagic_cancel(const pelagic_sea* sea, int cancelled, pelagic_error* error);
/* Frames keep what they need of it: they may be released later. Null is nothing to close. */
PELAGIC_API void pelagic_close(pelagic_sea* sea);

/* What a shot says, for hosts that want to know. */
typedef struct pelagic_info {
    size_t size;
    int first_frame, last_frame;
    double frames_per_second;
    double time_scale;           /* seconds of the sea in a second on the screen */
    double loop_s;               /* after which the sea is the same again; 0: never */
    double significant_height_m; /* Hs; of a sea that changes, at its first key */
    double peak_wavelength_m;    /* of a sea that changes, of its keys' mean */
    double finest_cell_m,
        finest_pixel_m; /* what is asked for finer, by points and rays, counts as this: of wave trains at least 1/64 of the shortest */
    size_t
        frame_bytes; /* what a frame holds; beside it bounds keep up to three times as much, rays up to ray_cache_bytes */
    size_t
        foam_bytes; /* what a frame keeps of its foam's past, where coverage or age_s is asked for everywhere */
    size_t vessels; /* of waves.vessels: what pelagic_vessel_at() knows */
} pelagic_info;
PELAGIC_API pelagic_status pelagic_get_info(const pelagic_sea* sea, pelagic_info* info, pelagic_error* error);

/* The time of a frame of the shot [s]; frames may lie between frames. In a loop it goes on rising: the sea repeats by itself. */
PELAGIC_API pelagic_status pelagic_time_of_frame(const pelagic_sea* sea, double frame, double* time_s,
                                                 pelagic_error* error);

/* A pinhole whose pixels are square. */
typedef struct pelagic_camera {
    size_t size;
    double position_m[3];
    double right[3], up[3], forward[3]; /* unit vectors in the world; up = right × forward */
    double tan_half_width;              /* tangent of half the horizontal field of view */
    int width, height;                  /* pixels */
} pelagic_camera;
/* The shot's own at a frame. */
PELAGIC_API pelagic_status pelagic_shot_camera(const pelagic_sea* sea, double frame, pelagic_camera* camera,
                                               pelagic_error* error);

/* ---- Vessels */

/* One of waves.vessels, which makes a wake, on its path in calm water. Waves move what floats on top of that: the water at points of the hull is
 * pelagic_water_at() of position_m + x ahead + y port. The wake is in it. */
typedef struct pelagic_vessel {
    size_t size;
    double position_m[3];               /* the middle of the hull at the water, whose z is 0 */
    double ahead[3], port[3], up[3];    /* unit vectors in the world: to the bow, to port, upwards */
    double velocity_mps[3];             /* per second of the sea */
    double length_m, beam_m, draught_m; /* of the hull in the water */
} pelagic_vessel;
/* The vessel'th, from 0, at a frame of the shot, which may lie between frames and outside its range: that instant,
 * whatever the shutter. pelagic_water_at() answers for the middle of the shutter: for both to agree, give the frame at that middle. */
PELAGIC_API pelagic_status pelagic_vessel_at(const pelagic_sea* sea, size_t vessel, double frame,
                                             pelagic_vessel* at, pelagic_error* error);

/* ---- A frame */

/* The sea from open_s to close_s, no more than a second later; the same twice: a moment. Runs the frame's transforms: pelagic_frame_set() again into the
 * same memory. */
PELAGIC_API pelagic_status pelagic_frame_create(const pelagic_sea* sea, double open_s, double close_s,
                                                pelagic_frame** frame, pelagic_error* error);
PELAGIC_API pelagic_status pelagic_frame_set(pelagic_frame* frame, double open_s, double close_s,
                                             pelagic_error* error);
/* Null is nothing to release. */
PELAGIC_API void pelagic_frame_release(pelagic_frame* frame);

/* ---- Bounds */

/* At rest, in the world, as far out as cameras may be (1e9 m); edges belong to it. */
typedef struct pelagic_region {
    size_t size;
    double min_m[2], max_m[2];
    double finest_cell_m, coarsest_cell_m; /* of what will be asked for there; 0: the finest there is; any */
} pelagic_region;
typedef struct pelagic_box {
    size_t size;
    double min_m[3], max_m[3];
} pelagic_box;
/* A box in the world that all displaced points of the region stay in while the shutter is open. It is never left by what
 * pelagic_evaluate() answers for those footprints. Some 0.1 s, more with trains, and as much again for the first question
 * about a footprint. */
PELAGIC_API pelagic_status pelagic_bounds(const pelagic_frame* frame, const pelagic_region* region,
                                          pelagic_box* box, pelagic_error* error);

/* ---- Points */

typedef struct pelagic_points {
    size_t size;
    double origin_m[2]; /* of the points, in the world */
    size_t count;
    const float* rest_m;  /* x, y of each, relative to the origin */
    const float* cell_m;  /* of each; null: the finest there is */
    const float* pixel_m; /* of each; null: the finest there is */
    /* Of each, from the shutter's opening (0) to its closing (close_s - open_s); null: its middle. One that lies outside by more than
     * arithmetic in single precision rounds (2 FLT_EPSILON of the shutter's length) or is no number is refused; of a moment all are 0.
     * Positions follow it; normals, variances and coverage are those of the middle. */
    const float* time_s;
} pelagic_points;

/* Buffers of the caller, as long as there are points; null: not wanted, and not computed. */
typedef struct pelagic_values {
    size_t size;
    float* position_m;     /* x, y, z, relative to the origin at z = 0 */
    float* normal;         /* x, y, z: unit; z is negative where the surface has folded over */
    float* velocity_mps;   /* x, y, z: orbital, of linear waves; no Stokes drift is in it */
    float* slope_variance; /* xx, yy, xy of the slopes that a pixel doesn't resolve */
    /* All foam, 0 … 1: what breaks now, and where the shot has persistent foam (effects.foam_decay_s) what earlier breaking has left.
     * To a program whose structure ends here, as version 0.1.0 had it: what breaks now, as if no foam were persistent. */
    float* coverage;
    float* breaking; /* what of the coverage breaks now, 0 … 1 */
    float* age_s;    /* the mean age of the foam that is there, what breaks now counting as 0 */
} pelagic_values;

/* Before coverage or age_s is asked for at many places, in one call or in many: goes through the past of their foam once, with
 * several threads; a time soon after another takes much less. Without, the call that meets a new place does
 * it alone. Nothing but time depends on it; of points, only the places and pixels count. */
PELAGIC_API pelagic_status pelagic_prepare(const pelagic_frame* frame, const pelagic_points* points,
                                           pelagic_error* error);

/* Each value depends on its point alone, and is finite where the point's place is. */
PELAGIC_API pelagic_status pelagic_evaluate(const pelagic_frame* frame, const pelagic_points* points,
                                            const pelagic_values* values, pelagic_error* error);

/* ---- The water above places */

typedef struct pelagic_water {
    size_t size;
    float height_m;        /* z, in the world */
    float normal[3];       /* unit */
    float velocity_mps[3]; /* of the water at that height */
} pelagic_water;

/* The water above `count` places (x, y) of the world, in the middle of the shutter: what floats there asks it. The points at rest that are
 * displaced to the places are found by iteration, to a millimetre but for a few places of a sea that folds much; where the surface has folded over itself its highest sheet counts.
 * footprint_m: about the width of what floats; waves shorter than twice that are left out; 0: the finest there is. `water`: an array as
 * long as the places, each as large as the size of the first says. Each answer depends on its place alone, and is finite; what is no
 * place is refused. Some 10 us a place (with wave trains 0.2 us a train) and, where the surface has folded nearby, up to a millisecond. */
PELAGIC_API pelagic_status pelagic_water_at(const pelagic_frame* frame, const double* places_m, size_t count,
                                            double footprint_m, pelagic_water* water, pelagic_error* error);

/* ---- Rays */

typedef struct pelagic_rays {
    size_t size;
    double origin_m[3]; /* of the batch, in the world */
    size_t count;
    const float* offset_m;    /* x, y, z of where each begins, relative to the origin; null: there */
    const float* direction;   /* x, y, z of each, of any length: distances are counted in it */
    const float *near, *far;  /* distances between which each counts; null: 0, and without end */
    const float* time_s;      /* of each, as in pelagic_points; null: the shutter's middle */
    const float* footprint_m; /* width of each where it begins; null: 0 */
    const float*
        spread; /* how much each widens in a metre: of a pixel's ray, the tangent of its angle; null: 0 */
    double tolerance; /* how far from the surface hits may lie, in footprints: 0.05 ... 4; 0: 0.5 */
    int on_earth;     /* 0: flat; 1: the sea is bent with the earth, which touches z = 0 at the origin */
} pelagic_rays;

/* Buffers of the caller, as long as there are rays; null: not wanted, and not computed. */
typedef struct pelagic_hits {
    size_t size;
    float* distance;    /* in lengths of the direction; infinity: the ray hits nothing */
    float* rest_m;      /* x, y of the place at rest, relative to the origin, on a flat sea */
    float* footprint_m; /* of the ray there */
    /* Of each hit, as pelagic_evaluate() has them for the place at rest, with the footprint as cell and pixel; the position is that on the ray,
     * at its time and, on the earth, on the bent sea, for which normals and velocities are turned too. Zeros where there is none.
     * null: not wanted. */
    const pelagic_values* values;
} pelagic_hits;

/* The first place where each ray meets the sea, from above or from below. The sea is the exact surface of the frame's finest cells, but for the
 * tolerance: a hit lies no farther from it than tolerance x footprint, a ray that goes deeper through it has a hit, and one that stays
 * further away has none. That is by samples of the frame, of which five standard deviations are within the tolerance. Footprints below
 * pelagic_info.finest_cell_m count as that.
 *
 * A ray that begins within the tolerance of the surface may begin on its other side. A ray that has gone between the heights of the highest
 * crest and the lowest trough for 32 km meets the sea at rest from there on; on the earth, one that goes down from below all waves
 * hits nothing. None is followed further than 1e12 m. A ray that isn't finite,
 * has no direction or begins more than 1e10 m away from the origin hits nothing; a negative near, footprint or spread counts as 0.
 *
 * What rays ask for first is worked out then and kept while there is room, about ray_cache_bytes and, of each call that runs, what its last
 * ray took; hits don't depend on that. */
PELAGIC_API pelagic_status pelagic_intersect(const pelagic_frame* frame, const pelagic_rays* rays,
                                             const pelagic_hits* hits, pelagic_error* error);
/* Whether each ray meets the sea at all: 1 or 0. Less work than the first place. */
PELAGIC_API pelagic_status pelagic_occluded(const pelagic_frame* frame, const pelagic_rays* rays,
                                            unsigned char* occluded, pelagic_error* error);

/* ---- A mesh for a camera */

typedef struct pelagic_expand_options {
    size_t size;
    double
        cell_px; /* the side of a cell on the screen, 0.25 … 1000 pixels; 0: 2. No mesh has more than 8192 × 8192 cells. */
    int triangles; /* 0: quads; 1: triangles */
    int on_earth; /* 0: flat, as points and bounds are; 1: bent with the earth, which touches z = 0 below the camera */
    /* Instead of cell_px, 0.01 … 100 pixels: cells as large as keep 95 % of the sea in the picture so near to the surface of the finest cells,
     * along its normal; up to 8 pixels large, and no smaller than 0.25. Found by samples, which takes up to half as long
     * as the mesh; the frame remembers the last. 0: not asked. */
    double error_px;
} pelagic_expand_options;
typedef struct pelagic_mesh_size {
    size_t size;
    size_t points, faces, corners; /* corners of all faces: 4 or 3 of each */
} pelagic_mesh_size;
PELAGIC_API pelagic_status pelagic_expand_size(const pelagic_frame* frame, const pelagic_camera* camera,
                                               const pelagic_expand_options* options,
                                               pelagic_mesh_size* mesh_size, pelagic_error* error);

typedef struct pelagic_mesh_buffers {
    size_t size;
    size_t points, corners; /* how many the buffers have room for; out: how many there are */
    uint32_t*
        corner; /* indices of points, face after face, counter-clockwise seen from above; null: not wanted */
    float* rest_m; /* x, y of each point, relative to origin_m, on a flat sea; null: not wanted */
    const pelagic_values* values; /* of each point, in the middle of the shutter; null: not wanted */
    double origin_m[3];           /* out: what positions are relative to: below the camera, at z = 0 */
} pelagic_mesh_buffers;
/* All of the sea that may be in view from there while the shutter is open, with cells that are as large on the screen as `options` say:
 * they grow with distance, and each point has the waves that its cells resolve. Cells that are longer than wide filter each wave
 * by their length in its direction, so that positions aren't exactly those of pelagic_evaluate(), and may leave a box of the same region
 * by little. `options` may be null. */
PELAGIC_API pelagic_status pelagic_expand(const pelagic_frame* frame, const pelagic_camera* camera,
                                          const pelagic_expand_options* options,
                                          pelagic_mesh_buffers* buffers, pelagic_error* error);

#ifdef __cplusplus
}
#endif
#endif
