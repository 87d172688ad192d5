#include "tests/plugin/host/procedural/first_version.h"

#include "tests/plugin/host/procedural/first_version/pelagic/procedural.h"

namespace pelagic::test {

FirstVersion ask_as_first_version(const char* text, double time_s, const std::vector<float>& rest_m,
                                  float footprint_m) {
    const std::size_t count = rest_m.size() / 2;
    FirstVersion answer;
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = text;
    pelagic_sea* sea = nullptr;
    pelagic_frame* frame = nullptr;
    if (pelagic_open(&source, nullptr, &sea, nullptr) != PELAGIC_OK ||
        pelagic_frame_create(sea, time_s, time_s, &frame, nullptr) != PELAGIC_OK)
        return answer;
    const std::vector<float> footprints_m(count, footprint_m);
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.count = count;
    points.rest_m = rest_m.data();
    points.cell_m = points.pixel_m = footprints_m.data();
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    answer.coverage.resize(count);
    values.coverage = answer.coverage.data();
    if (pelagic_evaluate(frame, &points, &values, nullptr) != PELAGIC_OK) answer.coverage.clear();

    std::vector<float> offset_m, direction;
    for (std::size_t i = 0; i < count; ++i) {
        offset_m.insert(offset_m.end(), {rest_m[2 * i], rest_m[2 * i + 1], 30.0f});
        direction.insert(direction.end(), {0.0f, 0.0f, -1.0f});
    }
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    rays.count = count;
    rays.offset_m = offset_m.data();
    rays.direction = direction.data();
    rays.footprint_m = footprints_m.data();
    answer.of_hits.resize(count);
    answer.rest_m.resize(2 * count);
    values.coverage = answer.of_hits.data();
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    hits.rest_m = answer.rest_m.data();
    hits.values = &values;
    if (pelagic_intersect(frame, &rays, &hits, nullptr) != PELAGIC_OK) answer.of_hits.clear();

    pelagic_info info = PELAGIC_INIT(pelagic_info);
    if (pelagic_get_info(sea, &info, nullptr) == PELAGIC_OK)
        answer.frame_bytes = static_cast<double>(info.frame_bytes);
    pelagic_frame_release(frame);
    pelagic_close(sea);
    return answer;
}

}  // namespace pelagic::test
