#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <stdexcept>

#include "core/base/build_watch.h"
#include "core/base/instruction_set.h"
#include "core/plan/fingerprint.h"
#include "core/scene/canonical.h"
#include "plugin/accuracy/accuracy.h"

namespace pelagic {
namespace {

constexpr std::chrono::seconds kPartTime{3};

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

std::string shot_hash(const Scene& shot) {
    return Fingerprint().add(canonical(shot)).text();
}

MeasuredRow sweep(const ApproximationRow& row, const Scene& shot, int repeats, const SweepWatch& watch) {
    using Clock = std::chrono::steady_clock;
    MeasuredRow measured{.name = row.name,
                         .shot = shot_hash(shot),
                         .when = utc_now(),
                         .machine = instruction_set() + ", " +
                                    std::to_string(tbb::this_task_arena::max_concurrency()) + " threads",
                         .settings = {}};
    stop_if(watch.cancel);
    if (watch.progress) watch.progress(row.name, "building");
    Trials laid = row.lay_out(shot);
    measured.why_none = laid.why_none;
    std::vector<std::vector<double>> ms(laid.trials.size());
    for (Trial& trial : laid.trials) {
        stop_if(watch.cancel);
        if (watch.progress) watch.progress(row.name, trial.setting);
        trial.run();
        std::vector<double> errors = trial.errors();
        if (errors.size() != row.errors.size() ||
            !std::all_of(errors.begin(), errors.end(), [](double e) { return std::isfinite(e); }))
            throw std::logic_error(std::string(row.name) + ", " + trial.setting +
                                   ": its errors aren't the row's, or aren't finite");
        measured.settings.push_back(
            {trial.setting, trial.is_shots, std::move(errors), 0.0, trial.bytes, trial.transforms});
        if (watch.picture && trial.picture)
            watch.picture(row.name, measured.settings.size(), trial.picture());
    }
    const bool is_of_parts = row.kind == RowKind::Parts;
    const auto begin = Clock::now();
    const auto is_enough = [&](int rounds) {
        if (!is_of_parts) return rounds >= repeats;
        return rounds >= kPartRepeats * repeats &&
               (Clock::now() - begin > kPartTime || rounds >= 10 * kPartRepeats * repeats);
    };
    for (int i = 0; !is_enough(i); ++i)
        for (std::size_t t = 0; t < laid.trials.size(); ++t) {
            stop_if(watch.cancel);
            if (watch.progress) watch.progress(row.name, laid.trials[t].setting);
            const auto start = Clock::now();
            laid.trials[t].run();
            ms[t].push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
        }
    for (std::size_t t = 0; t < ms.size(); ++t) {
        measured.settings[t].ms = median(ms[t]);
        if (!is_of_parts || t == 0) continue;
        std::vector<double> less;
        for (std::size_t i = 0; i < ms[t].size(); ++i) less.push_back(ms[0][i] - ms[t][i]);
        measured.settings[t].ms = measured.settings[0].ms - median(less);
    }
    return measured;
}

}  // namespace pelagic
