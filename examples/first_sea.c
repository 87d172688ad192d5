/* The water at a buoy, in four lines of C: a shot, its sea, a moment, a place.
 *
 *   cc first_sea.c $(pkg-config --cflags --libs pelagic) -o first_sea && ./first_sea SHOT.toml */
#include <pelagic/procedural.h>

#include <stdio.h>

static pelagic_error error;
static pelagic_sea *sea;
static pelagic_frame *frame;
static pelagic_water water = PELAGIC_INIT(pelagic_water);

static pelagic_status ask(const char *path) {
    const pelagic_source source = {.size = sizeof source, .path = path};
    return pelagic_open(&source, NULL, &sea, &error) ||
           pelagic_frame_create(sea, 3.0, 3.0, &frame, &error) || /* seconds: the shutter opens and closes */
           pelagic_water_at(frame, (double[]){3.0, -8.0}, 1, 0.5, &water, &error); /* metres */
}

int main(int argc, char **argv) {
    const pelagic_status status = ask(argc > 1 ? argv[1] : "shot.toml");
    if (status == PELAGIC_OK)
        printf("%+.2f m high, tilted by %.2f, rising at %+.2f m/s\n", water.height_m, 1.0f - water.normal[2],
               water.velocity_mps[2]);
    else
        fprintf(stderr, "%s\n", error.message);
    pelagic_frame_release(frame);
    pelagic_close(sea);
    return status;
}
