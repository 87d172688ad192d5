// The sea, built once: amplitudes, frequencies and what the spectrum holds. Immutable, shared by threads and
// frames.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/buffer.h"
#include "core/base/build_watch.h"
#include "core/plan/extent.h"
#include "core/plan/plan.h"
#include "core/plan/weather.h"
#include "core/spectrum/spectral_moments.h"
#include "core/spectrum/spectrum_table.h"
#include "core/waves/coast.h"
#include "core/waves/ellipse_moments.h"
#include "core/waves/gusts.h"
#include "core/waves/trains.h"

namespace pelagic {

struct FootprintPair;

struct FoamLife;  // core/waves/whitecaps.h

// The FFT component: the modes of one cascade (core/plan/mode_lattice.h gives their order), of its own band
// only; each quantity side by side.
//   h(k,t) = forward · e^{−iωt} + backward · e^{iωt},  forward = h0(k), backward = conj(h0(−k))
template <class T>
struct Cascade {
    double size_m = 0.0;
    int radius = 0;                    // 0: no modes
    std::vector<std::size_t> columns;  // where each mx begins, and the end of the last
    Buffer<T> forward_re, forward_im, backward_re, backward_im;  // [m]
    Buffer<T> chop;               // choppiness · coth(kd) / k [m] (Breaking's); empty where nobody asks
    Buffer<double> cycles_per_s;  // ω/2π, already rounded to the loop where there is one
    // Of amplitudes that change: their rates [m/s], parallel to the four above; empty where they don't, or nobody asks for velocities.
    std::array<Buffer<T>, 4> growth;
    Buffer<T> widening;  // likewise of chop, over it [1/s]

    std::size_t modes() const { return cycles_per_s.size(); }
    std::size_t held_bytes() const {
        std::size_t values = forward_re.size() + forward_im.size() + backward_re.size() + backward_im.size() +
                             chop.size() + widening.size();
        for (const Buffer<T>& rates : growth) values += rates.size();
        return values * sizeof(T) + cycles_per_s.size() * sizeof(double);
    }
    // Where (mx, my = 0) stands.
    std::size_t middle(int mx) const { return (columns[mx] + columns[mx + 1]) / 2; }
};

// What the spectrum holds, in expectation: sums and integrals of Ψ, not of one realisation.
struct QueryStatistics {
    // All waves that the query may be asked for: the whole spectrum, or the band alone for a cascade's own tile, so
    // that the unresolved parts of the tiles add up to the sea's. Displacement gradients: of the waves that break.
    SpectralMoments whole;
    // Resolved by pixel level i alone, weights squared, and by levels i and i + 1 together (for blends between them).
    // Displacement gradients: by the breaking level i.
    std::vector<SpectralMoments> resolved, resolved_next;
};

// Which water is foam, and how much of it there is, in expectation.
struct Whitecaps {
    double threshold = 0.0;  // J below this breaks (core/waves/whitecaps.h), in the mean wind
    // With persistent foam: the coverage that breaking leaves per second that it lasts. Means over the sea: the
    // coverage left by earlier breaking, before it is limited to 1, and the part of it that present breaking doesn't
    // cover, which is the coverage of residual foam.
    double left_per_s = 0.0, left_coverage = 0.0, residual_coverage = 0.0;
    std::optional<Gusts> gusts{};  // none unless Plan::gusts
};

template <class T>
class Sea {
  public:
    // On all threads of the calling arena; the same bits whatever their number. A mode's amplitude depends on
    // the spectrum, the cascade's size and band, and the seed: not on resolutions, nor on what is asked of
    // the sea. Throws BuildCancelled. `table`: of the plan's spectrum, from another sea of the same scene; null: made.
    // One sea: std::invalid_argument for the plan of a shot with weather, whose sea is a SeaOverTime's (core/waves/sea_over_time.h).
    // `coast`: of another sea of the same scene and trains, whose breaking waves are resolved alike; another one is made.
    explicit Sea(Plan, const BuildWatch& watch = {}, std::shared_ptr<const SpectrumTable> table = nullptr,
                 std::shared_ptr<const Coast<T>> coast = nullptr);
    // Of a scene that has the same waves: they are shared.
    Sea(const Sea& waves, std::shared_ptr<const PreparedScene> from);
    // Between two of one plan, which `from` takes the place of the scene of: energies in shares, that of `second` with its rate [1/s];
    // of another displacement than planned, and over another depth, if there are.
    Sea(const Sea& first, const Sea& second, double share, double rate_per_s,
        std::shared_ptr<const PreparedScene> from, const std::optional<DisplacementAt>& displacement,
        const OverDepth* over);

    // What its waves have turned by since `before` (nothing: by nothing), over these depths.
    Turns turned(const Turns* before, std::span<const DepthAt::Part> parts) const;

    const Plan& plan() const { return plan_; }
    const std::shared_ptr<const SpectrumTable>& spectrum_table() const { return table_; }
    std::span<const Cascade<T>> cascades() const { return *cascades_; }
    const Trains<T>& trains() const { return trains_; }  // none unless plan().trains
    // How the trains go where they feel the floor; null where they don't.
    const std::shared_ptr<const Coast<T>>& coast() const { return coast_; }
    // Whether waves break on a coast's floor, of trains or of tiles; coast_foam() of it.
    bool has_surf() const { return coast_ || (plan_.masks && plan_.masks->surf); }
    double surf_foam(glm::dvec2 place_m, double height_m, double cell_m) const {
        return coast_ ? coast_foam(*coast_, place_m, height_m, cell_m, plan_.filter)
                      : coast_foam(*plan_.masks->surf, place_m, height_m, cell_m, plan_.filter);
    }
    double loop_s() const { return loop_s_; }
    // Where it isn't as planned, which the cascades' chop is: Frame has the share of their horizontal displacement.
    const std::optional<DisplacementAt>& displacement() const { return displacement_; }
    // The whole sea, capillary tail included; Jacobian moments of the waves that break, times choppiness².
    const SpectralMoments& total() const { return total_; }
    const QueryStatistics& statistics(int query) const { return statistics_.at(query); }
    // What ellipses leave unresolved of the cascades' waves beyond their round part, for queries that may ask
    // (has_ellipse_table).
    const EllipseMoments& ellipses(int query) const { return ellipses_.at(query); }
    // How far the surface moves from rest, in expectation (core/plan/extent.h).
    const Extent& extent() const { return plan_.from->extent; }
    // What a query's finest pixels resolve of total(), cascades and trains.
    SpectralMoments resolved_moments(int query) const;
    const Whitecaps& whitecaps() const { return whitecaps_; }
    // As they were if foam came and went like this; {}: if none were persistent.
    Whitecaps whitecaps(const FoamLife& life) const;
    // What a sea between two, as above, has for its own.
    static Whitecaps whitecaps_between(const Sea& first, const Sea& second, double share,
                                       std::shared_ptr<const PreparedScene> from,
                                       const std::optional<DisplacementAt>& displacement);
    double whitecap_threshold() const { return whitecaps_.threshold; }
    const std::optional<Gusts>& gusts() const { return whitecaps_.gusts; }
    double foam_left_per_s() const { return whitecaps_.left_per_s; }
    double left_coverage() const { return whitecaps_.left_coverage; }
    double residual_coverage() const { return whitecaps_.residual_coverage; }
    // Σ over this cascade's modes within the plan's mode_radius of E|h|² [m²]: its band's m0 where that
    // reaches the band's end.
    double expected_m0(int cascade) const { return expected_m0_.at(cascade); }
    // What a slick hides of the slopes (core/plan/masks.h); nothing where the plan has none.
    const SpectralMoments& slick() const { return slick_; }

  private:
    class Progress;
    // total() of a sea between two, and its trains where it has some.
    static SpectralMoments total_between(const Sea& first, const Sea& second, double share, double rate_per_s,
                                         const Plan& plan, const std::optional<DisplacementAt>& displacement,
                                         const OverDepth* over = nullptr, Trains<T>* made = nullptr);
    std::vector<FootprintPair> pairs_of(int cascade, std::vector<QueryStatistics>& breaking);
    void raise_heroes();
    Cascade<T> build(int cascade, std::vector<QueryStatistics>& breaking, Progress&);

    Plan plan_;
    std::shared_ptr<const SpectrumTable> table_;
    double loop_s_;
    std::optional<DisplacementAt> displacement_;
    SpectralMoments total_;
    Whitecaps whitecaps_;
    std::shared_ptr<const std::vector<Cascade<T>>> cascades_;
    Trains<T> trains_;
    std::shared_ptr<const Coast<T>> coast_;
    std::vector<QueryStatistics> statistics_;
    std::vector<EllipseMoments> ellipses_;
    std::vector<double> expected_m0_;
    SpectralMoments slick_;
};

}  // namespace pelagic
