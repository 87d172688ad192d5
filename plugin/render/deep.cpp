#include "plugin/render/deep.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numeric>
#include <utility>

namespace pelagic {
namespace {

constexpr float kVeilBegins_m = 0.1f, kFirstCut_m = 2.0f;
// What is less joins the next one.
constexpr double kLeastAlpha = 1e-5;

struct Part {
    double alpha = 0.0;
    glm::dvec3 light{0.0};
    void add(double more, const glm::dvec3& of) {
        alpha += more;
        light += of;
    }
};

struct Surfaces : Part {
    float id = 0.0f, first_m = 0.0f;
    double z_m = 0.0;              // the mean
    std::vector<std::size_t> all;  // sights

    void take(const Surfaces& other) {
        z_m = (alpha * z_m + other.alpha * other.z_m) / (alpha + other.alpha);
        add(other.alpha, other.light);
        first_m = std::min(first_m, other.first_m);
        all.insert(all.end(), other.all.begin(), other.all.end());
    }
};

// The two of one kind that are closest by the ratio of their distances.
bool merge_closest(std::vector<Surfaces>& of) {
    std::pair<std::size_t, std::size_t> best{0, 0};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < of.size(); ++i)
        for (std::size_t k = i + 1; k < of.size(); ++k)
            if (of[i].id == of[k].id && of[k].z_m < least * of[i].z_m) {
                least = of[k].z_m / of[i].z_m;
                best = {i, k};
            }
    if (best.first == best.second) return false;
    of[best.first].take(of[best.second]);
    of.erase(of.begin() + static_cast<std::ptrdiff_t>(best.second));
    return true;
}

std::vector<Surfaces> surfaces_of(std::span<const DeepSight> sights) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < sights.size(); ++i)
        if (sights[i].alpha > 0.0f) order.push_back(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return sights[a].z_m < sights[b].z_m; });
    std::vector<Surfaces> of;
    for (const std::size_t i : order) {
        const DeepSight& sight = sights[i];
        Surfaces one{{static_cast<double>(sight.alpha), glm::dvec3(sight.light)},
                     sight.id,
                     sight.z_m,
                     static_cast<double>(sight.z_m),
                     {i}};
        if (!of.empty() && of.back().id == sight.id && sight.z_m <= (1.0f + kDeepNear) * of.back().first_m)
            of.back().take(one);
        else
            of.push_back(std::move(one));
    }
    while (of.size() > kMostDeepSurfaces && merge_closest(of)) {
    }
    std::stable_sort(of.begin(), of.end(),
                     [](const Surfaces& a, const Surfaces& b) { return a.z_m < b.z_m; });
    // Programs blend what lies at the same distance.
    float last_m = 0.0f;
    for (Surfaces& one : of) {
        one.first_m = std::max(static_cast<float>(one.z_m),
                               std::nextafter(last_m, std::numeric_limits<float>::infinity()));
        last_m = one.first_m;
    }
    return of;
}

}  // namespace

std::uint32_t add_deep_pixel(std::span<const DeepSight> sights, const std::function<float(float)>& hides,
                             std::vector<DeepSample>& to) {
    const std::vector<Surfaces> surfaces = surfaces_of(sights);
    const bool has_veil =
        std::any_of(sights.begin(), sights.end(), [](const DeepSight& sight) { return sight.veil > 0.0f; });

    // The veil's parts end at the cuts, the last one nowhere.
    std::vector<float> cuts_m;
    for (const Surfaces& one : surfaces) cuts_m.push_back(one.first_m);
    float farthest_m = 0.0f;
    for (const DeepSight& sight : sights) farthest_m = std::max(farthest_m, sight.z_m);
    for (std::size_t i = 0; i < kVeilCuts && has_veil; ++i)
        if (const float cut_m = std::ldexp(kFirstCut_m, 2 * static_cast<int>(i)); cut_m < farthest_m)
            cuts_m.push_back(cut_m);
    std::sort(cuts_m.begin(), cuts_m.end());
    cuts_m.erase(std::unique(cuts_m.begin(), cuts_m.end()), cuts_m.end());
    std::vector<Part> veil(cuts_m.size() + 1);
    if (has_veil) {
        std::vector<double> hidden;  // before each part's end
        for (std::size_t i = 0; i < veil.size(); ++i) {
            const float end_m = i < cuts_m.size() ? cuts_m[i] : std::numeric_limits<float>::infinity();
            hidden.push_back(
                std::max(hidden.empty() ? 0.0 : hidden.back(), static_cast<double>(hides(end_m))));
        }
        std::vector<float> ends_m(sights.size());
        for (std::size_t i = 0; i < sights.size(); ++i) ends_m[i] = sights[i].z_m;
        for (const Surfaces& one : surfaces)
            for (const std::size_t i : one.all) ends_m[i] = one.first_m;
        for (std::size_t i = 0; i < sights.size(); ++i) {
            if (!(sights[i].veil > 0.0f)) continue;
            const auto last = static_cast<std::size_t>(
                std::lower_bound(cuts_m.begin(), cuts_m.end(), ends_m[i]) - cuts_m.begin());
            for (std::size_t part = 0; part <= last; ++part) {
                const double share = hidden[last] > 0.0
                                         ? (hidden[part] - (part > 0 ? hidden[part - 1] : 0.0)) / hidden[last]
                                     : part == last ? 1.0
                                                    : 0.0;
                veil[part].add(share * static_cast<double>(sights[i].veil),
                               share * glm::dvec3(sights[i].veil_light));
            }
        }
    }

    const std::size_t before = to.size();
    double left = 1.0;
    Part carried;
    const auto put = [&](double least, float z_m, float z_back_m, float id) {
        if (!(carried.alpha > least)) return;
        const double rest = std::max(left, kLeastAlpha);
        double alpha = std::min(carried.alpha / rest, 1.0);
        if (alpha > 1.0 - kLeastAlpha) alpha = 1.0;
        to.push_back({glm::vec3(carried.light / rest), static_cast<float>(alpha), z_m, z_back_m, id});
        left -= carried.alpha;
        carried = {};
    };
    std::size_t next = 0;
    float veil_from_m = 0.0f;
    for (std::size_t part = 0; part < veil.size(); ++part) {
        const bool is_last = part == cuts_m.size();
        const float begin_m = part > 0  ? cuts_m[part - 1]
                              : is_last ? kVeilBegins_m
                                        : std::min(kVeilBegins_m, 0.5f * cuts_m[part]);
        const float end_m = is_last ? 2.0f * std::max(begin_m, 1.0f) : cuts_m[part];
        if (carried.alpha <= kLeastAlpha) veil_from_m = begin_m;
        carried.add(veil[part].alpha, veil[part].light);
        // Behind the last part nothing comes that it could join.
        put(is_last ? kLeastAlpha : static_cast<double>(kLeastVeil), veil_from_m, end_m, 0.0f);
        if (!is_last && next < surfaces.size() && surfaces[next].first_m == cuts_m[part]) {
            const Surfaces& one = surfaces[next++];
            carried.add(one.alpha, one.light);
            put(kLeastAlpha, one.first_m, one.first_m, one.id);
        }
    }
    return static_cast<std::uint32_t>(to.size() - before);
}

std::size_t most_deep_samples(std::size_t sights, std::size_t objects, bool has_veil) {
    // Kinds: the objects, the sea and drops.
    const std::size_t surfaces = std::min(sights, std::max(kMostDeepSurfaces, objects + 2));
    return has_veil ? 2 * surfaces + kVeilCuts + 1 : surfaces;
}

}  // namespace pelagic
