// The preview's window. See window.h.
#include "plugin/host/preview/window.h"

// Included before GLFW, which then leaves OpenGL's declarations to it.
#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/lighting/tone.h"
#include "core/scene/canonical.h"
#include "core/scene/number_keys.h"
#include "core/scene/shot_text.h"
#include "core/scene/text.h"
#include "core/surface/view.h"
#include "core/waves/whitecaps.h"
#include "plugin/files/files.h"
#include "plugin/format/png/png.h"
#include "plugin/host/gpu/foam_worker.h"
#include "plugin/host/preview/controls.h"
#include "plugin/host/preview/drawn_objects.h"
#include "plugin/host/preview/live.h"
#include "plugin/host/preview/orbit.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/render/seen_drops.h"
#include "plugin/render/under_water.h"

namespace pelagic {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTurn_per_px = 0.005;  // [rad]: a window's width is about half a turn
constexpr double kHaste = 5.0;          // the factor of Shift on a flight's speed
constexpr std::size_t kHistory = 120;   // pictures in the graph
constexpr double kSmoothing = 0.1;      // of the displayed times, to make them readable
// Limits the step of playing and flying after a slow picture.
constexpr double kLongestStep_s = 0.25;
constexpr double kIdle_s = 0.05;  // between pictures that show nothing new

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// GLFW's description of the last error.
std::string glfw_reason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? std::string("no reason given") : std::string(text);
}

class Glfw {
  public:
    Glfw() {
        if (glfwInit() != GLFW_TRUE)
            throw PreviewError(
                "there is no display to open a window on (" + glfw_reason() +
                "); draw without one with --offscreen FILE.png, or give the window a display of its own: "
                "xvfb-run -s '-screen 0 1280x720x24' pelagic preview …");
    }
    ~Glfw() { glfwTerminate(); }
    Glfw(const Glfw&) = delete;
    Glfw& operator=(const Glfw&) = delete;
};

// The window's size: the requested or the shot's, limited by the screen.
glm::ivec2 window_size(const Scene& scene, const WindowOptions& options) {
    if (options.size.x > 0 && options.size.y > 0) return options.size;
    glm::ivec2 room(1280, 720);
    if (GLFWmonitor* monitor = glfwGetPrimaryMonitor(); monitor != nullptr) {
        glm::ivec2 corner(0);
        glfwGetMonitorWorkarea(monitor, &corner.x, &corner.y, &room.x, &room.y);
    }
    const glm::ivec2 wanted = scene.camera.resolution;
    const double scale =
        std::min({1.0, static_cast<double>(room.x) / wanted.x, static_cast<double>(room.y) / wanted.y});
    return glm::max(glm::ivec2(static_cast<int>(wanted.x * scale), static_cast<int>(wanted.y * scale)),
                    glm::ivec2(320, 200));
}

class Window {
  public:
    Window(glm::ivec2 size, const std::string& title) {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
        glfwWindowHint(GLFW_DEPTH_BITS, 0);  // the renderer has its own depth buffer
        glfwWindowHint(GLFW_STENCIL_BITS, 0);
        window_ = glfwCreateWindow(size.x, size.y, title.c_str(), nullptr, nullptr);
        if (window_ == nullptr)
            throw PreviewError(
                "the display gives no OpenGL 3.3 core context (" + glfw_reason() +
                "); update its driver, or set LIBGL_ALWAYS_SOFTWARE=1 for Mesa's software one, "
                "or draw without a window: --offscreen FILE.png");
        glfwMakeContextCurrent(window_);
        glfwSetWindowUserPointer(window_, this);
        // Set before Dear ImGui's callback, which calls this one. Dear ImGui only knows which keys are down
        // when a picture begins; this one also catches a short press between two slow pictures.
        glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
            if (action == GLFW_RELEASE) return;
            static_cast<Window*>(glfwGetWindowUserPointer(window))
                ->pressed_.push_back({key, action == GLFW_REPEAT});
        });
    }
    ~Window() { glfwDestroyWindow(window_); }
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    GLFWwindow* get() const { return window_; }
    glm::ivec2 size_px() const {
        glm::ivec2 size(0);
        glfwGetFramebufferSize(window_, &size.x, &size.y);
        return size;
    }
    // Framebuffer pixels per window unit, the unit of mouse positions.
    double mouse_scale() const {
        glm::ivec2 size(0);
        glfwGetWindowSize(window_, &size.x, &size.y);
        return size.x > 0 ? static_cast<double>(size_px().x) / size.x : 1.0;
    }
    float content_scale() const {
        float x = 1.0f, y = 1.0f;
        glfwGetWindowContentScale(window_, &x, &y);
        return std::clamp(std::max(x, y), 1.0f, 4.0f);
    }
    bool is_down(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
    struct Press {
        int key;
        bool repeated;  // held down
    };
    // Presses since the last call, in order.
    std::vector<Press> take_pressed() { return std::exchange(pressed_, {}); }

  private:
    GLFWwindow* window_ = nullptr;
    std::vector<Press> pressed_;
};

class Gui {
  public:
    explicit Gui(const Window& window) {
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;  // writes no settings file
        set_controls_style(window.content_scale());
        ImGui_ImplGlfw_InitForOpenGL(window.get(), true);
        ImGui_ImplOpenGL3_Init("#version 330 core");
    }
    ~Gui() {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;
};

// Saves the back buffer as a PNG.
void save_window(glm::ivec2 size, const std::filesystem::path& file) {
    const auto row = static_cast<std::size_t>(size.x) * 3;
    std::vector<std::uint8_t> upwards(row * size.y), rgb(upwards.size());
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glReadBuffer(GL_BACK);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, size.x, size.y, GL_RGB, GL_UNSIGNED_BYTE, upwards.data());
    for (std::size_t y = 0; y < static_cast<std::size_t>(size.y); ++y)
        std::copy_n(upwards.begin() + static_cast<std::ptrdiff_t>(y * row), row,
                    rgb.end() - static_cast<std::ptrdiff_t>((y + 1) * row));
    files::write_atomically(file, png::encode({.width = size.x, .height = size.y, .bytes = rgb}));
}

// The first free name: NAME.preview.0001.png, …
std::filesystem::path picture_name(const std::filesystem::path& folder, const std::string& name) {
    for (int i = 1;; ++i) {
        const std::string number = std::to_string(i);
        std::filesystem::path file =
            folder / (name + ".preview." + std::string(4 - std::min<std::size_t>(number.size(), 4), '0') +
                      number + ".png");
        std::error_code unknown;  // ignored: writing will report an unreadable folder
        if (!std::filesystem::exists(file, unknown)) return file;
    }
}

// Light and the artist's picture of foam, made in the background like the sea.
struct LiveSky {
    Sky sky;
    std::shared_ptr<const FoamImage> foam_picture;
};

std::shared_ptr<const LiveSky> build_sky(const Scene& scene) {
    LiveSky made;
    made.sky = make_sky(scene);
    made.foam_picture = kept_foam_picture(scene);
    return std::make_shared<const LiveSky>(std::move(made));
}

bool same_light(const Scene& a, const Scene& b) {
    return light_content(a) == light_content(b);
}

class Preview {
  public:
    Preview(const Scene& scene, const WindowOptions& options)
        : options_(options),
          shot_(scene),
          window_(window_size(scene, options), "Pelagic: " + scene.shot.name),
          gui_(window_),
          controls_(controls_for(scene)),
          skies_(build_sky) {
        controls_.pixel_size = options.pixel_size != 0 ? options.pixel_size : renderer_.is_software() ? 2 : 1;
        if (options.frame) {
            controls_.frame = *options.frame;
            controls_.playing = false;
        }
        shown_frame_ = controls_.frame;
        readout_.device = renderer_.device();
        camera_.take(view_at(scene.camera, scene.shot.first_frame));
        // Synchronises with the screen, except for a screenshot.
        glfwSwapInterval(options.screenshot ? 0 : 1);
        lit_ = now_ = scene_at(scene, std::round(controls_.frame));
        show_sky(build_sky(now_));
        sea_.ask(scene);
    }

    void run() {
        auto last = Clock::now();
        while (glfwWindowShouldClose(window_.get()) == 0) {
            is_idle() ? glfwWaitEventsTimeout(kIdle_s) : glfwPollEvents();
            const glm::ivec2 size = window_.size_px();
            if (size.x <= 0 || size.y <= 0) {  // minimised
                glfwWaitEventsTimeout(kIdle_s);
                continue;
            }
            const double whole_ms = milliseconds_since(last);
            last = Clock::now();
            begin_picture(whole_ms);
            act();
            // Playing starts with the first sea.
            if (frame_ != nullptr) play_on(controls_, std::min(whole_ms * 1e-3, kLongestStep_s), shot_.shot);
            move(std::min(whole_ms * 1e-3, kLongestStep_s));
            take_what_is_ready();
            if (options_.screenshot && !readout_.message.empty() && readout_.message != note_)
                throw PreviewError(readout_.message);
            draw_sea(size);
            if (std::exchange(save_picture_, false)) save_without_panel(size);
            ImGui::Render();
            ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
            if (is_screenshot_due()) {
                save_window(size, *options_.screenshot);
                tell_speed();
                return;
            }
            const auto presenting = Clock::now();
            glfwSwapBuffers(window_.get());
            smooth(readout_.times.present_ms, milliseconds_since(presenting));
        }
        if (options_.screenshot)
            throw PreviewError("the window was closed before its picture was there: no " +
                               options_.screenshot->string() + "; leave it open, or lower --after");
        glfwHideWindow(window_.get());  // closing waits for a build in progress
    }

  private:
    static void smooth(double& shown, double now) {
        shown = shown > 0.0 ? shown + kSmoothing * (now - shown) : now;
    }

    // Nothing moves and there is no input: pictures may be rare.
    bool is_idle() const {
        return !options_.screenshot && !controls_.playing && !is_flying_ && !readout_.building_sea &&
               !readout_.building_sky && shown_frame_ == controls_.frame && !ImGui::IsAnyMouseDown();
    }

    void begin_picture(double whole_ms) {
        smooth(readout_.times.total_ms, whole_ms);
        readout_.history_ms.push_back(static_cast<float>(whole_ms));
        if (readout_.history_ms.size() > kHistory) readout_.history_ms.erase(readout_.history_ms.begin());
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
    }

    // Handles the panel and the keys.
    void act() {
        const auto start = Clock::now();
        const Clicks clicks = draw_controls(controls_, readout_, shot_);
        smooth(readout_.times.panel_ms, milliseconds_since(start));
        const ImGuiIO& io = ImGui::GetIO();
        if (clicks.reset) {
            const Controls fresh = controls_for(shot_);
            controls_.scene = fresh.scene;
            controls_.draw = fresh.draw;
            controls_.exposure_stops = fresh.exposure_stops;
        }
        if (clicks.shot_camera || clicks.reset) readout_.follows_shot = true;
        if (clicks.copy) copy();
        if (clicks.save && options_.save) save_shot();
        for (const Window::Press& press : window_.take_pressed())
            if (!io.WantTextInput) act_on(press);
    }

    void act_on(const Window::Press& press) {
        const auto step = [&](int frames) {
            controls_.playing = false;
            go_to(controls_, std::round(controls_.frame) + frames, shot_.shot);
        };
        if (press.key == GLFW_KEY_RIGHT) return step(1);
        if (press.key == GLFW_KEY_LEFT) return step(-1);
        if (press.repeated) return;
        switch (press.key) {
            case GLFW_KEY_ESCAPE:
                return glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
            case GLFW_KEY_Q:
                if (ImGui::GetIO().KeyCtrl) glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
                return;
            case GLFW_KEY_F1:
                controls_.show_help = !controls_.show_help;
                return;
            case GLFW_KEY_TAB:
                controls_.show_panel = !controls_.show_panel;
                return;
            case GLFW_KEY_F12:
                save_picture_ = true;
                return;
            case GLFW_KEY_HOME:
                readout_.follows_shot = true;
                return;
            case GLFW_KEY_SPACE:
                return play_or_pause(controls_, shot_.shot);
            default:
                return;
        }
    }

    // What the panel asks for, with the camera's current pose.
    Scene scene_now() const {
        Scene now = controls_.scene;
        if (!readout_.follows_shot) {
            const auto millimetres = [](glm::dvec3 v_m) { return glm::round(v_m * 1e3) / 1e3; };
            now.camera.position_m = millimetres(camera_.position_m());
            now.camera.look_at_m = millimetres(camera_.middle_m());
        }
        return now;
    }

    void copy() {
        const std::string keys = shot_text(scene_now(), shot_);
        glfwSetClipboardString(window_.get(),
                               keys.empty() ? "# nothing differs from the shot\n" : keys.c_str());
    }

    void save_shot() {
        const Scene now = scene_now();
        try {
            options_.save(now, shot_);
            shot_ = controls_.scene = now;
            save_error_.clear();
        } catch (const std::runtime_error& error) {
            save_error_ = error.what();
        }
    }

    // Moves the camera by mouse and keys. Until the first movement it follows the shot's.
    void move(double step_s) {
        const ImGuiIO& io = ImGui::GetIO();
        const View lens = lens_now();
        const glm::dvec2 hand(io.MouseDelta.x, io.MouseDelta.y);
        const auto is_dragging = [&](int button) {
            // Skips the picture of the press itself: its mouse movement came before.
            return !io.WantCaptureMouse && ImGui::IsMouseDown(button) && !ImGui::IsMouseClicked(button) &&
                   (hand.x != 0.0 || hand.y != 0.0);
        };
        const bool left = is_dragging(ImGuiMouseButton_Left);
        const bool slides = is_dragging(ImGuiMouseButton_Middle) || (left && io.KeyShift);
        const bool looks = is_dragging(ImGuiMouseButton_Right);
        const double wheel = io.WantCaptureMouse ? 0.0 : static_cast<double>(io.MouseWheel);
        const auto axis = [&](int more, int less) {
            return (window_.is_down(more) ? 1.0 : 0.0) - (window_.is_down(less) ? 1.0 : 0.0);
        };
        glm::dvec3 steering(0.0);
        if (!io.WantTextInput && !io.KeyCtrl)
            steering = {axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_W, GLFW_KEY_S),
                        axis(GLFW_KEY_E, GLFW_KEY_Q)};
        is_flying_ = steering != glm::dvec3(0.0);
        if (!left && !slides && !looks && wheel == 0.0 && !is_flying_) return;
        if (std::exchange(readout_.follows_shot, false)) camera_.take(lens);
        if (slides) {
            camera_.pan(hand * window_.mouse_scale() / static_cast<double>(controls_.pixel_size), lens);
        } else if (left) {
            camera_.orbit(-kTurn_per_px * hand);
        }
        if (looks) camera_.look(-kTurn_per_px * hand);
        camera_.zoom(wheel);
        camera_.fly({.steering = steering, .seconds = step_s, .haste = io.KeyShift ? kHaste : 1.0});
    }

    // The shot's camera at the displayed time, with the window's resolution. In a window wider than the shot
    // the vertical field of view is kept, in a narrower one the horizontal: the shot's picture is always
    // inside.
    View lens_now() const {
        View view = view_at(shot_.camera, shown_frame_);
        const glm::dvec2 shot_size(shot_.camera.resolution);
        view.resolution =
            glm::max((window_.size_px() + (controls_.pixel_size - 1)) / controls_.pixel_size, glm::ivec2(1));
        const double wider =
            static_cast<double>(view.resolution.x) / view.resolution.y * shot_size.y / shot_size.x;
        view.tan_half_width *= std::max(wider, 1.0);
        view.shift /= std::max(wider, 1.0);
        return view;
    }

    View view_now() const {
        const View lens = lens_now();
        return readout_.follows_shot ? lens : camera_.view(lens);
    }

    void show_sky(const std::shared_ptr<const LiveSky>& sky) {
        sky_ = sky;
        take_water();
        renderer_.set_sky(sky->sky, water_);
        meter();
    }

    std::string water_content() const { return canonical(now_, key_parts(KeyPart::Water)); }
    void take_water() {
        water_of_ = frame_ ? frame_->packed->layout() : nullptr;
        water_ = water_of_ ? make_water(now_, water_of_->sea().plan().from->spectrum) : make_water(now_);
        water_from_ = water_content();
        take_floor(frame_ ? frame_->build->drawn->rest_m() : 0.0);
    }

    // Pictures of the floor are read only when what it is made of changes: another wind has the same.
    void take_floor(double rest_m) {
        std::string from = water_from_ + number_text(now_.sea.depth_m) + " " + number_text(rest_m);
        if (from == floor_from_) return;
        floor_from_ = std::move(from);
        floor_.reset();
        floor_error_.clear();
        if (!water_.has_body) return;
        try {
            floor_ = std::make_shared<const Floor>(make_floor(now_, rest_m));
        } catch (const std::invalid_argument& error) {  // a picture that is gone
            floor_error_ = error.what();
        }
    }

    void meter() {
        metered_wind_mps_ = controls_.scene.sea.wind_speed_mps;
        // Where a map of depths is gone, as the panel says, over deep water.
        const Floor deep;
        exposure_ = shot_exposure(now_, sky_->sky, 0.0, floor_ ? floor_.get() : &deep);
    }

    // Requests what the panel asks for and takes finished results, without waiting.
    void take_what_is_ready() {
        now_ = scene_at(controls_.scene, std::round(controls_.frame));
        if (!same_light(lit_, now_)) {
            lit_ = now_;
            skies_.ask(lit_);
        }
        if (const auto sky = skies_.take()) show_sky(sky);
        if (sky_ && metered_wind_mps_ != controls_.scene.sea.wind_speed_mps) meter();
        sea_.ask(controls_.scene);
        const View view = view_now();
        const bool may_be_wet = frame_ == nullptr || frame_->build->drawn->may_be_under_waves(view);
        const auto only_if = [&](bool wanted) { return wanted ? std::optional<View>(view) : std::nullopt; };
        has_spray_ = render_options(controls_.scene).lighting.spray;
        sea_.show(shot_.shot.time_s(controls_.frame), only_if(may_be_wet), only_if(has_spray_),
                  floor_before(view),
                  shot_.objects.empty() ? std::nullopt : std::optional<double>(controls_.frame));
        const std::shared_ptr<const LiveBuild> before = frame_ ? frame_->build : nullptr;
        frame_ = sea_.newest();
        const bool is_other = (frame_ && frame_->build != before) || water_content() != water_from_;
        if (is_other || (frame_ && frame_->packed->layout() !=
                                       water_of_)) {  // a sea that changes has its own water at each time
            take_water();
            renderer_.set_water(water_);
            if (is_other) meter();
        }
        const LiveStatus status = sea_.status();
        if (!std::exchange(readout_.building_sea, status.building)) asked_at_ = Clock::now();
        readout_.built = status.built;
        readout_.waited_s = 1e-3 * milliseconds_since(asked_at_);
        readout_.building_sky = skies_.is_busy();
        readout_.message = status.error.empty() ? skies_.error() : status.error;
        const DrawnSea* drawn = frame_ ? frame_->build->drawn.get() : nullptr;
        controls_.draw.from_below = drawn && drawn->is_below(view);
        is_under_water_ = !controls_.draw.from_below && (sea_.water_over_eye().has_value() ||
                                                         (drawn && drawn->cage_above(view).has_value()));
        if (readout_.message.empty() && is_under_water_)
            readout_.message =
                drawn && drawn->has_below()
                    ? "the camera is under water among the waves, which only pelagic render "
                      "draws: raise it (E), or lower it (Q)"
                    : "the camera is under water, which can't be drawn: raise it (E), or wait for "
                      "the wave to pass";
        if (frame_ != nullptr && std::exchange(uploaded_, frame_->number) != frame_->number) upload();
        for (const std::string& error : {upload_error_, floor_error_, save_error_})
            if (readout_.message.empty()) readout_.message = error;
        if (frame_ != nullptr && frame_->build->note != note_) {
            note_ = frame_->build->note;
            if (!note_.empty()) std::cerr << "pelagic: note: " << note_ << '\n';
        }
        if (readout_.message.empty()) readout_.message = note_;
        readout_.has_sea = frame_ != nullptr;
        if (frame_ == nullptr) return;
        readout_.significant_height_m = frame_->build->drawn->grid_options().significant_height_m;
        readout_.times.build_s = frame_->build->build_s;
        smooth(readout_.times.transforms_ms, frame_->transforms_ms);
        smooth(readout_.times.packing_ms, frame_->packing_ms);
    }

    void upload() {
        // The camera goes with the sea that is shown, which may be an earlier frame's.
        const Shot& shot = shot_.shot;
        const double sea_s = frame_->packed->time_s();
        shown_frame_ = controls_.frame;
        if (sea_s != shot.time_s(controls_.frame) && shot.time_scale != 0.0) {
            shown_frame_ = 1.0 + (sea_s - shot.time_offset_s) / shot.time_scale * shot.fps;
            // In a loop every round has such a frame: the nearest one.
            if (const double round = std::round(shot.loop_s * shot.fps); round > 0.0)
                shown_frame_ += round * std::round((controls_.frame - shown_frame_) / round);
        }
        try {
            renderer_.upload(*frame_->packed);
            upload_error_.clear();
        } catch (const PreviewError& error) {
            upload_error_ = error.what();
        }
    }

    void draw_sea(glm::ivec2 size) {
        const View view = view_now();
        readout_.camera_m = view.position_m;
        readout_.drawn_px = view.resolution;
        // Nothing rather than a wrong picture, or the sky of half the globe over a sea that isn't there yet.
        if (is_under_water_ || frame_ == nullptr) {
            glBindFramebuffer(GL_FRAMEBUFFER, 0);
            glViewport(0, 0, size.x, size.y);
            glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
            glClear(GL_COLOR_BUFFER_BIT);
            return;
        }
        const auto start = Clock::now();
        // Cells in pixels of the picture as drawn, as in `pelagic render` of that size: with larger pixels there are
        // fewer vertices.
        const auto mesh = std::make_shared<SeaMesh>();
        frame_->build->drawn->lay_out({view, static_cast<int>(std::lround(controls_.frame))}, *mesh,
                                      controls_.scene.surface.cell_px);
        smooth(readout_.times.grid_ms, milliseconds_since(start));
        follow_foam(view, {mesh, &mesh->points});
        const Sea<float>& sea = frame_->packed->layout()->sea();
        controls_.draw.foam =
            make_foam(now_, sky_ ? sky_->foam_picture : nullptr,
                      sea.plan().foam ? active_foam(sea.plan().from->scene, sea.residual_coverage()) : 1.0);
        controls_.draw.lighting.spray = has_spray_;
        lacks_drops_ = false;
        if (has_spray_)
            show_spray(view);
        else
            renderer_.set_spray({});
        const std::shared_ptr<const Floor> lit_floor = sea_.newest_floor();
        renderer_.set_floor(lit_floor ? lit_floor : floor_);
        show_objects();
        renderer_.draw(view, *mesh, controls_.draw);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glViewport(0, 0, size.x, size.y);
        renderer_.show(exposure_ * static_cast<float>(std::exp2(controls_.exposure_stops)),
                       white_balance(now_.camera.white_balance_k));
        readout_.times.gpu = renderer_.times();
    }

    // The floor and the water as they are lit before a camera, where their pattern is seen at all.
    std::optional<LiveSea::FloorWanted> floor_before(const View& view) const {
        constexpr int kSide = 512;  // half of a single picture's: each frame has one
        const bool is_below = frame_ && frame_->build->drawn->is_below(view);
        if (!floor_ || !sky_ || now_.water.caustics == 0.0 ||
            !(is_below || floor_->has_depths() || shows_floor(water_, static_cast<double>(water_.floor_m))))
            return {};
        return LiveSea::FloorWanted{.floor = floor_,
                                    .light = {.view = view,
                                              .water = water_,
                                              .sun_direction = sky_->sky.sun_direction,
                                              .sun_angular_radius = sky_->sky.sun_angular_radius,
                                              .gain = now_.water.caustics,
                                              .side = kSide,
                                              .is_below = is_below}};
    }

    void show_objects() {
        const auto ready = sea_.newest_objects();
        if (!ready || !sky_) return renderer_.set_objects({}, {});
        renderer_.set_objects(
            *ready, object_surroundings(controls_.draw.lighting, sky_->sky, water_, law_coverage(now_)));
    }

    // The spray before the last camera for which it is ready, and its drops.
    void show_spray(const View& view) {
        lacks_drops_ = are_drops_near(frame_->build->scene, view);
        const std::shared_ptr<const Spray> ready = sea_.newest_spray();
        if (!ready || !sky_) return;
        Spray spray = *ready;
        light_spray(spray, controls_.draw.lighting, sky_->sky, water_, law_coverage(now_));
        // Drops fly on while later ones are computed, as long as that is nearly their way.
        constexpr double kLongest_s = 0.5;
        const std::shared_ptr<const LiveDrops> drops = sea_.newest_drops();
        double late_s = drops ? frame_->packed->time_s() - drops->time_s : 0.0;
        if (const double loop_s = frame_->build->sea->first()->loop_s(); loop_s > 0.0)
            late_s = std::remainder(late_s, loop_s);
        if (drops && drops->build == frame_->build && std::abs(late_s) <= kLongest_s) {
            renderer_.set_spray(spray, {drops, &drops->drops}, late_s);
            lacks_drops_ = false;
        } else {
            renderer_.set_spray(spray);
        }
    }

    // Persistent foam comes when it is ready. Until then a picture shows what there is.
    void follow_foam(const View& view, const std::shared_ptr<const ProjectedGrid>& grid) {
        if (foam_of_ != frame_->build) {
            foam_worker_.reset();
            foam_of_ = frame_->build;
            foam_view_.reset();
            if (frame_->packed->layout()->has_living_foam()) foam_worker_.emplace(foam_of_->sea);
            if (foam_worker_ && upload_error_.empty())
                renderer_.upload_foam(std::make_shared<const PackedFoam>());  // not the last sea's
        }
        const bool is_seen =
            controls_.draw.lighting.whitecaps || controls_.draw.false_colour == FalseColour::Coverage;
        if (!foam_worker_ || !is_seen || !upload_error_.empty()) return;
        const double time_s = frame_->packed->time_s();
        if (foam_view_ != view || foam_time_s_ != time_s) {
            foam_view_ = view;
            foam_time_s_ = time_s;
            foam_worker_->ask(time_s, {grid});
        }
        if (const auto foam = foam_worker_->take()) renderer_.upload_foam(foam);
        if (readout_.message.empty()) readout_.message = foam_worker_->error();
    }

    void save_without_panel(glm::ivec2 size) {
        try {
            save_window(size, picture_name(options_.folder, shot_.shot.name));
            save_error_.clear();
        } catch (const files::FileError& error) {
            save_error_ = error.what();
        }
    }

    bool is_screenshot_due() {
        if (!options_.screenshot || frame_ == nullptr) return false;
        if (foam_worker_ && foam_worker_->is_busy()) return false;
        if (lacks_drops_) return false;
        if (pictures_++ == 0) first_picture_ = Clock::now();
        return pictures_ >= options_.screenshot_after;
    }

    // The first picture compiles the shaders, and doesn't count.
    void tell_speed() const {
        const double seconds = 1e-3 * milliseconds_since(first_picture_);
        std::cout << "picture: " << options_.screenshot->string() << '\n';
        if (pictures_ > 1)
            std::cout << (pictures_ - 1) / seconds << " pictures a second, " << readout_.drawn_px.x << " x "
                      << readout_.drawn_px.y << ", drawn by " << readout_.device << '\n';
        const PictureTimes& times = readout_.times;
        std::cout << "milliseconds: grid " << times.grid_ms << ", panel " << times.panel_ms << ", submitting "
                  << times.gpu.submit_ms << ", upload " << times.gpu.upload_ms << ", sea " << times.gpu.sea_ms
                  << ", sky " << times.gpu.sky_ms << ", showing " << times.gpu.show_ms << ", presenting "
                  << times.present_ms << "; beside it: transforms " << times.transforms_ms << ", packing "
                  << times.packing_ms << std::endl;
    }

    const WindowOptions options_;
    Scene shot_;  // as its file has it
    Glfw glfw_;
    Window window_;
    Gui gui_;
    Controls controls_;
    Readout readout_;
    SeaRenderer renderer_;
    OrbitCamera camera_;
    std::shared_ptr<const LiveSky> sky_;  // the one that is shown
    double metered_wind_mps_ = 0.0;
    float exposure_ = 1.0f;
    WaterBody water_;
    std::shared_ptr<const Floor> floor_;  // null: the water has no body
    std::string water_from_, floor_from_;
    std::shared_ptr<const SeaLayout> water_of_;
    Scene now_;  // the panel's at the frame that plays, without keys
    Scene lit_;  // the scene whose light was requested last
    const LiveFrame* frame_ = nullptr;
    long uploaded_ = 0;  // the frame's number
    double shown_frame_ = 1.0;
    int pictures_ = 0;
    Clock::time_point first_picture_, asked_at_ = Clock::now();
    std::shared_ptr<const LiveBuild> foam_of_;
    std::optional<FoamWorker> foam_worker_;  // of foam_of_, where its foam is persistent
    std::optional<View> foam_view_;          // what it was asked for last
    double foam_time_s_ = 0.0;
    bool is_flying_ = false, save_picture_ = false, is_under_water_ = false, has_spray_ = false,
         lacks_drops_ = false;  // that are still to come
    std::string upload_error_, floor_error_, save_error_, note_;
    LiveWorker<Scene, LiveSky> skies_;
    LiveSea sea_{LiveLimits{.memory = machine::memory_limit_or(options_.max_memory_bytes),
                            .texture = renderer_.largest_texture()}};
};

}  // namespace

void run_window(const Scene& scene, const WindowOptions& options) {
    Preview(scene, options).run();
}

}  // namespace pelagic
