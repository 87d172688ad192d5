// The GLSL counterpart of core/base/number.h: the operations used by the shared formulas (*.inl).
#define T float

float select(bool which, float yes, float no) { return which ? yes : no; }
float minimum(float a, float b) { return min(a, b); }
float maximum(float a, float b) { return max(a, b); }
float magnitude(float x) { return abs(x); }
float minus_product(float c, float a, float b) { return c - a * b; }
float square_root(float x) { return sqrt(x); }
float exponential(float x) { return exp(x); }
float power(float x, float y) { return pow(x, y); }

float sine_of_cycles(float x) { return sin(6.28318530717958647692 * (x - floor(x + 0.5))); }
float cosine_of_cycles(float x) { return cos(6.28318530717958647692 * (x - floor(x + 0.5))); }

// One step of Newton's method corrects the hardware's pow(), which has no guaranteed precision.
float cube_root(float x) {
    float size = max(abs(x), 1e-30);
    float y = exp2(log2(size) / 3.0);
    y -= (y * y * y - size) / (3.0 * y * y);
    return x < 0.0 ? -y : y;
}

// erfc from special.glsl's erfcx(x) = exp(x²) erfc(x).
float complementary_error(float x) {
    float tail = exp(-x * x) * erfcx(abs(x));
    return x < 0.0 ? 2.0 - tail : tail;
}
