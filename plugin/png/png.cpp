// PNG through libpng, onto a string.
#include "plugin/png/png.h"

#include <png.h>

#include <csetjmp>
#include <exception>
#include <new>
#include <stdexcept>

namespace pelagic::png {
namespace {

constexpr int kLargest = 1000000;  // [pixels] per side: the library's limit
// zlib's level, 1 … 9. Pictures of a sea look like noise to it: higher levels only take longer.
constexpr int kZipLevel = 3;

// The state of the library's callbacks. C++ exceptions must not pass through its C code.
struct Sink {
    std::string bytes;
    std::exception_ptr error;
};

extern "C" void pelagic_png_write(png_structp file, png_bytep bytes, std::size_t count) {
    auto& sink = *static_cast<Sink*>(png_get_io_ptr(file));
    try {
        sink.bytes.append(reinterpret_cast<const char*>(bytes), count);
        return;
    } catch (...) {
        sink.error = std::current_exception();
    }
    png_error(file, "no memory");
}

extern "C" void pelagic_png_flush(png_structp) {}

// Returns false if the library failed. Has no local with a destructor, because the library uses longjmp().
bool write(png_structp file, png_infop info, const Image& image) {
    if (setjmp(png_jmpbuf(file)) != 0) return false;
    const auto width = static_cast<png_uint_32>(image.width);
    png_set_user_limits(file, kLargest, kLargest);
    png_set_compression_level(file, kZipLevel);
    png_set_IHDR(file, info, width, static_cast<png_uint_32>(image.height), 8, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(file, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (!image.comment.empty()) {
        png_text text{};
        text.compression = PNG_TEXT_COMPRESSION_NONE;
        text.key = const_cast<png_charp>("Comment");  // the library copies both
        text.text = const_cast<png_charp>(image.comment.c_str());
        text.text_length = image.comment.size();
        png_set_text(file, info, &text, 1);
    }
    png_write_info(file, info);
    for (int y = 0; y < image.height; ++y)
        png_write_row(file, image.rgb.data() + std::size_t{3} * width * static_cast<std::size_t>(y));
    png_write_end(file, nullptr);
    return true;
}

}  // namespace

std::string encode(const Image& image) {
    const std::string size = std::to_string(image.width) + " x " + std::to_string(image.height);
    if (image.width < 1 || image.width > kLargest || image.height < 1 || image.height > kLargest)
        throw std::invalid_argument("a picture of " + size + " pixels: both must be 1 to 1000000");
    if (image.rgb.size() != std::size_t{3} * image.width * image.height)
        throw std::invalid_argument("a picture of " + size + " pixels with " +
                                    std::to_string(image.rgb.size()) + " bytes: three a pixel are needed");
    Sink sink;
    png_structp file = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr,
                                               [](png_structp, png_const_charp) {});  // warnings
    png_infop info = file == nullptr ? nullptr : png_create_info_struct(file);
    bool whole = false;
    if (info != nullptr) {
        png_set_write_fn(file, &sink, pelagic_png_write, pelagic_png_flush);
        whole = write(file, info, image);
    }
    png_destroy_write_struct(&file, &info);
    if (sink.error) std::rethrow_exception(sink.error);
    if (!whole) throw std::bad_alloc();  // the only failure left after the checks above
    return std::move(sink.bytes);
}

}  // namespace pelagic::png
