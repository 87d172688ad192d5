// The query at one point: the GPU's evaluate().

uniform float whitecap_threshold;

// Footprints are given as width and long axis [m]. Trains follow them however long they are: (width, stretch) as
// TrainArgs has it.
vec3 train_footprint(vec3 given, float finest) {
    float width = given.x > finest ? given.x : finest;
    float along2 = dot(given.yz, given.yz);
    float beyond2 = along2 - width * width;
    return vec3(width, beyond2 > 0.0 ? sqrt(beyond2 / along2) * given.yz : vec2(0.0));
}

// Height, Dx, Dy of the point that rests at x.
vec3 query_cell(vec2 rest_m, vec3 cell) {
    vec3 sum = cell_cascades(rest_m, footprint_of(0, kCellRungs, cell));
    if (kTrains) sum += cell_trains(split_metres(rest_m), train_footprint(cell, finest_m.x));
    return sum;
}

// The slopes that a mesh of such cells leaves unresolved, at rest: variances (xx, yy, xy).
vec3 query_mesh_variance(vec2 rest_m, vec3 cell) {
    Footprint footprint = footprint_of(kCellRungs, kPixelRungs, cell);
    TrainSums sums = TrainSums(PixelFields(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), vec4(0.0), hidden_of(footprint));
    if (kTrains) sums = pixel_trains(split_metres(rest_m), train_footprint(cell, finest_m.y), sums);
    PixelMoments hidden = possible_moments(sums.hidden);
    return vec3(hidden.xx, hidden.yy, hidden.xy);
}

struct AllFoam {
    float coverage;  // of all foam
    float breaking;  // of what breaks now
    float age_s;     // of what earlier breaking has left, on average
};

struct PixelAnswer {
    vec3 normal;
    vec3 slope_variance, slope_variance_at_rest;  // of unresolved waves: xx, yy, xy
    float coverage;
    float rung;  // lower + t
};

PixelAnswer query_pixel(vec2 rest_m, vec3 pixel) {
    Footprint footprint = footprint_of(kCellRungs, kPixelRungs, pixel);
    bool apart = kCoverage && breaks_apart(footprint);
    vec4 breaking = apart ? breaking_cascades(rest_m, footprint) : vec4(0.0);
    TrainSums sums = TrainSums(pixel_cascades(rest_m, footprint), breaking, hidden_of(footprint));
    if (kTrains) sums = pixel_trains(split_metres(rest_m), train_footprint(pixel, finest_m.y), sums);
    PixelFields f = sums.fields;
    PixelMoments hidden = possible_moments(sums.hidden);
    SurfaceNormal n = surface_normal(f.slope_x, f.slope_y, f.dxx, f.dyy, f.dxy, f.dyx);
    SlopeVariances carried =
        carried_slopes(SlopeVariances(hidden.xx, hidden.yy, hidden.xy), f.dxx, f.dyy, f.dxy, f.dyx);
    vec4 strain = apart ? sums.breaking : vec4(f.dxx, f.dyy, f.dxy, f.dyx);
    GustAnswer gust = GustAnswer(1.0, whitecap_threshold);
    if (kGusts) gust = gusts_at(rest_m, pixel);
    float foam = 0.0;
    if (kCoverage)
        foam = coverage(jacobian_moments(strain.x, strain.y, strain.z, strain.w,
                                         HiddenStrain(hidden.xxxx, hidden.xxxy, hidden.xxyy, hidden.xyyy,
                                                      hidden.yyyy)),
                        gust.whitecap_threshold, kThirdMoment);
    return PixelAnswer(vec3(n.x, n.y, n.z), gust.factor * vec3(carried.xx, carried.yy, carried.xy),
                       vec3(hidden.xx, hidden.yy, hidden.xy), foam, float(footprint.rung.lower) + footprint.rung.t);
}
