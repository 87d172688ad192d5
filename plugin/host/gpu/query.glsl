// The query at one point: the GPU's evaluate().

uniform float whitecap_threshold;

// Of the surface that the sea lies on, with kShaped: the includer sets it.
vec3 rest_normal = vec3(0.0, 0.0, 1.0);

// Footprints are given as width and long axis [m]. Trains follow them however long they are: (width, stretch) as
// TrainArgs has it.
vec3 train_footprint(vec3 given, float finest) {
    float width = given.x > finest ? given.x : finest;
    float along2 = dot(given.yz, given.yz);
    float beyond2 = along2 - width * width;
    return vec3(width, beyond2 > 0.0 ? sqrt(beyond2 / along2) * given.yz : vec2(0.0));
}

TrainSums with_trains(vec2 rest_m, vec3 footprint, TrainSums sums) {
    if (kCoast) return coast_pixel_trains(rest_m, footprint, sums);
    return kTrains ? pixel_trains(split_metres(rest_m), footprint, sums) : sums;
}

// Height, Dx, Dy of the point that rests at x.
vec3 query_cell(vec2 rest_m, vec3 cell) {
    Footprint footprint = footprint_of(0, kCellLevels, cell);
    vec3 sum = cell_cascades(kSea, rest_m, footprint);
    MaskGains masks = MaskGains(1.0, 0.0, 0.0, 1.0, 1.0);
    if (kMasked) masks = masks_at(rest_m);
    if (kCalmCell >= 0) sum = calm_cell(rest_m, footprint, masks, sum);
    if (kCoast) sum += coast_cell_trains(rest_m, train_footprint(cell, finest_m.x));
    else if (kTrains) sum += cell_trains(split_metres(rest_m), train_footprint(cell, finest_m.x));
    if (kMasked) sum *= masks.waves;
    return kVessels > 0 ? sum + wake_cell(rest_m, footprint) : sum;
}

// The slopes that a mesh of such cells leaves unresolved, at rest: variances (xx, yy, xy).
vec3 query_mesh_variance(vec2 rest_m, vec3 cell) {
    Footprint footprint = footprint_of(kCellLevels, kPixelLevels, cell);
    TrainSums sums = TrainSums(PixelFields(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, vec3(0.0)), vec4(0.0), unresolved_of(footprint));
    sums = with_trains(rest_m, train_footprint(cell, finest_m.y), sums);
    PixelMoments unresolved = possible_moments(sums.unresolved);
    if (kMasked) unresolved = masked_moments(unresolved, footprint, masks_at(rest_m));
    if (kVessels > 0) unresolved = with_hidden_wakes(unresolved, rest_m, footprint);
    return vec3(unresolved.xx, unresolved.yy, unresolved.xy);
}

struct AllFoam {
    float coverage;  // of all foam
    float breaking;  // of what breaks now
    float age_s;     // of what earlier breaking has left, on average
    float bubbles;   // what it has left of them, of 1 where all breaks; negative: nobody knows
};

// With the foam of wakes beside what waves leave.
AllFoam with_strips(AllFoam all, vec2 rest_m, float footprint_m) {
    for (int vessel = 0; vessel < kVessels; ++vessel) {
        WakeWater water = wake_strip(vessel, rest_m, footprint_m);
        if (!(water.foam > 0.0)) continue;
        all.coverage = with_wake_foam(all.coverage, water.foam);
        all.age_s = with_wake_age(all.age_s, water);
    }
    return all;
}

struct PixelAnswer {
    vec3 normal;
    vec3 slope_variance, slope_variance_at_rest;  // of unresolved waves: xx, yy, xy
    float coverage;
    float level;  // lower + t
};

PixelAnswer query_pixel(vec2 rest_m, vec3 pixel) {
    Footprint footprint = footprint_of(kCellLevels, kPixelLevels, pixel);
    bool apart = kCoverage && breaks_apart(footprint);
    BreakingFields breaking = BreakingFields(vec4(0.0), vec2(0.0));
    if (apart) breaking = breaking_cascades(kSea, rest_m, footprint);
    PixelFields cascades_here = pixel_cascades(kSea, rest_m, footprint);
    MaskGains masks = MaskGains(1.0, 0.0, 0.0, 1.0, 1.0);
    if (kMasked) masks = masks_at(rest_m);
    if (kCalmPixel >= 0) cascades_here = calm_pixel(rest_m, footprint, masks, cascades_here);
    vec2 before_trains = cascades_here.values.yz;
    TrainSums sums = TrainSums(cascades_here, breaking.gradient, unresolved_of(footprint));
    sums = with_trains(rest_m, train_footprint(pixel, finest_m.y), sums);
    PixelFields f = sums.fields;
    PixelMoments unresolved = possible_moments(sums.unresolved);
    if (kMasked) {
        sums.breaking = masked_gradient(sums.breaking, breaking.values + (f.values.yz - before_trains), masks);
        f = masked_fields(f, masks);
        unresolved = masked_moments(unresolved, footprint, masks);
    }
    if (kVessels > 0) {
        f = with_wakes(f, rest_m, footprint);
        if (apart) sums.breaking += breaking_cascades(kWakes, rest_m, footprint).gradient;
        unresolved = with_hidden_wakes(unresolved, rest_m, footprint);
    }
    SurfaceNormal n = surface_normal(f.slope_x, f.slope_y, f.dxx, f.dyy, f.dxy, f.dyx);
    if (kShaped)
        n = normal_on(SurfaceNormal(rest_normal.x, rest_normal.y, rest_normal.z), f.slope_x, f.slope_y, f.dxx, f.dyy, f.dxy,
                      f.dyx);
    SlopeVariances carried =
        carried_slopes(SlopeVariances(unresolved.xx, unresolved.yy, unresolved.xy), f.dxx, f.dyy, f.dxy, f.dyx);
    vec4 gradient = apart ? sums.breaking : vec4(f.dxx, f.dyy, f.dxy, f.dyx);
    GustAnswer gust = GustAnswer(1.0, whitecap_threshold);
    if (kGusts) gust = gusts_at(rest_m, pixel);
    float foam = 0.0;
    if (kCoverage)
        foam = coverage(jacobian_moments(gradient.x, gradient.y, gradient.z, gradient.w,
                                         UnresolvedGradients(unresolved.xxxx, unresolved.xxxy, unresolved.xxyy, unresolved.xyyy,
                                                      unresolved.yyyy)),
                        gust.whitecap_threshold, kThirdMoment);
    if (kSurf && kCoverage) foam += (1.0 - foam) * surf_foam(rest_m, f.values.x, pixel.x > finest_m.y ? pixel.x : finest_m.y);
    if (kMasked) foam *= masks.foam;
    return PixelAnswer(vec3(n.x, n.y, n.z), gust.factor * vec3(carried.xx, carried.yy, carried.xy),
                       vec3(unresolved.xx, unresolved.yy, unresolved.xy), foam, float(footprint.blend.lower) + footprint.blend.t);
}
