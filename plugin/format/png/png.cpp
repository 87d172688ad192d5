// PNG through libpng, onto a string.
#include "plugin/format/png/png.h"

#include <png.h>

#include <csetjmp>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <vector>

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

extern "C" {  // static: libpelagic shows its own functions alone
static void png_write_bytes(png_structp file, png_bytep bytes, std::size_t count) {
    auto& sink = *static_cast<Sink*>(png_get_io_ptr(file));
    try {
        sink.bytes.append(reinterpret_cast<const char*>(bytes), count);
        return;
    } catch (...) {
        sink.error = std::current_exception();
    }
    png_error(file, "no memory");
}

static void png_flush_bytes(png_structp) {}

static void png_read_bytes(png_structp file, png_bytep bytes, std::size_t count) {
    auto& left = *static_cast<std::string_view*>(png_get_io_ptr(file));
    if (left.size() < count) png_error(file, "the file ends too early");
    std::memcpy(bytes, left.data(), count);
    left.remove_prefix(count);
}
}  // extern "C"

// Unpacks the bytes that are `left`, row after row into `row`. As write().
bool read(png_structp file, png_infop info, std::string_view& left, png_bytep row) {
    if (setjmp(png_jmpbuf(file)) != 0) return false;
    png_set_read_fn(file, &left, png_read_bytes);
    png_set_user_limits(file, kLargest, kLargest);
    png_set_crc_action(file, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_benign_errors(file, 0);
    png_read_info(file, info);
    const png_uint_32 height = png_get_image_height(file, info);
    for (png_uint_32 y = 0; y < height; ++y) png_read_row(file, row, nullptr);
    png_read_end(file, nullptr);
    return left.empty();
}

// Up to the pixels, and the pixels, whatever they are, as three bytes each. As write().
bool read_header(png_structp file, png_infop info, std::string_view& left) {
    if (setjmp(png_jmpbuf(file)) != 0) return false;
    png_set_read_fn(file, &left, png_read_bytes);
    png_set_user_limits(file, kLargest, kLargest);
    png_set_crc_action(file, PNG_CRC_ERROR_QUIT, PNG_CRC_WARN_DISCARD);
    png_read_info(file, info);
    return true;
}
bool read_pixels(png_structp file, png_infop info, png_bytepp rows) {
    if (setjmp(png_jmpbuf(file)) != 0) return false;
    png_set_scale_16(file);
    png_set_expand(file);
    png_set_gray_to_rgb(file);
    png_set_strip_alpha(file);
    png_set_interlace_handling(file);
    png_read_update_info(file, info);
    if (png_get_rowbytes(file, info) != std::size_t{3} * png_get_image_width(file, info)) return false;
    png_read_image(file, rows);
    png_read_end(file, nullptr);
    return true;
}

std::size_t bytes_a_pixel(const Image& image) {
    return image.has_alpha ? 4 : 3;
}

// Returns false if the library failed. Has no local with a destructor, because the library uses longjmp().
bool write(png_structp file, png_infop info, const Image& image) {
    if (setjmp(png_jmpbuf(file)) != 0) return false;
    const auto width = static_cast<png_uint_32>(image.width);
    png_set_user_limits(file, kLargest, kLargest);
    png_set_compression_level(file, kZipLevel);
    png_set_IHDR(file, info, width, static_cast<png_uint_32>(image.height), 8,
                 image.has_alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
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
        png_write_row(file, image.bytes.data() + bytes_a_pixel(image) * width * static_cast<std::size_t>(y));
    png_write_end(file, nullptr);
    return true;
}

}  // namespace

std::string encode(const Image& image) {
    const std::string size = std::to_string(image.width) + " x " + std::to_string(image.height);
    if (image.width < 1 || image.width > kLargest || image.height < 1 || image.height > kLargest)
        throw std::invalid_argument("a picture of " + size + " pixels: both must be 1 to 1000000");
    if (image.bytes.size() != bytes_a_pixel(image) * image.width * image.height)
        throw std::invalid_argument(
            "a picture of " + size + " pixels with " + std::to_string(image.bytes.size()) +
            " bytes: " + std::to_string(bytes_a_pixel(image)) + " a pixel are needed");
    Sink sink;
    png_structp file = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr,
                                               [](png_structp, png_const_charp) {});  // warnings
    png_infop info = file == nullptr ? nullptr : png_create_info_struct(file);
    bool whole = false;
    if (info != nullptr) {
        png_set_write_fn(file, &sink, png_write_bytes, png_flush_bytes);
        whole = write(file, info, image);
    }
    png_destroy_write_struct(&file, &info);
    if (sink.error) std::rethrow_exception(sink.error);
    if (!whole) throw std::bad_alloc();  // the only failure left after the checks above
    return std::move(sink.bytes);
}

Pixels decode(std::string_view bytes, std::size_t most) {
    constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
    if (!bytes.starts_with(kSignature)) throw ReadError("is no PNG");
    png_structp file = png_create_read_struct(
        PNG_LIBPNG_VER_STRING, nullptr, [](png_structp reader, png_const_charp) { png_longjmp(reader, 1); },
        [](png_structp, png_const_charp) {});
    png_infop info = file == nullptr ? nullptr : png_create_info_struct(file);
    struct Closed {
        png_structp& file;
        png_infop& info;
        ~Closed() { png_destroy_read_struct(&file, &info, nullptr); }
    } const closed{file, info};
    if (info == nullptr) throw std::bad_alloc();
    constexpr const char* kDamaged = "is cut short or damaged";
    if (!read_header(file, info, bytes)) throw ReadError(kDamaged);
    const std::size_t width = png_get_image_width(file, info), height = png_get_image_height(file, info);
    if (width * height > most)
        throw ReadError("has " + std::to_string(width) + " x " + std::to_string(height) +
                        " pixels, more than there is room for");
    Pixels pixels{static_cast<int>(width), static_cast<int>(height),
                  std::vector<std::uint8_t>(3 * width * height)};
    std::vector<png_bytep> rows(height);
    for (std::size_t y = 0; y < height; ++y) rows[y] = pixels.rgb.data() + 3 * width * y;
    if (!read_pixels(file, info, rows.data())) throw ReadError(kDamaged);
    return pixels;
}

bool is_whole(std::string_view bytes) {
    // The signature, the header's length and name, and its content: width, height, 8 bits of red, green and
    // blue, or of those and alpha.
    constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
    constexpr std::string_view kColours("\x08\x02\0\0\0", 5), kWithAlpha("\x08\x06\0\0\0", 5);
    constexpr std::size_t kWidth = 16, kColoursAt = 24, kHeader = 33;
    if (bytes.size() < kHeader || !bytes.starts_with(kSignature)) return false;
    const std::string_view colours = bytes.substr(kColoursAt, kColours.size());
    if (colours != kColours && colours != kWithAlpha) return false;
    std::size_t width = 0;
    for (std::size_t i = kWidth; i < kWidth + 4; ++i)
        width = width << 8 | static_cast<std::uint8_t>(bytes[i]);
    if (width > kLargest) return false;
    std::vector<std::uint8_t> row(4 * width);
    // Neither errors nor warnings are printed.
    png_structp file = png_create_read_struct(
        PNG_LIBPNG_VER_STRING, nullptr, [](png_structp reader, png_const_charp) { png_longjmp(reader, 1); },
        [](png_structp, png_const_charp) {});
    png_infop info = file == nullptr ? nullptr : png_create_info_struct(file);
    if (info == nullptr) {
        png_destroy_read_struct(&file, &info, nullptr);
        throw std::bad_alloc();
    }
    const bool whole = read(file, info, bytes, row.data());  // `bytes` are then what is left
    png_destroy_read_struct(&file, &info, nullptr);
    return whole;
}

}  // namespace pelagic::png
