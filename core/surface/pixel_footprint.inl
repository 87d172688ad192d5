// What a pixel covers of the sea that is drawn, for plain numbers and for GLSL: see core/base/number.h.

// As in Points (core/evaluate/evaluate.h): the short axis, and the long one as a vector [m].
template <class T>
struct PixelFootprint {
    T width, axis_x, axis_y;
};

// The ellipse of a pixel whose sides are these vectors on the horizontal plane: the axes of the matrix that has them
// as columns. The long axis is at most so long, > 0: seen edge-on a surface would have a footprint without end.
template <class T>
inline PixelFootprint<T> pixel_footprint(T right_x, T right_y, T up_x, T up_y, T longest) {
    // In units of `longest`, so that no square overflows.
    const T ax = right_x / longest, ay = right_y / longest, bx = up_x / longest, by = up_y / longest;
    const T xx = ax * ax + bx * bx, yy = ay * ay + by * by, xy = ax * ay + bx * by;
    const T middle = T(0.5) * (xx - yy), root = square_root(middle * middle + xy * xy);
    const T along = square_root(T(0.5) * (xx + yy) + root);
    const T across = magnitude(ax * by - ay * bx) / select(along > T(0), along, T(1));
    // The eigenvector without cancellation; of a circle any.
    const T x = select(middle > T(0), middle + root, xy), y = select(middle > T(0), xy, root - middle);
    const T length = square_root(x * x + y * y);
    const T scale = longest * minimum(along, T(1)) / select(length > T(0), length, T(1));
    return PixelFootprint<T>(longest * minimum(across, T(1)), select(length > T(0), x * scale, scale),
                             y * scale);
}

// The same on the plane of a mesh's triangle. `at_rest`: the ellipse on the sea at rest; its width is the pixel's at this
// distance. right, up: unit vectors along the picture's sides; ray: through the pixel, 1 along the optical axis; all
// of them their horizontal parts. nearer_right, nearer_up: how 1/w grows from pixel to pixel, as a part of itself and
// in units of the tangent that a pixel covers; w is the distance along the optical axis. A step in the picture leads
// from ray·w to (ray + right)·w/(1 + nearer_right).
//
// The slope matters most near crests: a triangle that is nearly edge-on shows in one pixel what a flat sea shows in
// ten. With the flat sea's footprint it would be shaded with any one of its many colours, another one in each frame.
// The length is at most four times the flat sea's: beyond that the pixel shows the next triangle.
template <class T>
inline PixelFootprint<T> footprint_on_mesh(PixelFootprint<T> at_rest, T right_x, T right_y, T up_x, T up_y,
                                           T ray_x, T ray_y, T nearer_right, T nearer_up) {
    const T longest =
        T(4) * maximum(square_root(at_rest.axis_x * at_rest.axis_x + at_rest.axis_y * at_rest.axis_y),
                       at_rest.width);
    // A flat sea straight below, or nothing is known.
    if (!(nearer_right != T(0) || nearer_up != T(0)) || !(longest > T(0))) return at_rest;
    // Limits triangles that are nearly edge-on, so that squares stay finite.
    const T most = T(1000000);
    const T r = minimum(maximum(nearer_right, -most), most), u = minimum(maximum(nearer_up, -most), most);
    return pixel_footprint(at_rest.width * (right_x - ray_x * r), at_rest.width * (right_y - ray_y * r),
                           at_rest.width * (up_x - ray_x * u), at_rest.width * (up_y - ray_y * u), longest);
}
