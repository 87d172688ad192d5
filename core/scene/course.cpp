#include "core/scene/course.h"

#include <algorithm>
#include <sstream>
#include <string>

namespace pelagic {

std::optional<std::vector<CourseKey>> course_of(std::string_view path) {
    std::vector<CourseKey> keys;
    for (std::size_t from = 0; from <= path.size();) {
        const std::size_t end = std::min(path.find(',', from), path.size());
        std::istringstream words{std::string(path.substr(from, end - from))};
        words.imbue(std::locale::classic());
        CourseKey key;
        std::string more;
        if (!(words >> key.frame >> key.east_m >> key.north_m) || words >> more) return std::nullopt;
        keys.push_back(key);
        from = end + 1;
    }
    return keys;
}

}  // namespace pelagic
