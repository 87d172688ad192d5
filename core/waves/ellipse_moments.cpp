#include "core/waves/ellipse_moments.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/plan/taps.h"
#include "core/spectrum/gauss.h"

namespace pelagic {
namespace {

constexpr int kNodesALevel = EllipseTable::kNodesALevel, kNodesAnOctave = EllipseTable::kNodesAnOctave,
              kRatios = EllipseTable::kRatios, kDirections = EllipseTable::kDirections;
constexpr int kSectors = 48;  // of half a turn: a wave and its opposite count alike
static_assert(kSectors % EllipseTable::kDirections == 0);

// A few per cent of a cascade's band, by direction.
struct Band {
    int cascade;
    double k;                                        // where its slopes are
    std::array<double, kSectors> slopes, gradients;  // k²E and choppiness² coth² k²E of each sector
};

std::vector<Band> bands_of(const Plan& plan, const Query& query) {
    const DirectionalSpectrum& spectrum = plan.from->spectrum;
    const auto panels = spectrum.panels();
    const auto& rule = GaussLegendre<4>::rule();
    std::vector<Band> bands;
    for (int c = 0; c < static_cast<int>(plan.cascades.size()); ++c) {
        if (query.only_cascade && *query.only_cascade != c) continue;
        const CascadePlan& cascade = plan.cascades[c];
        if (cascade.vessel) continue;  // none of the spectrum's
        const double choppiness2 = cascade.choppiness * cascade.choppiness;
        // Resolutions that the plan chose are fine enough for the finest footprint only, and must not decide about
        // coarser ones' bits: their bands count to the end.
        const double end = plan.from->scene.waves.cascades.empty()
                               ? cascade.k_upper
                               : std::min(cascade.k_upper, kPi * cascade.resolution / cascade.size_m);
        for (std::size_t p = 0; p + 1 < panels.size(); ++p) {
            const double from = std::max(panels[p], cascade.k_lower), to = std::min(panels[p + 1], end);
            if (!(from < to)) continue;
            double slopes = 0.0, gradients = 0.0, k = 0.0;
            for (std::size_t i = 0; i < rule.node.size(); ++i) {
                const double at = 0.5 * (from + to) + 0.5 * (to - from) * rule.node[i];
                const double e = 0.5 * (to - from) * rule.weight[i] * spectrum.omnidirectional(at);
                const double ratio =
                    at < plan.breaking.k_end() ? spectrum.dispersion().horizontal_ratio(at) : 0.0;
                k += at * at * at * e;
                slopes += at * at * e;
                gradients += choppiness2 * ratio * ratio * at * at * e;
            }
            if (!(slopes > 0.0)) continue;
            Band band{.cascade = c, .k = k / slopes, .slopes = {}, .gradients = {}};
            const double all = spectrum.arc(band.k, 0.0, kTwoPi), step = kPi / kSectors;
            if (!(all > 0.0)) continue;
            for (int s = 0; s < kSectors; ++s) {
                const double first = (s - 0.5) * step;
                const double share = (spectrum.arc(band.k, first, first + step) +
                                      spectrum.arc(band.k, first + kPi, first + kPi + step)) /
                                     all;
                band.slopes[s] = share * slopes;
                band.gradients[s] = share * gradients;
            }
            bands.push_back(band);
        }
    }
    return bands;
}

}  // namespace

EllipseMoments::EllipseMoments(const Plan& plan, const Query& query)
    : widths_(kNodesALevel * (static_cast<int>(query.pixel_m.size()) - 1) + 1) {
    const std::vector<double>& levels_m = query.pixel_m;
    const std::vector<Band> bands = bands_of(plan, query);
    std::vector<double> whole_m;
    for (const CascadePlan& cascade : plan.cascades)
        whole_m.push_back(whole_footprint_m(cascade, plan.filter));
    values_.resize(static_cast<std::size_t>(widths_) * kRatios * kDirections);
    std::array<UnresolvedMoments<double>, kSectors> wave;  // moments of a sector of unit variance
    for (int s = 0; s < kSectors; ++s) {
        const double x = std::cos(kPi * s / kSectors), y = std::sin(kPi * s / kSectors);
        wave[s] = {x * x,         x * y,         y * y,         x * x * x * x,
                   x * x * x * y, x * x * y * y, x * y * y * y, y * y * y * y};
    }
    const auto node = [&](int width, int ratio) {
        const int lower = std::min(width / kNodesALevel, static_cast<int>(levels_m.size()) - 2);
        const double t = static_cast<double>(width) / kNodesALevel - lower;
        const double width_m = (1.0 - t) * levels_m[lower] + t * levels_m[lower + 1];
        const double length_m = width_m * std::exp2(static_cast<double>(ratio) / kNodesAnOctave);
        // Unresolved slopes and displacement gradients, by the angle between wave and axis and by the wave's own
        // direction.
        std::array<std::array<double, kSectors>, kSectors> slopes{}, gradients{};
        // By angle: what an ellipse as wide as `wide_m` leaves unresolved of the waves that levels with these
        // footprints resolve.
        using ByAngle = std::array<double, kSectors>;
        const auto unresolved_of = [&](const Band& band, double low_m, double high_m, double wide_m,
                                       ByAngle& unresolved) {
            const double resolved =
                (1.0 - t) * plan.filter.weight(band.k, low_m) + t * plan.filter.weight(band.k, high_m);
            const Taps<double> taps = taps_of(std::max(wide_m, whole_m[band.cascade]), length_m);
            if (!(resolved > 0.0) || last_tap(taps.reach) == 0) return false;
            for (int angle = 0; angle < kSectors; ++angle) {
                const double response = tap_response(taps, band.k * std::cos(kPi * angle / kSectors));
                unresolved[angle] = resolved * resolved * (1.0 - response) * (1.0 + response);
            }
            return true;
        };
        const Breaking& breaking = plan.breaking;
        const double low_m = levels_m[lower], high_m = levels_m[lower + 1];
        const bool is_apart = low_m < breaking.footprint_m;
        ByAngle unresolved;
        const auto add = [&](const ByAngle& by_wave, std::array<ByAngle, kSectors>& to) {
            for (int angle = 0; angle < kSectors; ++angle)
                for (int s = 0; s < kSectors; ++s) to[angle][s] += unresolved[angle] * by_wave[s];
        };
        for (const Band& band : bands) {
            const bool hides = unresolved_of(band, low_m, high_m, width_m, unresolved);
            if (hides) add(band.slopes, slopes);
            const bool hides_breaking =
                is_apart ? unresolved_of(band, breaking.footprint_of(low_m), breaking.footprint_of(high_m),
                                         breaking.footprint_of(width_m), unresolved)
                         : hides;
            if (hides_breaking) add(band.gradients, gradients);
        }
        for (int d = 0; d < kDirections; ++d) {
            UnresolvedMoments<double> sum{};
            for (int s = 0; s < kSectors; ++s) {
                const int angle = (s - d * (kSectors / kDirections) + kSectors) % kSectors;
                for (std::size_t m = 0; m < sum.size(); ++m)
                    sum[m] += wave[s][m] * (m < kUnresolvedSlopes ? slopes : gradients)[angle][s];
            }
            UnresolvedMoments<float>& to =
                values_[(static_cast<std::size_t>(width) * kRatios + ratio) * kDirections + d];
            std::transform(sum.begin(), sum.end(), to.begin(),
                           [](double v) { return static_cast<float>(v); });
        }
    };
    tbb::parallel_for(0, widths_ * (kRatios - 1),
                      [&](int i) { node(i / (kRatios - 1), i % (kRatios - 1) + 1); });
}

EllipseMoments::EllipseMoments(const EllipseMoments& first, const EllipseMoments& second, double share,
                               double gradients)
    : widths_(first.widths_), values_(first.values_.size()) {
    for (std::size_t i = 0; i < values_.size(); ++i)
        for (std::size_t m = 0; m < values_[i].size(); ++m)
            values_[i][m] = static_cast<float>((m < kUnresolvedSlopes ? 1.0 : gradients) *
                                               ((1.0 - share) * static_cast<double>(first.values_[i][m]) +
                                                share * static_cast<double>(second.values_[i][m])));
}

UnresolvedMoments<double> EllipseMoments::unresolved(double level, double ratio, double direction) const {
    UnresolvedMoments<double> sum{};
    if (values_.empty()) return sum;
    struct At {
        int node;
        double share;  // of the next
    };
    const auto between = [](double x, int nodes) {
        const int node = std::clamp(static_cast<int>(x), 0, std::max(nodes - 2, 0));
        return At{node, x - node};
    };
    const At w = between(level * kNodesALevel, widths_);
    const At r = between(std::log2(ratio) * kNodesAnOctave, kRatios);
    const double turn = direction / kPi;
    const double around = (turn - std::floor(turn)) * kDirections;
    const int before = std::min(static_cast<int>(around), kDirections - 1);
    for (int corner = 0; corner < 8; ++corner) {
        const int dw = corner & 1, dr = corner >> 1 & 1, dd = corner >> 2;
        const double share = (dw ? w.share : 1.0 - w.share) * (dr ? r.share : 1.0 - r.share) *
                             (dd ? around - before : 1.0 - (around - before));
        if (share == 0.0) continue;
        const UnresolvedMoments<float>& of =
            values_[(static_cast<std::size_t>(w.node + dw) * kRatios + r.node + dr) * kDirections +
                    (before + dd) % kDirections];
        for (std::size_t m = 0; m < sum.size(); ++m) sum[m] += share * static_cast<double>(of[m]);
    }
    return sum;
}

}  // namespace pelagic
