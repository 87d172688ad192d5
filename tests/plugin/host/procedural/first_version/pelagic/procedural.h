/* The C interface as version 0.1.0 had it, without its comments: what programs of that time were compiled with. */
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
    PELAGIC_INVALID_ARGUMENT = 1,
    PELAGIC_SHOT_REFUSED = 2,
    PELAGIC_TOO_SMALL = 3,
    PELAGIC_OUT_OF_MEMORY = 4,
    PELAGIC_CANCELLED = 5,
    PELAGIC_FAILED = 6
} pelagic_status;
typedef struct pelagic_error {
    char message[2048];
} pelagic_error;
typedef struct pelagic_sea pelagic_sea;
typedef struct pelagic_frame pelagic_frame;
PELAGIC_API const char* pelagic_version(void);
PELAGIC_API const char* pelagic_status_text(pelagic_status status);
typedef struct pelagic_source {
    size_t size;
    const char* path;
    const char* text;
    size_t text_length;
} pelagic_source;
typedef struct pelagic_open_options {
    size_t size;
    double finest_cell_m, finest_pixel_m;
    int threads;
    int (*progress)(double done, void* user);
    void* user;
    size_t ray_cache_bytes;
} pelagic_open_options;
PELAGIC_API pelagic_status pelagic_open(const pelagic_source* source, const pelagic_open_options* options,
                                        pelagic_sea** sea, pelagic_error* error);
PELAGIC_API void pelagic_close(pelagic_sea* sea);
typedef struct pelagic_info {
    size_t size;
    int first_frame, last_frame;
    double frames_per_second;
    double time_scale;
    double loop_s;
    double significant_height_m;
    double peak_wavelength_m;
    double finest_cell_m, finest_pixel_m;
    size_t frame_bytes;
} pelagic_info;
PELAGIC_API pelagic_status pelagic_get_info(const pelagic_sea* sea, pelagic_info* info, pelagic_error* error);
PELAGIC_API pelagic_status pelagic_time_of_frame(const pelagic_sea* sea, double frame, double* time_s,
                                                 pelagic_error* error);
typedef struct pelagic_camera {
    size_t size;
    double position_m[3];
    double right[3], up[3], forward[3];
    double tan_half_width;
    int width, height;
} pelagic_camera;
PELAGIC_API pelagic_status pelagic_shot_camera(const pelagic_sea* sea, double frame, pelagic_camera* camera,
                                               pelagic_error* error);
PELAGIC_API pelagic_status pelagic_frame_create(const pelagic_sea* sea, double open_s, double close_s,
                                                pelagic_frame** frame, pelagic_error* error);
PELAGIC_API pelagic_status pelagic_frame_set(pelagic_frame* frame, double open_s, double close_s,
                                             pelagic_error* error);
PELAGIC_API void pelagic_frame_release(pelagic_frame* frame);
typedef struct pelagic_region {
    size_t size;
    double min_m[2], max_m[2];
    double finest_cell_m, coarsest_cell_m;
} pelagic_region;
typedef struct pelagic_box {
    size_t size;
    double min_m[3], max_m[3];
} pelagic_box;
PELAGIC_API pelagic_status pelagic_bounds(const pelagic_frame* frame, const pelagic_region* region,
                                          pelagic_box* box, pelagic_error* error);
typedef struct pelagic_points {
    size_t size;
    double origin_m[2];
    size_t count;
    const float* rest_m;
    const float* cell_m;
    const float* pixel_m;
    const float* time_s;
} pelagic_points;
typedef struct pelagic_values {
    size_t size;
    float* position_m;
    float* normal;
    float* velocity_mps;
    float* slope_variance;
    float* coverage;
} pelagic_values;
PELAGIC_API pelagic_status pelagic_evaluate(const pelagic_frame* frame, const pelagic_points* points,
                                            const pelagic_values* values, pelagic_error* error);
typedef struct pelagic_rays {
    size_t size;
    double origin_m[3];
    size_t count;
    const float* offset_m;
    const float* direction;
    const float *near, *far;
    const float* time_s;
    const float* footprint_m;
    const float* spread;
    double tolerance;
    int on_earth;
} pelagic_rays;
typedef struct pelagic_hits {
    size_t size;
    float* distance;
    float* rest_m;
    float* footprint_m;
    const pelagic_values* values;
} pelagic_hits;
PELAGIC_API pelagic_status pelagic_intersect(const pelagic_frame* frame, const pelagic_rays* rays,
                                             const pelagic_hits* hits, pelagic_error* error);
PELAGIC_API pelagic_status pelagic_occluded(const pelagic_frame* frame, const pelagic_rays* rays,
                                            unsigned char* occluded, pelagic_error* error);
typedef struct pelagic_expand_options {
    size_t size;
    double cell_px;
    int triangles;
    int on_earth;
    double error_px;
} pelagic_expand_options;
typedef struct pelagic_mesh_size {
    size_t size;
    size_t points, faces, corners;
} pelagic_mesh_size;
PELAGIC_API pelagic_status pelagic_expand_size(const pelagic_frame* frame, const pelagic_camera* camera,
                                               const pelagic_expand_options* options,
                                               pelagic_mesh_size* mesh_size, pelagic_error* error);
typedef struct pelagic_mesh_buffers {
    size_t size;
    size_t points, corners;
    uint32_t* corner;
    float* rest_m;
    const pelagic_values* values;
    double origin_m[3];
} pelagic_mesh_buffers;
PELAGIC_API pelagic_status pelagic_expand(const pelagic_frame* frame, const pelagic_camera* camera,
                                          const pelagic_expand_options* options,
                                          pelagic_mesh_buffers* buffers, pelagic_error* error);
#ifdef __cplusplus
}
#endif
#endif
