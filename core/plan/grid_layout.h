// How a field's N × N samples lie in memory: what the plan counts, Frame fills and evaluate() reads.
#pragma once

#include <cstddef>

namespace pelagic {

// Columns that repeat the first ones behind each row's last, so that whoever reads across a period's seam
// need not wrap.
inline constexpr std::size_t kRowSkirt = 16;

// From row to row: a multiple of a cache line, never of half a page (the pieces of a column would all compete
// for the same few places of the caches).
template <class T>
constexpr std::size_t line_stride(int n) {
    constexpr std::size_t kLine = 64 / sizeof(T), kHalfPage = 2048 / sizeof(T);
    const std::size_t stride = (static_cast<std::size_t>(n) + kRowSkirt + kLine - 1) / kLine * kLine;
    return stride % kHalfPage == 0 ? stride + kLine : stride;
}

// Rows are filled two at a time: an odd N has one more than it shows.
template <class T>
constexpr std::size_t grid_samples(int n) {
    return (static_cast<std::size_t>(n) + 1) / 2 * 2 * line_stride<T>(n);
}
constexpr std::size_t grid_bytes(int n, bool double_precision) {
    return double_precision ? grid_samples<double>(n) * sizeof(double)
                            : grid_samples<float>(n) * sizeof(float);
}

}  // namespace pelagic
