// The turbulent wake at a place (core/plan/wake_strip.h), for plain numbers and for GLSL: see core/base/number.h. After filter.inl, of
// which it is made.

inline constexpr double kWakeWhite_s = 4.0;    // what breaks at bow and stern: its e-folding time,
inline constexpr double kWakeWhite = 0.75;     // and its coverage
inline constexpr double kWakeBeaten_s = 90.0;  // what the propeller beats in
inline constexpr double kWakeBeaten = 0.6;
inline constexpr double kWakeDamped = 0.7;  // of short waves' amplitude, by new turbulence
inline constexpr double kWakeCalms = 1.3;   // of the strip's width: as far as they are damped
inline constexpr double kWakeWidest = 1.5;  // of the reach: a pixel's footprint
inline constexpr double kBandReach = 1.3;   // of half a band's width: where its soft edges end
inline constexpr double kBowOpens = 0.1;    // of the way: how far the bow's bands have gone outwards
inline constexpr double kBowBand = 0.08;    // of the beam: half a band's width at the bow,
inline constexpr double kBowWidens = 0.04;  // and of the way, what it has grown by

// A hull, and the age at which its wake ends.
template <class T>
struct WakeHull {
    T length_m, beam_m, foam, oldest_s;
};

// The nearest place of the path: how far off, how far along from the bow, how long ago, and how much of a wake was made there.
template <class T>
struct WakePlace {
    T off_m, way_m, age_s, strength;
};

// Coverage, 0 … 1, how long ago it broke, and how much of short waves' amplitude is damped, 0 … 1.
template <class T>
struct WakeWater {
    T foam, age_s, calm;
};

template <class T>
inline T wake_rise(T x) {
    return smooth_rise(minimum(maximum(x, T(0)), T(1)));
}

template <class T>
inline T wake_half_width(T behind_m, T length_m, T beam_m) {
    return T(0.5) * beam_m * power(T(1) + maximum(behind_m, T(0)) / (T(0.5) * length_m), T(0.2));
}

// A band round `middle_m` to either side, of soft edges; a pixel's width makes it wider and thinner.
template <class T>
inline T wake_band(T off_m, T middle_m, T half_m, T footprint_m) {
    const T wide_m = maximum(half_m, T(0.5) * footprint_m);
    return half_m / wide_m *
           wake_rise(T(1.5) * (T(1) - magnitude(off_m - middle_m) / (T(kBandReach) * wide_m)));
}

// How far the bow's bands lie off the path at most, so far along it from the bow.
template <class T>
inline T wake_bow_reach(T way_m, T beam_m) {
    return T(0.5 + kBandReach * kBowBand) * beam_m + T(kBowOpens + kBandReach * kBowWidens) * way_m;
}

// Through a pixel of this footprint [m], at most kWakeWidest of the strip's reach: a band that is spread over more would be cut off there.
template <class T>
inline WakeWater<T> wake_water(WakeHull<T> hull, WakePlace<T> at, T footprint_m) {
    const T length_m = hull.length_m, beam_m = hull.beam_m, way_m = at.way_m;
    const T behind_m = way_m - length_m, half_m = wake_half_width(behind_m, length_m, beam_m);
    const T made = at.strength * wake_rise(T(4) * (T(1) - at.age_s / hull.oldest_s));
    const T left = wake_rise(behind_m / beam_m + T(0.5)) * made;
    const T stern = left * wake_band(at.off_m, T(0), half_m, footprint_m) *
                    (T(kWakeWhite) * exponential(-at.age_s / T(kWakeWhite_s)) +
                     T(kWakeBeaten) * exponential(-at.age_s / T(kWakeBeaten_s)));
    // The bow's: from its two sides outwards, broken as it leaves the hull.
    const T ahead = maximum(T(1) - T(2) * way_m / length_m, T(0));
    const T opened_m = T(0.5) * beam_m * (T(1) - ahead * ahead) + T(kBowOpens) * way_m;
    const T bow_age_s = at.age_s + maximum(T(0.5) * length_m - way_m, T(0)) / length_m;
    const T bow = T(kWakeWhite) * exponential(-bow_age_s / T(kWakeWhite_s)) * made *
                  wake_rise(way_m / (T(0.15) * length_m)) *
                  wake_band(at.off_m, opened_m, T(kBowBand) * beam_m + T(kBowWidens) * way_m, footprint_m);
    return WakeWater<T>(
        hull.foam * minimum(T(1) - (T(1) - minimum(stern, T(1))) * (T(1) - bow), T(1)), at.age_s,
        T(kWakeDamped) * left * wake_band(at.off_m, T(0), T(kWakeCalms) * half_m, footprint_m));
}

// Foam beside what is there already, of another age: coverage and age.
template <class T>
inline T with_wake_foam(T coverage, T more) {
    return T(1) - (T(1) - coverage) * (T(1) - more);
}
// Where it is much, the age is its own.
template <class T>
inline T with_wake_age(T age_s, WakeWater<T> water) {
    return age_s + minimum(T(4) * water.foam, T(1)) * (water.age_s - age_s);
}
