#include "core/waves/sea_over_time.h"

#include <cmath>
#include <utility>

namespace pelagic {

template <class T>
SeaOverTime<T>::SeaOverTime(Plan plan, const BuildWatch& watch, const SeaOverTime* like)
    : plan_(std::move(plan)) {
    const auto table_of = [&](std::size_t key) {
        return like ? like->seas_[key]->spectrum_table() : nullptr;
    };
    if (!plan_.from->weather) {
        seas_.push_back(std::make_shared<const Sea<T>>(plan_, watch, table_of(0),
                                                       like ? like->seas_[0]->coast() : nullptr));
        return;
    }
    const std::vector<Weather::Key>& keys = plan_.from->weather->keys;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (i > 0 && keys[i].sea == keys[i - 1].sea) {
            seas_.push_back(seas_.back());
            continue;
        }
        if (keys[i].waves < i) {
            seas_.push_back(std::make_shared<const Sea<T>>(*seas_[keys[i].waves], keys[i].sea));
            continue;
        }
        BuildWatch part{.progress = {}, .cancel = watch.cancel};
        if (watch.progress)
            part.progress = [&, i](double done) {
                watch.progress((static_cast<double>(i) + done) / static_cast<double>(keys.size()));
            };
        Plan own = plan_;
        own.from = keys[i].sea;
        seas_.push_back(std::make_shared<const Sea<T>>(std::move(own), part, table_of(i)));
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (i == 0) {
            // As if the first key's depth had been there before it.
            const auto first = depth_at(*plan_.from, keys[0].time_s);
            if (!first) return;
            const DepthAt::Part until{first->depth_m, keys[0].time_s};
            turns_.push_back(seas_[0]->turned(nullptr, {&until, 1}));
            continue;
        }
        turns_.push_back(seas_[0]->turned(&turns_.back(), depth_until(*plan_.from, i)));
    }
}

template <class T>
std::optional<OverDepth> SeaOverTime<T>::over_depth(double t_s) const {
    const auto depth = turns_.empty() ? std::nullopt : depth_at(*plan_.from, t_s);
    if (!depth) return std::nullopt;
    return OverDepth{.depth_m = depth->depth_m,
                     .depth_mps = depth->depth_mps,
                     .time_s = t_s,
                     .turns = seas_[0]->turned(&turns_[depth->key], depth->parts)};
}

template <class T>
SeaOverTime<T>::SeaOverTime(std::shared_ptr<const Sea<T>> sea) : plan_(sea->plan()), seas_{std::move(sea)} {}

template <class T>
double SeaOverTime<T>::significant_height_m(double t_s) const {
    const auto height_m = [&](std::size_t key) { return seas_[key]->total().significant_height_m(); };
    if (!plan_.from->weather) return height_m(0);
    const Weather::Blend blend = plan_.from->weather->at(t_s);
    const double first_m = height_m(blend.first), second_m = height_m(blend.second);
    return std::sqrt((1.0 - blend.share) * first_m * first_m + blend.share * second_m * second_m);
}

template <class T>
Whitecaps SeaOverTime<T>::whitecaps(double t_s) const {
    if (!plan_.from->weather) return seas_.front()->whitecaps();
    const Weather::Blend blend = plan_.from->weather->at(t_s);
    const auto displacement = displacement_at(*plan_.from, t_s);
    if (blend.first == blend.second && !displacement) return seas_[blend.first]->whitecaps();
    return Sea<T>::whitecaps_between(*seas_[blend.first], *seas_[blend.second], blend.share,
                                     prepared_at(plan_.from, t_s), displacement);
}

template <class T>
std::shared_ptr<const Sea<T>> SeaOverTime<T>::at(double t_s) const {
    if (!plan_.from->weather) return seas_.front();
    const Weather::Blend blend = plan_.from->weather->at(t_s);
    const auto displacement = displacement_at(*plan_.from, t_s);
    const auto over = over_depth(t_s);
    if (blend.first == blend.second && !displacement && !over) return seas_[blend.first];
    return std::make_shared<const Sea<T>>(*seas_[blend.first], *seas_[blend.second], blend.share,
                                          blend.rate_per_s, prepared_at(plan_.from, t_s), displacement,
                                          over ? &*over : nullptr);
}

template class SeaOverTime<float>;
template class SeaOverTime<double>;

}  // namespace pelagic
