// The query at one point: the GPU's evaluate().

uniform float whitecap_threshold;
uniform vec2 finest_m;  // the finest footprints of cells and pixels; trains are filtered no finer

float long_side(vec3 footprint_m) { return max(footprint_m.x, length(footprint_m.yz)); }

// Height, Dx, Dy of the point that rests at x.
vec3 query_cell(vec2 rest_m, vec3 cell) {
    float cell_m = long_side(cell);
    SplitMetres x = split_metres(rest_m);
    vec3 sum = cell_cascades(x, cell_m);
    if (kTrains) sum += cell_trains(x, cell_m > finest_m.x ? cell_m : finest_m.x);
    return sum;
}

struct PixelAnswer {
    vec3 normal;
    PixelMoments hidden;
    float coverage;
    float rung;  // lower + t
};

PixelAnswer query_pixel(vec2 rest_m, vec3 pixel) {
    float pixel_m = long_side(pixel);
    SplitMetres x = split_metres(rest_m);
    Rung rung = rung_of(kCellRungs, kPixelRungs, pixel_m);
    TrainSums sums = TrainSums(pixel_cascades(x, rung), hidden_of(rung));
    if (kTrains) sums = pixel_trains(x, pixel_m > finest_m.y ? pixel_m : finest_m.y, sums);
    PixelFields f = sums.fields;
    PixelMoments hidden = possible_moments(sums.hidden);
    SurfaceNormal n = surface_normal(f.slope_x, f.slope_y, f.dxx, f.dyy, f.dxy);
    float foam = 0.0;
    if (kCoverage)
        foam = coverage(jacobian_moments(f.dxx, f.dyy, f.dxy,
                                         HiddenStrain(hidden.xxxx, hidden.xxxy, hidden.xxyy, hidden.xyyy,
                                                      hidden.yyyy)),
                        whitecap_threshold, kThirdMoment);
    return PixelAnswer(vec3(n.x, n.y, n.z), hidden, foam, float(rung.lower) + rung.t);
}
