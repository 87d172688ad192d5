#include "plugin/bake/volume_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/constants.h"
#include "core/plan/breaking.h"
#include "core/spectrum/gauss.h"
#include "core/spectrum/spectral_moments.h"
#include "core/waves/breaking_rate.h"
#include "core/waves/whitecaps.h"
#include "plugin/bake/level_set.h"
#include "plugin/bake/volumes.h"
#include "plugin/format/vdb/vdb.h"

namespace pelagic {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBlock = vdb::kBlock;

// The share of a standard normal variable below x.
double normal_share(double x) {
    return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

// Blocks along z that so many voxels in a row meet, wherever they begin.
double blocks_of_row(double voxels) {
    return (voxels + kBlock - 1.0) / kBlock;
}

// First-order variances of J: of the trace of the displacement gradient.
struct JacobianVariance {
    double whole = 0.0,
           resolved = 0.0;         // of all waves that break, and of what the voxels' footprint shows of them
    double gradient_per_m2 = 0.0;  // of the resolved J's gradient, both components together
};

JacobianVariance jacobian_variance(const Plan& plan, double footprint_m) {
    const DirectionalSpectrum& spectrum = plan.from->spectrum;
    const Breaking& breaking = plan.breaking;
    JacobianVariance of;
    const auto add = [&](double from, double to, double share) {
        const auto moment = [&](const auto& factor) {
            return GaussLegendre<8>::rule().integrate(from, to, [&](double k) {
                const double pressed =
                    share * breaking.choppiness.largest() * k * spectrum.dispersion().horizontal_ratio(k);
                return factor(k) * pressed * pressed * spectrum.omnidirectional(k);
            });
        };
        const auto resolved = [&](double k) {
            const double weight = plan.filter.weight(k, footprint_m);
            return weight * weight;
        };
        of.whole += moment([](double) { return 1.0; });
        of.resolved += moment(resolved);
        of.gradient_per_m2 += moment([&](double k) { return k * k * resolved(k); });
    };
    breaking.choppiness.for_panels(spectrum, 0.0, breaking.k_end(), add);
    return of;
}

JacobianMoments<double> jacobian_of(const SpectralMoments& gradient, double pressed, double direction) {
    const double c = std::cos(direction), s = std::sin(direction);
    return jacobian_moments<double>(
        -pressed * c * c, -pressed * s * s, -pressed * c * s, -pressed * c * s,
        {gradient.xxxx, gradient.xxxy, gradient.xxyy, gradient.xyyy, gradient.yyyy});
}

}  // namespace

ExpectedSpray expected_spray(const Plan& plan) {
    const Scene& scene = plan.from->scene;
    const DirectionalSpectrum& spectrum = plan.from->spectrum;
    const double voxel_m = scene.output.voxel_m;
    const bool third = plan.knobs.third_moment;
    const SpectralMoments total = moments_with_breaking(spectrum, 0.0, kInfinity, plan.breaking);
    const double threshold = calibrated_threshold(
        total, law_coverage(scene), mean_choppiness(spectrum, plan.breaking), third, foam_life(plan));
    const JacobianVariance variance = jacobian_variance(plan, plan.breaking.footprint_of(voxel_m));
    if (!has_spray(scene) || !std::isfinite(threshold) || !(variance.resolved > 0.0)) return {};

    // How far a voxel's sea must be compressed for spray: there what its footprint leaves unresolved breaks now and
    // then.
    const double direction = total.mean_direction();
    SpectralMoments unresolved = total;
    unresolved.scale_gradients(std::max(1.0 - variance.resolved / variance.whole, 0.0));
    const auto whole = jacobian_of(total, 0.0, direction);
    const double least = kNegligibleSpray * coverage(whole, threshold, third);
    if (!(least > 0.0)) return {};
    double pressed = 0.0;
    for (double low = -1.0, high = 1.0; high - low > 1e-6;) {
        pressed = 0.5 * (low + high);
        (coverage(jacobian_of(unresolved, pressed, direction), threshold, third) > least ? high : low) =
            pressed;
    }
    const double deviate =
        breaking_deviate({.mean = 0.0,
                          .variance = variance.resolved,
                          .third = whole.third * std::pow(variance.resolved / whole.variance, 1.5)},
                         -pressed, third);

    // Of the world's columns: water that is compressed covers less of it.
    const double share = std::clamp(1.0 - pressed, 0.0, 1.0) * normal_share(deviate);
    const double side =
        (kBlock - 1.0) * voxel_m * std::sqrt(0.5 * variance.gradient_per_m2 / variance.resolved);
    const double edge = std::exp(-0.5 * deviate * deviate);
    // Of excursions that begin beside a voxel and reach it. They come in groups, along crests: a fifth fewer were found alone.
    constexpr double kAlone = 0.8;
    const double nearby =
        std::max(kAlone * edge * (side / kPi - side * side * deviate / std::pow(kTwoPi, 1.5)), 0.0);
    const double hit = share + (1.0 - share) * -std::expm1(-nearby / std::max(1.0 - share, 1e-9));
    const double columns = voxels_a_side(scene), blocks = std::ceil(columns / kBlock);
    const SprayLaw law = spray_law(scene, plan.from->extent.significant_height_m);
    // Most ribbons are hardly lifted; and lifted ones leave room below.
    const double high = (spray_top_m(law) - SprayRibbons::kMostLift * law.ribbons.step_m *
                                                (law.ribbons.extinction_per_m.x > 0.0)) /
                            voxel_m +
                        1.0;
    // Ribbons come from several places upwind, more or less each for itself.
    const double from = law.ribbons.extinction_per_m.x > 0.0 ? 6.0 : 1.0;
    return {.blocks = blocks * blocks * (1.0 - std::pow(1.0 - hit, from)) * blocks_of_row(high),
            .voxels = columns * columns * (1.0 - std::pow(1.0 - share, from)) * high};
}

double expected_level_set_blocks(const Plan& plan) {
    const Scene& scene = plan.from->scene;
    const double voxel_m = scene.output.voxel_m, columns = voxels_a_side(scene);
    // In voxels from here on. Waves that are shorter than a block are no slope of its surface.
    const SpectralMoments waves = moments(plan.from->spectrum, 0.0, kTwoPi / (kBlock * voxel_m));
    const double deviation = std::max(std::sqrt(plan.from->spectrum.m0()) / voxel_m, 1e-6);
    const double band = 2.0 * kHalfWidth_voxels;
    const double rise = std::sqrt(2.0 / kPi) * (kBlock - 1.0) * (std::sqrt(waves.xx) + std::sqrt(waves.yy));
    const double reach = 0.5 * (band * std::sqrt(1.0 + waves.mss()) + rise);
    const double floor = std::floor(-plan.from->extent.height_m / voxel_m) - kBelow_voxels;

    const auto block_of = [](double voxel) { return std::floor(voxel / kBlock); };
    const double lowest = block_of(floor - kHalfWidth_voxels);
    const double along_floor = block_of(floor + kHalfWidth_voxels - 1.0) - lowest + 1.0;
    // A block's voxels have their middles from a half on to 7.5.
    const double farthest = std::ceil((8.0 * deviation + reach) / kBlock);
    double along_surface = 0.0, along_side = 0.0;
    for (double block = -farthest; block <= farthest; ++block)
        along_surface += normal_share((kBlock * (block + 1.0) - 0.5 + reach) / deviation) -
                         normal_share((kBlock * block + 0.5 - reach) / deviation);
    for (double block = lowest; block <= farthest; ++block)
        along_side += normal_share((kHalfWidth_voxels - 0.5 - kBlock * block) / deviation);
    // Near a side lie the first two columns of blocks, and those beside the last voxel.
    const double all = block_of(columns - 1.0 + kHalfWidth_voxels) + 2.0;
    const double inner = std::max(block_of(columns - kHalfWidth_voxels) - 1.0, 0.0);
    return inner * inner * std::min(along_surface + along_floor, along_side) +
           (all * all - inner * inner) * along_side;
}

}  // namespace pelagic
