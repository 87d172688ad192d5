/* The sea as a renderer asks for it: bounds of a region, the mesh that a camera sees, where a ray meets it.
 *
 *   procedural SHOT.toml FRAME MESH.obj
 *
 * Built against an installed Pelagic: cc procedural.c $(pkg-config --cflags --libs pelagic) -o procedural */
#include <pelagic/procedural.h>

#include <stdio.h>
#include <stdlib.h>

static pelagic_error error;

/* Ends the program where a call didn't do what it should. */
static void check(pelagic_status status, const char *what) {
    if (status == PELAGIC_OK) return;
    fprintf(stderr, "%s: %s: %s\n", what, pelagic_status_text(status), error.message);
    exit(1);
}

static void *room(size_t count, size_t size) {
    void *memory = malloc(count * size);
    if (!memory) {
        fprintf(stderr, "no memory for %zu values\n", count);
        exit(1);
    }
    return memory;
}

static void write_obj(const char *path, const pelagic_mesh_buffers *mesh) {
    FILE *file = fopen(path, "w");
    if (!file) {
        perror(path);
        exit(1);
    }
    for (size_t i = 0; i < mesh->points; ++i) {
        const float *position = mesh->values->position_m + 3 * i, *normal = mesh->values->normal + 3 * i;
        fprintf(file, "v %.9g %.9g %.9g\n", position[0], position[1], position[2]);
        fprintf(file, "vn %.6g %.6g %.6g\n", normal[0], normal[1], normal[2]);
    }
    for (size_t i = 0; i < mesh->corners; i += 4) {
        fprintf(file, "f");
        for (size_t k = i; k < i + 4; ++k)
            fprintf(file, " %lu//%lu", (unsigned long)mesh->corner[k] + 1, (unsigned long)mesh->corner[k] + 1);
        fprintf(file, "\n");
    }
    if (fclose(file) != 0) {
        perror(path);
        exit(1);
    }
}

int main(int argc, char **argv) {
    if (argc != 4) {
        fprintf(stderr, "usage: %s SHOT.toml FRAME MESH.obj\n", argv[0]);
        return 2;
    }

    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.path = argv[1];
    pelagic_sea *sea;
    check(pelagic_open(&source, NULL, &sea, &error), argv[1]);

    /* The sea while a shutter of half a frame is open. */
    const double number = atof(argv[2]);
    double open_s, close_s;
    check(pelagic_time_of_frame(sea, number - 0.25, &open_s, &error), "frame");
    check(pelagic_time_of_frame(sea, number + 0.25, &close_s, &error), "frame");
    pelagic_frame *frame;
    check(pelagic_frame_create(sea, open_s, close_s, &frame, &error), "frame");

    pelagic_info info = PELAGIC_INIT(pelagic_info);
    check(pelagic_get_info(sea, &info, &error), "info");
    pelagic_region region = PELAGIC_INIT(pelagic_region);
    for (int axis = 0; axis < 2; ++axis) {
        region.min_m[axis] = -info.peak_wavelength_m;
        region.max_m[axis] = info.peak_wavelength_m;
    }
    pelagic_box box = PELAGIC_INIT(pelagic_box);
    check(pelagic_bounds(frame, &region, &box, &error), "bounds");
    printf("two peak waves round the origin: %.2f to %.2f m high, significant height %.2f m\n", box.min_m[2],
           box.max_m[2], info.significant_height_m);

    /* The mesh that the shot's own camera sees, quads of four pixels. */
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    check(pelagic_shot_camera(sea, number, &camera, &error), "camera");
    pelagic_expand_options options = PELAGIC_INIT(pelagic_expand_options);
    options.cell_px = 4.0;
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    check(pelagic_expand_size(frame, &camera, &options, &size, &error), "expand");
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = room(3 * size.points, sizeof(float));
    values.normal = room(3 * size.points, sizeof(float));
    pelagic_mesh_buffers mesh = PELAGIC_INIT(pelagic_mesh_buffers);
    mesh.points = size.points;
    mesh.corners = size.corners;
    mesh.corner = room(size.corners, sizeof *mesh.corner);
    mesh.values = &values;
    check(pelagic_expand(frame, &camera, &options, &mesh, &error), "expand");
    write_obj(argv[3], &mesh);
    printf("%zu quads of %zu points, round (%.1f, %.1f) m: %s\n", size.faces, size.points, mesh.origin_m[0],
           mesh.origin_m[1], argv[3]);

    /* No mesh: what a ray through the middle of the picture meets. */
    const float spread = (float)(2.0 * camera.tan_half_width / camera.width);
    float direction[3], distance;
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    for (int axis = 0; axis < 3; ++axis) {
        rays.origin_m[axis] = camera.position_m[axis];
        direction[axis] = (float)camera.forward[axis];
    }
    rays.count = 1;
    rays.direction = direction;
    rays.spread = &spread;
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    hits.distance = &distance;
    check(pelagic_intersect(frame, &rays, &hits, &error), "intersect");
    printf("in the middle of the picture: the sea %.1f m away (infinity: none)\n", distance);

    free(mesh.corner);
    free(values.position_m);
    free(values.normal);
    pelagic_frame_release(frame);
    pelagic_close(sea);
    return 0;
}
